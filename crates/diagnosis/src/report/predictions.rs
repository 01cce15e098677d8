//! Predictions of the test drives, by the robot's file as it is and beside the findings.

use std::collections::BTreeMap;

use crate::{
    fit::baseline::Baseline,
    observe::{
        observations::{Observations, REST},
        span::Span,
    },
    report::diagnosis::FileError,
    search::{engine::Found, explanation::Explanation},
};

/// Error of predictions of the test drives over seconds of the whole power: of the battery where it shows, else of both sides.
pub(crate) fn file_error(observed: &Observations<'_>, baseline: &Baseline, predicted: &[f64]) -> FileError {
    let mut seconds = BTreeMap::<(usize, u64), [f64; 3]>::new();
    let rows = observed.averages()[..observed.test_rows].iter().zip(&observed.series.recorded).zip(predicted);
    for (i, ((average, recorded), predicted)) in rows.enumerate() {
        if observed.is_power(i) || average.channel == REST {
            let sums = seconds.entry((average.run, average.t_s.to_bits())).or_default();
            let sigma_w = baseline.noise.sigma(average.channel, baseline.predicted[i]);
            *sums = [sums[0] + recorded, sums[1] + predicted, sums[2] + sigma_w * sigma_w];
        }
    }
    let count = seconds.len().max(1) as f64;
    let mean = |value: &dyn Fn(&[f64; 3]) -> f64| seconds.values().map(value).sum::<f64>() / count;
    FileError {
        rmse_w: mean(&|[recorded, predicted, _]| (recorded - predicted).powi(2)).sqrt(),
        bias_w: mean(&|[recorded, predicted, _]| recorded - predicted),
        mean_power_w: mean(&|[recorded, ..]| *recorded),
        noise_w: mean(&|[.., variance_w2]| *variance_w2).sqrt(),
    }
}

/// Predictions with an explanation, or with nothing.
pub(crate) struct Corrected {
    /// Row by row of the test drives.
    pub(crate) predicted: Vec<f64>,
    /// Part of it that is the effect of listed mechanisms; none where there are none.
    pub(crate) effect: Option<Vec<f64>>,
    /// When the listed mechanisms act.
    pub(crate) spans: Vec<Span>,
}

impl Corrected {
    /// Those of an explanation, or of nothing missing.
    pub(crate) fn of(observed: &Observations<'_>, found: &Found, first: Option<&Explanation>) -> Self {
        let nothing = found.explanations.iter().find(|one| one.names.is_empty());
        let fitted = first.or(nothing).and_then(|one| one.fitted.as_ref());
        // Fitted predictions are told about those at the file's parameters.
        let predicted = |i: usize| {
            let baseline = &found.baseline;
            let moved: f64 =
                baseline.sensitivities.iter().zip(baseline.u.iter()).map(|(column, u)| column[i] * u).sum();
            baseline.predicted[i] - moved + fitted.map_or(0.0, |fitted| fitted.change[i])
        };
        let named = fitted.filter(|fitted| !fitted.members.is_empty());
        Corrected {
            predicted: (0..observed.test_rows).map(predicted).collect(),
            effect: named.map(|fitted| fitted.effect.clone()),
            spans: named.iter().flat_map(|fitted| &fitted.members).map(|member| member.span).collect(),
        }
    }
}
