//! `power_scale`: a power meter that reads too much or too little.

use crate::mechanism::{Kind, Mechanism, Parameter, Scale, SizePrior};

/// A power meter that reads too much or too little.
pub(super) struct PowerScale;

impl Mechanism for PowerScale {
    fn name(&self) -> &'static str {
        "power_scale"
    }

    fn label(&self) -> &'static str {
        "a power meter that reads in proportion too much or little"
    }

    fn kind(&self) -> Kind {
        Kind::Measurement
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "gain", unit: "1", bounds: [-0.6, 1.0], probe: 0.02 }]
    }

    /// 20 %, as of a shunt of the next size.
    fn size_prior(&self, _: &Scale<'_>) -> Vec<SizePrior> {
        vec![SizePrior::either(0.2)]
    }

    fn equation(&self) -> &'static str {
        "recorded power = (1 + g) true power"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!(
            "recorded power is {:.1} % too {}",
            100.0 * values[0].abs(),
            if values[0] > 0.0 { "high" } else { "low" }
        )
    }

    fn reading_w(&self, values: &[f64], true_w: f64) -> f64 {
        (1.0 + values[0]) * true_w
    }
}
