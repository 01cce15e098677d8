//! `clock_offset`: power that was recorded by another clock than speeds.

use crate::mechanism::{Kind, Mechanism, Parameter, Scale, SizePrior};

/// One standard deviation of the delay [s].
const DELAY_S: f64 = 0.4;

/// Power that was recorded by another clock than speeds.
pub(super) struct ClockOffset;

impl Mechanism for ClockOffset {
    fn name(&self) -> &'static str {
        "clock_offset"
    }

    fn label(&self) -> &'static str {
        "power recorded late"
    }

    fn kind(&self) -> Kind {
        Kind::Measurement
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[Parameter { name: "delay_s", unit: "s", bounds: [-3.0, 3.0], probe: 0.05 }]
    }

    /// Four rows of a log of ten a second.
    fn size_prior(&self, _: &Scale<'_>) -> Vec<SizePrior> {
        vec![SizePrior::either(DELAY_S)]
    }

    /// Half a row of a log of ten a second.
    fn healthy_share(&self) -> f64 {
        0.12
    }

    /// Without healthy drives a row: each reading in it may be up to a row old.
    fn unstated_share(&self, scale: &Scale<'_>) -> f64 {
        (scale.row_s / DELAY_S).max(self.healthy_share())
    }

    fn equation(&self) -> &'static str {
        "recorded power(t) = true power(t − d)"
    }

    fn statement(&self, values: &[f64]) -> String {
        format!(
            "power was recorded {:.2} s {} than speeds",
            values[0].abs(),
            if values[0] > 0.0 { "later" } else { "earlier" }
        )
    }

    fn delay_s(&self, values: &[f64]) -> f64 {
        values[0]
    }
}
