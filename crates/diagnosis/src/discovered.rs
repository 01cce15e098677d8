//! A term that was discovered, as the report has it.

use crate::{
    report::{EvidenceFigures, Finding, FindingFit, FoundParameter},
    series::Series,
    term::{Scale, Term},
    words,
};

/// The name that a discovery goes by.
pub(crate) const UNKNOWN: &str = "unknown";

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
        }
    }

    /// The sentence a person reads: what it goes with, how much it is, and where most of it lies.
    fn statement(&self, series: &Series) -> String {
        let counts = |i: &usize| series.averages[*i].suspect && series.is_power(*i);
        let sizes: Vec<f64> =
            (0..self.column_w.len()).filter(counts).map(|i| self.size * self.column_w[i]).collect();
        let mean_w = sizes.iter().sum::<f64>() / sizes.len().max(1) as f64 * series.channels() as f64;
        let more = if mean_w >= 0.0 { "more" } else { "less" };
        let mut text = format!(
            "something outside the list takes {:.1} W {more} on average: {}",
            mean_w.abs(),
            self.term.words()
        );
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
