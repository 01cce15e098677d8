//! How predictions hang on everything that is fitted, about a fit.

use model::{Robot, mechanism};
use rayon::prelude::*;

use crate::{
    Error,
    average::{Average, Quantity},
    baseline::differences,
    candidates, form,
    knobs::Knob,
    series::{Applied, Series},
    span::Span,
};

/// Changes of predictions, average by average.
pub(crate) struct Sensitivities {
    /// The robot and the mechanisms that they were worked out about.
    about: (Robot, Vec<Applied>),
    /// Change of predictions with each knob, per width of the file.
    pub(crate) columns: Vec<Vec<f64>>,
    /// Change of predictions per unit of each size of each mechanism that acts.
    pub(crate) sizes: Vec<Vec<Vec<f64>>>,
    /// Change of predictions with half a row of delay of power behind speeds, in suspect drives and in all: less than a row is the
    /// sensors' business, and what they are late by in healthy drives they are in the others too.
    pub(crate) delays: [Vec<f64>; 2],
    /// Change of predictions with the battery's resistance, per one sigma: in all drives, and in those under suspicion from their beginning and
    /// as time goes on. A meter that reads otherwise does so in one of them, and at once.
    pub(crate) sags: Vec<Vec<f64>>,
    /// Change of climbs with slopes that were read too steep, per one sigma: in all drives, and in those under suspicion, as an inclinometer is
    /// from one day to the next. One that is askew by more, or from some time on, is.
    pub(crate) tilts: Vec<Vec<f64>>,
    /// Change of predictions with one newton that holds the wheels of the left and of the right side back, in all drives: what a force at
    /// the rim costs beyond the motors.
    pub(crate) rims_w_per_n: [Vec<f64>; 2],
    /// What the forms of mechanisms that act leave open, per one sigma.
    pub(crate) forms: Vec<Vec<f64>>,
}

/// Relative width of the battery's resistance, which voltages tell.
const RESISTANCE_SIGMA: f64 = 0.1;
/// One sigma by which slopes by heights and as they are read differ in all drives [rad]: as an inclinometer is mounted, a fifth of a degree.
const SLOPE_SIGMA_RAD: f64 = 4e-3;
/// Predictions hang on knobs as they did where none moved by more than this, in widths of the file, and on mechanisms where none changed by
/// more than this share of itself.
pub(crate) const NEAR: f64 = 0.2;

impl Sensitivities {
    /// All about a fit, of which those with knobs are known. How far forms are open hangs on what was learnt of healthy drives before.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn new(
        series: &Series,
        robot: &Robot,
        applied: &[Applied],
        predicted_w: &[f64],
        columns: Vec<Vec<f64>>,
    ) -> Result<Self, Error> {
        Ok(Sensitivities {
            about: (robot.clone(), applied.to_vec()),
            columns,
            sizes: candidates::of_sizes(series, robot, applied, predicted_w)?,
            delays: delays(series, robot, applied, predicted_w)?,
            sags: sags(series, predicted_w),
            tilts: tilts(series, robot, applied, predicted_w)?,
            rims_w_per_n: rims_w_per_n(series, robot, applied, predicted_w)?,
            forms: form::forms(series, robot, applied, predicted_w)?,
        })
    }

    /// Whether they hold for mechanisms that act: the same ones in the same spans, all by about as much.
    pub(crate) fn hold_for(&self, applied: &[Applied]) -> bool {
        let is_near = |one: &Applied, other: &Applied| {
            let parameters = one.mechanism.parameters().iter();
            parameters
                .zip(one.values.iter().zip(&other.values))
                .all(|(parameter, (from, to))| (to - from).abs() <= NEAR * from.abs().max(parameter.probe))
        };
        self.are_of(applied, is_near)
    }

    /// Whether they were worked out about this.
    pub(crate) fn are_about(&self, robot: &Robot, applied: &[Applied]) -> bool {
        self.about.0 == *robot && self.are_of(applied, |one, other| one.values == other.values)
    }

    fn are_of(&self, applied: &[Applied], is_alike: impl Fn(&Applied, &Applied) -> bool) -> bool {
        let (_, own) = &self.about;
        let is_same = |one: &Applied, other: &Applied| {
            one.mechanism.name() == other.mechanism.name() && one.span == other.span && is_alike(one, other)
        };
        own.len() == applied.len() && own.iter().zip(applied).all(|(one, other)| is_same(one, other))
    }
}

