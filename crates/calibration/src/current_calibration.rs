//! A robot fitted to recordings of motor current.

use model::{Robot, robot::Surface};
use rayon::prelude::*;

use crate::{
    Drives, DrivesCoverage, Error,
    calibrate::{Calibration, FittedParameter, HeldOut, Options, held_note, with_slip_track},
    current::YawSource,
    current_fit::{CurrentFit, LIFTING, SCALE, fit_force_alone, fit_reference, fit_surface},
    current_judge::{SurfaceVerdict, judge},
    field::SCALE_SIGMA,
    fit::NORMAL_975,
    folds,
    score::median,
    slip_law::{TanhLaw, nearest_tanh},
};

/// The current model of a robot: one surface that what belongs to the robot was fitted on, and the others.
#[derive(Clone, Debug)]
pub struct CurrentCalibration {
    /// The robot that was fitted, with its measured slip track.
    pub robot: Robot,
    /// Name of the reference surface.
    pub reference: String,
    /// Fits of the halves of its runs.
    pub reference_halves: [CurrentFit; 2],
    /// Surface by surface, the reference first.
    pub surfaces: Vec<SurfaceFit>,
    /// Slip track, as fitted from wheels and gyroscope.
    pub slip_track: FittedParameter,
}

/// One surface.
#[derive(Clone, Debug)]
pub struct SurfaceFit {
    /// Its name.
    pub surface: String,
    /// The fit of all of its runs.
    pub fit: CurrentFit,
    /// Its slip law as a robot file has it.
    pub law: TanhLaw,
    /// The same with force per ampere left to this surface alone.
    pub force_alone: CurrentFit,
    /// How each half of the runs is judged by the other; `None` where there is one run.
    pub verdict: Option<SurfaceVerdict>,
}

/// Skid and rolling current, at the places of [`crate::current::CurrentParameters`].
const ROLLING: usize = 0;
const SKID: usize = 2;
const SHAPE: usize = 4;

/// Fits all surfaces.
///
/// # Errors
/// [`Error::NoReference`] where the surface asked for was not driven on, [`Error::TooFewRuns`] where it was driven on in one run,
/// [`Error::Stopped`] when the drives' watch breaks.
pub fn fit_currents(robot: &Robot, drives: &Drives, options: &Options) -> Result<CurrentCalibration, Error> {
    let driven: Vec<usize> =
        (0..drives.surfaces.len()).filter(|i| drives.averages.iter().any(|a| a.surface == *i)).collect();
    let reference = match &options.reference_surface {
        Some(name) => driven.iter().copied().find(|&i| drives.surfaces[i] == *name).ok_or_else(|| {
            let found = driven.iter().map(|&i| drives.surfaces[i].clone()).collect();
            Error::NoReference { surface: name.clone(), found }
        })?,
        None => best_reference(robot, drives, &driven)?,
    };
    let on_reference = drives.on_surface(reference)?;
    let runs = on_reference.judged_runs().len();
    if runs < 2 {
        return Err(Error::TooFewRuns { surface: drives.surfaces[reference].clone(), runs });
    }
    let (robot, slip_track) = with_slip_track(robot, &on_reference)?;
    let [first, second] = folds::halves(&on_reference)?;
    let fit = |drives: &Drives| fit_reference(&robot, drives);
    let (whole, (first, second)) =
        rayon::join(|| fit(&on_reference), || rayon::join(|| fit(&first), || fit(&second)));
    let (whole, reference_halves) = (whole?, [first?, second?]);
    let mut order = vec![reference];
    order.extend(driven.into_iter().filter(|&i| i != reference));
    let surfaces = order.into_par_iter().map(|i| {
        let here = drives.on_surface(i)?;
        let is_reference = i == reference;
        let fit =
            if is_reference { whole.clone() } else { fit_surface(&robot, &here, &whole, YawSource::Wheels)? };
        let judged = here.judged_runs().len() > 1;
        let judge = || judge(&robot, &here, &reference_halves, is_reference, YawSource::Wheels);
        let verdict = judged.then(judge).transpose()?.map(|(verdict, _)| verdict);
        let force_alone = fit_force_alone(&robot, &here, &whole)?;
        let p = &fit.parameters;
        drives.go_on()?;
        let law = nearest_tanh(&robot, &here, p.slip_angle_scale_rad, p.slip_shape);
        Ok(SurfaceFit { surface: drives.surfaces[i].clone(), fit, law, force_alone, verdict })
    });
    let surfaces = surfaces.collect::<Result<_, Error>>()?;
    Ok(CurrentCalibration {
        reference: drives.surfaces[reference].clone(),
        robot,
        reference_halves,
        surfaces,
        slip_track,
    })
}

