//! Mechanisms that explain much and are not what is missing.

use model::{Robot, mechanism};

use crate::{
    Error,
    alternatives::fitted,
    baseline::Baseline,
    candidates::apart,
    discover::Sure,
    gates::best_beside_doubted,
    misfit::misfit,
    needed::{drop_idle, drop_one},
    null::Null,
    search::{Found, MOST, State, decide, is_told},
    series::{Applied, Series},
    span::Span,
    undoing::last_undoes,
    unshown,
};

/// A mechanism that explains much and is not what is missing.
#[derive(Clone, Debug, PartialEq)]
pub struct Refused {
    /// Its name.
    pub mechanism: &'static str,
    /// Why it is not, to follow on "would explain part of it, but".
    pub why: String,
    /// The part of the drives in which it would have acted.
    pub(crate) span: Span,
    /// Chance of as much as it explains, corrected for all that was tried.
    pub(crate) p_value: f64,
}

impl Refused {
    /// Whether something is missing though its name was refused: it has to be as sure as a term that is found, and where hardly more than
    /// usual is left a hundred times surer.
    pub(crate) fn leaves_something(&self, is_much: bool) -> bool {
        let least_sure = if is_much { Sure::AsUsual } else { Sure::Very };
        self.p_value <= least_sure.level()
    }
}

/// Why one of what was found, by its number, is not what is missing, and of what was put in the place of something doubted; `None` if it
/// may be.
pub(crate) type Doubt<'a> = dyn Fn(&State, usize, bool) -> Result<Option<String>, Error> + 'a;

/// Leaves out what is doubted, one by one, and fits the rest again each time, whose doubts may have been hidden by what was left out.
/// What explains as much and is not doubted takes its place, or one more is taken up beside which it is not, and nothing is missing then;
/// names that are doubted are no other names of what stays, but for those that drives only do not show. Later doubts come up only where
/// earlier ones do not. Without healthy drives nothing is: the model's own error would pass for a reason.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn refuse(
    series: &Series,
    file: &Robot,
    state: &mut State,
    doubts: &[&Doubt<'_>],
    null: &Null,
) -> Result<Vec<Refused>, Error> {
    let (mut refused, mut tried) = (Vec::new(), Vec::new());
    if !series.has_healthy() {
        return Ok(refused);
    }
    while let Some((which, why)) = first_doubted(state, doubts)? {
        let Found { applied: Applied { mechanism, span, .. }, p_value, .. } = state.found[which];
        let mechanism = mechanism.name();
        tried.push(mechanism);
        let is_shown = unshown::doubt(series, state, which).is_none();
        let may_stand_in = is_shown || is_told(series);
        let stand_in =
            if may_stand_in { stand_in(series, file, (state, which), &tried, doubts)? } else { None };
        if let Some(next) = stand_in {
            *state = next;
            if !is_shown {
                // What drives do not show they do not rule out.
                state.found[which].indistinguishable_from.push(mechanism.to_owned());
            }
        } else if let Some(next) = beside(series, file, state, doubts, null)? {
            *state = next;
        } else {
            state.found.remove(which);
            refused.push(Refused { mechanism, why, span, p_value });
            state.refit(series, file)?;
        }
    }
    if !refused.is_empty() {
        drop_idle(series, file, state, null)?;
    }
    for which in 0..state.found.len() {
        let Found { indistinguishable_from, next_names, .. } = &state.found[which];
        let is_possible = |name: &str| is_possible(series, file, state, (which, name), doubts);
        let others = not_ruled_out(indistinguishable_from, next_names, is_possible)?;
        state.found[which].indistinguishable_from = others;
    }
    Ok(refused)
}

/// Of names that explain as much those that are possible, or else the first that is of the next, which are too near to leave one name alone.
fn not_ruled_out(
    as_good: &[String],
    next: &[String],
    is_possible: impl Fn(&str) -> Result<bool, Error>,
) -> Result<Vec<String>, Error> {
    let mut possible = Vec::new();
    for name in as_good {
        possible.extend(is_possible(name)?.then(|| name.clone()));
    }
    let mut next = next.iter();
    while possible.is_empty()
        && let Some(name) = next.next()
    {
        possible.extend(is_possible(name)?.then(|| name.clone()));
    }
    Ok(possible)
}

