//! How much of the full skid resistance a tyre feels at a slip angle.

use model::{Robot, skid};

use crate::Drives;

/// The peaked slip law.
///
/// ```text
/// σ(α) = sin(C atan(α / α_s))
/// ```
///
/// α slip angle, α_s its scale \[rad\], C shape \[-\]. For C of 1 to 1.3 it is close to the tanh(α/α_s) of the robot file; above
/// 1.5 it peaks at α = α_s tan(π/2C) and falls beyond, as tyres do on ice. The form is H. B. Pacejka's Magic Formula
/// (*Tire and Vehicle Dynamics*, 3rd ed. 2012, eq. 4.49) with D = 1 and E = 0.
pub fn peaked(slip_angle_rad: f64, scale_rad: f64, shape: f64) -> f64 {
    (shape * (slip_angle_rad / scale_rad).atan()).sin()
}

/// A law `share · tanh(α / scale)`, which is what a robot file has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TanhLaw {
    /// Of the full skid resistance of the peaked law.
    pub share: f64,
    /// α_s of the robot file \[rad\].
    pub scale_rad: f64,
}

/// The tanh law whose skid moments are nearest to those of a peaked law, in the least-squares sense over the turns that were
/// driven. Where these spin in place on ice, the peaked law has fallen from its peak, and the share is well below one.
pub fn nearest_tanh(robot: &Robot, drives: &Drives, scale_rad: f64, shape: f64) -> TanhLaw {
    let turning: Vec<(f64, f64)> = drives
        .rows
        .iter()
        .filter(|row| row.used && !row.stuck && row.difference_mps().abs() > LEAST_DIFFERENCE_MPS)
        .map(|row| (row.speed_mps(), row.difference_mps() / robot.slip_track_m))
        .collect();
    let some: Vec<(f64, f64)> =
        turning.iter().copied().step_by(turning.len().div_ceil(MOST_TURNS).max(1)).collect();
    let moments = |law: &dyn Fn(f64) -> f64| -> Vec<f64> {
        some.iter().map(|(v, w)| skid::mobilized_arm_m(robot, *v, *w, law)).collect()
    };
    let wanted = moments(&|angle_rad| peaked(angle_rad, scale_rad, shape));
    let fit = |tanh_rad: f64| {
        let unit = moments(&|angle_rad| (angle_rad / tanh_rad).tanh());
        let (product, square) =
            unit.iter().zip(&wanted).fold((0.0, 0.0), |(p, s), (u, w)| (p + u * w, s + u * u));
        // Σ(w − share u)² is Σw² less this, at the best share.
        let explained = if square > 0.0 { product * product / square } else { 0.0 };
        (explained, TanhLaw { share: if square > 0.0 { product / square } else { 1.0 }, scale_rad: tanh_rad })
    };
    // As steep at zero as the peaked law, and steps of 2 % to a tenth and to ten times of that.
    let steepest_rad = scale_rad / shape;
    let tried = (-116..=116).map(|step| fit((steepest_rad * 1.02f64.powi(step)).clamp(LEAST_SCALE_RAD, 1.5)));
    let as_steep = (0.0, TanhLaw { share: 1.0, scale_rad: steepest_rad });
    tried.fold(as_steep, |best, next| if next.0 > best.0 { next } else { best }).1
}

/// Turns that are looked at.
const MOST_TURNS: usize = 500;
/// Rim speed difference that is a turn \[m/s\]: ten encoder steps of a Husky.
const LEAST_DIFFERENCE_MPS: f64 = 0.08;
/// Below this a law is Coulomb's for all that encoders can tell \[rad\].
const LEAST_SCALE_RAD: f64 = 0.01;

#[cfg(test)]
mod tests {
    use model::Sides;

    use super::*;
    use crate::row::Row;

    #[test]
    fn a_shape_above_one_and_a_half_peaks_at_one_and_falls_beyond() {
        let peak_rad = 0.05 * (std::f64::consts::FRAC_PI_2 / 1.7).tan();
        assert!((peaked(peak_rad, 0.05, 1.7) - 1.0).abs() < 1e-12);
        assert!(peaked(1.5, 0.05, 1.7) < 0.6);
    }

    #[test]
    fn the_tanh_of_spins_alone_has_the_peaked_law_at_their_slip_angle() {
        let robot = model::builtin::husky_a200();
        let spin = Sides { left: -0.2, right: 0.2 };
        let rows = vec![Row { rim_mps: spin, used: true, ..Row::default() }; 10];
        let law = nearest_tanh(&robot, &Drives { rows, ..Drives::default() }, 0.03, 1.8);
        // In place, a square base slips at 45°.
        let angle_rad = std::f64::consts::FRAC_PI_4;
        let tanh = law.share * (angle_rad / law.scale_rad).tanh();
        assert!((tanh - peaked(angle_rad, 0.03, 1.8)).abs() < 1e-9);
        assert!(law.share < 0.5, "ice that slides resists less than ice that creeps: {law:?}");
    }

    #[test]
    fn a_law_without_a_peak_keeps_its_height() {
        let robot = model::builtin::husky_a200();
        let turn = |i: i32| Sides { left: 0.3 - 0.01 * f64::from(i), right: 0.3 + 0.01 * f64::from(i) };
        let rows = (5..60).map(|i| Row { rim_mps: turn(i), used: true, ..Row::default() }).collect();
        let law = nearest_tanh(&robot, &Drives { rows, ..Drives::default() }, 0.15, 1.2);
        assert!((law.share - 1.0).abs() < 0.1, "{law:?}");
        assert!((law.scale_rad / (0.15 / 1.2) - 1.0).abs() < 0.4, "{law:?}");
    }
}
