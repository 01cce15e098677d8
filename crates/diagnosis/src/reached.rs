//! The robot's own numbers fitted to the drives by Gauss's and Newton's steps.

use std::borrow::Cow;

use model::Robot;
use nalgebra::{DMatrix, DVector};

use crate::{
    Error,
    baseline::differences,
    knobs::Knob,
    noise::Noise,
    sensitivities::{NEAR, of_knobs},
    series::{Applied, Series},
};

/// Where the steps end.
pub(crate) struct Reached<'a> {
    pub(crate) robot: Robot,
    /// What was fitted.
    pub(crate) knobs: Vec<Knob>,
    pub(crate) predicted_w: Vec<f64>,
    /// Scatter of all that the fit leaves.
    pub(crate) noise: Noise,
    /// Change of predictions with each knob, per width of the file: the ones given, if they held all the way.
    pub(crate) columns: Cow<'a, [Vec<f64>]>,
}

/// Steps of Gauss and Newton at most; two or three do.
const STEPS: usize = 5;
/// A fit has settled when no knob moves by more than this, in widths of the file.
const SETTLED: f64 = 1e-3;

impl<'a> Reached<'a> {
    /// Fits the knobs from a robot that is near, with mechanisms acting; columns that hold there are worked out if none are given.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn from(
        series: &Series,
        (file, applied): (&Robot, &[Applied]),
        near: &Robot,
        columns: &'a [Vec<f64>],
    ) -> Result<Self, Error> {
        let knobs = Knob::of(file, &series.surfaces(), series.seen());
        let trusted = series.is_trusted();
        let fitted = if applied.is_empty() { trusted.clone() } else { vec![true; trusted.len()] };
        let mut robot = near.clone();
        let mut predicted_w = series.predict(&robot, applied)?;
        let noise_of = |predicted_w: &[f64]| {
            let errors_w = differences(&series.recorded, predicted_w);
            Noise::of(&errors_w, predicted_w, &series.averages, &trusted)
        };
        let mut noise = noise_of(&predicted_w);
        let mut last_move = if columns.is_empty() { f64::INFINITY } else { 0.0 };
        let mut columns = Cow::Borrowed(columns);
        for _ in 0..STEPS {
            if last_move > NEAR {
                columns = Cow::Owned(of_knobs(series, &robot, &knobs, applied, &predicted_w)?);
            }
            let errors = differences(&series.recorded, &predicted_w);
            let moves =
                solve(series, &knobs, file, &robot, (&errors, &predicted_w, &columns), &noise, &fitted);
            for (knob, by) in knobs.iter().zip(&moves) {
                let value = knob.value(&robot) + by.clamp(-3.0, 3.0) * knob.sigma;
                knob.set(&mut robot, value);
            }
            predicted_w = series.predict(&robot, applied)?;
            noise = noise_of(&predicted_w);
            last_move = moves.iter().fold(0.0, |most, by| by.abs().max(most));
            if last_move < SETTLED {
                break;
            }
        }
        Ok(Reached { robot, knobs, predicted_w, noise, columns })
    }
}

/// One step towards the least squares of robust errors and what the file says, in widths of the file.
fn solve(
    series: &Series,
    knobs: &[Knob],
    file: &Robot,
    robot: &Robot,
    (errors, predicted_w, columns): (&[f64], &[f64], &[Vec<f64>]),
    noise: &Noise,
    fitted: &[bool],
) -> Vec<f64> {
    let count = knobs.len();
    let white = noise.whitening(predicted_w, &series.averages);
    let errors = white.of(errors);
    let columns: Vec<Vec<f64>> = columns.iter().map(|column| white.of(column)).collect();
    // Errors beyond three sigma count linearly.
    let weight = |(e, fitted): (&f64, &bool)| if *fitted { (3.0 / e.abs().max(1e-9)).min(1.0) } else { 0.0 };
    let root_weight: Vec<f64> = errors.iter().zip(fitted).map(|one| weight(one).sqrt()).collect();
    let weighted = DMatrix::from_fn(errors.len(), count, |i, j| root_weight[i] * columns[j][i]);
    let errors = DVector::from_fn(errors.len(), |i, _| root_weight[i] * errors[i]);
    let from_file =
        DVector::from_fn(count, |j, _| (knobs[j].value(file) - knobs[j].value(robot)) / knobs[j].sigma);
    let square = DMatrix::identity(count, count) + weighted.transpose() * &weighted;
    let right = from_file + weighted.tr_mul(&errors);
    match square.cholesky() {
        Some(root) => root.solve(&right).iter().copied().collect(),
        None => vec![0.0; count],
    }
}