/// Whether another mechanism may be what one of several stands for.
fn is_possible(
    series: &Series,
    file: &Robot,
    state: &State,
    (which, name): (usize, &str),
    doubts: &[&Doubt<'_>],
) -> Result<bool, Error> {
    match instead(series, file, state, (which, name))? {
        // What drives do not show they do not rule out.
        Some(instead) if unshown::doubt(series, &instead, which).is_none() => {
            Ok(doubted(&instead, which, doubts, false)?.is_none())
        }
        _ => Ok(true),
    }
}

/// What was found with what explains most of that which explains as much as one that is doubted, and is not doubted itself, in its place;
/// but for some that were tried.
fn stand_in(
    series: &Series,
    file: &Robot,
    (state, which): (&State, usize),
    tried: &[&str],
    doubts: &[&Doubt<'_>],
) -> Result<Option<State>, Error> {
    let mut best: Option<(f64, State)> = None;
    for name in &state.found[which].indistinguishable_from {
        if tried.contains(&name.as_str()) {
            continue;
        }
        let Some(next) = instead(series, file, state, (which, name))? else { continue };
        let left = misfit(series, &next.fit, &state.fit);
        if best.as_ref().is_none_or(|(least, _)| left < *least)
            && doubted(&next, which, doubts, true)?.is_none()
        {
            best = Some((left, next));
        }
    }
    Ok(best.map(|(_, state)| state))
}

/// What was found with one more beside it, if nothing of all is doubted then: what a second mechanism does is what the first one's size
/// seemed to go with.
fn beside(
    series: &Series,
    file: &Robot,
    state: &State,
    doubts: &[&Doubt<'_>],
    null: &Null,
) -> Result<Option<State>, Error> {
    if state.found.len() >= MOST {
        return Ok(None);
    }
    let applied = state.applied();
    let Some((rivals, gain)) = best_beside_doubted(series, &state.fit, &applied, null)? else {
        return Ok(None);
    };
    let mut both = state.clone();
    both.take_up(decide(series, file, (&applied, &state.fit), (&rivals, gain), null)?);
    let is_one_too_many = last_undoes(series, &both)? || drop_one(series, file, &mut both, null)?;
    Ok((!is_one_too_many && first_doubted(&both, doubts)?.is_none()).then_some(both))
}

/// What was found with another mechanism, which explains as much, instead of one; `None` where drives tell nothing of that.
fn instead(
    series: &Series,
    file: &Robot,
    state: &State,
    (which, name): (usize, &str),
) -> Result<Option<State>, Error> {
    let Some(mechanism) = mechanism::by_name(name) else { return Ok(None) };
    let (one, others) = apart(&state.applied(), which);
    let without = Baseline::fit(series, file, &others)?;
    let Some(applied) = fitted(series, &without, &others, mechanism, one.span)? else { return Ok(None) };
    let mut found = state.found.clone();
    found[which].applied = applied;
    found[which].indistinguishable_from.retain(|other| other != name);
    let mut instead = State { found, fit: without };
    instead.refit(series, file)?;
    Ok(Some(instead))
}

/// Why one is doubted, which may stand in for another.
fn doubted(
    state: &State,
    which: usize,
    doubts: &[&Doubt<'_>],
    stands_in: bool,
) -> Result<Option<String>, Error> {
    for doubt in doubts {
        if let Some(why) = doubt(state, which, stands_in)? {
            return Ok(Some(why));
        }
    }
    Ok(None)
}

/// What is doubted first, and why.
fn first_doubted(state: &State, doubts: &[&Doubt<'_>]) -> Result<Option<(usize, String)>, Error> {
    for doubt in doubts {
        for which in 0..state.found.len() {
            if let Some(why) = doubt(state, which, false)? {
                return Ok(Some((which, why)));
            }
        }
    }
    Ok(None)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_the_second_name_is_ruled_out_the_next_takes_its_place_and_nobody_asks_for_it_where_it_is_not() {
        let names = |names: &str| names.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let left = |as_good: &str, next: &str, ruled_out: &str| {
            let is_possible = |name: &str| Ok(!ruled_out.contains(name));
            not_ruled_out(&names(as_good), &names(next), is_possible).unwrap().join(" ")
        };
        // A load that is towed explains a little less than soft soil, and only that is ruled out.
        assert_eq!(left("soft_soil", "towed_load surface_change", "soft_soil"), "towed_load");
        assert_eq!(left("soft_soil", "towed_load surface_change", "soft_soil towed_load"), "surface_change");
        assert_eq!(left("soft_soil", "towed_load", ""), "soft_soil");
        assert_eq!(left("soft_soil payload", "towed_load", "payload"), "soft_soil");
        assert_eq!(left("", "", ""), "");
    }

    #[test]
    fn what_was_never_sure_is_no_reason_to_doubt_once_its_name_is_refused() {
        let refused = |p_value: f64| Refused {
            mechanism: "payload",
            why: "it makes predictions worse where nothing was fitted".to_owned(),
            span: Span::ALL,
            p_value,
        };
        let leaves = |p_value: f64| [false, true].map(|is_much| refused(p_value).leaves_something(is_much));
        assert_eq!(leaves(0.55), [false, false]);
        assert_eq!(leaves(1e-3), [false, true]);
        assert_eq!(leaves(1e-5), [true, true]);
    }
}
