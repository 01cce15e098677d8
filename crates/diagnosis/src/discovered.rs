//! A term that was discovered, as the report has it.

use crate::{
    report::{EvidenceFigures, Finding, FindingFit, FoundParameter},
    series::Series,
    term::{Scale, Term},
    words,
};

/// The name of an effect that no mechanism of the list describes.
pub const UNKNOWN: &str = "unknown";

/// A term that was discovered, with its size.
pub(crate) struct Discovered {
    pub(crate) term: Term,
    /// c, in no unit, or in watts where the scale is one watt.
    pub(crate) size: f64,
    /// Half width of its 95 % interval.
    pub(crate) half_width: f64,
    /// Chance of as much, corrected for all that was tried.
    pub(crate) p_value: f64,
    /// Discounted evidence less what the term costs.
    pub(crate) score: f64,
    /// Gain of held-out squared errors, as a share of them.
    pub(crate) held_out_gain: f64,
    /// Power per unit of c, average by average \[W\].
    pub(crate) column_w: Vec<f64>,
    /// The mechanism whose power is most like it, if any is much.
    pub(crate) resembles: Option<&'static str>,
}

impl Discovered {
    /// As the report has it, with held-out errors without and with it \[W\].
    pub(crate) fn finding(&self, series: &Series, [before_w, after_w]: [f64; 2]) -> Finding {
        // The scale of one watt is the unit of c.
        let unit = if self.term.scale == Scale::Watt { "W" } else { "1" };
        let interval_95 = Some([self.size - self.half_width, self.size + self.half_width]);
        let mut parameters = vec![FoundParameter { name: "c", value: self.size, unit, interval_95 }];
        let bounds = series.bounds(self.term.span).into_iter();
        parameters.extend(bounds.map(|(name, value, unit)| FoundParameter {
            name,
            value,
            unit,
            interval_95: None,
        }));
        Finding {
            mechanism: UNKNOWN.to_owned(),
            statement: words::capital(&self.statement(series)),
            equation: self.term.equation(),
            parameters,
            evidence: EvidenceFigures {
                p_value: self.p_value,
                delta_bic: self.score,
                held_out_gain: self.held_out_gain,
            },
            indistinguishable_from: Vec::new(),
            fit: FindingFit { held_out_rmse_before_w: before_w, held_out_rmse_after_w: after_w },
            probability: None,
            scope: None,
        }
    }

    /// The sentence a person reads: what it goes with, how much it is, and where most of it lies.
    fn statement(&self, series: &Series) -> String {
        let counts = |i: &usize| series.averages[*i].suspect && series.is_power(*i);
        let sizes = || (0..self.column_w.len()).filter(counts).map(|i| self.size * self.column_w[i]);
        let mut text =
            format!("something outside the list {}: {}", amount(sizes, series.channels()), self.term.words());
        if !self.term.span.is_all() {
            text += &format!(", {}", self.term.span.words(&series.names));
        }
        if let Some(where_w) = self.regime(series) {
            text += &where_w;
        }
        if let Some(name) = self.resembles {
            text += &format!("; it resembles {}", words::plain(name));
        }
        text
    }

    /// Between which values of its first quantity nine tenths of it lie.
    fn regime(&self, series: &Series) -> Option<String> {
        let (name, of, unit) = self.term.groups.iter().find(|group| !group.is_turn())?.quantity;
        let parts = self.column_w.iter().zip(&series.averages).filter(|(w, a)| **w != 0.0 && a.suspect);
        let mut parts: Vec<(f64, f64)> =
            parts.map(|(w, a)| (of(&a.since(self.term.span)), (self.size * w).powi(2))).collect();
        parts.retain(|(value, _)| value.is_finite());
        parts.sort_by(|a, b| a.0.total_cmp(&b.0));
        let whole: f64 = parts.iter().map(|(_, size)| size).sum();
        let mut sum = 0.0;
        let mut at = |share: f64| {
            sum = 0.0;
            parts.iter().find(|(_, size)| {
                sum += size;
                sum >= share * whole
            })
        };
        let (low, high) = (at(0.05)?.0, at(0.95)?.0);
        Some(format!(", nine tenths of it where {name} is {low:.2} to {high:.2} {unit}"))
    }
}

/// How much power changes, of each meter's averages one after the other: in the mean if that is most of it.
fn amount<I: Iterator<Item = f64>>(changes_w: impl Fn() -> I, meters: usize) -> String {
    let count = changes_w().count().max(1) as f64;
    let mean_w = changes_w().sum::<f64>() / count;
    let rms_w = (changes_w().map(|w| w * w).sum::<f64>() / count).sqrt();
    if mean_w.abs() < 0.5 * rms_w {
        let whose = if meters == 2 { "the power of a side" } else { "power" };
        return format!("changes {whose} by {rms_w:.1} W root mean square, up and down");
    }
    let more = if mean_w >= 0.0 { "more" } else { "less" };
    format!("takes {:.1} W {more} on average", mean_w.abs() * meters as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_goes_up_and_down_is_told_by_its_size_and_not_by_a_mean_of_nothing() {
        let of = |changes_w: &'static [f64], meters| amount(|| changes_w.iter().copied(), meters);
        assert_eq!(of(&[2.0, 3.0, 2.0, 3.0], 2), "takes 5.0 W more on average");
        assert_eq!(of(&[-2.0, -3.0], 1), "takes 2.5 W less on average");
        assert_eq!(
            of(&[2.0, -2.0, 3.0, -3.0], 2),
            "changes the power of a side by 2.5 W root mean square, up and down"
        );
        assert_eq!(of(&[0.0, 0.0], 1), "takes 0.0 W more on average");
    }
}
