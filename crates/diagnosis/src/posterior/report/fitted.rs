//! Predictions of the test drives beside the findings.

use crate::posterior::{engine::Found, observations::Observations, search::explanation::Explanation};

/// Predictions with an explanation, or with nothing.
pub(crate) struct Corrected {
    /// Row by row of the test drives.
    pub(crate) predicted: Vec<f64>,
    /// Part of it that is the effect of listed mechanisms; none where there are none.
    pub(crate) effect: Option<Vec<f64>>,
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
        }
    }
}