/// The surface with two runs or more whose lifting current is known best, relative to its size.
fn best_reference(robot: &Robot, drives: &Drives, driven: &[usize]) -> Result<usize, Error> {
    let mut enough: Vec<usize> = Vec::new();
    for &surface in driven {
        enough.extend((drives.on_surface(surface)?.judged_runs().len() > 1).then_some(surface));
    }
    let candidates = if enough.is_empty() { driven } else { &enough };
    if let [only] = candidates {
        return Ok(*only);
    }
    let doubt = |i: usize| {
        let fit = fit_reference(robot, &drives.on_surface(i)?)?;
        Ok((i, fit.fit.sigma(LIFTING) / fit.parameters.lifting_a.max(f64::MIN_POSITIVE)))
    };
    let doubts = candidates.par_iter().map(|&i| doubt(i)).collect::<Result<Vec<_>, Error>>()?;
    Ok(doubts.into_iter().min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(i, _)| i))
}

/// Fits a robot to recordings of motor current.
pub(crate) fn calibrate(robot: &Robot, drives: &Drives, options: &Options) -> Result<Calibration, Error> {
    let found = fit_currents(robot, drives, options)?;
    let mut parameters = vec![found.slip_track.clone(), force_parameter(&found)];
    for surface in &found.surfaces {
        parameters.extend(friction_parameters(robot, &found, surface));
    }
    parameters.extend(rest_of_the_model(&found));
    let fitted = fitted_robot(robot, &found, &parameters);
    fitted.validate()?;
    let mut notes = notes(&found);
    notes.extend(held_note(&parameters));
    if robot.motors.left.force_n_per_a.is_none() && !parameters[1].determined {
        notes.push(FORCE_UNKNOWN.into());
    }
    Ok(Calibration {
        held_out: held_out(&found),
        notes,
        parameters,
        robot: fitted,
        coverage: DrivesCoverage::default(),
    })
}

const FORCE_UNKNOWN: &str = "force per ampere is assumed, not found, and all friction with it: drive slopes of known pitch, or give \
     force_n_per_a in motors.left and motors.right of the robot";

fn force_parameter(found: &CurrentCalibration) -> FittedParameter {
    let reference = &found.surfaces[0].fit;
    let [low, high] = reference.force_interval_n_per_a(&found.robot);
    FittedParameter {
        name: "motors.force_n_per_a".into(),
        value: reference.force_n_per_a(&found.robot),
        unit: "N/A".into(),
        interval_95: high.is_finite().then_some([low, high]),
        determined: reference.fit.determined(LIFTING),
    }
}

/// μ_R = i0/G, μ_S = S/G and the slip-angle scale of one surface by the tanh law nearest to its own, with the lifting current of
/// the reference.
///
/// What the recording does not determine keeps the value of the robot file, where that knows the ground.
fn friction_parameters(
    file: &Robot,
    found: &CurrentCalibration,
    surface: &SurfaceFit,
) -> [FittedParameter; 3] {
    let reference = &found.surfaces[0].fit;
    let lifting_a = reference.parameters.lifting_a;
    let lifting_share = reference.fit.sigma(LIFTING) / lifting_a;
    let fit = &surface.fit.fit;
    let known = file.surfaces.get(&surface.surface);
    let parameter =
        |field: &str, i: usize, [value, share]: [f64; 2], determined: bool, before: Option<[f64; 2]>| {
            let [value, share] = before.filter(|_| !determined).unwrap_or([value, share]);
            let half = if determined { fit.student[i] } else { NORMAL_975 } * share * value;
            FittedParameter {
                name: format!("surfaces.{}.{field}", surface.surface),
                value,
                unit: if i == SCALE { "rad" } else { "1" }.into(),
                interval_95: Some([(value - half).max(0.0), value + half]),
                determined,
            }
        };
    let share = |i: usize| fit.sigma(i) / fit.values[i].max(f64::MIN_POSITIVE);
    let force_known = reference.fit.determined(LIFTING) || file.motors.left.force_n_per_a.is_some();
    let friction = |field: &str, i: usize, before: Option<[f64; 2]>| {
        let height = if i == SKID { surface.law.share } else { 1.0 };
        let value = [height * fit.values[i] / lifting_a, share(i).hypot(lifting_share)];
        parameter(field, i, value, fit.determined(i) && force_known, before)
    };
    // Scale and shape move together: of their ratio, what they share cancels.
    let together = fit.covariance[(SCALE, SHAPE)] / (fit.values[SCALE] * fit.values[SHAPE]);
    let variance = share(SCALE).powi(2) + share(SHAPE).powi(2) - 2.0 * together;
    let scale = [surface.law.scale_rad, variance.max(0.0).sqrt()];
    let u = &file.uncertainty;
    let scale_before = known.map(|s| [s.slip_angle_scale_rad, SCALE_SIGMA]);
    [
        friction("mu_roll", ROLLING, known.map(|s| [s.mu_roll, u.mu_roll])),
        friction("mu_skid", SKID, known.map(|s| [s.mu_skid, u.mu_skid])),
        parameter("slip_angle_scale_rad", SCALE, scale, fit.determined(SCALE), scale_before),
    ]
}

