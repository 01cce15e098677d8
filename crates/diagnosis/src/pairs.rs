//! Two mechanisms at once: each may hide the other, or a third may pass for both.

use model::Robot;
use nalgebra::{DMatrix, DVector};

use crate::{
    Error,
    baseline::Baseline,
    foremost::Foremost,
    gates::best,
    misfit::misfit,
    needed::drop_one,
    null::Null,
    search::{AS_GOOD, Found, State, decide, is_told},
    series::{Applied, Series},
    undoing::{last_undoes, undo_in_all},
    weigh::{Weighed, system},
};

/// Mechanisms of which pairs are tried, those that explain most by themselves.
const TRIED: usize = 12;
/// By how much a pair has to explain more than any mechanism by itself: a χ² that one of 66 pairs reaches by chance once in 100 drives.
const SECOND: f64 = 14.4;
/// The same as a share of what that explains, where the model misses something itself: less may be just that.
const MORE: f64 = 0.25;

/// Two mechanisms that were found, each weighed again beside the other, if that explains more; anything else as it is.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn revised(
    series: &Series,
    file: &Robot,
    before: &Baseline,
    state: State,
    null: &Null,
) -> Result<State, Error> {
    if state.found.len() != 2 {
        return Ok(state);
    }
    let revised = revise(series, file, &state.applied(), null)?;
    Ok(better(series, before, state, revised, null))
}

/// What was found, or two mechanisms that explain more together.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn tried(
    series: &Series,
    file: &Robot,
    before: &Baseline,
    mut state: State,
    null: &Null,
) -> Result<State, Error> {
    let is_delayed = state.found.iter().any(|f| f.applied.mechanism.name() == "clock_offset");
    if state.found.len() < 3
        && !is_delayed
        && let Some(pair) = pair(series, before, &state.applied(), null)?
    {
        let other = revise(series, file, &pair, null)?;
        state = better(series, before, state, other, null);
    }
    Ok(state)
}

/// The other state, if there is one and it explains more for its parameters.
fn better(series: &Series, before: &Baseline, state: State, other: Option<State>, null: &Null) -> State {
    let blocks = system(series, before).blocks();
    let cost = |state: &State| {
        let count: usize = state.found.iter().map(Found::numbers).sum();
        misfit(series, &state.fit, before) / null.common_discount(blocks)
            + count as f64 * (blocks as f64).ln()
    };
    match other {
        Some(other) if cost(&other) < cost(&state) => other,
        _ => state,
    }
}

/// The pair that explains clearly more, by sensitivities, than what was found does.
fn pair(
    series: &Series,
    before: &Baseline,
    found: &[Applied],
    null: &Null,
) -> Result<Option<[Applied; 2]>, Error> {
    let Foremost { closest: mut weighed, blocks, .. } = Foremost::of(series, before, &[], null)?;
    let left = system(series, before).left().clone();
    // A delay is weighed beside less than everything else, and hides nothing.
    weighed.retain(|one| one.evidence.own.nrows() == left.len());
    let score = |set: &[&Weighed]| -> Option<(f64, Vec<f64>)> {
        if set.is_empty() {
            return None;
        }
        let columns: Vec<_> = set.iter().flat_map(|one| one.evidence.own.column_iter()).collect();
        let own = DMatrix::from_columns(&columns);
        let right = own.tr_mul(&left);
        let values = own.tr_mul(&own).cholesky()?.solve(&right);
        let explained = values.dot(&right) / null.common_discount(blocks);
        let count: usize = set.iter().map(|one| one.candidate.numbers()).sum();
        Some((explained - count as f64 * (blocks as f64).ln(), values.iter().copied().collect()))
    };
    let is_found = |one: &&Weighed| found.iter().any(|f| f.mechanism.name() == one.name());
    let so_far: Vec<&Weighed> = weighed.iter().filter(is_found).collect();
    let single = weighed.iter().filter_map(|one| score(&[one])).map(|(score, _)| score).fold(0.0, f64::max);
    let so_far = score(&so_far).filter(|_| so_far.len() > 1).map_or(0.0, |(score, _)| score + AS_GOOD);
    // Where nothing passes by itself, nothing is replaced.
    let more = if found.is_empty() || is_told(series) { 0.0 } else { MORE };
    let least = f64::max((1.0 + more) * single + SECOND, so_far);
    weighed.truncate(TRIED);
    let mut most: Option<(f64, [Applied; 2])> = None;
    for (i, a) in weighed.iter().enumerate() {
        for b in &weighed[i + 1..] {
            if a.name() == b.name() {
                continue;
            }
            let Some((score, values)) = score(&[a, b]) else { continue };
            let [own_w, other_w] = parts(&[a, b], &values);
            if undo_in_all(series, &own_w, &other_w) {
                continue;
            }
            if score > least && most.as_ref().is_none_or(|(best, _)| score > *best) {
                let (own, other) = values.split_at(a.candidate.linear.len());
                most = Some((score, [a.at(before, own), b.at(before, other)]));
            }
        }
    }
    let is_new = |pair: &[Applied; 2]| {
        pair.iter().any(|one| found.iter().all(|f| f.mechanism.name() != one.mechanism.name()))
    };
    Ok(most.map(|(_, pair)| pair).filter(is_new))
}

/// What each of two mechanisms explains.
fn parts(pair: &[&Weighed; 2], values: &[f64]) -> [DVector<f64>; 2] {
    let (first, second) = values.split_at(pair[0].candidate.linear.len());
    let of = |one: &Weighed, values: &[f64]| &one.evidence.own * DVector::from_column_slice(values);
    [of(pair[0], first), of(pair[1], second)]
}

/// Weighs each of two mechanisms beside the other; `None` if one of them is not needed.
fn revise(series: &Series, file: &Robot, pair: &[Applied], null: &Null) -> Result<Option<State>, Error> {
    let [_, b] = pair else { return Ok(None) };
    let beside = [b.clone()];
    let fit = Baseline::fit(series, file, &beside)?;
    let Some((rivals, gain)) = best(series, &fit, &beside, null)? else { return Ok(None) };
    let (first, _) = decide(series, file, (&beside, &fit), (&rivals, gain), null)?;
    let beside = [first.applied.clone()];
    let fit = Baseline::fit(series, file, &beside)?;
    let Some((rivals, gain)) = best(series, &fit, &beside, null)? else { return Ok(None) };
    let decided = decide(series, file, (&beside, &fit), (&rivals, gain), null)?;
    let mut state = State { found: vec![first], fit };
    state.take_up(decided);
    let is_needed = !drop_one(series, file, &mut state, null)? && !last_undoes(series, &state)?;
    Ok(is_needed.then_some(state))
}
