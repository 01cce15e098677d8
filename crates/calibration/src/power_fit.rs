//! Fitting the robot to recordings of power.

use model::{
    Robot,
    robot::{Motor, Surface},
};
use recording::PowerForm;

use crate::{
    Drives, Error,
    fit::{Fit, Parameter, Problem},
    folds,
    noise::Noise,
    power::{PowerModel, seen_w},
};

/// What is known of ground that the robot file does not name: rolling 0.1 ± 0.1 and skid 0.4 ± 0.3 span hard floor to loose
/// sand (Dogru & Marques 2018, Fig. 13; BorealTC: 0.10 to 0.15 and 0.11 to 0.61); the scale is the file's default.
const NEW_GROUND: [[f64; 2]; 3] = [[0.1, 0.1], [0.4, 0.3], [0.3, 0.15]];
/// Relative sigma of a slip-angle scale that the robot file gives; its `uncertainty` has no such entry.
pub(crate) const SCALE_SIGMA: f64 = 0.5;
/// Sigma of the fraction that comes back: that of a fraction of which nothing is known, √(1/12).
const REGENERATION_SIGMA: f64 = 0.29;
/// Sigma of a standing power that the robot file gives as zero \[W\]: a computer and its sensors.
const STANDING_SIGMA_W: f64 = 30.0;

/// The robot as fitted to recordings of power.
#[derive(Clone, Debug)]
pub struct PowerFit {
    /// The robot with the values found.
    pub robot: Robot,
    /// The values and their uncertainty.
    pub fit: Fit,
}

/// A field of the robot that is fitted.
#[derive(Clone, Debug, PartialEq)]
enum Field {
    MuRoll(String),
    MuSkid(String),
    Scale(String),
    LeftK1,
    LeftK2,
    RightK1,
    RightK2,
    Regeneration,
    Hotel,
    Electronics,
}

/// Rows on which a first fit of a long recording is made, before all of them have their say.
const FIRST_ROWS: usize = 50_000;

/// Fits friction per surface, motor constants, regeneration and standing powers to all rows.
///
/// # Errors
/// [`Error::Robot`] where the result does not pass the robot's own checks.
pub fn fit_power(robot: &Robot, drives: &Drives) -> Result<PowerFit, Error> {
    if drives.rows.len() <= FIRST_ROWS {
        return fit_from(robot, drives, None);
    }
    let first = fit_thinned(robot, drives)?;
    fit_from(robot, drives, Some(&first.fit))
}

/// Fits to a part of a long recording, spread evenly over it: what judges other runs need not be as sharp as what is kept.
///
/// # Errors
/// Those of [`fit_power`].
pub fn fit_thinned(robot: &Robot, drives: &Drives) -> Result<PowerFit, Error> {
    let part = drives.thinned(FIRST_ROWS);
    if part.averages.is_empty() { fit_from(robot, drives, None) } else { fit_from(robot, &part, None) }
}

fn fit_from(known: &Robot, drives: &Drives, before: Option<&Fit>) -> Result<PowerFit, Error> {
    let form = drives.form.unwrap_or(PowerForm::Battery);
    let robot = with_new_ground(known, drives);
    let (fields, mut parameters) = known_before(&robot, known, drives, form);
    for parameter in &mut parameters {
        let earlier =
            before.and_then(|fit| Some((fit, fit.parameters.iter().position(|p| p.name == parameter.name)?)));
        if let Some((fit, i)) = earlier {
            parameter.start = fit.values[i];
        }
    }
    let model = PowerModel::new(drives);
    model.averages(&robot, |_, _| [])?;
    let predict = |values: &[f64]| predicted(&model, &applied(&robot, &fields, values), drives, form);
    let recorded = drives.recorded_averages();
    let block = folds::blocks(drives);
    let problem = |noise: Noise| Problem {
        recorded: &recorded,
        block: &block,
        noise: noise.weight(),
        largest: noise.largest(),
        predict: &predict,
    };
    let start: Vec<f64> = parameters.iter().map(|p| p.start).collect();
    let mut noise = Noise::of(&predict(&start), &recorded, drives);
    if before.is_none() {
        let rough = problem(noise).solve(&parameters);
        noise = Noise::of(&predict(&rough.values), &recorded, drives);
        parameters.iter_mut().zip(&rough.values).for_each(|(parameter, value)| parameter.start = *value);
    }
    let fit = problem(noise).solve_determined(&parameters);
    let fitted = applied(&robot, &fields, &fit.values);
    fitted.validate()?;
    Ok(PowerFit { robot: fitted, fit })
}

/// One-second averages of what a recording of a candidate would show, column behind column.
fn predicted(model: &PowerModel<'_>, candidate: &Robot, drives: &Drives, form: PowerForm) -> Vec<f64> {
    let Ok(seen) = model.averages(candidate, |row, power| seen_w(candidate, form, row, power)) else {
        return Vec::new();
    };
    (0..drives.recorded.len()).flat_map(|column| seen.iter().map(move |watts| watts[column])).collect()
}

