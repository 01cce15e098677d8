//! Two mechanisms at once: each may hide the other, or a third may pass for both.

use model::Robot;
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::{
    Error,
    baseline::Baseline,
    evidence::System,
    foremost::Foremost,
    form,
    gates::best,
    misfit::misfit,
    needed::drop_one,
    null::Null,
    onset,
    search::{AS_GOOD, Found, State, decide},
    series::{Applied, Series},
    undoing::{last_undoes, undo_in_all},
    weigh::{Weighed, system},
};

/// Mechanisms of which pairs are tried, those that explain most by themselves.
const TRIED: usize = 12;
/// By how much a pair has to explain more than any mechanism by itself, each with what its form leaves open: a χ² that one of 66 pairs
/// reaches by chance once in 100 drives.
const SECOND: f64 = 14.4;

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

/// What was found, or two mechanisms that explain more together, each weighed again beside the other: the first beside the second to begin
/// with, or the other way round where that leaves one that is not needed, as where a third takes the place of the first.
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
    if !is_delayed && let Some(pair) = pair(series, before, &state.applied(), null)? {
        let swapped = || revise(series, file, &[pair[1].clone(), pair[0].clone()], null);
        let other = revise(series, file, &pair, null)?.map_or_else(swapped, |state| Ok(Some(state)))?;
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
    let beside = system(series, before);
    let left = beside.left();
    // A delay is weighed beside less than everything else, and hides nothing.
    weighed.retain(|one| one.evidence.own.nrows() == left.len());
    let is_found = |one: &Weighed| found.iter().any(|f| f.mechanism.name() == one.name());
    let weighed = weighed.into_iter().enumerate().filter(|(i, one)| *i < TRIED || is_found(one));
    let common = null.common_discount(blocks);
    let weighed: Vec<Weighed> = weighed.map(|(_, one)| one).collect();
    let open = |one: Weighed| Ok(Open::of(in_time(series, before, one, common)?, series, before, &beside));
    let weighed: Vec<Open> = weighed.into_par_iter().map(open).collect::<Result<_, Error>>()?;
    let score = |set: &[&Open]| -> Option<(f64, Vec<f64>)> {
        let (explained, values) = explained(set, left)?;
        let count: usize = set.iter().map(|one| one.weighed.candidate.numbers()).sum();
        Some((explained / common - count as f64 * (blocks as f64).ln(), values))
    };
    let so_far: Vec<&Open> = weighed.iter().filter(|one| is_found(&one.weighed)).collect();
    let single = weighed.iter().filter_map(|one| score(&[one])).map(|(score, _)| score).fold(0.0, f64::max);
    let so_far = score(&so_far).filter(|_| so_far.len() > 1).map_or(0.0, |(score, _)| score + AS_GOOD);
    let least = f64::max(single + SECOND, so_far);
    let mut most: Option<(f64, [Applied; 2])> = None;
    let tried = &weighed[..weighed.len().min(TRIED)];
    for (i, a) in tried.iter().enumerate() {
        for b in &tried[i + 1..] {
            if a.weighed.name() == b.weighed.name() {
                continue;
            }
            let Some((score, values)) = score(&[a, b]) else { continue };
            let [own_w, other_w] = parts(&[&a.weighed, &b.weighed], &values);
            if undo_in_all(series, &own_w, &other_w) {
                continue;
            }
            if score > least && most.as_ref().is_none_or(|(best, _)| score > *best) {
                let (own, other) = values.split_at(a.weighed.candidate.linear.len());
                most = Some((score, [a.weighed.at(before, own), b.weighed.at(before, other)]));
            }
        }
    }
    let is_new = |pair: &[Applied; 2]| {
        pair.iter().any(|one| found.iter().all(|f| f.mechanism.name() != one.mechanism.name()))
    };
    Ok(most.map(|(_, pair)| pair).filter(is_new))
}

/// A candidate from when it seems to set in by itself: what is left of it where its first guess lies beside that is no second one.
fn in_time(series: &Series, before: &Baseline, one: Weighed, discount: f64) -> Result<Weighed, Error> {
    if one.is_in_place() {
        return Ok(one);
    }
    Ok(onset::refine(series, before, &[], &one, discount)?.map_or(one, |bounded| bounded.weighed))
}

/// A mechanism with what its form leaves open.
struct Open {
    weighed: Weighed,
    /// Per one sigma, less what is fitted anyway.
    forms: DMatrix<f64>,
}

