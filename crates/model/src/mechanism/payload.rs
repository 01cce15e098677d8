//! `payload`: a load that the robot carries and its file does not know of.

use crate::{
    Robot,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter},
};

/// A load that the robot carries and its file does not know of.
pub(super) struct Payload;

impl Mechanism for Payload {
    fn name(&self) -> &'static str {
        "payload"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "mass_kg", unit: "kg", bounds: [-60.0, 400.0], probe: 1.0 }]
    }

    fn equation(&self) -> &'static str {
        "m = m_file + m_load"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!("the robot carries {:.1} kg that its file does not know of", values[0])
    }

    fn adjust(&self, _: &Robot, values: &[f64], _: &Moment) -> Adjustment {
        Adjustment { mass_kg: values[0], ..Adjustment::default() }
    }
}
