//! Rolling resistance of the wheels.

use crate::{Robot, Sides, elementary};

/// Rim speed over which rolling resistance turns round with the wheel [m/s].
///
/// Coulomb friction jumps at standstill. 0.001 m/s is an eighth of the encoder step of a Husky A200
/// (0.008 m/s), so the smoothing hides nothing that could be measured.
pub const TURNAROUND_SPEED_MPS: f64 = 0.001;

/// Rolling resistance of a side per unit of μ_R and of its normal load, −1 to 1.
///
/// It opposes the turning of the wheel, not the sliding of the ground beneath it: the loss is in the
/// carcass. Where the slip track equals the track both speeds are the same.
#[inline(always)]
pub fn direction(rim_speed_mps: f64) -> f64 {
    elementary::tanh(rim_speed_mps / TURNAROUND_SPEED_MPS)
}

/// How much easier the wheels roll when the centre of mass is off the middle.
///
/// ```text
/// c = √( ((a/2 − |δx|)² + (b/2)²) / ((a/2)² + (b/2)²) )
/// ```
///
/// a wheelbase, b track, δx forward offset of the centre of mass [m]. Dogru & Marques (2018), eq. 16, where it
/// multiplies μ_R; found by experiment there, for |δx| ≤ 0.11 m on a base of 0.54 m.
pub fn center_of_mass_correction(robot: &Robot) -> f64 {
    let (half_a, half_b) = (robot.wheelbase_m / 2.0, robot.track_m / 2.0);
    let to_nearest_axle = half_a - robot.center_of_mass.forward_m.abs();
    (to_nearest_axle.hypot(half_b)) / half_a.hypot(half_b)
}

/// Share of the normal load on each side: ½ ± δy/b of eq. 14.
pub fn load_share(robot: &Robot) -> Sides<f64> {
    let shift = robot.center_of_mass.left_m / robot.track_m;
    Sides { left: 0.5 + shift, right: 0.5 - shift }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;

    #[test]
    fn a_centred_mass_needs_no_correction_and_one_on_an_axle_leaves_the_half_track() {
        let mut robot = builtin::husky_a200();
        assert_eq!(center_of_mass_correction(&robot), 1.0);
        robot.center_of_mass.forward_m = -robot.wheelbase_m / 2.0;
        assert!((center_of_mass_correction(&robot) - 0.5f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn rolling_resistance_is_full_at_walking_pace_and_gone_at_standstill() {
        assert_eq!(direction(0.0), 0.0);
        assert!((direction(0.2) - 1.0).abs() < 1e-12);
        assert_eq!(direction(-0.3), -direction(0.3));
    }
}
