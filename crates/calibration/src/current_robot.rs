//! A robot file fitted to recordings of motor current.

use model::{Robot, knowledge::Provenance};

use crate::{
    Drives, Error,
    calibrate::{FittedParameter, Found, Options, held_note, with_slip_track},
    contradiction::{contradictions, far},
    current_calibration::{reference, refuse_one_run},
    current_fit::{CurrentFit, IN_THE_FILE, fit_reference},
    file_fit::{CurrentField, FileFit, fit_file},
    fit::NORMAL_975,
    force::{self, Force, ForceSource},
};

/// What a fit found beside the robot.
struct FittedFile {
    slip_track: FittedParameter,
    reference: CurrentFit,
    force: Force,
    file: FileFit,
}

fn fit(robot: &Robot, drives: &Drives, options: &Options, is_half: bool) -> Result<FittedFile, Error> {
    let surface = reference(robot, drives, options)?;
    let on_reference = drives.on_surface(surface)?;
    if !is_half {
        refuse_one_run(drives, surface, &on_reference)?;
    }
    let (robot, slip_track) = with_slip_track(robot, &on_reference)?;
    let reference = fit_reference(&robot, &on_reference)?;
    let mut force = Force::of(&robot, &drives.surfaces[surface], &reference);
    let file = fit_file(&robot, drives, &force)?;
    if force.is_confounded {
        force.by_friction(&robot, &file);
    }
    Ok(FittedFile { slip_track, reference, force, file })
}

/// The robot that half of the runs gives.
///
/// # Errors
/// As [`calibrate`], but for a single run.
pub(crate) fn fit_half(robot: &Robot, drives: &Drives, options: &Options) -> Result<Robot, Error> {
    // A half may lack the ground that was asked for.
    let asked = options.reference_surface.as_ref().filter(|name| drives.surfaces.contains(name));
    let options = Options { reference_surface: asked.cloned(), ..options.clone() };
    Ok(fit(robot, drives, &options, true)?.file.robot)
}

/// Fits a robot file to recordings of motor current.
///
/// # Errors
/// [`Error::NoReference`], [`Error::TooFewRuns`], [`Error::Stopped`].
pub(crate) fn calibrate(robot: &Robot, drives: &Drives, options: &Options) -> Result<Found, Error> {
    let found = fit(robot, drives, options, false)?;
    let mut parameters = vec![found.slip_track.clone(), found.force.parameter()];
    parameters.extend(idle_parameter(&found.file.robot));
    parameters.extend((0..found.file.fields.len()).filter_map(|i| parameter(robot, &found, i)));
    parameters.extend(rest_of_the_model(&found.reference));
    let mut notes = vec![found.force.note()];
    notes.push("mu_roll holds the no-load current of the motors, which currents alone cannot tell from rolling resistance".into());
    notes.extend(stuck_notes(drives));
    notes.extend(held_note(&parameters));
    notes.extend(contradictions(&found.file.fit));
    notes.extend(far_from_file(robot, &found));
    let mut fitted = found.file.robot.clone();
    write_uncertainty(&mut fitted, &parameters);
    if matches!(found.force.source, ForceSource::Slopes(_)) {
        for side in ["left", "right"] {
            fitted.provenance.insert(format!("motors.{side}.force_n_per_a"), Provenance::Fitted);
        }
    }
    Ok(Found { parameters, notes, robot: fitted })
}

/// The reading at standstill, where the robot stood.
fn idle_parameter(robot: &Robot) -> Option<FittedParameter> {
    Some(FittedParameter {
        name: "motors.idle_current_a".into(),
        value: robot.motors.left.idle_current_a?,
        unit: "A".into(),
        interval_95: None,
        determined: true,
    })
}

