//! Lateral skid of the wheels while turning.

use crate::{Robot, robot::Surface};

/// Moment that skid sets against the turn, per newton of normal load [m].
///
/// ```text
/// M_skid / N = sgn(ω) Σ_i |x_i − δx| · n_i · μ_S · tanh(α_i / α_s),   α_i = atan2(|vy_i|, |vx_i|)
/// vx_i = v − ω y_i,   vy_i = ω (x_i − δx)
/// ```
///
/// Wheels at (±a/2, ±b/2), n_i the load share of eq. 14, α_i the slip angle. The instantaneous centre lies
/// abreast of the centre of mass, as eq. 15 assumes, so the lever arms start there. α_s → 0 is the paper's
/// Coulomb skid; α_s > 0 lets wide arcs skid less than tight ones, as rubber does.
pub fn moment_per_load_m(robot: &Robot, surface: &Surface, speed_mps: f64, yaw_rate_radps: f64) -> f64 {
    arm_m(robot, surface.slip_angle_scale_rad, speed_mps, yaw_rate_radps) * surface.mu_skid
}

/// The moment of [`moment_per_load_m`] over μ_S [m].
pub(crate) fn arm_m(robot: &Robot, slip_angle_scale_rad: f64, speed_mps: f64, yaw_rate_radps: f64) -> f64 {
    let law = |slip_angle_rad| saturation(slip_angle_rad, slip_angle_scale_rad);
    mobilized_arm_m(robot, speed_mps, yaw_rate_radps, law) * sign(yaw_rate_radps)
}

/// The arm of full skid, Σ_i |x_i − δx| · n_i [m]; never 0, so that it can divide.
pub(crate) fn full_arm_m(robot: &Robot) -> f64 {
    let (half_m, forward_m) = (robot.wheelbase_m / 2.0, robot.center_of_mass.forward_m);
    let share = forward_m / robot.wheelbase_m;
    let arm_m = (half_m - forward_m) * (0.5 + share) + (half_m + forward_m) * (0.5 - share);
    arm_m.max(f64::MIN_POSITIVE)
}

/// Σ_i |x_i − δx| · n_i · σ(α_i) of [`moment_per_load_m`], for any law σ of how much of the full skid resistance a wheel
/// feels at a slip angle, 0 to π/2 [m].
pub fn mobilized_arm_m(
    robot: &Robot,
    speed_mps: f64,
    yaw_rate_radps: f64,
    mobilized: impl Fn(f64) -> f64,
) -> f64 {
    let com = &robot.center_of_mass;
    let (half_a, half_b) = (robot.wheelbase_m / 2.0, robot.track_m / 2.0);
    let [front_m, rear_m] = [half_a - com.forward_m, -half_a - com.forward_m];
    let of_axle = |arm_m: f64| {
        [half_b, -half_b].map(|y_m| {
            let along_mps = speed_mps - yaw_rate_radps * y_m;
            let across_mps = yaw_rate_radps * arm_m;
            if across_mps == 0.0 { 0.0 } else { mobilized(across_mps.abs().atan2(along_mps.abs())) }
        })
    };
    let front = of_axle(front_m);
    // Axles as far from the centre slip at the same angles, and those are what costs.
    let rear = if rear_m == -front_m { front } else { of_axle(rear_m) };
    let mut sum_m = 0.0;
    for (arm_m, x_sign, axle) in [(front_m, 1.0, front), (rear_m, -1.0, rear)] {
        let share_x = 0.5 + com.forward_m / robot.wheelbase_m * x_sign;
        for (y_sign, mobilized) in [1.0, -1.0].into_iter().zip(axle) {
            let share_y = 0.5 + com.left_m / robot.track_m * y_sign;
            sum_m += arm_m.abs() * share_x * share_y * mobilized;
        }
    }
    sum_m
}

/// tanh(α/α_s): how much of the full skid resistance a wheel feels, 0 to 1.
fn saturation(slip_angle_rad: f64, scale_rad: f64) -> f64 {
    // tanh x = 1 − 2/(1 + exp 2x): for x ≥ 0 as exact as any part of a share has to be, in a third of the library's time.
    if scale_rad == 0.0 { 1.0 } else { 1.0 - 2.0 / (1.0 + (2.0 * slip_angle_rad / scale_rad).exp()) }
}

fn sign(value: f64) -> f64 {
    if value == 0.0 { 0.0 } else { value.signum() }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use proptest::prelude::*;

    use super::*;
    use crate::builtin;

    #[test]
    fn coulomb_skid_of_a_centred_robot_is_half_the_wheelbase_times_mu() {
        let robot = builtin::husky_a200();
        let surface = Surface { slip_angle_scale_rad: 0.0, ..robot.surfaces["marble"].clone() };
        assert_relative_eq!(moment_per_load_m(&robot, &surface, 0.3, 0.5), 0.29 * 0.27, epsilon = 1e-12);
    }

    #[test]
    fn a_mass_on_the_rear_axle_does_not_skid() {
        let mut robot = builtin::husky_a200();
        robot.center_of_mass.forward_m = -robot.wheelbase_m / 2.0;
        let moment_m = moment_per_load_m(&robot, &robot.surfaces["marble"], 0.3, 0.5);
        assert!(moment_m.abs() < 1e-12, "{moment_m}");
    }

    proptest! {
        #[test]
        fn skid_opposes_the_turn_and_never_exceeds_coulomb(v in -1.0f64..1.0, w in -3.0f64..3.0) {
            let robot = builtin::husky_a200();
            let moment_m = moment_per_load_m(&robot, &robot.surfaces["marble"], v, w);
            prop_assert!(moment_m * w >= 0.0);
            prop_assert!(moment_m.abs() <= 0.29 * 0.27 + 1e-12);
            let mirrored_m = moment_per_load_m(&robot, &robot.surfaces["marble"], v, -w);
            prop_assert!((mirrored_m + moment_m).abs() < 1e-15);
        }
    }
}
