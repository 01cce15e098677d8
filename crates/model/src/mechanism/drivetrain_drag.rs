//! `drivetrain_drag`: bearings, chains or brakes that hold the wheels of a side back.

use crate::{
    Robot, STANDARD_GRAVITY_MPS2, Sides,
    mechanism::{Adjustment, Form, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
    rolling,
};

/// Bearings, chains or brakes that hold the wheels of a side back.
pub(super) struct DrivetrainDrag;

impl Mechanism for DrivetrainDrag {
    fn name(&self) -> &'static str {
        "drivetrain_drag"
    }

    fn label(&self) -> &'static str {
        "drag in one side's drive train"
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

    /// A fortieth of the weight: about what rolling takes, as of a brake that rubs.
    fn size_prior(&self, scale: &Scale<'_>) -> Vec<SizePrior> {
        vec![SizePrior::positive(0.025 * scale.robot.mass_kg * STANDARD_GRAVITY_MPS2); 2]
    }

    /// One side; what holds both back alike is the ground.
    fn forms(&self, _: &Robot) -> Vec<Form> {
        [0, 1].map(|side| Form::one_free(vec![0.0; 2], side)).into()
    }

    fn equation(&self) -> &'static str {
        "F_i = F_drag,i sgn(u_i)"
    }

    fn statement(&self, values: &[f64]) -> String {
        match values {
            [left_n, 0.0] => format!("the drivetrain drags: {left_n:.1} N on the left side"),
            [0.0, right_n] => format!("the drivetrain drags: {right_n:.1} N on the right side"),
            [left_n, right_n, ..] => {
                format!("the drivetrain drags: {left_n:.1} N on the left side, {right_n:.1} N on the right")
            }
            _ => "the drivetrain drags".into(),
        }
    }

    fn adjust(&self, _: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        let direction = moment.motion.rim_speeds_mps.map(rolling::direction);
        let force_n = direction.zip(Sides { left: values[0], right: values[1] }).map(|(s, n)| s * n);
        Adjustment { force_n, ..Adjustment::default() }
    }
}