/// What the robot file has no field for, of the reference surface.
fn rest_of_the_model(found: &CurrentCalibration) -> Vec<FittedParameter> {
    let fit = &found.surfaces[0].fit.fit;
    let in_the_file = [ROLLING, SKID, SCALE, LIFTING];
    let rest = (0..fit.values.len()).filter(|i| !in_the_file.contains(i));
    rest.map(|i| FittedParameter {
        name: format!("current_model.{}", fit.parameters[i].name),
        value: fit.values[i],
        unit: fit.parameters[i].unit.into(),
        interval_95: Some(fit.interval_95(i)),
        determined: fit.determined(i),
    })
    .collect()
}

fn fitted_robot(robot: &Robot, found: &CurrentCalibration, parameters: &[FittedParameter]) -> Robot {
    let mut fitted = Robot { slip_track_m: found.robot.slip_track_m, ..robot.clone() };
    let of = |name: &str| parameters.iter().find(|p| p.name == name);
    if let Some(force) = of("motors.force_n_per_a") {
        fitted.motors.left.force_n_per_a = Some(force.value);
        fitted.motors.right.force_n_per_a = Some(force.value);
    }
    if let Some(surface) = found.surfaces.first() {
        let idle_a = Some(surface.fit.idle_a).filter(|idle_a| *idle_a > 0.0);
        fitted.motors.left.idle_current_a = idle_a;
        fitted.motors.right.idle_current_a = idle_a;
    }
    let (mut roll_share, mut skid_share) = (0.0f64, 0.0f64);
    for surface in &found.surfaces {
        let field = |field: &str| of(&format!("surfaces.{}.{field}", surface.surface));
        let (Some(roll), Some(skid), Some(scale)) =
            (field("mu_roll"), field("mu_skid"), field("slip_angle_scale_rad"))
        else {
            continue;
        };
        roll_share = roll_share.max(relative_sigma(roll, surface.fit.fit.student[ROLLING]));
        skid_share = skid_share.max(relative_sigma(skid, surface.fit.fit.student[SKID]));
        let new = Surface {
            mu_roll: roll.value,
            mu_skid: skid.value,
            slip_angle_scale_rad: scale.value,
            dogru_marques: None,
            mechanisms: Vec::new(),
        };
        fitted.surfaces.insert(surface.surface.clone(), new);
    }
    fitted.uncertainty.mu_roll = roll_share.min(1.0);
    fitted.uncertainty.mu_skid = skid_share.min(1.0);
    fitted
}

fn relative_sigma(parameter: &FittedParameter, student: f64) -> f64 {
    let high = parameter.interval_95.map_or(parameter.value, |[_, high]| high);
    if parameter.value > 0.0 { (high - parameter.value) / student / parameter.value } else { 0.0 }
}

/// Surface by surface, and the mean over them weighted by runs.
fn held_out(found: &CurrentCalibration) -> Option<HeldOut> {
    let verdicts: Vec<SurfaceVerdict> = found.surfaces.iter().filter_map(|s| s.verdict.clone()).collect();
    if verdicts.is_empty() {
        return None;
    }
    let runs: f64 = verdicts.iter().map(|v| v.runs as f64).sum();
    let mean =
        |f: fn(&SurfaceVerdict) -> f64| verdicts.iter().map(|v| v.runs as f64 * f(v)).sum::<f64>() / runs;
    let errors: Vec<f64> =
        verdicts.iter().flat_map(|v| v.energy_error_percent.iter().map(|(_, e)| e.abs())).collect();
    Some(HeldOut {
        rmse_w: mean(|v| v.rmse_w.powi(2)).sqrt(),
        r2: mean(|v| v.r2),
        bias_w: None,
        median_energy_error_percent: median(&errors),
        rmse_a: Some(mean(|v| v.rmse_a.powi(2)).sqrt()),
        r2_a: Some(mean(|v| v.pooled_r2_a)),
        surfaces: verdicts,
    })
}

fn notes(found: &CurrentCalibration) -> Vec<String> {
    let mut notes = vec![
        format!(
            "what belongs to the robot was fitted on `{}`, which determines force per ampere best or was asked for",
            found.reference
        ),
        "mu_roll holds the no-load current of the motors, which currents alone cannot tell from rolling resistance".into(),
    ];
    for verdict in found.surfaces.iter().filter_map(|s| s.verdict.as_ref()) {
        if verdict.stuck_rows > 0 {
            notes.push(format!(
                "{}: {} of {} rows left out, since the wheels turned against each other and the robot did not",
                verdict.surface, verdict.stuck_rows, verdict.rows
            ));
        }
    }
    notes
}
