//! Which of several mechanisms are needed beside the others.

use model::{
    Robot,
    mechanism::{self, Kind},
};

use crate::{
    Error,
    average::{Average, Quantity},
    misfit::misfit,
    null::Null,
    polish::{Polished, settle},
    search::{AS_GOOD, Found, State, is_told},
    series::{Applied, Series},
    span::Span,
    weigh::system,
};

/// Share of the squares of what other mechanisms do that one has to exceed where it acts: the form of a strong mechanism is no better
/// known, healthy drives say nothing of it, and what it misses would pass for a weak one.
const FORM: f64 = 0.05;
/// Least share of what a mechanism adds to the others that has to be beyond that.
const BEYOND_FORM: f64 = 0.5;
/// Share of the squares of all that the others do that one has to add at least: where the model misses something itself, where healthy
/// drives show that it hardly does, and for what acts in a place, as among many places one has what their form misses.
const LEAST_OF_ALL: f64 = 0.05;
const LEAST_OF_ALL_WHERE_TOLD: f64 = 0.02;
const LEAST_IN_PLACE: f64 = 0.1;

/// Leaves out what others found later explain as well, and says whether there was any.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn drop_one(series: &Series, file: &Robot, state: &mut State, null: &Null) -> Result<bool, Error> {
    if state.found.len() < 2 {
        return Ok(false);
    }
    let whole = misfit(series, &state.fit, &state.fit);
    let blocks = system(series, &state.fit).blocks();
    for i in 0..state.found.len() {
        let name = state.found[i].applied.mechanism.name();
        if name == "clock_offset" {
            // Delays up to half a row are fitted anyway, so that its loss does not show.
            continue;
        }
        let mut others = state.applied();
        others.remove(i);
        let without = settle(series, file, &others, &state.fit.robot)?;
        let lost = misfit(series, &without.base, &state.fit) - whole;
        let count = state.found[i].numbers() as f64;
        // The last one was just found to be needed.
        let is_needed = i + 1 == state.found.len()
            || lost / null.discount(name, blocks) >= count * (blocks as f64).ln() + AS_GOOD;
        if !is_needed || !is_beyond_form(series, state, i, &without)? {
            state.found.remove(i);
            state.take(without);
            return Ok(true);
        }
    }
    Ok(false)
}

/// Leaves out what explains hardly anything once something that it stood beside was refused.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn drop_idle(series: &Series, file: &Robot, state: &mut State, null: &Null) -> Result<(), Error> {
    let blocks = system(series, &state.fit).blocks();
    let mut which = 0;
    while which < state.found.len() {
        let name = state.found[which].applied.mechanism.name();
        let mut others = state.applied();
        others.remove(which);
        let without = settle(series, file, &others, &state.fit.robot)?;
        let lost = misfit(series, &without.base, &state.fit) - misfit(series, &state.fit, &state.fit);
        let cost = state.found[which].numbers() as f64 * (blocks as f64).ln();
        // Delays up to half a row are fitted anyway, so that its loss does not show.
        if name != "clock_offset" && lost / null.discount(name, blocks) < cost {
            state.found.remove(which);
            state.take(without);
        } else {
            which += 1;
        }
    }
    Ok(())
}

/// Whether what a mechanism adds to the others, fitted without it, is more, where it acts, than their forms may miss.
fn is_beyond_form(series: &Series, state: &State, which: usize, without: &Polished) -> Result<bool, Error> {
    let white = state.fit.whitening(series);
    let one = &state.found[which].applied;
    let others = state.found.iter().enumerate().filter(|(i, _)| *i != which).map(|(_, found)| found);
    let with_one_form = others.zip(&without.applied).filter(|(found, _)| has_one_form(found));
    let of_one_form: Vec<Applied> = with_one_form.map(|(_, applied)| applied.clone()).collect();
    let none_w = series.predict(&without.base.robot, &of_one_form)?;
    let difference =
        |a: &[f64], b: &[f64]| white.of(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>());
    let added = difference(&state.fit.predicted_w, &without.base.predicted_w);
    let beside = difference(&without.base.predicted_w, &none_w);
    let quantities = || series.averages.iter().map(Average::quantity);
    // What a form misses of one quantity does not pass for what shows in another.
    let shown_in = shown_in(series, &added);
    let (whole, others) = (squares(series, &added, shown_in), squares(series, &beside, shown_in));
    if is_told(series) {
        return Ok(whole >= LEAST_OF_ALL_WHERE_TOLD * others);
    }
    let least = if matches!(one.span, Span::Within(_)) { LEAST_IN_PLACE } else { LEAST_OF_ALL };
    let both = added.iter().zip(&beside).zip(quantities()).filter(|(_, quantity)| *quantity == shown_in);
    let beyond: f64 = both.map(|((a, b), _)| (a * a - FORM * b * b).max(0.0)).sum();
    Ok(whole >= least * others && beyond >= BEYOND_FORM * whole)
}

/// The quantity in which an effect, in sigma, shows most.
pub(crate) fn shown_in(series: &Series, effect: &[f64]) -> Quantity {
    let most =
        |a: &Quantity, b: &Quantity| squares(series, effect, *a).total_cmp(&squares(series, effect, *b));
    Quantity::ALL.into_iter().max_by(most).unwrap_or(Quantity::Power)
}

/// Squares of an effect in one quantity.
fn squares(series: &Series, effect: &[f64], of: Quantity) -> f64 {
    let quantities = series.averages.iter().map(Average::quantity);
    effect.iter().zip(quantities).filter(|(_, quantity)| *quantity == of).map(|(x, _)| x * x).sum()
}

/// Whether there is no doubt of what it does: faults of meters and standing loads do the same whatever robot and ground are like. What may
/// be something else as well is doubted.
fn has_one_form(found: &Found) -> bool {
    let is_certain = |name: &str| {
        let is_of_a_meter = mechanism::by_name(name).is_some_and(|one| one.kind() == Kind::Measurement);
        is_of_a_meter || name == "hotel_load"
    };
    is_certain(found.applied.mechanism.name())
        && found.indistinguishable_from.iter().all(|name| is_certain(name))
}
