//! `center_of_mass`: a centre of mass off the place that the robot's file gives.

use crate::{
    Robot, STANDARD_GRAVITY_MPS2, Sides,
    mechanism::{Adjustment, Form, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

/// Farthest that it lies from the middle, as a share of what axles or sides are apart: an axle then carries four fifths. The paper's
/// robot came to 0.2 with 28 kg on its back.
const MOST_OFF: f64 = 0.3;

/// Where a form behind the middle begins \[m\].
const BEHIND_M: f64 = -1e-6;

/// A centre of mass off the place that the robot's file gives.
pub(super) struct CenterOfMass;

impl Mechanism for CenterOfMass {
    fn name(&self) -> &'static str {
        "center_of_mass"
    }

    fn label(&self) -> &'static str {
        "a shifted center of mass"
    }

    fn filed(&self, robot: &Robot, values: &[f64], _: &[String]) -> Option<Robot> {
        self.robot(robot, values)
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[
            Parameter { name: "forward_m", unit: "m", bounds: [-0.25, 0.25], probe: 0.01 },
            Parameter { name: "left_m", unit: "m", bounds: [-0.25, 0.25], probe: 0.01 },
        ]
    }

    /// No axle and no side carries more than four fifths: what stands so could hardly be driven.
    fn bounds(&self, robot: &Robot, parameter: usize) -> [f64; 2] {
        let com = &robot.center_of_mass;
        let (filed_m, apart_m) =
            if parameter == 0 { (com.forward_m, robot.wheelbase_m) } else { (com.left_m, robot.track_m) };
        let farthest_m = MOST_OFF * apart_m;
        [(-farthest_m - filed_m).min(0.0), (farthest_m - filed_m).max(0.0)]
    }

    /// A fifth of what axles and sides are apart: the paper's robot came to that with 28 kg on its back.
    fn size_prior(&self, scale: &Scale<'_>) -> Vec<SizePrior> {
        let Robot { wheelbase_m, track_m, .. } = *scale.robot;
        [wheelbase_m, track_m].map(|apart_m| SizePrior::either(0.2 * apart_m)).into()
    }

    /// Ahead of the middle, behind it, and to the side alone: power hardly changes with the sign of the distance from the middle.
    fn forms(&self, _: &Robot) -> Vec<Form> {
        [0.0, BEHIND_M]
            .map(|forward_m| Form { values: vec![forward_m, 0.0], free: vec![0, 1], widening: 1.0 })
            .into_iter()
            .chain([Form::one_free(vec![0.0; 2], 1)])
            .collect()
    }

    fn equation(&self) -> &'static str {
        "loads of eq. 14 and M_skid at δx + Δx, δy + Δy; what holds it back turns it by (m g sinγ sinβ + m dv/dt) Δy"
    }

    fn statement(&self, values: &[f64]) -> String {
        let [forward_m, left_m] = [values[0], values[1]];
        let (along, across) = (
            if forward_m < 0.0 { "farther back" } else { "farther forward" },
            if left_m < 0.0 { "farther right" } else { "farther left" },
        );
        format!(
            "the centre of mass is {:.3} m {along} and {:.3} m {across} than the robot's file says",
            forward_m.abs(),
            left_m.abs()
        )
    }

    fn robot(&self, robot: &Robot, values: &[f64]) -> Option<Robot> {
        let mut moved = robot.clone();
        moved.center_of_mass.forward_m += values[0];
        moved.center_of_mass.left_m += values[1];
        Some(moved)
    }

    fn adjust(&self, robot: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        let turned_kg = robot.mass_kg * values[1] / robot.track_m;
        let turned = |by_mps2: f64| Sides { left: turned_kg * by_mps2, right: -turned_kg * by_mps2 };
        Adjustment {
            lifting_n: turned(STANDARD_GRAVITY_MPS2),
            force_n: turned(moment.acceleration.forward_mps2),
            ..Adjustment::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Acceleration, Motion};

    #[test]
    fn speeding_up_pushes_the_side_of_the_mass_as_a_climb_does() {
        let robot = crate::builtin::husky_a200();
        let motion = Motion::of_body(&robot, 0.5, 0.0);
        let acceleration =
            Acceleration { forward_mps2: 0.2 * STANDARD_GRAVITY_MPS2, yaw_radps2: 0.0, left_mps2: 0.0 };
        let moment = Moment { acceleration, ..Moment::steady(motion) };
        let adjustment = CenterOfMass.adjust(&robot, &[0.0, 0.05], &moment);
        assert!(adjustment.force_n.left > 0.0);
        for (force_n, lifting_n) in [
            (adjustment.force_n.left, adjustment.lifting_n.left),
            (adjustment.force_n.right, adjustment.lifting_n.right),
        ] {
            approx::assert_relative_eq!(force_n, 0.2 * lifting_n, max_relative = 1e-12);
        }
    }
}
