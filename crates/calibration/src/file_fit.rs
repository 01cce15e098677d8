//! Fitting the robot file to motor currents: every number found has a field there, and currents are those that `predict` computes.
//!
//! The [`crate::current`] model is richer (relaxation, attitude filter, peaked slip law) and finds force per ampere; what it has beyond
//! the file would be lost, so the numbers of the file are fitted once more as the file uses them.

use model::{
    KnownMechanism, Robot, STANDARD_GRAVITY_MPS2, Sides,
    mechanism::{self, Mechanism},
};

use crate::{
    Drives, Error,
    correlation::Correlation,
    current::idle_a,
    current_fit::{MOST_ROWS, ROUGH_NOISE_A, SCALE_STARTS_RAD, thinned},
    field::{NEW_GROUND, SCALE_SIGMA, with_new_ground},
    fit::{Fit, Parameter, Problem},
    folds,
    force::Force,
    noise::{LARGEST, Noise},
    power::PowerModel,
    predict::current_readings_a,
};

/// Relative sigma of the inertia of rotors and gears at the rims, over the robot's mass: as [`mechanism`] has it.
const INERTIA_MASSES: f64 = 0.3;
/// Sigma of the height of the centre of mass over the track: half of it, as for a robot that stands as high as it is wide.
const HEIGHT_TRACKS: f64 = 0.5;
/// Sigma of the drag of one side over the weight: about what rolling takes, as of a brake that rubs.
const DRAG_WEIGHTS: f64 = 0.025;
/// Rolls below this tell no height \[rad\]: what an IMU is mounted askew by.
const LEAST_ROLL_RAD: f64 = 0.02;

/// A field of the robot file that motor currents tell.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum CurrentField {
    /// Newtons per ampere of both sides.
    Force,
    /// What the wheels' rotors and gears add to the mass of each side.
    Inertia,
    /// Drag of the right side, negative for drag of the left one.
    Drag,
    Height,
    MuRoll(String),
    MuSkid(String),
    Scale(String),
}

/// A robot file fitted to motor currents.
#[derive(Clone, Debug)]
pub(crate) struct FileFit {
    /// The robot with the values found.
    pub(crate) robot: Robot,
    /// What was fitted.
    pub(crate) fields: Vec<CurrentField>,
    /// Its values and their uncertainty at the force per ampere that was assumed.
    pub(crate) fit: Fit,
}

/// Fits the fields of a robot file on all surfaces at once, at one force per ampere.
///
/// # Errors
/// [`Error::Stopped`] when the drives' watch breaks.
pub(crate) fn fit_file(file: &Robot, drives: &Drives, force: &Force) -> Result<FileFit, Error> {
    let part = thinned(drives, MOST_ROWS)?;
    let known = with_new_ground(&with_force(file, force, drives), drives);
    let (fields, parameters) = known_before(file, &known, &part, force);
    let model = PowerModel::new(&part)?;
    let columns = part.recorded.len();
    let predict = |values: &[f64]| {
        let candidate = applied(&known, &fields, values);
        let readings = model.averages(&candidate, |row, power| {
            let amperes = current_readings_a(&candidate, row, power).unwrap_or(Sides::both(f64::NAN));
            [amperes.left, amperes.right]
        })?;
        Ok((0..columns).flat_map(|column| readings.iter().map(move |sides| sides[column])).collect())
    };
    let (recorded, block, series) = (part.recorded_averages(), folds::blocks(&part), folds::series(&part));
    let problem = |sigma, correlation, largest| Problem {
        recorded: &recorded,
        block: &block,
        series: &series,
        sigma,
        correlation,
        largest,
        predict: &predict,
    };
    let even = vec![ROUGH_NOISE_A; recorded.len()];
    // As of the peaked law, the valley of a slip-angle scale has two ends.
    let mut rough: Option<Fit> = None;
    for start_rad in [None, Some(SCALE_STARTS_RAD[0])] {
        let mut from = parameters.clone();
        for (parameter, field) in from.iter_mut().zip(&fields).filter(|(parameter, _)| !parameter.held) {
            if let (CurrentField::Scale(_), Some(start_rad)) = (field, start_rad) {
                parameter.start = start_rad;
            }
        }
        let found = problem(&even, Correlation::NONE, LARGEST).solve(&from)?;
        rough = Some(rough.filter(|other| other.cost <= found.cost).unwrap_or(found));
    }
    let mut started = parameters;
    let values: Vec<f64> = rough.map_or_else(|| started.iter().map(|p| p.start).collect(), |fit| fit.values);
    for (parameter, value) in started.iter_mut().zip(&values).filter(|(parameter, _)| !parameter.held) {
        parameter.start = *value;
    }
    let about = predict(&values)?;
    let noise = Noise::even(&about, &recorded, &part);
    let fit = problem(&noise.sigmas(&about), noise.correlation, LARGEST).solve_determined(&started)?;
    Ok(FileFit { robot: applied(&known, &fields, &fit.values), fields, fit })
}

/// The robot with the force per ampere and the reading at standstill.
fn with_force(file: &Robot, force: &Force, drives: &Drives) -> Robot {
    /// Beyond it, it is no reading of a robot that stands: the largest that a file may have \[A\].
    const MOST_IDLE_A: f64 = 100.0;
    let mut robot = file.clone();
    let standing_a = Some(idle_a(drives)).filter(|idle_a| (0.0..=MOST_IDLE_A).contains(idle_a));
    for motor in [&mut robot.motors.left, &mut robot.motors.right] {
        motor.force_n_per_a = Some(force.n_per_a);
        motor.idle_current_a = standing_a.filter(|idle_a| *idle_a > 0.0).or(motor.idle_current_a);
    }
    robot
}

