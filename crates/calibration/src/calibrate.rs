//! A robot fitted to its recordings.

use model::Robot;
use recording::{PowerForm, Recording, Watch, unwatched};
use serde::Serialize;

use crate::{
    Drives, DrivesCoverage, Error, HeldOut, Skill, SlipTrack,
    contradiction::contradictions,
    current_robot,
    doubt::clipped_note,
    fit::NORMAL_975,
    held_out::{as_written, held_out},
    power_fit::{PowerFit, fit_power, fit_thinned},
    rhythm::rhythm_note,
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

/// A robot fitted to its recordings, with what is uncertain about it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Calibration {
    /// What was fitted.
    pub parameters: Vec<FittedParameter>,
    /// How well the robot file of half of the runs predicts the other half; `null` where a single run was recorded.
    pub held_out: Option<HeldOut>,
    /// How well the robot file that is written predicts the runs that it was fitted to.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub as_written: Option<Skill>,
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
    let Found { parameters, mut notes, robot: fitted } = fit_drives(robot, &drives, options)?;
    fitted.validate()?;
    let fit = |half: &Recording| fit_half(robot, &Drives::watched(robot, half, watch)?, options);
    let held_out = held_out(robot, recording, &drives, &fit, watch)?;
    if held_out.is_none() {
        notes.push("there is one run, so no run could judge the fit; record two or more".to_owned());
    }
    let as_written = Some(as_written(&fitted, recording, watch)?);
    let coverage = DrivesCoverage::default();
    let found = Calibration { parameters, held_out, as_written, notes, robot: fitted, coverage };
    Ok(found
        .covering(recording, &drives)
        .with_note(slopes_note(recording))
        .with_note(rhythm_note(recording).as_deref())
        .with_note(clipped_note(robot, recording).as_deref()))
}

/// What a fit of drives found.
pub(crate) struct Found {
    pub(crate) parameters: Vec<FittedParameter>,
    pub(crate) notes: Vec<String>,
    pub(crate) robot: Robot,
}

fn fit_drives(robot: &Robot, drives: &Drives, options: &Options) -> Result<Found, Error> {
    if drives.form == Some(PowerForm::MotorCurrents) {
        return current_robot::calibrate(robot, drives, options);
    }
    let (robot, track) = with_slip_track(robot, drives)?;
    let found = fit_power(&robot, drives)?;
    let mut parameters = vec![track];
    parameters.extend((0..found.fit.values.len()).map(|i| fitted(&found, i)));
    let mut notes: Vec<String> = held_note(&parameters).into_iter().collect();
    notes.extend(contradictions(&found.fit));
    Ok(Found { parameters, notes, robot: with_uncertainty(&found) })
}

/// The robot that the same fit makes of half of the runs.
fn fit_half(robot: &Robot, drives: &Drives, options: &Options) -> Result<Robot, Error> {
    if drives.form == Some(PowerForm::MotorCurrents) {
        return current_robot::fit_half(robot, drives, options);
    }
    let (robot, _) = with_slip_track(robot, drives)?;
    Ok(fit_thinned(&robot, drives)?.robot)
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
    robot.uncertainty.hotel_power_w = relative("hotel_power_w", u.hotel_power_w);
    robot
}