fn delays(
    series: &Series,
    robot: &Robot,
    applied: &[Applied],
    predicted_w: &[f64],
) -> Result<[Vec<f64>; 2], Error> {
    let Some(mechanism) = mechanism::by_name("clock_offset") else { return Ok([Vec::new(), Vec::new()]) };
    let delay = Applied { mechanism, values: vec![0.5 * series.row_s()], span: Span::ALL };
    let mut with = applied.to_vec();
    with.push(delay.clone());
    let seen = [series.predict(robot, &with)?, series.predict_with(robot, applied, &[delay])?];
    let [suspect, healthy] = seen.map(|seen| differences(&seen, predicted_w));
    let all = suspect.iter().zip(&healthy).map(|(a, b)| a + b).collect();
    Ok([suspect, all])
}

/// See [`Sensitivities::rims_w_per_n`].
fn rims_w_per_n(
    series: &Series,
    robot: &Robot,
    applied: &[Applied],
    predicted_w: &[f64],
) -> Result<[Vec<f64>; 2], Error> {
    let Some(mechanism) = mechanism::by_name("drivetrain_drag") else { return Ok([Vec::new(), Vec::new()]) };
    let held_back = |values: Vec<f64>| -> Result<Vec<f64>, Error> {
        let drag = Applied { mechanism, values, span: Span::ALL };
        let suspect = [applied, std::slice::from_ref(&drag)].concat();
        Ok(differences(&series.predict_with(robot, &suspect, &[drag])?, predicted_w))
    };
    Ok([held_back(vec![1.0, 0.0])?, held_back(vec![0.0, 1.0])?])
}

/// See [`Sensitivities::sags`].
fn sags(series: &Series, predicted: &[f64]) -> Vec<Vec<f64>> {
    let Some(change) = series.sag_change() else { return Vec::new() };
    let whole_s = series.longest_s().max(1.0);
    let column = |share: &dyn Fn(&Average) -> f64| {
        let of = |(average, predicted): (&Average, &f64)| match average.quantity() {
            Quantity::Voltage => share(average) * predicted,
            _ => 0.0,
        };
        series.averages.iter().zip(predicted).map(of).collect::<Vec<f64>>()
    };
    let in_suspect = |share: f64, a: &Average| if a.suspect { share } else { 0.0 };
    let mut sags = vec![column(&|_| RESISTANCE_SIGMA)];
    if series.has_healthy() {
        sags.push(column(&|a| in_suspect(change, a)));
    }
    // From its middle on either way, one sigma over all of a drive.
    sags.push(column(&|a| in_suspect(change * 12.0_f64.sqrt() * (a.t_s / whole_s - 0.5), a)));
    sags
}

/// See [`Sensitivities::tilts`].
fn tilts(
    series: &Series,
    robot: &Robot,
    applied: &[Applied],
    predicted: &[f64],
) -> Result<Vec<Vec<f64>>, Error> {
    let Some((change_rad, mechanism)) = series.slope_change_rad().zip(mechanism::by_name("pitch_bias"))
    else {
        return Ok(Vec::new());
    };
    let askew = |by_rad: f64| Applied { mechanism, values: vec![by_rad], span: Span::ALL };
    let in_climbs = |seen: Vec<f64>| -> Vec<f64> {
        let of = |((average, seen), predicted): ((&Average, f64), &f64)| match average.quantity() {
            Quantity::Height => seen - predicted,
            _ => 0.0,
        };
        series.averages.iter().zip(seen).zip(predicted).map(of).collect()
    };
    let with = [applied, &[askew(SLOPE_SIGMA_RAD)]].concat();
    let all = in_climbs(series.predict_with(robot, &with, &[askew(SLOPE_SIGMA_RAD)])?);
    let with = [applied, &[askew(change_rad)]].concat();
    let suspect = in_climbs(series.predict(robot, &with)?);
    Ok(if series.has_healthy() { vec![all, suspect] } else { vec![all] })
}

/// Change of predictions with each knob, per width of the file.
///
/// # Errors
/// A surface that the robot does not know.
pub(crate) fn of_knobs(
    series: &Series,
    robot: &Robot,
    knobs: &[Knob],
    applied: &[Applied],
    predicted_w: &[f64],
) -> Result<Vec<Vec<f64>>, Error> {
    knobs
        .par_iter()
        .map(|knob| {
            let mut moved = robot.clone();
            knob.set(&mut moved, knob.value(robot) + knob.step());
            let by = knob.value(&moved) - knob.value(robot);
            if by == 0.0 {
                return Ok(vec![0.0; predicted_w.len()]);
            }
            let there = series.predict(&moved, applied)?;
            Ok(there.iter().zip(predicted_w).map(|(a, b)| (a - b) / by * knob.sigma).collect())
        })
        .collect()
}
