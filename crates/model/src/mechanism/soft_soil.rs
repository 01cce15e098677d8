//! `soft_soil`: wheels that sink, the more the more they slip sideways.

use crate::{
    Robot,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

/// Wheels that sink, the more the more they slip sideways.
pub(super) struct SoftSoil;

impl Mechanism for SoftSoil {
    fn name(&self) -> &'static str {
        "soft_soil"
    }

    fn label(&self) -> &'static str {
        "soft soil"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "sinking", unit: "1", bounds: [0.0, 20.0], probe: 0.05 }]
    }

    /// Half as much again as on hard ground, never less.
    fn size_prior(&self, _: &Scale<'_>) -> Vec<SizePrior> {
        vec![SizePrior::positive(0.5)]
    }

    /// Tyres on any ground roll harder in turns than straight on; healthy robots of worlds with another law of that came to 0.12 of c.
    fn healthy_share(&self) -> f64 {
        0.3
    }

    fn equation(&self) -> &'static str {
        "μ_R = μ_R,hard (1 + c (1 + 2 |sin α|)), α the slip angle of the wheels"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!(
            "wheels sink: rolling resistance is {:.0} % higher straight on and {:.0} % higher turning on the spot",
            100.0 * values[0],
            300.0 * values[0]
        )
    }

    fn adjust(&self, robot: &Robot, values: &[f64], moment: &Moment) -> Adjustment {
        let across_mps = moment.motion.yaw_rate_radps * robot.wheelbase_m / 2.0;
        let mu_roll = moment.motion.rim_speeds_mps.map(|u| {
            let slip_rad = across_mps.abs().atan2(u.abs());
            1.0 + values[0] * (1.0 + 2.0 * slip_rad.sin())
        });
        Adjustment { mu_roll, ..Adjustment::default() }
    }
}