/// The robot with the ground that the recording names and it lacks.
fn with_new_ground(robot: &Robot, drives: &Drives) -> Robot {
    let mut robot = robot.clone();
    for name in &drives.surfaces {
        let [[mu_roll, _], [mu_skid, _], [slip_angle_scale_rad, _]] = NEW_GROUND;
        let new = Surface { mu_roll, mu_skid, slip_angle_scale_rad, dogru_marques: None };
        robot.surfaces.entry(name.clone()).or_insert(new);
    }
    robot
}

/// What the robot file says of each field, and how surely; ground that it did not know has its own widths.
fn known_before(
    robot: &Robot,
    known: &Robot,
    drives: &Drives,
    form: PowerForm,
) -> (Vec<Field>, Vec<Parameter>) {
    let mut lines = Vec::new();
    let mut add =
        |field: Field, name: String, unit: &'static str, mean: f64, sigma: f64, bounds: [f64; 2]| {
            let prior = Some([mean, sigma]);
            lines.push((field, Parameter { name, unit, start: mean, bounds, prior, held: false }));
        };
    let u = &robot.uncertainty;
    let driven = |name: &String| drives.stretches.iter().any(|s| drives.surfaces[s.surface] == *name);
    for name in drives.surfaces.iter().filter(|name| driven(name)) {
        let Some(s) = robot.surfaces.get(name) else { continue };
        let new = !known.surfaces.contains_key(name);
        let sigma = |i: usize, mean: f64, relative: f64| if new { NEW_GROUND[i][1] } else { relative * mean };
        let at = |field: &str| format!("surfaces.{name}.{field}");
        add(
            Field::MuRoll(name.clone()),
            at("mu_roll"),
            "1",
            s.mu_roll,
            sigma(0, s.mu_roll, u.mu_roll),
            [0.0, 1.0],
        );
        add(
            Field::MuSkid(name.clone()),
            at("mu_skid"),
            "1",
            s.mu_skid,
            sigma(1, s.mu_skid, u.mu_skid),
            [0.0, 2.0],
        );
        let scale_rad = s.slip_angle_scale_rad.max(0.02);
        let scale_sigma_rad = sigma(2, scale_rad, SCALE_SIGMA);
        add(
            Field::Scale(name.clone()),
            at("slip_angle_scale_rad"),
            "rad",
            scale_rad,
            scale_sigma_rad,
            [0.01, 1.5],
        );
    }
    let sides = [
        ("left", robot.motors.left, Field::LeftK1, Field::LeftK2),
        ("right", robot.motors.right, Field::RightK1, Field::RightK2),
    ];
    for (side, Motor { k1_w_per_n2: k1, k2, .. }, first, second) in sides {
        let name = format!("motors.{side}.k1_w_per_n2");
        add(first, name, "W/N²", k1, u.k1 * k1, [0.2 * k1, 5.0 * k1 + 1e-9]);
        add(second, format!("motors.{side}.k2"), "1", k2, u.k2 * k2, [1.0, (2.0 * k2).max(3.0)]);
    }
    let regeneration = robot.motors.regeneration;
    add(Field::Regeneration, "motors.regeneration".into(), "1", regeneration, REGENERATION_SIGMA, [0.0, 1.0]);
    let standing = |mean_w: f64| [mean_w, (0.5 * mean_w).max(STANDING_SIGMA_W)];
    if matches!(form, PowerForm::Battery | PowerForm::CurrentAndVoltage) {
        let [mean_w, sigma_w] = standing(robot.hotel_power_w);
        add(Field::Hotel, "hotel_power_w".into(), "W", mean_w, sigma_w, [0.0, mean_w + 1000.0]);
    }
    let [mean_w, sigma_w] = standing(robot.drive_electronics_w);
    add(Field::Electronics, "drive_electronics_w".into(), "W", mean_w, sigma_w, [0.0, mean_w + 500.0]);
    lines.into_iter().unzip()
}

/// The robot with fitted values in their fields.
fn applied(robot: &Robot, fields: &[Field], values: &[f64]) -> Robot {
    let mut robot = robot.clone();
    for (field, &value) in fields.iter().zip(values) {
        let place = match field {
            Field::MuRoll(name) => robot.surfaces.get_mut(name).map(|s| &mut s.mu_roll),
            Field::MuSkid(name) => robot.surfaces.get_mut(name).map(|s| &mut s.mu_skid),
            Field::Scale(name) => robot.surfaces.get_mut(name).map(|s| &mut s.slip_angle_scale_rad),
            Field::LeftK1 => Some(&mut robot.motors.left.k1_w_per_n2),
            Field::LeftK2 => Some(&mut robot.motors.left.k2),
            Field::RightK1 => Some(&mut robot.motors.right.k1_w_per_n2),
            Field::RightK2 => Some(&mut robot.motors.right.k2),
            Field::Regeneration => Some(&mut robot.motors.regeneration),
            Field::Hotel => Some(&mut robot.hotel_power_w),
            Field::Electronics => Some(&mut robot.drive_electronics_w),
        };
        if let Some(place) = place {
            *place = value;
        }
    }
    robot
}
