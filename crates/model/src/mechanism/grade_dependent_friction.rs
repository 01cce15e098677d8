//! `grade_dependent_friction`: rolling resistance that grows with the steepness of the ground.

use crate::{
    Robot,
    mechanism::{Adjustment, Kind, Mechanism, Moment, Parameter, Scale, SizePrior},
};

/// Rolling resistance that grows with the steepness of the ground.
pub(super) struct GradeDependentFriction;

impl Mechanism for GradeDependentFriction {
    fn name(&self) -> &'static str {
        "grade_dependent_friction"
    }

    fn label(&self) -> &'static str {
        "friction that grows with the slope"
    }

    fn kind(&self) -> Kind {
        Kind::Physics
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "per_slope", unit: "1", bounds: [-20.0, 40.0], probe: 0.3 }]
    }

    /// Three per cent for each per cent of slope: a third more rolling resistance on a slope of one in ten.
    fn size_prior(&self, _: &Scale<'_>) -> Vec<SizePrior> {
        vec![SizePrior::either(3.0)]
    }

    fn equation(&self) -> &'static str {
        "μ_R(γ) = μ_R (1 + c sin γ)"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!("rolling resistance changes by {:.1} % for each per cent of slope", values[0])
    }

    fn adjust(&self, _: &Robot, values: &[f64], _: &Moment) -> Adjustment {
        Adjustment { mu_roll_per_steepness: values[0], ..Adjustment::default() }
    }
}
