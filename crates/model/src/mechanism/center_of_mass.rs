//! `center_of_mass`: a centre of mass off the place that the robot's file gives.

use crate::{
    Robot, STANDARD_GRAVITY_MPS2, Sides,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter},
};

/// A centre of mass off the place that the robot's file gives.
pub(super) struct CenterOfMass;

impl Mechanism for CenterOfMass {
    fn name(&self) -> &'static str {
        "center_of_mass"
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

    fn equation(&self) -> &'static str {
        "eqs. 14-16 at δx + Δx, δy + Δy; gravity turns the robot by m g sin γ sin β Δy"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!(
            "the centre of mass is {:.3} m farther forward and {:.3} m farther left than the robot's file says",
            values[0], values[1]
        )
    }

    fn robot(&self, robot: &Robot, values: &[f64]) -> Option<Robot> {
        let mut moved = robot.clone();
        moved.center_of_mass.forward_m += values[0];
        moved.center_of_mass.left_m += values[1];
        Some(moved)
    }

    fn adjust(&self, robot: &Robot, values: &[f64], _: &Moment) -> Adjustment {
        let turn_n = robot.mass_kg * STANDARD_GRAVITY_MPS2 * values[1] / robot.track_m;
        Adjustment { lifting_n: Sides { left: turn_n, right: -turn_n }, ..Adjustment::default() }
    }
}
