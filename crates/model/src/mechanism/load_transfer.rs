//! `load_transfer`: a centre of mass high above the ground shifts load to the lower and to the outer side.
//!
//! The weight then presses on the ground beside the middle, λ b to the lower side, so that what holds the robot back, its own
//! weight on a climb, turns it towards that side: straight up a slope at an angle, the lower side has to push more. In a turn there, tyres
//! hold the robot sideways with the rear axle's load more than with the front's ([`crate::SidewaysPull`]).

use crate::{
    Robot, STANDARD_GRAVITY_MPS2, Sides,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

/// A centre of mass high above the ground shifts load to the lower and to the outer side.
pub(super) struct LoadTransfer;

impl Mechanism for LoadTransfer {
    fn name(&self) -> &'static str {
        "load_transfer"
    }

    fn label(&self) -> &'static str {
        "a high center of mass"
    }

    fn filed(&self, robot: &Robot, values: &[f64], _: &[String]) -> Option<Robot> {
        let mut changed = robot.clone();
        changed.center_of_mass.height_m += values[0];
        // A file has no heights below the ground.
        (changed.center_of_mass.height_m >= 0.0).then_some(changed)
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "height_m", unit: "m", bounds: [-1.0, 3.0], probe: 0.02 }]
    }

    /// Half a track: the height of a robot that stands as high as it is wide. A file that gives none is never too high.
    fn size_prior(&self, scale: &Scale<'_>) -> Vec<SizePrior> {
        let sigma_m = 0.5 * scale.robot.track_m;
        let is_given = scale.robot.center_of_mass.height_m > 0.0;
        vec![if is_given { SizePrior::either(sigma_m) } else { SizePrior::positive(sigma_m) }]
    }

    /// Files that give no height leave out one of some centimetres.
    fn healthy_share(&self) -> f64 {
        0.3
    }

    fn equation(&self) -> &'static str {
        "n_l = ½ − λ, n_f = ½ − h/a sinγ sinβ, (F_r − F_l) b/2 = … + λ b (m g sinγ sinβ + m dv/dt), λ = h/b (tan φ + v ω / g)"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!("the centre of mass is {:.2} m higher than the model takes it for", values[0])
    }

    fn adjust(&self, robot: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        let outward = moment.motion.speed_mps * moment.motion.yaw_rate_radps / STANDARD_GRAVITY_MPS2;
        let per_tilt = values[0] / robot.track_m;
        let leaning_n = per_tilt * robot.mass_kg * STANDARD_GRAVITY_MPS2;
        let turned = |by_n: f64| Sides { left: -by_n, right: by_n };
        Adjustment {
            load_left: -per_tilt * outward,
            load_left_per_tilt: -per_tilt,
            load_forward_per_along: -values[0] / robot.wheelbase_m,
            leaning_n,
            lifting_n: turned(leaning_n * outward),
            force_n: turned(leaning_n * outward * moment.acceleration.forward_mps2 / STANDARD_GRAVITY_MPS2),
            ..Adjustment::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::{Acceleration, Attitude, Friction, FrictionShape, Manoeuvre, Motion, builtin};

    /// Forces of the sides straight on by moments about a mass on a stick over the middle: wheels carry, hold sideways and roll by their
    /// loads, and the robot does not turn.
    fn by_moments_n(height_m: f64, attitude: Attitude, forward_mps2: f64) -> Sides<f64> {
        let robot = builtin::husky_a200();
        let weight_n = robot.mass_kg * STANDARD_GRAVITY_MPS2;
        let ((along, cos_pitch), (across, cos_roll)) =
            (attitude.pitch_rad.sin_cos(), attitude.roll_rad.sin_cos());
        let back_n = weight_n * along + robot.mass_kg * forward_mps2;
        let (right_n, down_n) = (weight_n * cos_pitch * across, weight_n * cos_pitch * cos_roll);
        let [forward_m, left_m] = [back_n, right_n].map(|pull_n| -height_m * pull_n / down_n);
        let arm_m = robot.track_m / 2.0;
        let load_n = [1.0, -1.0].map(|side| down_n / 2.0 * (1.0 + side * left_m / arm_m));
        let rolling_n = load_n.map(|n| robot.surfaces["marble"].mu_roll * n);
        // What holds the robot sideways acts where the load lies and turns it by this about the middle.
        let turns_nm = forward_m * right_n;
        let [left_n, right_n] = [1.0, -1.0].map(|side| (back_n + side * turns_nm / arm_m) / 2.0);
        Sides { left: left_n + rolling_n[0], right: right_n + rolling_n[1] }
    }

    #[test]
    fn the_lower_side_of_a_climb_pushes_more_as_moments_about_a_high_mass_demand() {
        let robot = builtin::husky_a200();
        let marble = &robot.surfaces["marble"];
        for (height_m, pitch_rad, roll_rad, forward_mps2) in
            [(0.4, 0.2, 0.15, 0.0), (0.4, 0.2, -0.15, 0.3), (0.3, -0.25, 0.1, -0.2), (0.5, 0.0, 0.2, 0.4)]
        {
            let attitude = Attitude { pitch_rad, roll_rad };
            let acceleration = Acceleration { forward_mps2, yaw_radps2: 0.0, left_mps2: 0.0 };
            let motion = Motion::of_body(&robot, 0.5, 0.0);
            let moment = Moment { acceleration, attitude, ..Moment::steady(motion) };
            let adjustment = LoadTransfer.adjust(&robot, &[height_m], &moment);
            let shape = FrictionShape::new(&robot, marble.slip_angle_scale_rad, &motion);
            let friction = Friction::new(&robot, marble);
            let at = Sides::both(20.0);
            let manoeuvre = Manoeuvre::adjusted(&robot, &friction, motion, &shape, at, &adjustment);
            let force_n = manoeuvre.power_accelerating(attitude, acceleration).force_n;
            let expected_n = by_moments_n(height_m, attitude, forward_mps2);
            assert_relative_eq!(force_n.left, expected_n.left, max_relative = 1e-9);
            assert_relative_eq!(force_n.right, expected_n.right, max_relative = 1e-9);
        }
    }

    #[test]
    fn outward_in_a_turn_is_downward_on_a_slope() {
        // A turn to the left at v ω = g tan φ throws the weight to the right as a slope of φ does.
        let robot = builtin::husky_a200();
        let (speed_mps, yaw_rate_radps) = (0.8, 0.6);
        let adjustment = |yaw_rate_radps| {
            LoadTransfer.adjust(
                &robot,
                &[0.4],
                &Moment::steady(Motion::of_body(&robot, speed_mps, yaw_rate_radps)),
            )
        };
        let tilt = speed_mps * yaw_rate_radps / STANDARD_GRAVITY_MPS2;
        let (turning, straight) = (adjustment(yaw_rate_radps), adjustment(0.0));
        assert_relative_eq!(turning.load_left, straight.load_left_per_tilt * tilt, max_relative = 1e-12);
        assert_relative_eq!(turning.lifting_n.right, straight.leaning_n * tilt, max_relative = 1e-12);
    }
}
