//! Fill values that no header marks.

use super::steps::{Candidate, Steps};
use crate::{Warning, WarningKind, fill_value};

/// Height of blocks that a map of surfaces may show on level ground [m]: trees and houses seldom reach it.
const TALL_BLOCK_M: f64 = 50.0;
/// Chance that steps at random make a fill value of an ordinary one.
const FALSE_ALARM: f64 = 1e-6;

/// A warning where one exact value stands off from all ground beside it: every step from its cells to others is higher than
/// the highest step anywhere else. If steps were dealt at random, `e` edges would be the highest of `e + n` by a chance of
/// `e! n! / (e + n)!`, which must be below [`FALSE_ALARM`]. Walls and blocks on level ground stand off so too; therefore the
/// value must be a conventional fill value ([`fill_value::is_conventional`]) beside ground with relief of its own, or stand
/// off by more than trees and houses do.
pub(super) fn fill_value(steps: &Steps) -> Option<Warning> {
    let candidate = steps.candidates.iter().filter(|one| is_fill(one)).max_by_key(|one| one.cells)?;
    let Candidate { value, cells, least_edge_m, .. } = *candidate;
    let verb = if cells == 1 { "cell holds" } else { "cells hold" };
    let detail = format!(
        "{cells} {verb} exactly {value} and stand off from all ground beside by {least_edge_m:.1} m or more: it looks like a fill value that no header marks; if it is one, give it as nodata (--nodata {value}; nodata_m={value} in the query of POST /v1/maps)"
    );
    Some(Warning::new(WarningKind::FillValue, detail))
}

fn is_fill(candidate: &Candidate) -> bool {
    if candidate.edges == 0 || candidate.least_edge_m <= candidate.highest_other_m {
        return false;
    }
    let is_taller_than_blocks = candidate.least_edge_m > TALL_BLOCK_M;
    let has_relief_beside = candidate.sloped_others >= candidate.edges;
    let is_conventional = fill_value::is_conventional(candidate.value) && has_relief_beside;
    (is_taller_than_blocks || is_conventional)
        && log_chance(candidate.edges, candidate.others) < FALSE_ALARM.ln()
}

/// Logarithm of the chance that so many steps drawn at random are the highest of all: of 1 / (e + n over e).
fn log_chance(edges: usize, others: usize) -> f64 {
    let (least, most) = (edges.min(others), edges.max(others) as f64);
    /// Factors after which the chance is far below any limit.
    const ENOUGH: usize = 64;
    (1..=least.min(ENOUGH)).map(|k| (k as f64 / (most + k as f64)).ln()).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chance_is_that_of_a_draw() {
        for (edges, others, ways) in [(1, 9, 10.0), (2, 3, 10.0), (3, 3, 20.0), (4, 8, 495.0)] {
            approx::assert_relative_eq!(log_chance(edges, others), -f64::ln(ways), epsilon = 1e-12);
        }
    }
}
