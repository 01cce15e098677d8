//! `regeneration`: more or less of what the hill drives comes back.

use crate::{
    Robot,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

/// More or less of what the hill drives comes back.
pub(super) struct Regeneration;

impl Mechanism for Regeneration {
    fn name(&self) -> &'static str {
        "regeneration"
    }

    fn label(&self) -> &'static str {
        "more or less energy returned downhill"
    }

    fn filed(&self, robot: &Robot, values: &[f64], _: &[String]) -> Option<Robot> {
        let mut changed = robot.clone();
        changed.motors.regeneration += values[0];
        Some(changed)
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "added", unit: "1", bounds: [-1.0, 1.0], probe: 0.05 }]
    }

    /// Half of what returns; a file that has all return cannot have more.
    fn size_prior(&self, scale: &Scale<'_>) -> Vec<SizePrior> {
        vec![match scale.robot.motors.regeneration {
            all if all >= 1.0 => SizePrior::negative(0.5),
            none if none <= 0.0 => SizePrior::positive(0.5),
            _ => SizePrior::either(0.5),
        }]
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
