//! Ground that changes for other ground: where one ends, the other begins.

use model::{Robot, mechanism::Mechanism};

use crate::{
    Error,
    search::{Found, State},
    series::{Applied, Series},
    span::Span,
};

/// The mechanism that stands for other ground.
pub(crate) const GROUND: &str = "surface_change";
/// Grounds that differ by less are one: a second, small change would stand in for whatever else acts.
const OTHER: f64 = 0.1;

/// Ground on which one change was found, which may change once more.
pub(crate) fn second(series: &Series, applied: &[Applied]) -> Option<&'static dyn Mechanism> {
    let changes: Vec<&Applied> = applied.iter().filter(|a| a.mechanism.name() == GROUND).collect();
    let is_large = |change: &&Applied| change.values.iter().any(|share| share.abs() > OTHER);
    (changes.len() == 1 && changes.iter().all(is_large))
        .then(|| series.others(&[]).find(|one| one.name() == GROUND))
        .flatten()
}

/// Whether two are one ground all the time and another, in its stead, until or from some time.
pub(crate) fn take_turns(a: &Applied, b: &Applied) -> bool {
    let are_grounds = [a, b].iter().all(|one| one.mechanism.name() == GROUND);
    let is_one_all = |one: &Applied, other: &Applied| one.span.is_all() && other.span.rest().is_some();
    are_grounds && (is_one_all(a, b) || is_one_all(b, a))
}

/// Says two grounds of which one was found all the time, and another beside it until or from some time, each by itself.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn part(series: &Series, file: &Robot, state: &mut State) -> Result<(), Error> {
    let count = state.found.len();
    let pairs = (0..count).flat_map(|i| (0..count).map(move |j| (i, j)));
    let is_pair = |&(i, j): &(usize, usize)| {
        let [a, b] = [i, j].map(|one| &state.found[one].applied);
        a.span.is_all() && take_turns(a, b)
    };
    let Some((whole, some)) = pairs.filter(|(i, j)| i != j).find(is_pair) else { return Ok(()) };
    let limits_95 = state.found[some].limits_95.clone();
    let shares = state.found[whole].applied.values.clone();
    let Found { applied, .. } = &mut state.found[some];
    for (share, beside) in applied.values.iter_mut().zip(shares) {
        *share = (1.0 + *share) * (1.0 + beside) - 1.0;
    }
    let rest = applied.span.rest().unwrap_or(Span::ALL);
    let other = &mut state.found[whole];
    (other.applied.span, other.limits_95) = (rest, limits_95);
    state.refit(series, file)
}
