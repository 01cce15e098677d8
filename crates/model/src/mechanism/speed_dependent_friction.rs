//! `speed_dependent_friction`: rolling resistance that grows with speed.

use crate::{
    Robot,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

/// Rolling resistance that grows with speed.
pub(super) struct SpeedDependentFriction;

impl Mechanism for SpeedDependentFriction {
    fn name(&self) -> &'static str {
        "speed_dependent_friction"
    }

    fn label(&self) -> &'static str {
        "friction that grows with speed"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "per_mps", unit: "s/m", bounds: [-2.0, 5.0], probe: 0.05 }]
    }

    /// Rolling resistance that is six tenths more at top speed than at rest: tyres on soft ground (Wong, Theory of Ground Vehicles, ch. 2).
    fn size_prior(&self, scale: &Scale<'_>) -> Vec<SizePrior> {
        vec![SizePrior::either(0.6 / scale.robot.max_wheel_speed_mps)]
    }

    /// Rolling resistance of tyres on hard ground grows by some per cent from rest to top speed.
    fn healthy_share(&self) -> f64 {
        0.15
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
