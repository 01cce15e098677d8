//! The best fit of every set of names.

use std::{collections::BTreeMap, sync::Arc};

use crate::fit::joint::Fitted;

/// Names of mechanisms, sorted.
pub(crate) type Names = Vec<&'static str>;

/// A fit of a set of names.
#[derive(Clone)]
pub(crate) struct Kept {
    /// The fit in its best form and windows.
    pub(crate) fitted: Arc<Fitted>,
    /// By how much all forms and windows of the names together are likelier than the best, in log evidence.
    pub(crate) spread: f64,
}

impl Kept {
    /// Log evidence of the names.
    pub(crate) fn log(&self) -> f64 {
        self.fitted.log + self.spread
    }
}

/// The best fit of every set of names that was fitted.
#[derive(Default)]
pub(crate) struct Fits(BTreeMap<Names, Kept>);

impl Fits {
    /// Keeps a fit unless one of the same names is likelier.
    pub(crate) fn keep(&mut self, names: Names, kept: Kept) {
        if self.0.get(&names).is_none_or(|known| kept.log() > known.log()) {
            self.0.insert(names, kept);
        }
    }

    /// The fit of a set of names.
    pub(crate) fn get(&self, names: &[&'static str]) -> Option<&Kept> {
        self.0.get(names)
    }

    /// Sets of names, small ones first.
    pub(crate) fn by_size(&self) -> Vec<&Names> {
        let mut sets: Vec<&Names> = self.0.keys().collect();
        sets.sort_by_key(|names| names.len());
        sets
    }

    /// Fits of so many members that lie at most so far behind the likeliest of all, in log evidence.
    pub(crate) fn leading(&self, members: usize, behind: f64) -> Vec<Kept> {
        let best = self.0.values().map(Kept::log).fold(f64::NEG_INFINITY, f64::max);
        let leads = |kept: &&Kept| kept.fitted.members.len() == members && kept.log() > best - behind;
        self.0.values().filter(leads).cloned().collect()
    }
}
