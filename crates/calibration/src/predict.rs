//! Predicted against recorded power, run by run.

use std::ops::Range;

use model::{Power, PowerKernel, Robot, Sides};
use rayon::prelude::*;
use recording::{Channel, PowerForm, Recording, Watch, unwatched};
use serde::Serialize;

use crate::{
    Coverage, Doubt, Drives, Error,
    coverage::coverage,
    doubt::clipped_note,
    doubts,
    held_out::Skill,
    power::{PowerModel, columns_by_row, seen_w},
    rhythm::rhythm_note,
    row::Row,
    score::Tally,
    slopes::slopes_note,
};

/// How well one run, or all of them, was predicted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunPrediction {
    /// Name of the run; `total` for all.
    pub run: String,
    /// Rows compared; readings of a power meter that is slower than the wheels.
    pub rows: usize,
    /// Rows in which the wheels turned against each other and the robot did not; they are compared all the same.
    pub stuck_rows: usize,
    /// Mean of predicted less recorded power \[W\].
    pub bias_w: f64,
    /// Root mean square of predicted less recorded power \[W\].
    pub rmse_w: f64,
    /// R² of power by row; `null` where the recorded power is constant.
    pub r2: Option<f64>,
    /// How much of the run is counted in energies, and why the rest is not.
    pub coverage: Coverage,
    /// Recorded energy \[J\].
    pub recorded_j: f64,
    /// Predicted energy \[J\].
    pub predicted_j: f64,
    /// Normalised error of eq. 17 over the one-second averages, each weighted by what was recorded, as in Table IV of Dogru &
    /// Marques (2018) \[%\]: 100 Σ|predicted − recorded| / Σ|recorded|.
    pub normalized_error_percent: Option<f64>,
    /// Root mean square error of one-second averages of side current, where motor currents were recorded \[A\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rmse_a: Option<f64>,
    /// R² of the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub r2_a: Option<f64>,
}

/// Predicted against recorded power of a recording.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Prediction {
    /// Run by run.
    pub runs: Vec<RunPrediction>,
    /// All of them.
    pub total: RunPrediction,
    /// What is doubtful about the recording.
    pub doubts: Vec<Doubt>,
    /// What a person should know of how it was compared.
    pub notes: Vec<String>,
}

/// A prediction with what it was made of, row by row.
#[derive(Clone, Debug)]
pub struct PredictedDrives {
    /// The summary.
    pub prediction: Prediction,
    /// The drives compared.
    pub drives: Drives,
    /// Predicted power by row of the drives \[W\].
    pub predicted_w: Vec<f64>,
    /// Recorded power by row, NaN in gaps \[W\].
    pub recorded_w: Vec<f64>,
}

/// Predicts the power of recorded drives from their wheel speeds and slopes.
///
/// Where motor currents were recorded, recorded power is that of eq. 2 at the force `force_n_per_a` times the current, with the
/// sign of the predicted force; a side that the ground drives shows 1/k2² of the current for the same force.
///
/// # Errors
/// [`Error::NothingToFit`], [`Error::UnknownSurface`] or [`Error::NoForcePerAmpere`].
pub fn predict(robot: &Robot, recording: &Recording) -> Result<PredictedDrives, Error> {
    predict_watched(robot, recording, &unwatched())
}

/// Predicts as [`predict()`] does, followed by a watch.
///
/// # Errors
/// As [`predict()`], and [`Error::Stopped`] soon after the watch breaks.
pub fn predict_watched(
    robot: &Robot,
    recording: &Recording,
    watch: &Watch,
) -> Result<PredictedDrives, Error> {
    let thin = &*recording.thinned_watched(watch)?;
    let mut found = predict_drives(robot, thin, Drives::watched(robot, thin, watch)?)?;
    found.prediction.doubts = doubts(robot, recording, watch)?;
    found.prediction.notes.extend(slopes_note(recording).map(str::to_owned));
    found.prediction.notes.extend(rhythm_note(recording));
    found.prediction.notes.extend(clipped_note(robot, recording));
    Ok(found)
}

/// Drives with what a robot file predicts of them.
struct Compared {
    drives: Drives,
    predicted_w: Vec<f64>,
    recorded_w: Vec<f64>,
    stuck: Vec<bool>,
    averages: Averages,
}

