//! What mechanisms and terms do where they act in all drives alike: that is nobody's mechanism, but what the robot's file does not tell.
//!
//! A robot in order has wheels that spin, tyres that slip and a centre of mass somewhere. What the file leaves out of that is in its
//! healthy drives as well, and only what suspect drives have beyond them is looked for. Functions of the inputs take it up as far as they
//! are like it; where they are not, the suspect drives would show the whole of it.

use model::{Robot, mechanism::Mechanism};
use rayon::prelude::*;

use crate::{
    Error,
    average::Quantity,
    baseline::{Baseline, differences},
    candidates::grids,
    nuisance::{SHARE_OF_WHAT_IS_LIKE_EFFECTS, means},
    series::{Applied, Series},
    span::Span,
    term::Term,
};

/// Changes of what is predicted with each number of each mechanism in all drives, each scaled to one sigma of what models miss; none
/// without healthy drives.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn columns(series: &Series, robot: &Robot, predicted: &[f64]) -> Result<Vec<Vec<f64>>, Error> {
    if !series.has_healthy() {
        return Ok(Vec::new());
    }
    let means = means(&series.averages, predicted);
    let column = |(mechanism, parameter): (&'static dyn Mechanism, usize)| {
        let mut values = vec![0.0; mechanism.parameters().len()];
        values[parameter] = mechanism.parameters()[parameter].probe;
        let everywhere = [Applied { mechanism, values, span: Span::ALL }];
        let seen = series.predict_with(robot, &everywhere, &everywhere)?;
        Ok(scaled(series, &means, &differences(&seen, predicted)))
    };
    let numbers: Vec<(&'static dyn Mechanism, usize)> = series.others(&[]).flat_map(numbers).collect();
    let columns: Vec<Option<Vec<f64>>> = numbers.into_par_iter().map(column).collect::<Result<_, Error>>()?;
    Ok(columns.into_iter().flatten().collect())
}

/// Numbers of a mechanism that power follows in proportion from nothing on. Delays in all drives are the sensors' business and stand
/// in the fit already, and heat takes time constants.
fn numbers(mechanism: &'static dyn Mechanism) -> Vec<(&'static dyn Mechanism, usize)> {
    if let "clock_offset" | "motor_heating" = mechanism.name() {
        return Vec::new();
    }
    let [(_, linear), ..] = &grids(mechanism)[..] else { return Vec::new() };
    let all = if mechanism.name() == "drivetrain_drag" { vec![0, 1] } else { linear.clone() };
    all.into_iter().map(|parameter| (mechanism, parameter)).collect()
}

/// What a term does in the drives under suspicion, and what of it goes with driving where it acts in all drives alike, scaled in the same
/// way: a robot in order does it as well, and there only what suspect drives have beyond that is missing. The latter is nothing without
/// healthy drives, and of what sets in at some time of the suspect ones.
pub(crate) fn of_term(series: &Series, base: &Baseline, term: &Term) -> [Vec<f64>; 2] {
    let driven = base.driven(series);
    let suspect = term.column(&driven);
    let everywhere = (series.has_healthy() && term.span.is_all()).then(|| {
        let means = means(&series.averages, &base.predicted_w);
        scaled(series, &means, &term.of_driving().everywhere(&driven))
    });
    [suspect, everywhere.flatten().unwrap_or_else(|| vec![0.0; series.averages.len()])]
}

/// A change scaled to the share of power that models may miss; `None` if it changes no power. What other meters show of it goes along.
fn scaled(series: &Series, means: &[f64], change: &[f64]) -> Option<Vec<f64>> {
    let power = || change.iter().zip(&series.averages).filter(|(_, a)| a.quantity() == Quantity::Power);
    let squares = power().map(|(x, a)| (x / means[a.channel].max(1e-9)).powi(2)).sum::<f64>();
    let by = scale(squares, power().count())?;
    Some(change.iter().map(|x| x * by).collect())
}

/// What scales a change to the share of power that models may miss, by the sum of its squares as shares of mean power over so many averages;
/// `None` if it is nothing.
pub(crate) fn scale(squares: f64, count: usize) -> Option<f64> {
    let share = (squares / count.max(1) as f64).sqrt();
    (share > 0.0).then(|| SHARE_OF_WHAT_IS_LIKE_EFFECTS / share)
}
