//! `power_offset`: a power meter whose zero is off.

use crate::{
    Robot,
    mechanism::{Form, Kind, Mechanism, Parameter, Scale, SizePrior},
};

/// Share of what meters are off by, up to which they are so alike.
const ALIKE: f64 = 0.1;

/// A power meter whose zero is off.
///
/// What is recorded of the battery comes from a meter of its own, which is off as each side's is (m = 0) or right (m = -1), or by as much as
/// both sides' together (m = 1).
pub(super) struct PowerOffset;

impl Mechanism for PowerOffset {
    fn name(&self) -> &'static str {
        "power_offset"
    }

    fn label(&self) -> &'static str {
        "a power meter that is off by a constant"
    }

    fn kind(&self) -> Kind {
        Kind::Measurement
    }

    fn parameters(&self) -> &'static [Parameter] {
        &[
            Parameter { name: "offset_w", unit: "W", bounds: [-200.0, 200.0], probe: 1.0 },
            Parameter { name: "battery_more", unit: "1", bounds: [-2.0, 2.0], probe: 1.0 },
        ]
    }

    /// What zeros of meters are off by.
    fn size_prior(&self, scale: &Scale<'_>) -> Vec<SizePrior> {
        vec![SizePrior::either(scale.meter_zero_w), SizePrior::either(1.0)]
    }

    /// The battery's meter off as each side's, or right. Off by their sum it would be what drivers lose.
    fn forms(&self, _: &Robot) -> Vec<Form> {
        [0.0, -1.0].map(|more| Form::one_free(vec![0.0, more], 0)).into()
    }

    fn equation(&self) -> &'static str {
        "recorded power = true power + P_0 on the meter of each side, + (1 + m) P_0 on the battery's"
    }

    fn statement(&self, values: &[f64]) -> String {
        let told = |offset_w: f64| {
            let much = if offset_w > 0.0 { "much" } else { "little" };
            format!("reads {:.1} W too {much}", offset_w.abs())
        };
        let [offset_w, battery_w] = [values[0], (1.0 + values[1]) * values[0]];
        match values[1] {
            more if more.abs() < ALIKE => format!("every power meter {}", told(offset_w)),
            more if more + 1.0 < ALIKE => {
                format!("the power meter of each side {}, and the battery's is right", told(offset_w))
            }
            _ => format!(
                "the power meter of each side {}, and the battery's {}",
                told(offset_w),
                told(battery_w)
            ),
        }
    }

    fn battery_reading_w(&self, values: &[f64], true_w: f64) -> f64 {
        true_w + (1.0 + values[1]) * values[0]
    }

    fn reading_w(&self, values: &[f64], true_w: f64) -> f64 {
        true_w + values[0]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_meter_of_the_battery_is_off_alike_or_right_or_by_the_sum_of_both_sides() {
        let told = |battery_more: f64| {
            let values = [-2.0, battery_more];
            (PowerOffset.battery_reading_w(&values, 50.0), PowerOffset.statement(&values))
        };
        assert_eq!(told(0.0), (48.0, "every power meter reads 2.0 W too little".to_owned()));
        let side = "the power meter of each side reads 2.0 W too little, and the battery's";
        assert_eq!(told(-1.0), (50.0, format!("{side} is right")));
        assert_eq!(told(1.0), (46.0, format!("{side} reads 4.0 W too little")));
        assert_eq!(PowerOffset.reading_w(&[-2.0, 1.0], 20.0), 18.0);
    }
}