/// One field of the file, with what force per ampere leaves open of it; that itself is told apart.
fn parameter(file: &Robot, found: &FittedFile, i: usize) -> Option<FittedParameter> {
    let (fit, field) = (&found.file.fit, &found.file.fields[i]);
    let (value, parameter) = (fit.values[i], &fit.parameters[i]);
    // What a share of force per ampere is worth: forces at known currents grow with it.
    let by_force = match field {
        CurrentField::Force => return None,
        CurrentField::MuRoll(_) | CurrentField::MuSkid(_) | CurrentField::Drag => value.abs(),
        CurrentField::Inertia => value + file.mass_kg / 2.0,
        CurrentField::Height | CurrentField::Scale(_) => 0.0,
    };
    let is_friction = matches!(field, CurrentField::MuRoll(_) | CurrentField::MuSkid(_));
    let is_known = !(is_friction && found.force.source == ForceSource::Assumed);
    let determined = fit.determined(i) && is_known;
    let half = match relative_before(file, field).filter(|_| !fit.determined(i)) {
        Some(share) => NORMAL_975 * share * value,
        None => fit.half_width(i).hypot(found.force.relative_half() * by_force),
    };
    let [low, high] = parameter.bounds;
    Some(FittedParameter {
        name: parameter.name.clone(),
        value,
        unit: parameter.unit.into(),
        interval_95: Some([(value - half).max(low), (value + half).min(high)]),
        determined,
    })
}

/// Relative sigma that the file's `uncertainty` gives of the friction of ground that it knows.
fn relative_before(file: &Robot, field: &CurrentField) -> Option<f64> {
    match field {
        CurrentField::MuRoll(name) => file.surfaces.get(name).map(|_| file.uncertainty.mu_roll),
        CurrentField::MuSkid(name) => file.surfaces.get(name).map(|_| file.uncertainty.mu_skid),
        _ => None,
    }
}

/// What the robot file has no field for, of the reference surface: no prediction has it.
fn rest_of_the_model(reference: &CurrentFit) -> Vec<FittedParameter> {
    let fit = &reference.fit;
    let rest = (0..fit.values.len()).filter(|i| !IN_THE_FILE.contains(i));
    rest.map(|i| FittedParameter {
        name: format!("current_model.{}", fit.parameters[i].name),
        value: fit.values[i],
        unit: fit.parameters[i].unit.into(),
        interval_95: Some(fit.interval_95(i)),
        determined: fit.determined(i),
    })
    .collect()
}

/// Sentences about numbers that contradict what the robot's file said of them.
fn far_from_file(file: &Robot, found: &FittedFile) -> Vec<String> {
    let fit = &found.file.fit;
    let by_field = |i: usize| {
        let (parameter, field) = (&fit.parameters[i], &found.file.fields[i]);
        let share = relative_before(file, field).filter(|_| !parameter.held)?;
        let [mean, _] = parameter.prior?;
        far(&parameter.name, parameter.unit, fit.values[i], [mean, share * mean])
    };
    let force = file.motors.left.force_n_per_a.zip(force::known_share(file));
    let of_force = force.and_then(|(mean, share)| {
        far("motors.force_n_per_a", "N/A", found.force.n_per_a, [mean, share * mean])
    });
    of_force.into_iter().chain((0..fit.values.len()).filter_map(by_field)).collect()
}

fn stuck_notes(drives: &Drives) -> Vec<String> {
    let of = |(surface, name): (usize, &String)| {
        let here = drives.stretches.iter().filter(|stretch| stretch.surface == surface);
        let rows = here.flat_map(|stretch| &drives.rows[stretch.rows.clone()]);
        let [stuck, all] = rows.fold([0, 0], |[stuck, all], row| [stuck + usize::from(row.stuck), all + 1]);
        (stuck > 0).then(|| {
            format!(
                "{name}: {stuck} of {all} rows are not fitted, since the wheels turned against each other and the robot did not"
            )
        })
    };
    drives.surfaces.iter().enumerate().filter_map(of).collect()
}

/// Writes the largest relative sigma of each kind of friction.
fn write_uncertainty(robot: &mut Robot, parameters: &[FittedParameter]) {
    let largest = |ending: &str| {
        let of_kind = parameters.iter().filter(|p| p.name.ends_with(ending) && p.value > 0.0);
        let sigmas = of_kind.filter_map(|p| Some((p.interval_95?[1] - p.value) / NORMAL_975 / p.value));
        sigmas.fold(0.0, f64::max).min(1.0)
    };
    let (roll, skid) = (largest("mu_roll"), largest("mu_skid"));
    // Nothing is known exactly.
    if roll > 0.0 {
        robot.uncertainty.mu_roll = roll;
    }
    if skid > 0.0 {
        robot.uncertainty.mu_skid = skid;
    }
}
