//! Which of several mechanisms are needed beside the others.

use model::Robot;

use crate::{
    Error,
    average::{Average, Quantity},
    baseline::differences,
    form::is_certain,
    misfit::misfit,
    null::Null,
    polish::{Polished, settle},
    search::{AS_GOOD, Found, State},
    series::{Applied, Series},
    span::Span,
    weigh::system,
};

/// Share of the squares of all that the others do that one has to add at least: what their form misses beyond what it leaves open
/// (`form`) would pass for a weak one. For what acts in a place, as among many places one has what forms miss.
const LEAST_OF_ALL: f64 = 0.01;
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

/// Whether what a mechanism adds to the others, fitted without it, is more than their forms may miss.
fn is_beyond_form(series: &Series, state: &State, which: usize, without: &Polished) -> Result<bool, Error> {
    let white = state.fit.whitening(series);
    let one = &state.found[which].applied;
    let others = state.found.iter().enumerate().filter(|(i, _)| *i != which).map(|(_, found)| found);
    let certain = others.zip(&without.applied).filter(|(found, _)| has_one_form(found));
    let certain: Vec<Applied> = certain.map(|(_, applied)| applied.clone()).collect();
    let none_w = series.predict(&without.base.robot, &certain)?;
    let difference = |a: &[f64], b: &[f64]| white.of(&differences(a, b));
    let added = difference(&state.fit.predicted_w, &without.base.predicted_w);
    let beside = difference(&without.base.predicted_w, &none_w);
    // What a form misses of one quantity does not pass for what shows in another.
    let shown_in = shown_in(series, &added);
    let (whole, others) = (squares(series, &added, shown_in), squares(series, &beside, shown_in));
    let least = if matches!(one.span, Span::Within(_)) { LEAST_IN_PLACE } else { LEAST_OF_ALL };
    Ok(whole >= least * others)
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

/// Whether there is no doubt of what it does; what may be something else as well is doubted.
fn has_one_form(found: &Found) -> bool {
    is_certain(found.applied.mechanism.name())
        && found.indistinguishable_from.iter().all(|name| is_certain(name))
}