fn compare(robot: &Robot, drives: Drives) -> Result<Compared, Error> {
    let stuck: Vec<bool> = drives.rows.par_iter().map(|row| row.stuck).collect();
    // A prediction is judged on all of a drive; being stuck is part of it.
    let drives = drives.including_stuck().including_level();
    let form = drives.form.unwrap_or(PowerForm::Battery);
    let amperes = (form == PowerForm::MotorCurrents).then(|| force_n_per_a(robot)).transpose()?;
    let (predicted_w, recorded_w) = columns_by_row(&drives, robot, |i, power| {
        let row = &drives.rows[i];
        let read = |column: usize| drives.recorded.get(column).map_or(0.0, |values| values[i]);
        let recorded_w = match amperes {
            Some(amperes) => {
                watts_of_currents(robot, row, signed_n_per_a(robot, amperes, row, power.force_n), read)
                    .iter()
                    .sum()
            }
            None => read(0) + read(1),
        };
        (seen_w(robot, form, row, power).iter().sum::<f64>(), recorded_w)
    })?;
    let currents_a = match amperes {
        Some(amperes) => currents(robot, &drives, amperes)?,
        None => Vec::new(),
    };
    drives.go_on()?;
    let averages = Averages {
        predicted_w: drives.averaged(&predicted_w),
        recorded_w: drives.averaged(&recorded_w),
        currents_a,
    };
    Ok(Compared { drives, predicted_w, recorded_w, stuck, averages })
}

/// How well a robot file predicts drives: run by run, and surface by surface.
pub(crate) struct JudgedDrives {
    pub(crate) judged: Vec<Judged>,
    pub(crate) surfaces: Vec<(String, Judged)>,
}

/// Judges a robot file on a recording as [`predict_watched()`] does, without a look at what is doubtful about it.
pub(crate) fn judge_drives(
    robot: &Robot,
    recording: &Recording,
    watch: &Watch,
) -> Result<JudgedDrives, Error> {
    let recording = &*recording.thinned_watched(watch)?;
    let compared = compare(robot, Drives::watched(robot, recording, watch)?)?;
    let names = compared.drives.surfaces.iter().cloned().enumerate();
    let on_surface = |(surface, name): (usize, String)| {
        let by_run = judge(&compared, Some(surface));
        (name, by_run.iter().fold(Judged::default(), Judged::join))
    };
    Ok(JudgedDrives { judged: judge(&compared, None), surfaces: names.map(on_surface).collect() })
}

fn predict_drives(robot: &Robot, recording: &Recording, drives: Drives) -> Result<PredictedDrives, Error> {
    let compared = compare(robot, drives)?;
    let judged = judge(&compared, None);
    let Compared { drives, predicted_w, recorded_w, .. } = compared;
    let order = drives.judged_runs();
    let covered = coverage(recording, &drives);
    let of_all = Coverage::of_all(&covered);
    if of_all.used_s <= 0.0 && recording.rows() > 1 {
        let no_time = || {
            "no run has two rows, between which time passes; name drives in the column `run`, not rows"
                .to_owned()
        };
        return Err(Error::NothingCounted { why: of_all.words().unwrap_or_else(no_time) });
    }
    let runs = order
        .iter()
        .map(|run| judged[*run].named(drives.runs[*run].clone(), covered[*run].clone()))
        .collect();
    let total = judged.iter().fold(Judged::default(), Judged::join).named("total".into(), of_all);
    Ok(PredictedDrives {
        prediction: Prediction {
            runs,
            total,
            doubts: Vec::new(),
            notes: drives.meter_note().into_iter().collect(),
        },
        drives,
        predicted_w,
        recorded_w,
    })
}

