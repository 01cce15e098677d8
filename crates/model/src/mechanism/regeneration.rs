//! `regeneration`: more or less of what the hill drives comes back.

use crate::{
    Robot,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter},
};

/// More or less of what the hill drives comes back.
pub(super) struct Regeneration;

impl Mechanism for Regeneration {
    fn name(&self) -> &'static str {
        "regeneration"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "added", unit: "1", bounds: [-1.0, 1.0], probe: 0.05 }]
    }

    fn equation(&self) -> &'static str {
        "P = k1 F² + (r + Δr) u F / k2 where u F < 0"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!(
            "{:.0} % {} of the back-driven power returns than the robot's file says",
            100.0 * values[0].abs(),
            if values[0] < 0.0 { "less" } else { "more" }
        )
    }

    fn adjust(&self, _: &Robot, values: &[f64], _: &Moment) -> Adjustment {
        Adjustment { regeneration: values[0], ..Adjustment::default() }
    }
}
