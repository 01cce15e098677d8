//! How often the truth lay in the intervals of what was determined.

use std::collections::BTreeMap;

/// One determined parameter of one trial.
pub(crate) struct Found {
    pub(crate) name: String,
    /// (found - true) / sigma.
    pub(crate) deviation: f64,
    /// The truth lay in the 95 % interval.
    pub(crate) inside: bool,
}

/// Of one parameter over all trials in which it was determined.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Tally {
    pub(crate) determined: usize,
    pub(crate) inside: usize,
    pub(crate) sum: f64,
    pub(crate) squares: f64,
}

/// How often determined parameters lay in their intervals, by name.
#[derive(Debug, Default)]
pub(crate) struct Coverage {
    pub(crate) trials: usize,
    pub(crate) tallies: BTreeMap<String, Tally>,
}

impl Coverage {
    pub(crate) fn of(trials: Vec<Vec<Found>>) -> Coverage {
        let mut coverage = Coverage { trials: trials.len(), ..Coverage::default() };
        for found in trials.into_iter().flatten() {
            let tally = coverage.tallies.entry(found.name).or_default();
            tally.determined += 1;
            tally.inside += usize::from(found.inside);
            tally.sum += found.deviation;
            tally.squares += found.deviation * found.deviation;
        }
        coverage
    }

    /// What most trials determined.
    pub(crate) fn identifiable(&self) -> impl Iterator<Item = (&String, &Tally)> {
        self.tallies.iter().filter(|(_, tally)| 2 * tally.determined > self.trials)
    }
}