/// Fields with what is known of them before.
fn known_before(
    file: &Robot,
    known: &Robot,
    drives: &Drives,
    force: &Force,
) -> (Vec<CurrentField>, Vec<Parameter>) {
    let mut lines: Vec<(CurrentField, Parameter)> = Vec::new();
    let mut add = |field, name: String, unit, prior: [f64; 2], bounds: [f64; 2], held: bool| {
        let start = prior[0].clamp(bounds[0], bounds[1]);
        lines.push((field, Parameter { name, unit, start, bounds, prior: Some(prior), held }));
    };
    let [low, high] = force.bounds();
    let sigma = force.n_per_a * force.relative_sigma;
    let held = !force.is_confounded;
    add(CurrentField::Force, "motors.force_n_per_a".into(), "N/A", [force.n_per_a, sigma], [low, high], held);
    let weight_n = file.mass_kg * STANDARD_GRAVITY_MPS2;
    let (inertia, drag) = (inertia_kg(file), drag_n(file));
    let bounds = by_name("inertia").map_or([0.0, file.mass_kg], |one| one.bounds(file, 0));
    let prior = [inertia, INERTIA_MASSES * file.mass_kg];
    add(CurrentField::Inertia, "mechanisms.inertia.kg_per_side".into(), "kg", prior, bounds, false);
    let most_n = by_name("drivetrain_drag").map_or(0.0, |one| one.bounds(file, 0)[1]);
    let prior = [drag, DRAG_WEIGHTS * weight_n];
    add(
        CurrentField::Drag,
        "mechanisms.drivetrain_drag.right_n".into(),
        "N",
        prior,
        [-most_n, most_n],
        false,
    );
    let prior = [file.center_of_mass.height_m, HEIGHT_TRACKS * file.track_m];
    let rolls = drives.rows.iter().filter(|row| row.used && row.roll_rad.abs() > LEAST_ROLL_RAD).count();
    let level = 10 * rolls < drives.rows.len();
    add(
        CurrentField::Height,
        "center_of_mass.height_m".into(),
        "m",
        prior,
        [0.0, 5.0f64.min(2.0 * file.track_m)],
        level,
    );
    let driven = |name: &String| drives.stretches.iter().any(|s| drives.surfaces[s.surface] == *name);
    for name in drives.surfaces.iter().filter(|name| driven(name)) {
        let Some(surface) = known.surfaces.get(name) else { continue };
        let held = force.is_confounded && file.surfaces.contains_key(name);
        let at = |field: &str| format!("surfaces.{name}.{field}");
        // Grounds are told apart by their currents, whatever the file says of one of that name.
        let roll = [surface.mu_roll, NEW_GROUND[0][1]];
        add(CurrentField::MuRoll(name.clone()), at("mu_roll"), "1", roll, [0.0, 1.0], held);
        let skid = [surface.mu_skid, NEW_GROUND[1][1]];
        add(CurrentField::MuSkid(name.clone()), at("mu_skid"), "1", skid, [0.0, 2.0], held);
        let scale_rad = surface.slip_angle_scale_rad.max(0.02);
        let scale = [scale_rad, SCALE_SIGMA * scale_rad];
        add(CurrentField::Scale(name.clone()), at("slip_angle_scale_rad"), "rad", scale, [0.01, 1.5], false);
    }
    lines.into_iter().unzip()
}

/// The robot with fitted values in their fields.
fn applied(robot: &Robot, fields: &[CurrentField], values: &[f64]) -> Robot {
    let mut robot = robot.clone();
    for (field, &value) in fields.iter().zip(values) {
        let place = match field {
            CurrentField::Force => {
                robot.motors.left.force_n_per_a = Some(value);
                robot.motors.right.force_n_per_a = Some(value);
                None
            }
            CurrentField::Inertia => {
                put(&mut robot, "inertia", vec![value]);
                None
            }
            CurrentField::Drag => {
                put(&mut robot, "drivetrain_drag", vec![(-value).max(0.0), value.max(0.0)]);
                None
            }
            CurrentField::Height => Some(&mut robot.center_of_mass.height_m),
            CurrentField::MuRoll(name) => robot.surfaces.get_mut(name).map(|s| &mut s.mu_roll),
            CurrentField::MuSkid(name) => robot.surfaces.get_mut(name).map(|s| &mut s.mu_skid),
            CurrentField::Scale(name) => robot.surfaces.get_mut(name).map(|s| &mut s.slip_angle_scale_rad),
        };
        if let Some(place) = place {
            *place = value;
        }
    }
    robot
}

fn by_name(name: &str) -> Option<&'static dyn Mechanism> {
    mechanism::by_name(name)
}

/// Sets a mechanism of the robot; one that does nothing is left out.
fn put(robot: &mut Robot, name: &str, values: Vec<f64>) {
    robot.mechanisms.retain(|known| known.mechanism().name() != name);
    if let Some(mechanism) = by_name(name).filter(|_| values.iter().any(|value| *value != 0.0)) {
        robot.mechanisms.push(KnownMechanism::new(mechanism, values));
    }
}

/// Sum of the values of a mechanism that the robot has, by parameter.
fn of_mechanism(robot: &Robot, name: &str, parameter: usize) -> f64 {
    let known = robot.mechanisms.iter().filter(|known| known.mechanism().name() == name);
    known.filter_map(|known| known.values().get(parameter)).sum()
}

fn inertia_kg(robot: &Robot) -> f64 {
    of_mechanism(robot, "inertia", 0)
}

fn drag_n(robot: &Robot) -> f64 {
    of_mechanism(robot, "drivetrain_drag", 1) - of_mechanism(robot, "drivetrain_drag", 0)
}
