//! Which of several mechanisms are needed beside the others.

use model::Robot;
use nalgebra::DVector;

use crate::{
    Error,
    baseline::Baseline,
    candidates::apart,
    null::Null,
    search::{AS_GOOD, State, is_told},
    second_ground::take_turns,
    series::{Applied, Series},
    span::Span,
    weigh::{least_misfit, misfit, system},
};

/// Share of the squares of what other mechanisms do that one has to exceed where it acts, if the model misses something itself: the
/// form of a strong mechanism is no better known, and what that misses would pass for a weak one.
const FORM: f64 = 0.05;
/// Least share of what is lost without a mechanism that has to be beyond that.
const BEYOND_FORM: f64 = 0.5;
/// The same of all that the others do, and for what acts in a place: among many places, one has what their form misses.
const LEAST_OF_ALL: f64 = 0.05;
const LEAST_IN_PLACE: f64 = 0.1;
/// Least share of the squares of what two mechanisms do that both together do.
const LEFT_OF_BOTH: f64 = 0.25;

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
        let without = Baseline::fit_from(series, file, &others, &state.fit.robot)?;
        let lost = least_misfit(series, &without, &state.fit) - whole;
        let count = state.found[i].numbers() as f64;
        // The last one was just found to be needed.
        let is_needed = i + 1 == state.found.len()
            || lost / null.discount(name, blocks) >= count * (blocks as f64).ln() + AS_GOOD;
        if !is_needed || !is_told(series) && !is_beyond_form(series, state, i, lost)? {
            state.found.remove(i);
            state.refit(series, file)?;
            return Ok(true);
        }
    }
    Ok(false)
}

/// Whether what is lost without a mechanism is more, where it acts, than the others' forms may miss.
fn is_beyond_form(series: &Series, state: &State, which: usize, lost: f64) -> Result<bool, Error> {
    let white = state.fit.whitening(series);
    let (one, others) = apart(&state.applied(), which);
    let without_w = series.predict(&state.fit.robot, &others)?;
    let none_w = series.predict(&state.fit.robot, &[])?;
    let difference =
        |a: &[f64], b: &[f64]| white.of(&a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>());
    let (own, beside) = (difference(&state.fit.predicted_w, &without_w), difference(&without_w, &none_w));
    let squares = |effect: &[f64]| effect.iter().map(|x| x * x).sum::<f64>();
    let least = if matches!(one.span, Span::Within(_)) { LEAST_IN_PLACE } else { LEAST_OF_ALL };
    if lost < least * squares(&beside) {
        return Ok(false);
    }
    let share = lost / squares(&own).max(1e-300);
    let beyond =
        own.iter().zip(&beside).map(|(own, beside)| (share * own * own - FORM * beside * beside).max(0.0));
    Ok(beyond.sum::<f64>() >= BEYOND_FORM * lost)
}

/// Whether what was found last and something found before almost undo each other while both act: what is left of them is a third thing,
/// a pulse between two times, say, or ground whose place goes with what the robot does there.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn last_undoes(series: &Series, state: &State) -> Result<bool, Error> {
    let Some((last, before)) = state.found.split_last() else { return Ok(false) };
    let none_w = series.predict(&state.fit.robot, &[])?;
    let alone = |one: &Applied| series.predict(&state.fit.robot, std::slice::from_ref(one));
    let last_w = alone(&last.applied)?;
    for one in before.iter().filter(|one| !take_turns(&one.applied, &last.applied)) {
        let one_w = alone(&one.applied)?;
        let act = |i: &usize| [one, last].iter().all(|f| series.averages[*i].is_in(f.applied.span));
        let both: Vec<usize> = (0..none_w.len()).filter(act).collect();
        let of =
            |with_w: &[f64]| DVector::from_iterator(both.len(), both.iter().map(|i| with_w[*i] - none_w[*i]));
        if undo(&of(&last_w), &of(&one_w)) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Whether two changes almost undo each other.
pub(crate) fn undo(a: &DVector<f64>, b: &DVector<f64>) -> bool {
    (a + b).norm_squared() < LEFT_OF_BOTH * (a.norm_squared() + b.norm_squared())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_that_takes_back_what_another_does_is_no_second_thing_and_one_that_takes_back_its_half_is() {
        let both_sides = DVector::from_element(10, 1.0);
        let of_left = DVector::from_fn(10, |i, _| if i % 2 == 0 { -1.0 } else { 0.0 });
        assert!(undo(&both_sides, &(-0.66 * &both_sides)) && undo(&both_sides, &(-1.0 * &both_sides)));
        assert!(!undo(&both_sides, &of_left), "one side of what both sides do");
        assert!(!undo(&both_sides, &(0.5 * &both_sides)) && !undo(&both_sides, &(-0.2 * &both_sides)));
    }
}
