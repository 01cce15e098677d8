//! A robot fitted to its recordings.

use model::Robot;
use recording::{PowerForm, Recording, Watch, unwatched};
use serde::Serialize;

use crate::{
    Drives, DrivesCoverage, Error, SlipTrack,
    contradiction::contradictions,
    current_calibration,
    current_judge::SurfaceVerdict,
    fit::NORMAL_975,
    folds,
    power::{by_row, seen_w},
    power_fit::{PowerFit, fit_power, fit_thinned},
    score::{Score, median},
    slopes::slopes_note,
    stuck,
};

/// What a calibration may be told.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Options {
    /// For motor currents, the surface that what belongs to the robot is fitted on; default: the one that determines force per ampere
    /// best.
    pub reference_surface: Option<String>,
    /// Names of doubts that are overruled; see [`crate::Doubt`], and `held_out` for a fit that runs it did not see contradict.
    pub despite: Vec<String>,
}

/// One fitted number.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FittedParameter {
    /// Its field in the robot file, or its name in the current model.
    pub name: String,
    /// The value.
    pub value: f64,
    /// Its unit, `1` for none.
    pub unit: String,
    /// The interval that holds the true value in 95 of 100 recordings; `null` where nothing bounds it.
    pub interval_95: Option<[f64; 2]>,
    /// The recording says more about it than was known before; otherwise the value is what was known before.
    pub determined: bool,
}

/// How well the fit holds on runs that it did not see.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct HeldOut {
    /// Root mean square error of one-second averages \[W\].
    pub rmse_w: f64,
    /// R² of the same.
    pub r2: f64,
    /// Mean of predicted less recorded \[W\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bias_w: Option<f64>,
    /// Median magnitude of the energy error by run \[%\].
    pub median_energy_error_percent: f64,
    /// Root mean square error of side current, where currents were recorded \[A\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rmse_a: Option<f64>,
    /// R² of the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub r2_a: Option<f64>,
    /// Surface by surface, where currents were recorded.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub surfaces: Vec<SurfaceVerdict>,
}

/// A robot fitted to its recordings, with what is uncertain about it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// What was fitted.
    pub parameters: Vec<FittedParameter>,
    /// How well it holds on runs that were not fitted; `null` where a single run was recorded.
    pub held_out: Option<HeldOut>,
    /// What a person should know.
    pub notes: Vec<String>,
    /// How many seconds of every run were fitted, and why the rest was not.
    pub coverage: DrivesCoverage,
    /// The robot with the values found and their `uncertainty`.
    pub robot: Robot,
}

impl Calibration {
    /// The same with what of its drives was fitted.
    pub(crate) fn covering(mut self, recording: &Recording, drives: &Drives) -> Self {
        self.coverage = DrivesCoverage::of(recording, drives);
        self.notes.extend(self.coverage.total.words());
        self.notes.extend(drives.meter_note());
        self
    }

    fn with_note(mut self, note: Option<&str>) -> Self {
        self.notes.extend(note.map(str::to_owned));
        self
    }
}

/// Fits a robot to recordings: its priors are the robot file's, runs are kept apart, and every other run judges the fit of the rest.
///
/// # Errors
/// [`Error::NothingToFit`], or [`Error::Robot`] where the result is no robot.
pub fn calibrate(robot: &Robot, recording: &Recording, options: &Options) -> Result<Calibration, Error> {
    calibrate_watched(robot, recording, options, &unwatched())
}

/// Fits a robot as [`calibrate()`] does, followed by a watch.
///
/// # Errors
/// As [`calibrate()`], and [`Error::Stopped`] soon after the watch breaks.
pub fn calibrate_watched(
    robot: &Robot,
    recording: &Recording,
    options: &Options,
    watch: &Watch,
) -> Result<Calibration, Error> {
    let recording = &*recording.thinned_watched(watch)?;
    let drives = Drives::watched(robot, recording, watch)?;
    let found = calibrate_drives(robot, &drives, options)?;
    Ok(found.covering(recording, &drives).with_note(slopes_note(recording)))
}

fn calibrate_drives(robot: &Robot, drives: &Drives, options: &Options) -> Result<Calibration, Error> {
    if drives.form == Some(PowerForm::MotorCurrents) {
        return current_calibration::calibrate(robot, drives, options);
    }
    let (robot, track) = with_slip_track(robot, drives)?;
    let found = fit_power(&robot, drives)?;
    let mut parameters = vec![track];
    parameters.extend((0..found.fit.values.len()).map(|i| fitted(&found, i)));
    let held_out = power_held_out(&robot, drives)?;
    let mut notes: Vec<String> = held_note(&parameters).into_iter().collect();
    notes.extend(contradictions(&found.fit));
    if held_out.is_none() {
        notes.push("there is one run, so no run could judge the fit; record two or more".to_owned());
    }
    let robot = with_uncertainty(&found);
    Ok(Calibration { parameters, held_out, notes, robot, coverage: DrivesCoverage::default() })
}

