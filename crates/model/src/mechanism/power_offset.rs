//! `power_offset`: a power meter whose zero is off.

use crate::mechanism::{Kind, Mechanism, Parameter};

/// A power meter whose zero is off.
pub(super) struct PowerOffset;

impl Mechanism for PowerOffset {
    fn name(&self) -> &'static str {
        "power_offset"
    }

    fn kind(&self) -> Kind {
        Kind::Measurement
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "offset_w", unit: "W", bounds: [-200.0, 200.0], probe: 1.0 }]
    }

    fn equation(&self) -> &'static str {
        "recorded power = true power + P_0, on each meter"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!(
            "each power meter reads {:.1} W too {}",
            values[0].abs(),
            if values[0] > 0.0 { "much" } else { "little" }
        )
    }

    fn reading_w(&self, values: &[f64], true_w: f64) -> f64 {
        true_w + values[0]
    }
}
