//! What a limited amount is worth in the objective: the multiplier whose weighted sum bounds the limited optimum best.
//!
//! With objective c, limited amount r and limit L, for every λ ≥ 0 no path within the limit has less of c than
//!
//! ```text
//! min over paths (c + λ r) − λ L
//! ```
//!
//! and the λ with the largest bound is found by looking at ever closer pairs of paths, one within the limit and one beyond
//! (Handler & Zang, "A dual algorithm for the constrained shortest path problem", Networks 10, 1980). The bound only guides
//! and prunes the search; the answer is the search's own.

use crate::{
    bounded::{Bounded, Way},
    error::Error,
    limits::{Amounts, only, weighed},
};

/// A multiplier and the best path within all limits that was met on the way to it.
pub(crate) struct Multiplier {
    /// The objective plus the multiplier times the limited amount, as weights of amounts.
    pub(crate) sum: Amounts,
    /// λ L: what the bound takes off the weighted sum.
    pub(crate) off: f64,
    pub(crate) within: Option<Way>,
}

/// Pairs to look at; each about halves what is left between bound and best path.
const MOST_ROUNDS: usize = 12;
/// The bound is good enough when the weighted sum falls by a smaller share than this, the rounding of the planner's tables.
const CONVERGED: f64 = 2.5e-4;

impl Multiplier {
    /// The multiplier of one limited amount, given the objective's best path, which exceeds the limit, and the amount's own,
    /// which does not.
    pub(crate) fn find(
        bounded: &Bounded<'_>,
        at: usize,
        mut beyond: Way,
        mut below: Way,
    ) -> Result<Self, Error> {
        let (objective, limit) = (bounded.objective, bounded.most[at]);
        let mut best: Option<Way> = None;
        let mut take = |way: &Way| {
            let is_better = best.as_ref().is_none_or(|best| way.takes[objective] < best.takes[objective]);
            if is_better && bounded.holds(&way.takes) {
                best = Some(way.clone());
            }
        };
        take(&below);
        let mut lambda = 0.0;
        for _ in 0..MOST_ROUNDS {
            let slope =
                (below.takes[objective] - beyond.takes[objective]) / (beyond.takes[at] - below.takes[at]);
            if !(slope > 0.0 && slope.is_finite()) {
                break;
            }
            lambda = slope;
            let mut sum = only(objective);
            sum[at] = lambda;
            let way = bounded.least(sum)?;
            take(&way);
            let is_settled = weighed(&way.takes, &sum) >= weighed(&beyond.takes, &sum) * (1.0 - CONVERGED);
            if is_settled {
                break;
            }
            if way.takes[at] <= limit { below = way } else { beyond = way }
        }
        let mut sum = only(objective);
        sum[at] = lambda;
        Ok(Multiplier { sum, off: lambda * limit, within: best })
    }
}