impl Open {
    fn of(weighed: Weighed, series: &Series, before: &Baseline, beside: &System) -> Open {
        let white = before.whitening(series);
        let effect_w = weighed.candidate.effect_w(&weighed.evidence.values);
        let forms = form::of_one(series, weighed.name(), &effect_w);
        let forms: Vec<Vec<f64>> = forms.iter().map(|column| white.of(column)).collect();
        Open { weighed, forms: beside.own(&forms) }
    }
}

/// Squared errors that some mechanisms take together, and their values; `None` where they cannot be told apart.
fn explained(set: &[&Open], left: &DVector<f64>) -> Option<(f64, Vec<f64>)> {
    let own = set.iter().flat_map(|one| one.weighed.evidence.own.column_iter());
    let forms = set.iter().flat_map(|one| one.forms.column_iter());
    let columns: Vec<_> = own.chain(forms).collect();
    let first_form = columns.len() - set.iter().map(|one| one.forms.ncols()).sum::<usize>();
    if first_form == 0 {
        return None;
    }
    let all = DMatrix::from_columns(&columns);
    let mut square = all.tr_mul(&all);
    (first_form..all.ncols()).for_each(|i| square[(i, i)] += 1.0);
    let right = all.tr_mul(left);
    let values = square.cholesky()?.solve(&right);
    Some((values.dot(&right), values.rows(0, first_form).iter().copied().collect()))
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

#[cfg(test)]
mod tests {
    use model::mechanism;
    use recording::unwatched;

    use super::*;
    use crate::{candidates::Candidate, evidence::Evidence, hills::drive, series::Look, span::Span};

    #[test]
    fn what_sets_in_between_the_times_that_are_tried_is_weighed_from_when_it_does() {
        let robot = model::builtin::husky_a200();
        let span = Span::From { run: 0, t_s: 401.3 };
        let load = Applied { mechanism: mechanism::by_name("payload").unwrap(), values: vec![25.0], span };
        let [suspect, healthy] = [drive(&robot, 0.0, &[load]), drive(&robot, 1.0, &[])];
        let series = Series::new(&robot, &suspect, Some(&healthy)).unwrap();
        let null = Null::of(&robot, Some(&healthy), (&unwatched(), Look::Usual)).unwrap();
        let before = Baseline::fit(&series, &robot, &[]).unwrap();
        let Foremost { closest, blocks, .. } = Foremost::of(&series, &before, &[], &null).unwrap();
        let load = closest.into_iter().find(|one| one.name() == "payload").unwrap();
        let line = series.timeline();
        let from_s = |one: &Weighed| line.driven_s(one.candidate.applied.span);
        assert!((from_s(&load) - 401.3).abs() > 10.0, "{} s is looked at", from_s(&load));
        let rank = load.rank;
        let load = in_time(&series, &before, load, null.common_discount(blocks)).unwrap();
        assert!((from_s(&load) - 401.3).abs() < 5.0, "{} s", from_s(&load));
        assert!(
            load.rank > rank + SECOND,
            "what it left over, {}, would pass for a second one",
            load.rank - rank
        );
    }

    /// A mechanism that changes rows by so much, in sigma, with what its form leaves open.
    fn open(name: &str, own: DVector<f64>, forms: DMatrix<f64>) -> Open {
        let mechanism = mechanism::by_name(name).unwrap();
        let applied = Applied { mechanism, values: vec![0.0], span: Span::ALL };
        let candidate = Candidate { applied, linear: vec![0], columns: Vec::new() };
        let evidence = Evidence::of_one(1.0, 1.0, DMatrix::from_columns(&[own]));
        let weighed =
            Weighed { candidate, evidence, tried: 1, score: 0.0, rank: 0.0, p_value: 0.0, is_strong: true };
        Open { weighed, forms }
    }

    #[test]
    fn what_the_form_of_one_leaves_open_makes_no_pair_and_what_it_does_not_makes_one() {
        let rows = 200;
        let with = DVector::from_fn(rows, |i, _| if i % 2 == 0 { 1.0 } else { -1.0 });
        let strong = DVector::from_element(rows, 10.0);
        // A twelfth of it goes with something, which one sigma of its form allows for; the other mechanism does just that.
        let left = &strong + 0.83 * &with;
        let no_forms = DMatrix::zeros(rows, 0);
        let more = |forms: DMatrix<f64>| {
            let one = open("wind", strong.clone(), forms);
            let other = open("inertia", with.clone(), no_forms.clone());
            let of = |set: &[&Open]| explained(set, &left).map_or(0.0, |(explained, _)| explained);
            of(&[&one, &other]) - of(&[&one])
        };
        assert!(more(DMatrix::from_columns(&[0.8 * &with])) < SECOND);
        assert!(more(no_forms.clone()) > SECOND);
    }
}
