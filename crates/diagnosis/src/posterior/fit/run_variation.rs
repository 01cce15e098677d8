//! Random effects of runs: ground that differs from run to run, as rolling and skid resistance of each run of its own.

use crate::posterior::{fit::discrepancy::Components, observations::Observations};

/// Runs from which healthy drives tell how much runs differ.
const LEAST_RUNS: usize = 3;
/// Most runs that have columns of their own.
const MOST_RUNS: usize = 60;

/// Columns of unit amplitude: rolling and skid resistance of every run; none where there are too few or too many runs.
pub(crate) fn columns(observed: &Observations<'_>, components: &Components) -> Vec<Vec<f64>> {
    let averages = observed.averages();
    let healthy_runs = observed.runs(false);
    if healthy_runs < LEAST_RUNS || healthy_runs + observed.runs(true) > MOST_RUNS {
        return Vec::new();
    }
    let of_run = |suspect: bool, run: usize, component: &[f64]| -> Vec<f64> {
        let value = |i: usize| {
            let is_own = averages[i].suspect == suspect && averages[i].run == run && observed.is_power(i);
            if is_own { component[i] } else { 0.0 }
        };
        (0..averages.len()).map(value).collect()
    };
    let mut all = Vec::new();
    for suspect in [true, false] {
        for run in 0..observed.runs(suspect) {
            all.extend([&components.rolling, &components.skid].map(|one| of_run(suspect, run, one)));
        }
    }
    all
}
