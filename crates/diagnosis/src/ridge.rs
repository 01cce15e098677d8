//! Values that drives tell together and hardly apart: a weak wind on much area and a strong one on little, or motors that warm much slowly and
//! little soon, lie on a ridge, which is bent, so that standard errors at the best fit do not tell how far it reaches.

use std::f64::consts::FRAC_PI_8;

use model::Robot;
use rayon::prelude::*;

use crate::{
    Error,
    candidates::{self, apart},
    null::Null,
    polish::settle,
    search::State,
    series::{Applied, Series},
    usual,
    weigh::system,
};

/// Speeds of winds along the ridge [m/s], each in sixteen directions.
const SPEEDS_MPS: [f64; 11] = [1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 13.0, 17.0];
/// Time constants of heat along the ridge, over the range of those that are tried: each is less than a tenth more than the last.
const TIMES: u32 = 48;
/// 95 % quantile of χ² with one degree of freedom: what explains less than the best by no more is within the interval of each of its values
/// (profile likelihood; Venzon and Moolgavkar, Appl. Stat. 37, 1988).
const CHI_SQUARE_95: f64 = 3.841;

/// Widens the intervals of what was found to where the ridge reaches.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn widen(series: &Series, file: &Robot, state: &mut State, null: &Null) -> Result<(), Error> {
    for which in 0..state.found.len() {
        let along = along(&state.found[which].applied, file);
        if along.is_empty() {
            continue;
        }
        let reach = reach(series, file, (state, which), along, null)?;
        for (half, reach) in state.found[which].half_widths.iter_mut().zip(reach) {
            *half = half.map(|half| half.max(reach));
        }
    }
    Ok(())
}

/// How far from its values those along the ridge lie that explain about as much.
fn reach(
    series: &Series,
    file: &Robot,
    (state, which): (&State, usize),
    along: Vec<Vec<f64>>,
    null: &Null,
) -> Result<Vec<f64>, Error> {
    let (fitted, others) = apart(&state.applied(), which);
    let without = settle(series, file, &others, &state.fit.robot)?;
    let (base, others) = (&without.base, &without.applied);
    let (system, white) = (system(series, base), base.whitening(series));
    let at = |values: Vec<f64>| -> Result<Option<(f64, Vec<f64>)>, Error> {
        let probe = Applied { values: [vec![0.0], values[1..].to_vec()].concat(), ..fitted.clone() };
        let one = candidates::of(series, &base.robot, others, &base.predicted_w, probe, vec![0])?;
        let columns: Vec<Vec<f64>> = one.columns.iter().map(|column| white.of(column)).collect();
        let Some(evidence) = system.weigh(&columns) else { return Ok(None) };
        let by = [evidence.values[0]];
        let moved = candidates::moved(&one.applied, file, &[0], &by);
        // At the size that explains most; one that no robot has explains nothing.
        let explains = if moved.values[0] == by[0] && by[0] > 0.0 { evidence.explained } else { 0.0 };
        let unusual = usual::cost(std::slice::from_ref(&moved), &base.robot);
        Ok(Some((explains / null.common_discount(system.blocks()) - unusual, moved.values)))
    };
    let all = [vec![fitted.values.clone()], along].concat();
    let told: Vec<Option<(f64, Vec<f64>)>> = all.into_par_iter().map(at).collect::<Result<_, Error>>()?;
    Ok(farthest(&fitted.values, told.into_iter().flatten()))
}

/// Values that may explain as much, the first of which is a size that follows from the others; none of what lies on no ridge.
fn along(applied: &Applied, robot: &Robot) -> Vec<Vec<f64>> {
    let size = applied.values[0];
    match applied.mechanism.name() {
        "wind" => {
            let towards = |mps: f64, sixteenth: i32| {
                let (sin, cos) = (f64::from(sixteenth) * FRAC_PI_8).sin_cos();
                vec![size, mps * cos, mps * sin]
            };
            let all = SPEEDS_MPS.iter();
            all.flat_map(|mps| (0..16).map(move |sixteenth| towards(*mps, sixteenth))).collect()
        }
        "motor_heating" => {
            let [least_s, most_s] = candidates::range(applied, robot, 1);
            let time_s = |i: u32| least_s * (most_s / least_s).powf(f64::from(i) / f64::from(TIMES));
            (0..=TIMES).map(|i| vec![size, time_s(i)]).collect()
        }
        _ => Vec::new(),
    }
}

/// How far from some values those lie that explain about as much as the best.
fn farthest(from: &[f64], told: impl Iterator<Item = (f64, Vec<f64>)> + Clone) -> Vec<f64> {
    let best = told.clone().map(|(explained, _)| explained).fold(f64::NEG_INFINITY, f64::max);
    let near = told.filter(|(explained, _)| *explained > best - CHI_SQUARE_95);
    near.fold(vec![0.0; from.len()], |far, (_, values)| {
        let off = values.iter().zip(from).map(|(value, from)| (value - from).abs());
        far.iter().zip(off).map(|(far, off)| f64::max(*far, off)).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::span::Span;

    #[test]
    fn time_constants_lie_close_from_the_least_to_the_most_and_what_has_one_size_lies_on_no_ridge() {
        let of = |name: &str, values: Vec<f64>| {
            let mechanism = model::mechanism::by_name(name).unwrap();
            along(&Applied { mechanism, values, span: Span::ALL }, &model::builtin::husky_a200())
        };
        let times_s: Vec<f64> = of("motor_heating", vec![0.5, 900.0]).iter().map(|one| one[1]).collect();
        assert!(
            (times_s[0] - 60.0).abs() < 1e-9 && (times_s[TIMES as usize] - 3600.0).abs() < 1e-9,
            "{times_s:?}"
        );
        assert!(times_s.windows(2).all(|pair| (1.0..1.1).contains(&(pair[1] / pair[0]))), "{times_s:?}");
        assert!(of("payload", vec![5.0]).is_empty());
    }

    #[test]
    fn an_interval_reaches_as_far_as_what_explains_as_much_by_chance() {
        let told = [(50.0, vec![0.4, 6.0, 0.0]), (47.0, vec![1.2, 3.0, 1.0]), (45.0, vec![3.0, 1.0, 0.0])];
        let far = farthest(&[0.5, 5.0, 0.0], told.into_iter());
        assert!((far[0] - 0.7).abs() < 1e-12 && far[1..] == [2.0, 1.0], "{far:?}");
    }
}
