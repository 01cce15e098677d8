//! What the rows of all drives are explained by before any mechanism of a set: what healthy robots and good logs have of mechanisms, what the
//! model misses, and ground that differs from run to run; with the amplitudes that the evidence is summed over.

use std::ops::Range;

use model::{
    Robot,
    knowledge::Provenance,
    mechanism::{Mechanism, Scale},
};

use crate::{
    evidence::{
        linear_model::Amplitudes,
        noise::Whitening,
        width::{self, WIDTHS},
    },
    fit::{
        amplitude::{Healthy, RunSpread},
        baseline::Baseline,
        discrepancy::{LEAST_RUNS, Shares},
    },
    hypothesis::effect::Effect,
    observe::{
        observations::Observations,
        reach::{Beyond, beyond},
    },
};

/// Columns beside the robot's parameters.
pub(crate) struct Basis {
    /// They, of prior standard deviation one.
    pub(crate) columns: Vec<Vec<f64>>,
    /// Amplitudes of parts of the whole basis, the robot's parameters first.
    pub(crate) amplitudes: Amplitudes,
    /// Amplitudes of the discrepancy.
    pub(crate) shares: Shares,
    /// What the test drives do that those did not by which that is known.
    pub(crate) beyond: Vec<Beyond>,
    /// The likeliest standard deviation of ground from run to run, as a share of resistance.
    pub(crate) run_variation: f64,
}

impl Basis {
    /// Learns amplitudes from the drives, beside columns that are shared.
    pub(crate) fn new(
        observed: &Observations<'_>,
        (baseline, file): (&Baseline, &Robot),
        plain: &Whitening,
        shared: Vec<Vec<f64>>,
    ) -> Self {
        let all = Healthy { observed, baseline, whitening: plain, rows: 0..observed.rows() };
        let healthy = Healthy { rows: observed.test_rows..observed.rows(), ..all };
        // Of few healthy runs the test drives tell as well how much ground differs.
        let is_told = observed.runs(false).len() >= LEAST_RUNS;
        let runs = if is_told { healthy.run_spread(&shared) } else { all.run_spread(&shared) };
        let learnt = if observed.series.has_healthy() {
            let of_runs = runs.as_ref().filter(|_| is_told).map_or(&[][..], |runs| &runs.columns);
            healthy.model_error(&[&shared, of_runs].concat())
        } else {
            Shares::of_power(file.model_error_fraction())
        };
        // What a calibration found says nothing of drives that do what its own did not: there constants are fitted ones, and no more is known.
        let beyond = beyond_calibration(observed, file);
        let least = if beyond.is_empty() { 0.0 } else { Provenance::Fitted.model_error() };
        let shares = Shares { power: learnt.power.max(least), ..learnt };
        let mut columns = baseline.discrepancy(observed, shares);
        let first = baseline.sensitivities.len();
        let discrepancy = first..first + columns.len();
        columns.extend(shared);
        let mut amplitudes = Amplitudes::as_they_are().with(&discrepancy, &discrepancy_amplitudes(observed));
        let run_variation = runs.as_ref().map_or(0.0, |runs| runs.share);
        if let Some(RunSpread { columns: of_runs, factors, .. }) = runs {
            let from = first + columns.len();
            let own: Range<usize> = from..from + of_runs.len();
            amplitudes = amplitudes.with(&own, &factors);
            columns.extend(of_runs);
        }
        Basis { columns, amplitudes, shares, beyond, run_variation }
    }
}

/// What the drives have besides mechanisms of a set: with healthy drives sizes that all of them have in common, and shares by which drives in
/// order differ; without them shares that no file states.
pub(crate) fn shared(
    observed: &Observations<'_>,
    scale: &Scale<'_>,
    effects: &[Effect],
    common: &[Effect],
) -> Vec<Vec<f64>> {
    let has_healthy = observed.series.has_healthy();
    let share =
        |one: &dyn Mechanism| if has_healthy { one.healthy_share() } else { one.unstated_share(scale) };
    let mut columns: Vec<Vec<f64>> = common.iter().flat_map(|effect| effect.columns.clone()).collect();
    columns.extend(shares(effects, share));
    columns
}

/// Columns of shares of mechanisms' prior sizes.
pub(crate) fn shares(effects: &[Effect], share_of: impl Fn(&dyn Mechanism) -> f64) -> Vec<Vec<f64>> {
    let mut columns = Vec::new();
    for (i, effect) in effects.iter().enumerate() {
        let (name, share) = (effect.mechanism.name(), share_of(effect.mechanism));
        if share <= 0.0 {
            continue;
        }
        for (j, size) in effect.free.iter().enumerate() {
            let is_known = |other: &Effect| {
                other.mechanism.name() == name && other.free.iter().any(|s| s.parameter == size.parameter)
            };
            if !effects[..i].iter().any(is_known) {
                columns.push(effect.columns[j].iter().map(|by| share * by).collect());
            }
        }
    }
    columns
}

/// What the test drives do that those of a calibration did not; healthy drives beside them are rows of the same model.
fn beyond_calibration(observed: &Observations<'_>, file: &Robot) -> Vec<Beyond> {
    let known = file.model_error.as_ref().filter(|_| !observed.series.has_healthy());
    known.map_or_else(Vec::new, |known| beyond(&known.regimes, &observed.covered(0..observed.test_rows)))
}

/// Amplitudes of the discrepancy that are summed over, with their log priors: with healthy drives that which these show.
fn discrepancy_amplitudes(observed: &Observations<'_>) -> Vec<(f64, f64)> {
    if observed.series.has_healthy() {
        return vec![(1.0, 0.0)];
    }
    WIDTHS.into_iter().zip(width::log_priors()).collect()
}