/// The same drives with the power that eq. 2 makes of recorded motor currents, for whoever compares powers; a recording that tells
/// its power stays as it is.
///
/// Currents come without a sign: theirs is that of the force which the robot needs as its file has it.
///
/// # Errors
/// As [`predict_watched()`].
pub fn with_powers(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Recording, Error> {
    if recording.power_form() != Some(PowerForm::MotorCurrents) {
        return Ok(recording.clone());
    }
    let amperes = force_n_per_a(robot)?;
    let drives = Drives::watched(robot, recording, watch)?.including_stuck();
    let (left_w, right_w) = columns_by_row(&drives, robot, |i, power| {
        let row = &drives.rows[i];
        let read = |column: usize| drives.recorded.get(column).map_or(0.0, |values| values[i]);
        watts_of_currents(robot, row, signed_n_per_a(robot, amperes, row, power.force_n), read).into()
    })?;
    let mut recording = recording.clone();
    for (current, power, watts) in [
        (Channel::LeftMotorCurrent, Channel::LeftPower, left_w),
        (Channel::RightMotorCurrent, Channel::RightPower, right_w),
    ] {
        recording.channels.remove(&current);
        recording.channels.insert(power, watts);
    }
    Ok(recording)
}

/// Newtons that an ampere of each side's motor current stands for \[N/A\].
///
/// # Errors
/// [`Error::NoForcePerAmpere`] where the robot's file does not say.
pub fn force_n_per_a(robot: &Robot) -> Result<Sides<f64>, Error> {
    match (robot.motors.left.force_n_per_a, robot.motors.right.force_n_per_a) {
        (Some(left), Some(right)) => Ok(Sides { left, right }),
        _ => Err(Error::NoForcePerAmpere),
    }
}

/// What the current meters of both sides read of a row in which the model needs some power: the idle current of the robot's file where the
/// robot stands, else the force over `force_n_per_a`, less by k2² where the ground drives a side \[A\].
///
/// # Errors
/// [`Error::NoForcePerAmpere`].
pub fn current_readings_a(robot: &Robot, row: &Row, power: &Power) -> Result<Sides<f64>, Error> {
    Ok(readings_a(robot, force_n_per_a(robot)?, row, power))
}

/// The same at newtons per ampere that are known \[A\].
#[inline]
pub(crate) fn readings_a(robot: &Robot, per_a: Sides<f64>, row: &Row, power: &Power) -> Sides<f64> {
    if row.stands() {
        return robot.motor_sides().map(|motor| motor.idle_current_a.unwrap_or(0.0));
    }
    let per_a = signed_n_per_a(robot, per_a, row, power.force_n);
    power.force_n.zip(per_a).map(|(force_n, per_a)| force_n / per_a)
}

/// Signed newtons that an ampere of each side's reading stands for while that side exerts a force \[N/A\]: c where the motor drives,
/// c k2² where the ground drives it, with the sign of the force.
pub fn signed_n_per_a(
    robot: &Robot,
    force_n_per_a: Sides<f64>,
    row: &Row,
    force_n: Sides<f64>,
) -> Sides<f64> {
    let k2 = robot.motor_sides().map(|motor| motor.k2);
    let sides = force_n.zip(row.rim_mps).zip(force_n_per_a.zip(k2));
    sides.map(|((force_n, rim_mps), (per_a, k2))| {
        let gear = if force_n * rim_mps >= 0.0 { 1.0 } else { k2 * k2 };
        per_a * gear * if force_n < 0.0 { -1.0 } else { 1.0 }
    })
}

/// The power that eq. 2 makes of recorded currents, left and right \[W\].
fn watts_of_currents(
    robot: &Robot,
    row: &Row,
    force_n_per_a: Sides<f64>,
    read: impl Fn(usize) -> f64,
) -> [f64; 2] {
    let force_n = Sides { left: force_n_per_a.left * read(0), right: force_n_per_a.right * read(1) };
    let power = side_power(robot, row, force_n);
    seen_w(robot, PowerForm::MotorCurrents, row, &power)
}

/// One-second averages of predicted and recorded current, side by side \[A\].
fn currents(robot: &Robot, drives: &Drives, amperes: Sides<f64>) -> Result<Vec<[Vec<f64>; 2]>, Error> {
    let predicted = PowerModel::new(drives)?.averages(robot, |row, power| {
        let reading = readings_a(robot, amperes, row, power);
        [reading.left, reading.right]
    })?;
    let sides = (0..2).map(|side| {
        let of_side = predicted.iter().map(|current_a| current_a[side]).collect();
        [of_side, drives.averaged(&drives.recorded[side])]
    });
    Ok(sides.collect())
}

/// Eq. 2 on both sides at known forces, through the kernel that computes all power.
fn side_power(robot: &Robot, row: &Row, force_n: Sides<f64>) -> Power {
    let kernel = PowerKernel::of_motors(robot, row.rim_mps, row.motor_c);
    let side_w = kernel.side_w(force_n);
    Power { force_n, mechanical_w: force_n.zip(row.rim_mps).map(|(f, u)| f * u), side_w, bus_w: side_w.sum() }
}

/// One-second averages: predicted and recorded power, and pairs of predicted and recorded current by side.
struct Averages {
    predicted_w: Vec<f64>,
    recorded_w: Vec<f64>,
    currents_a: Vec<[Vec<f64>; 2]>,
}

/// How well one run was predicted, in what adds up over runs.
#[derive(Clone, Copy, Default)]
pub(crate) struct Judged {
    by_row: Tally,
    by_second: Tally,
    currents: Option<Tally>,
    stuck_rows: usize,
    predicted_j: f64,
    recorded_j: f64,
}

impl Judged {
    pub(crate) fn join(self, other: &Judged) -> Judged {
        Judged {
            by_row: self.by_row.join(&other.by_row),
            by_second: self.by_second.join(&other.by_second),
            currents: match (self.currents, other.currents) {
                (Some(currents), Some(more)) => Some(currents.join(&more)),
                (currents, more) => currents.or(more),
            },
            stuck_rows: self.stuck_rows + other.stuck_rows,
            predicted_j: self.predicted_j + other.predicted_j,
            recorded_j: self.recorded_j + other.recorded_j,
        }
    }

    /// It as figures of a robot file.
    pub(crate) fn skill(&self) -> Skill {
        let (by_row, by_second) = (self.by_row.score(), self.by_second.score());
        let currents = self.currents.map(|tally| tally.score());
        Skill {
            rows: by_row.count,
            rmse_w: by_row.rmse,
            r2: by_row.r2.is_finite().then_some(by_row.r2),
            second_rmse_w: by_second.rmse,
            second_r2: by_second.r2.is_finite().then_some(by_second.r2),
            bias_w: by_row.bias,
            rmse_a: currents.map(|score| score.rmse),
            r2_a: currents.map(|score| score.r2).filter(|r2| r2.is_finite()),
        }
    }

    /// Magnitude of 100 (predicted - recorded) / recorded energy \[%\]; `None` where none was recorded.
    pub(crate) fn energy_error_percent(&self) -> Option<f64> {
        let percent = 100.0 * (self.predicted_j / self.recorded_j - 1.0);
        percent.is_finite().then_some(percent.abs())
    }

    fn named(&self, run: String, coverage: Coverage) -> RunPrediction {
        let (by_row, by_second) = (self.by_row.score(), self.by_second.score());
        let currents = self.currents.map(|tally| tally.score());
        RunPrediction {
            run,
            rows: by_row.count,
            stuck_rows: self.stuck_rows,
            coverage,
            bias_w: by_row.bias,
            rmse_w: by_row.rmse,
            r2: by_row.r2.is_finite().then_some(by_row.r2),
            recorded_j: self.recorded_j,
            predicted_j: self.predicted_j,
            normalized_error_percent: Some(by_second.normalized_error_percent)
                .filter(|percent| percent.is_finite()),
            rmse_a: currents.map(|score| score.rmse),
            r2_a: currents.map(|score| score.r2),
        }
    }
}

/// Judges every run, all of it or what of it is on one surface.
fn judge(compared: &Compared, surface: Option<usize>) -> Vec<Judged> {
    let Compared { drives, predicted_w, recorded_w, stuck, averages } = compared;
    let is_there = |one: usize| surface.is_none_or(|surface| surface == one);
    // Stretches and averages are in order of rows, those of a run together.
    let stretches = by_run(drives.runs.len(), drives.stretches.iter().map(|stretch| stretch.run));
    let seconds = by_run(drives.runs.len(), drives.averages.iter().map(|average| average.run));
    let of_run = |(stretches, seconds): (Range<usize>, Range<usize>)| {
        let mut judged = Judged::default();
        for stretch in drives.stretches[stretches].iter().filter(|stretch| is_there(stretch.surface)) {
            let mut before_used = false;
            for i in stretch.rows.clone() {
                let row = &drives.rows[i];
                if row.used {
                    judged.by_row.add(predicted_w[i], recorded_w[i]);
                    judged.stuck_rows += usize::from(stuck[i]);
                    // Trapezes; a step counts where both of its ends are there.
                    if before_used {
                        judged.predicted_j += row.step_s * (predicted_w[i] + predicted_w[i - 1]) / 2.0;
                        judged.recorded_j += row.step_s * (recorded_w[i] + recorded_w[i - 1]) / 2.0;
                    }
                }
                before_used = row.used;
            }
        }
        let pairs = |[predicted, recorded]: [&[f64]; 2]| {
            let there = seconds.clone().filter(|i| is_there(drives.averages[*i].surface));
            Tally::of(there.map(|i| (predicted[i], recorded[i])))
        };
        judged.by_second = pairs([&averages.predicted_w, &averages.recorded_w]);
        if drives.placement.is_some() {
            // Between its readings a slow meter tells nothing of single rows.
            judged.by_row = judged.by_second;
        }
        let currents = averages.currents_a.iter().map(|[predicted, recorded]| pairs([predicted, recorded]));
        judged.currents = currents.reduce(|all, side| all.join(&side));
        judged
    };
    stretches.into_par_iter().zip(seconds).map(of_run).collect()
}

/// Where the entries of each run lie among entries in order of runs.
fn by_run(runs: usize, of_entry: impl Iterator<Item = usize>) -> Vec<Range<usize>> {
    let mut places = vec![0..0; runs];
    for (i, run) in of_entry.enumerate() {
        let first = if places[run].is_empty() { i } else { places[run].start };
        places[run] = first..i + 1;
    }
    places
}
