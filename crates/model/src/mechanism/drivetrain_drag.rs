//! `drivetrain_drag`: bearings, chains or brakes that hold the wheels of a side back.

use crate::{
    Robot, Sides,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter},
    rolling,
};

/// Bearings, chains or brakes that hold the wheels of a side back.
pub(super) struct DrivetrainDrag;

impl Mechanism for DrivetrainDrag {
    fn name(&self) -> &'static str {
        "drivetrain_drag"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[
            Parameter { name: "left_n", unit: "N", bounds: [-10.0, 300.0], probe: 1.0 },
            Parameter { name: "right_n", unit: "N", bounds: [-10.0, 300.0], probe: 1.0 },
        ]
    }

    fn equation(&self) -> &'static str {
        "F_i = F_drag,i sgn(u_i)"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!("the drivetrain drags: {:.1} N on the left side, {:.1} N on the right", values[0], values[1])
    }

    fn adjust(&self, _: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        let direction = moment.motion.rim_speeds_mps.map(rolling::direction);
        let force_n = direction.zip(Sides { left: values[0], right: values[1] }).map(|(s, n)| s * n);
        Adjustment { force_n, ..Adjustment::default() }
    }
}