/// Names what the recording does not determine, for a person to read.
pub(crate) fn held_note(parameters: &[FittedParameter]) -> Option<String> {
    let held: Vec<&str> = parameters.iter().filter(|p| !p.determined).map(|p| p.name.as_str()).collect();
    let note =
        || format!("not determined by these drives, held at what was known before: {}", held.join(", "));
    (!held.is_empty()).then(note)
}

/// The robot with the slip track that its gyroscope and wheels agree on, where both turned.
///
/// # Errors
/// [`Error::Stopped`] when the drives' watch breaks.
pub(crate) fn with_slip_track(robot: &Robot, drives: &Drives) -> Result<(Robot, FittedParameter), Error> {
    let mut robot = robot.clone();
    let parameter = |value: f64, interval_95, determined| FittedParameter {
        name: "slip_track_m".into(),
        value,
        unit: "m".into(),
        interval_95,
        determined,
    };
    let sensible = robot.track_m..=10.0 * robot.track_m;
    Ok(match stuck::slip_track(drives)? {
        Some(SlipTrack { value_m, sigma_m }) if sensible.contains(&value_m) => {
            robot.slip_track_m = value_m;
            let half_m = NORMAL_975 * sigma_m;
            (robot, parameter(value_m, Some([value_m - half_m, value_m + half_m]), true))
        }
        _ => (robot.clone(), parameter(robot.slip_track_m, None, false)),
    })
}

fn fitted(found: &PowerFit, i: usize) -> FittedParameter {
    let (parameter, fit) = (&found.fit.parameters[i], &found.fit);
    let [low, high] = fit.interval_95(i);
    FittedParameter {
        name: parameter.name.clone(),
        value: fit.values[i],
        unit: parameter.unit.into(),
        interval_95: Some([low.max(parameter.bounds[0]), high.min(parameter.bounds[1])]),
        determined: fit.determined(i),
    }
}

/// The fitted robot with the largest relative sigma of each kind of parameter.
fn with_uncertainty(found: &PowerFit) -> Robot {
    let mut robot = found.robot.clone();
    let relative = |ending: &str, before: f64| {
        let matching =
            (0..found.fit.values.len()).filter(|&i| found.fit.parameters[i].name.ends_with(ending));
        let sigmas =
            matching.filter(|&i| found.fit.values[i] > 0.0).map(|i| found.fit.sigma(i) / found.fit.values[i]);
        let largest = sigmas.fold(0.0, f64::max);
        if largest > 0.0 { largest.min(1.0) } else { before }
    };
    let u = robot.uncertainty;
    robot.uncertainty.mu_roll = relative("mu_roll", u.mu_roll);
    robot.uncertainty.mu_skid = relative("mu_skid", u.mu_skid);
    robot.uncertainty.k1 = relative("k1_w_per_n2", u.k1);
    robot.uncertainty.k2 = relative("k2", u.k2);
    robot
}

/// Each half of the runs judged by the fit of the other half.
fn power_held_out(robot: &Robot, drives: &Drives) -> Result<Option<HeldOut>, Error> {
    if drives.judged_runs().len() < 2 {
        return Ok(None);
    }
    let halves = folds::halves(drives)?;
    let (mut predicted_w, mut recorded_w, mut energies) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..2 {
        let fitted = fit_thinned(robot, &halves[i])?.robot;
        let mut judging = fitted.clone();
        let others = &halves[1 - i];
        for name in &others.surfaces {
            // Ground that the other half did not drive on is judged by the robot file, or by the default ground of a fit.
            if let Some(surface) = robot.surfaces.get(name) {
                judging.surfaces.entry(name.clone()).or_insert_with(|| surface.clone());
            }
        }
        let form = others.form.unwrap_or(PowerForm::Battery);
        let seen = by_row(others, &judging, |i, power| {
            seen_w(&judging, form, &others.rows[i], power).iter().sum::<f64>()
        })?;
        let predicted = others.averaged(&seen);
        let recorded = others.averaged_by(|row| others.recorded.iter().map(|column| column[row]).sum());
        let error = |run: usize| others.energy_error_percent(run, &predicted, &recorded).abs();
        energies.extend(others.judged_runs().into_iter().map(error));
        predicted_w.extend(predicted);
        recorded_w.extend(recorded);
    }
    let score = Score::of(&predicted_w, &recorded_w);
    Ok(Some(HeldOut {
        rmse_w: score.rmse,
        r2: score.r2,
        bias_w: Some(score.bias),
        median_energy_error_percent: median(&energies),
        ..HeldOut::default()
    }))
}
