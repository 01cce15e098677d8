//! Whether two mechanisms undo each other.

use nalgebra::DVector;

use crate::{
    Error,
    average::{Average, Quantity},
    search::State,
    second_ground::take_turns,
    series::{Applied, Series},
    weigh::{Sizes, system_at},
};

/// Least share of the squares of what two mechanisms do that both together do.
const LEFT_OF_BOTH: f64 = 0.25;
/// Sigma from which what two mechanisms do would be seen.
const SEEN_SIGMAS: f64 = 5.0;

/// Whether what was found last and something found before almost undo each other while both act: what is left of them is a third thing,
/// a pulse between two times, say, or ground whose place goes with what the robot does there. Not so if another meter than that of
/// power tells one from the other, as heights do a pitch that reads too much.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn last_undoes(series: &Series, state: &State) -> Result<bool, Error> {
    let Some((last, before)) = state.found.split_last() else { return Ok(false) };
    let none = series.predict(&state.fit.robot, &[])?;
    let effect = |one: &Applied| -> Result<Vec<f64>, Error> {
        let with = series.predict(&state.fit.robot, std::slice::from_ref(one))?;
        Ok(with.iter().zip(&none).map(|(with, without)| with - without).collect())
    };
    let of_last = effect(&last.applied)?;
    for one in before.iter().filter(|one| !take_turns(&one.applied, &last.applied)) {
        let of_one = effect(&one.applied)?;
        let act = |i: &usize| [one, last].iter().all(|f| series.averages[*i].is_in(f.applied.span));
        let both: Vec<usize> = (0..none.len()).filter(|i| series.is_power(*i)).filter(act).collect();
        let power_w = |effect: &[f64]| DVector::from_iterator(both.len(), both.iter().map(|i| effect[*i]));
        if undo(&power_w(&of_last), &power_w(&of_one)) && !tells_apart(series, state, [&of_last, &of_one]) {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Whether a meter that is not one of power tells what two mechanisms do apart, beside all that may be otherwise with meter and robot.
fn tells_apart(series: &Series, state: &State, effects: [&[f64]; 2]) -> bool {
    let system = system_at(series, &state.fit, Sizes::Fixed, &[]);
    let white = state.fit.whitening(series);
    let [a, b] = effects.map(|effect| system.weigh(&[white.of(effect)]));
    let (Some(a), Some(b)) = (a, b) else { return false };
    do_not_undo_elsewhere(series, &a.own.column(0).into_owned(), &b.own.column(0).into_owned())
}

/// Whether two changes, in sigma, almost undo each other in power, and there is nothing else in which they would be seen and do not.
pub(crate) fn undo_in_all(series: &Series, a: &DVector<f64>, b: &DVector<f64>) -> bool {
    let power = |x: &DVector<f64>| of_quantity(series, x, Quantity::Power);
    undo(&power(a), &power(b)) && !do_not_undo_elsewhere(series, a, b)
}

fn do_not_undo_elsewhere(series: &Series, a: &DVector<f64>, b: &DVector<f64>) -> bool {
    Quantity::ALL.into_iter().filter(|quantity| *quantity != Quantity::Power).any(|quantity| {
        let [a, b] = [a, b].map(|x| of_quantity(series, x, quantity));
        a.norm_squared() + b.norm_squared() > SEEN_SIGMAS * SEEN_SIGMAS && !undo(&a, &b)
    })
}

/// The rows of one quantity.
fn of_quantity(series: &Series, x: &DVector<f64>, quantity: Quantity) -> DVector<f64> {
    let rows = x.iter().zip(series.averages.iter().map(Average::quantity));
    DVector::from_vec(rows.filter(|(_, of)| *of == quantity).map(|(x, _)| *x).collect())
}

/// Whether two changes almost undo each other.
fn undo(a: &DVector<f64>, b: &DVector<f64>) -> bool {
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
