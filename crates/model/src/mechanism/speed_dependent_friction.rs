//! `speed_dependent_friction`: rolling resistance that grows with speed.

use crate::{
    Robot,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter},
};

/// Rolling resistance that grows with speed.
pub(super) struct SpeedDependentFriction;

impl Mechanism for SpeedDependentFriction {
    fn name(&self) -> &'static str {
        "speed_dependent_friction"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "per_mps", unit: "s/m", bounds: [-2.0, 5.0], probe: 0.05 }]
    }

    fn equation(&self) -> &'static str {
        "μ_R(u) = μ_R (1 + c |u|)"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!("rolling resistance changes by {:.0} % per m/s of speed", 100.0 * values[0])
    }

    fn adjust(&self, _: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        let mu_roll = moment.motion.rim_speeds_mps.map(|u| 1.0 + values[0] * u.abs());
        Adjustment { mu_roll, ..Adjustment::default() }
    }
}
