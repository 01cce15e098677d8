//! `towed_load`: a trailer: it rolls, is lifted and accelerated, but loads no wheel of the robot and does not skid; in turns it folds, and pulls
//! less.

use crate::{
    Motion, Robot, STANDARD_GRAVITY_MPS2, Sides,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
    rolling,
};

/// A trailer: it rolls, is lifted and accelerated, but loads no wheel of the robot and does not skid.
pub(super) struct TowedLoad;

/// Mass that is told as nothing, half of the last digit \[kg\].
const UNSEEN_KG: f64 = 0.05;

impl Mechanism for TowedLoad {
    fn name(&self) -> &'static str {
        "towed_load"
    }

    fn label(&self) -> &'static str {
        "something towed"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[
            Parameter { name: "rolling_n", unit: "N", bounds: [0.0, 500.0], probe: 1.0 },
            Parameter { name: "mass_kg", unit: "kg", bounds: [0.0, 500.0], probe: 1.0 },
        ]
    }

    /// A pull of 4 % of the robot's weight, by a trailer of four tenths of its mass that rolls at 0.1.
    fn size_prior(&self, scale: &Scale<'_>) -> Vec<SizePrior> {
        let mass_kg = scale.robot.mass_kg;
        [0.04 * mass_kg * STANDARD_GRAVITY_MPS2, 0.4 * mass_kg].map(SizePrior::positive).into()
    }

    /// What is heavy is hard to roll.
    fn size_correlation(&self) -> f64 {
        0.8
    }

    fn equation(&self) -> &'static str {
        "F = F_roll sgn(v) cos φ + m_t (g sin γ sin β cos φ + dv/dt cos² φ), tan φ = 2 b ω/v, half on each side"
    }

    fn statement(&self, values: &[f64]) -> String {
        let [rolling_n, mass_kg] = [values[0], values[1]];
        // On level ground at one speed its mass shows nowhere.
        if mass_kg < UNSEEN_KG {
            return format!(
                "the robot tows something that takes {rolling_n:.1} N to roll and shows no weight"
            );
        }
        format!("the robot tows a load of {mass_kg:.1} kg that takes {rolling_n:.1} N to roll")
    }

    fn adjust(&self, robot: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        let along = along(robot, &moment.motion);
        let rolling_n = values[0] * along * rolling::direction(moment.motion.speed_mps);
        let force_n = rolling_n + values[1] * along * along * moment.acceleration.forward_mps2;
        let lifting_n = Sides::both(values[1] * along * STANDARD_GRAVITY_MPS2 / 2.0);
        Adjustment { force_n: Sides::both(force_n / 2.0), lifting_n, ..Adjustment::default() }
    }
}

/// How far behind the robot's middle the trailer's axle lies, in track widths \[-\]. Nobody records it: assumed is a hitch at the back and a
/// drawbar that lets a trailer as wide as the robot fold beside it.
const BEHIND_TRACKS: f64 = 2.0;

/// cos φ, of the angle at which a trailer follows in a steady turn: its axle is pulled towards the hitch, and what pulls it across only turns
/// it (the end of a tractrix). 1 straight on and 0 on the spot.
fn along(robot: &Robot, motion: &Motion) -> f64 {
    let across_mps = motion.yaw_rate_radps * BEHIND_TRACKS * robot.track_m;
    if across_mps == 0.0 { 1.0 } else { motion.speed_mps.abs() / motion.speed_mps.hypot(across_mps) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::builtin;

    #[test]
    fn a_trailer_follows_a_circle_at_the_angle_of_its_radius_and_lets_a_robot_turn_on_the_spot() {
        let robot = builtin::husky_a200();
        let along = |speed_mps: f64, yaw_rate_radps: f64| {
            along(&robot, &Motion::of_body(&robot, speed_mps, yaw_rate_radps))
        };
        assert_eq!([along(0.8, 0.0), along(0.0, 0.0), along(0.0, 0.7)], [1.0, 1.0, 0.0]);
        // On a circle of the radius at which the axle lies behind, at 45 degrees, either way round.
        let radius_m = BEHIND_TRACKS * robot.track_m;
        for (speed_mps, side) in [(0.8, 1.0), (0.8, -1.0), (-0.8, 1.0)] {
            let cos = along(speed_mps, side * 0.8 / radius_m);
            assert!((cos - std::f64::consts::FRAC_1_SQRT_2).abs() < 1e-12, "{cos}");
        }
    }

    #[test]
    fn what_weighs_nothing_is_no_load_of_no_kilograms() {
        assert_eq!(
            TowedLoad.statement(&[6.94, 12.0]),
            "the robot tows a load of 12.0 kg that takes 6.9 N to roll"
        );
        let light = TowedLoad.statement(&[6.94, 0.0]);
        assert!(light.contains("6.9 N") && !light.contains("kg"), "{light}");
    }
}
