//! `inertia`: gears and armatures that are accelerated with the wheels, beyond the robot's own mass.

use crate::{
    Robot,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter},
};

/// Gears and armatures that are accelerated with the wheels, beyond the robot's own mass.
pub(super) struct Inertia;

impl Mechanism for Inertia {
    fn name(&self) -> &'static str {
        "inertia"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "kg_per_side", unit: "kg", bounds: [0.0, 400.0], probe: 1.0 }]
    }

    fn equation(&self) -> &'static str {
        "F_i = m_r du_i/dt"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!("turning parts resist acceleration like {:.1} kg on each side", values[0])
    }

    fn adjust(&self, _: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        Adjustment { force_n: moment.rim_mps2.map(|a| values[0] * a), ..Adjustment::default() }
    }
}
