//! The robot's own numbers fitted to the drives, and how predictions hang on them.

use std::sync::{Arc, OnceLock};

use model::{Robot, mechanism};
use nalgebra::{DMatrix, DVector};
use rayon::prelude::*;

use crate::{
    Error,
    average::{Average, Quantity},
    candidates, channel,
    discrepancy::Ground,
    driven::Driven,
    everywhere, form,
    knobs::Knob,
    learnt::{Fit, Learnt},
    noise::{Noise, Whitening},
    nuisance,
    series::{Applied, Look, Series},
    shared::Shared,
    span::Span,
};

/// A robot at its best fit, with the sensitivities that a linear search needs.
#[derive(Clone)]
pub(crate) struct Baseline {
    /// The robot.
    pub robot: Robot,
    /// What was fitted.
    pub(crate) knobs: Vec<Knob>,
    /// Fitted less filed values, in widths of the file.
    pub(crate) moved: Vec<f64>,
    /// Predictions at the fit.
    pub(crate) predicted_w: Vec<f64>,
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
    /// Scatter of what is recorded about the predictions, as [`Look`] says.
    pub(crate) noise: Noise,
    /// What [`Baseline::missed`] made, on even and on uneven ground.
    missed: Arc<[OnceLock<Arc<[Shared]>>; 2]>,
}

/// Relative width of the battery's resistance, which voltages tell.
const RESISTANCE_SIGMA: f64 = 0.1;
/// One sigma by which slopes by heights and as they are read differ in all drives [rad]: as an inclinometer is mounted, a fifth of a degree.
const SLOPE_SIGMA_RAD: f64 = 4e-3;
/// Steps of Gauss and Newton at most; two or three do.
const STEPS: usize = 5;
/// Predictions hang on knobs as they did where none moved by more than this, in widths of the file.
const NEAR: f64 = 0.2;
/// A fit has settled when no knob moves by more than this, in widths of the file.
const SETTLED: f64 = 1e-3;

impl Baseline {
    /// Fits the knobs, with mechanisms acting. While none does, only drives that nothing is missing from are fitted: a strong
    /// effect would otherwise be shared out between the robot and the noise.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn fit(series: &Series, file: &Robot, applied: &[Applied]) -> Result<Self, Error> {
        let alone = &series.told().alone;
        match alone.get() {
            Some((of, fit)) if applied.is_empty() && of == file => return Ok(fit.clone()),
            _ => {}
        }
        let fit = Baseline::fit_from(series, file, applied, file)?;
        if applied.is_empty() {
            alone.get_or_init(|| (file.clone(), fit.clone()));
        }
        Ok(fit)
    }

    /// The same fit, reached from a robot that is near it.
    ///
    /// # Errors
    /// A surface that the robot does not know.
    pub(crate) fn fit_from(
        series: &Series,
        file: &Robot,
        applied: &[Applied],
        near: &Robot,
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
        let mut columns = Vec::new();
        let mut last_move = f64::INFINITY;
        for _ in 0..STEPS {
            if last_move > NEAR {
                columns = columns_of(series, &robot, &knobs, applied, &predicted_w)?;
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
        let moved = knobs.iter().map(|k| (k.value(&robot) - k.value(file)) / k.sigma).collect();
        let delays = delays(series, &robot, applied, &predicted_w)?;
        let sizes = candidates::of_sizes(series, &robot, applied, &predicted_w)?;
        let sags = sags(series, &predicted_w);
        let tilts = tilts(series, &robot, applied, &predicted_w)?;
        let rims_w_per_n = rims_w_per_n(series, &robot, applied, &predicted_w)?;
        // Made beforehand: who waits for others to work it out with it must not come back for it.
        let fit = Fit { predicted_w: &predicted_w, columns: &columns, trusted: &trusted };
        let told = series.told();
        if told.learnt.get().is_none() {
            let learnt = Learnt::of(series, fit, &noise);
            told.learnt.get_or_init(|| learnt);
        }
        if let Some(learnt) = told.learnt.get()
            && series.look == Look::Closer
        {
            noise = learnt.noise_of(series, fit);
        }
        // How far forms are open hangs on what was learnt.
        let forms = form::forms(series, &robot, applied, &predicted_w)?;
        if told.everywhere.get().is_none() {
            let none_w =
                if applied.is_empty() { predicted_w.clone() } else { series.predict(&robot, &[])? };
            let columns = everywhere::columns(series, &robot, &none_w)?;
            told.everywhere.get_or_init(|| columns);
        }
        Ok(Baseline {
            robot,
            knobs,
            moved,
            predicted_w,
            columns,
            sizes,
            delays,
            sags,
            tilts,
            rims_w_per_n,
            forms,
            noise,
            missed: Default::default(),
        })
    }

    /// What models miss, the same in suspect and in healthy drives, channel by channel: its averages, and columns over them with
    /// weights of one sigma 1 [W].
    fn of_channels(&self, series: &Series, ground: Ground) -> Vec<(Vec<usize>, Vec<Vec<f64>>)> {
        let averages = &series.averages;
        let of = |(channel, mean_w): (usize, f64)| {
            let places = channel::places(averages, channel);
            let columns = match series.told().learnt.get() {
                Some(learnt) => learnt.of_channel(averages, &places, (channel, mean_w), ground),
                None => nuisance::of_channel(averages, &places, mean_w),
            };
            (places, columns)
        };
        nuisance::means(averages, &self.predicted_w).into_iter().enumerate().map(of).collect()
    }

    /// The same as columns over all averages [W].
    pub(crate) fn shared(&self, series: &Series) -> Vec<Vec<f64>> {
        let spread = |(places, columns): (Vec<usize>, Vec<Vec<f64>>)| {
            channel::spread(&columns, &places, series.averages.len())
        };
        self.of_channels(series, Ground::Even).into_iter().flat_map(spread).collect()
    }

    /// The same, whitened, to be taken out of other columns. They are many and long and asked for again and again.
    pub(crate) fn missed(&self, series: &Series, ground: Ground) -> Arc<[Shared]> {
        let make = || {
            let white = self.whitening(series);
            let of = |(places, columns): (Vec<usize>, Vec<Vec<f64>>)| {
                let columns: Vec<_> =
                    columns.iter().map(|column| white.of_channel(&places, column)).collect();
                Shared::new(places, &columns)
            };
            self.of_channels(series, ground).into_iter().filter_map(of).collect()
        };
        Arc::clone(self.missed[ground as usize].get_or_init(make))
    }

    /// What terms are made of in each average.
    pub(crate) fn driven<'a>(&'a self, series: &'a Series) -> Driven<'a> {
        Driven {
            robot: &self.robot,
            averages: &series.averages,
            predicted_w: &self.predicted_w,
            rims_w_per_n: &self.rims_w_per_n,
        }
    }

    /// What makes errors about the fit independent and of one sigma 1.
    pub(crate) fn whitening(&self, series: &Series) -> Whitening {
        self.noise.whitening(&self.predicted_w, &series.averages)
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

/// See [`Baseline::rims_w_per_n`].
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

/// See [`Baseline::sags`].
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

/// See [`Baseline::tilts`].
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

fn columns_of(
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

/// Recorded less predicted.
pub(crate) fn differences(recorded: &[f64], predicted: &[f64]) -> Vec<f64> {
    recorded.iter().zip(predicted).map(|(r, p)| r - p).collect()
}
