//! First-order lags: the tyre's relaxation and the attitude filter's mistake.

use model::STANDARD_GRAVITY_MPS2;

use crate::row::Row;

/// Time constant with which the attitude filter of the BorealTC Husky forgets an acceleration \[s\]; read off the decay of its
/// pitch at the beginnings of runs (1.1 to 1.5 s), on all of them.
pub const ATTITUDE_TIME_S: f64 = 1.2;

/// Relaxation of the tyre: side force follows the slip over the distance rolled.
///
/// ```text
/// dM'/dt = (ū / λ) (M − M'),   ū = (|u_l| + |u_r|) / 2,   M'(0) = M(0)
/// ```
///
/// M quasi-static moment, λ relaxation length \[m\]; exact for inputs that are constant over a step. H. B. Pacejka, *Tire
/// and Vehicle Dynamics* (2012), ch. 7.
pub fn relax(values: &mut [f64], rows: &[Row], length_m: f64) {
    let mut state = values.first().copied().unwrap_or(0.0);
    for (value, row) in values.iter_mut().zip(rows) {
        let rolled_m = (row.rim_mps.left.abs() + row.rim_mps.right.abs()) / 2.0 * row.step_s;
        state += (*value - state) * (1.0 - (-rolled_m / length_m).exp());
        *value = state;
    }
}

/// The tilt that an attitude filter reports because it takes acceleration for gravity \[rad\], one value a row.
///
/// ```text
/// de/dt = (v̇/g − e) / τ,   e(0) = v̇(0)/g
/// ```
pub fn tilt_error_rad(rows: &[Row], time_s: f64) -> Vec<f64> {
    let tilt = |row: &Row| row.rim_mps2.sum() / 2.0 / STANDARD_GRAVITY_MPS2;
    let mut state = rows.first().map_or(0.0, tilt);
    let step = |row: &Row| {
        state += (tilt(row) - state) * (1.0 - (-row.step_s / time_s).exp());
        state
    };
    rows.iter().map(step).collect()
}

#[cfg(test)]
mod tests {
    use model::Sides;

    use super::*;

    #[test]
    fn a_side_force_is_built_up_to_63_per_cent_over_one_relaxation_length() {
        let row = |step_s| Row { step_s, rim_mps: Sides::both(0.5), ..Row::default() };
        let rows: Vec<Row> = (0..=20).map(|i| row(if i == 0 { 0.0 } else { 0.01 })).collect();
        let mut values = vec![1.0; 21];
        values[0] = 0.0;
        relax(&mut values, &rows, 0.1);
        assert!((values[20] - (1.0 - (-1.0f64).exp())).abs() < 1e-12);
    }

    #[test]
    fn a_steady_acceleration_is_taken_for_a_tilt() {
        let rows = vec![Row { step_s: 0.1, rim_mps2: Sides::both(1.0), ..Row::default() }; 5];
        let tilt_rad = tilt_error_rad(&rows, ATTITUDE_TIME_S);
        assert!(tilt_rad.iter().all(|e| (e - 1.0 / STANDARD_GRAVITY_MPS2).abs() < 1e-12));
    }
}
