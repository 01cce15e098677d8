//! Predicted against recorded power, run by run.

use model::{Power, PowerKernel, Robot, Sides};
use rayon::prelude::*;
use recording::{Channel, PowerForm, Recording, Watch};
use serde::Serialize;

use crate::{
    Drives, Error,
    power::{PowerModel, by_row, seen_w},
    row::Row,
    score::Score,
};

/// How well one run, or all of them, was predicted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RunPrediction {
    /// Name of the run; `total` for all.
    pub run: String,
    /// Rows compared.
    pub rows: usize,
    /// Rows in which the wheels turned against each other and the robot did not; they are compared all the same.
    pub stuck_rows: usize,
    /// Mean of predicted less recorded power \[W\].
    pub bias_w: f64,
    /// Root mean square of predicted less recorded power \[W\].
    pub rmse_w: f64,
    /// R² of power by row; `null` where the recorded power is constant.
    pub r2: Option<f64>,
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
    predict_drives(robot, Drives::new(robot, recording)?)
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
    predict_drives(robot, Drives::watched(robot, recording, watch)?)
}

fn predict_drives(robot: &Robot, drives: Drives) -> Result<PredictedDrives, Error> {
    let stuck: Vec<bool> = drives.rows.iter().map(|row| row.stuck).collect();
    // A prediction is judged on all of a drive; being stuck is part of it.
    let drives = drives.including_stuck();
    let form = drives.form.unwrap_or(PowerForm::Battery);
    let amperes = (form == PowerForm::MotorCurrents).then(|| amperes(robot)).transpose()?;
    let by_row = by_row(&drives, robot, |i, power| {
        let row = &drives.rows[i];
        let read = |column: usize| drives.recorded.get(column).map_or(0.0, |values| values[i]);
        let recorded_w = match amperes {
            Some(amperes) => {
                watts_of_currents(robot, row, reading(robot, amperes, row, power), read).iter().sum()
            }
            None => read(0) + read(1),
        };
        (seen_w(robot, form, row, power).iter().sum::<f64>(), recorded_w)
    })?;
    let (predicted_w, recorded_w): (Vec<f64>, Vec<f64>) = by_row.into_iter().unzip();
    let currents_a = match amperes {
        Some(amperes) => currents(robot, &drives, amperes)?,
        None => Vec::new(),
    };
    drives.go_on()?;
    let order = drives.judged_runs();
    let averages = Averages {
        predicted_w: drives.averaged(&predicted_w),
        recorded_w: drives.averaged(&recorded_w),
        currents_a,
    };
    let judge = |run: Option<usize>| judge(&drives, run, &predicted_w, &recorded_w, &stuck, &averages);
    let (runs, total) =
        rayon::join(|| order.par_iter().map(|run| judge(Some(*run))).collect(), || judge(None));
    Ok(PredictedDrives { prediction: Prediction { runs, total }, drives, predicted_w, recorded_w })
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
    let amperes = amperes(robot)?;
    let drives = Drives::watched(robot, recording, watch)?.including_stuck();
    let watts = by_row(&drives, robot, |i, power| {
        let row = &drives.rows[i];
        let read = |column: usize| drives.recorded.get(column).map_or(0.0, |values| values[i]);
        watts_of_currents(robot, row, reading(robot, amperes, row, power), read)
    })?;
    let mut recording = recording.clone();
    for (side, (current, power)) in
        [(Channel::LeftMotorCurrent, Channel::LeftPower), (Channel::RightMotorCurrent, Channel::RightPower)]
            .into_iter()
            .enumerate()
    {
        recording.channels.remove(&current);
        recording.channels.insert(power, watts.iter().map(|watts| watts[side]).collect());
    }
    Ok(recording)
}

fn amperes(robot: &Robot) -> Result<Sides<f64>, Error> {
    match (robot.motors.left.force_n_per_a, robot.motors.right.force_n_per_a) {
        (Some(left), Some(right)) => Ok(Sides { left, right }),
        _ => Err(Error::NoForcePerAmpere),
    }
}

/// Signed newtons that an ampere of each side's reading stands for.
fn reading(robot: &Robot, amperes: Sides<f64>, row: &Row, power: &Power) -> Sides<f64> {
    let k2 = robot.motor_sides().map(|motor| motor.k2);
    let sides = power.force_n.zip(row.rim_mps).zip(amperes.zip(k2));
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
    let predicted = PowerModel::new(drives).averages(robot, |row, power| {
        let per_a = reading(robot, amperes, row, power);
        [power.force_n.left / per_a.left, power.force_n.right / per_a.right]
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

fn judge(
    drives: &Drives,
    run: Option<usize>,
    predicted_w: &[f64],
    recorded_w: &[f64],
    stuck: &[bool],
    averages: &Averages,
) -> RunPrediction {
    let wanted = |other: usize| run.is_none_or(|run| run == other);
    let (mut predicted, mut recorded, mut stuck_rows) = (Vec::new(), Vec::new(), 0);
    let (mut predicted_j, mut recorded_j) = (0.0, 0.0);
    for stretch in drives.stretches.iter().filter(|stretch| wanted(stretch.run)) {
        for i in stretch.rows.clone().filter(|&i| drives.rows[i].used) {
            predicted.push(predicted_w[i]);
            recorded.push(recorded_w[i]);
            stuck_rows += usize::from(stuck[i]);
            // Trapezes; a step counts where both of its ends are there.
            if i > stretch.rows.start && drives.rows[i - 1].used {
                predicted_j += drives.rows[i].step_s * (predicted_w[i] + predicted_w[i - 1]) / 2.0;
                recorded_j += drives.rows[i].step_s * (recorded_w[i] + recorded_w[i - 1]) / 2.0;
            }
        }
    }
    let by_row = Score::of(&predicted, &recorded);
    let places: Vec<usize> = (0..drives.averages.len()).filter(|&i| wanted(drives.averages[i].run)).collect();
    let of = |watts: &[f64]| places.iter().map(|&i| watts[i]).collect::<Vec<f64>>();
    let by_second = Score::of(&of(&averages.predicted_w), &of(&averages.recorded_w));
    let current = (!averages.currents_a.is_empty()).then(|| {
        let column = |which: usize| {
            let sides = averages.currents_a.iter();
            sides.flat_map(|side| places.iter().map(move |&i| side[which][i])).collect::<Vec<f64>>()
        };
        Score::of(&column(0), &column(1))
    });
    RunPrediction {
        run: run.map_or_else(|| "total".into(), |run| drives.runs[run].clone()),
        rows: predicted.len(),
        stuck_rows,
        bias_w: by_row.bias,
        rmse_w: by_row.rmse,
        r2: by_row.r2.is_finite().then_some(by_row.r2),
        recorded_j,
        predicted_j,
        normalized_error_percent: Some(by_second.normalized_error_percent)
            .filter(|percent| percent.is_finite()),
        rmse_a: current.map(|score| score.rmse),
        r2_a: current.map(|score| score.r2),
    }
}
