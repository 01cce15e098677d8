//! The paper's own procedure: steady stretches, eq. 6 solved for friction, eq. 16 fitted speed by speed.
//!
//! Dogru & Marques (2018), §V. It stands beside [`crate::calibrate()`] so that both can be compared on the same files.

use model::{
    Attitude, Motion, PowerModel, Robot, Sides,
    fit::{FrictionSample, rolling_and_skid},
    inversion::{SideOnSlope, SlopeSign},
    paper::{Region, region},
    robot::{PaperSurface, SpeedFriction, Surface},
};
use recording::{PowerForm, Recording, Watch};

use crate::{
    Calibration, Drives, DrivesCoverage, Error, FittedParameter, HeldOut, folds, held_out,
    score::{Score, median},
};

/// A stretch is steady while its rim speeds change by less than this from second to second \[m/s\]: six encoder steps of a Husky,
/// whose speeds dither by two or three.
const STEADY_MPS: f64 = 0.05;
/// Speeds this close are one speed \[m/s\], the grid of the paper's experiments.
const SPEED_STEP_MPS: f64 = 0.1;
/// R0 that stands for straight driving in eq. 16 \[m\].
const STRAIGHT_RADIUS_M: f64 = 1e9;

/// One steady stretch.
#[derive(Clone, Debug)]
struct Steady {
    run: usize,
    surface: usize,
    motion: Motion,
    attitude: Attitude,
    motor_c: Sides<f64>,
    recorded_w: Sides<f64>,
    duration_s: f64,
}

/// Fits friction by the paper's procedure. Motor constants are the robot file's, or those of a lifting test.
///
/// # Errors
/// [`Error::Needs`] where power was not recorded side by side or no stretch was steady; [`Error::Robot`] where a surface was driven at
/// one radius only;
/// [`Error::Stopped`] soon after the watch breaks.
pub fn calibrate(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Calibration, Error> {
    const METHOD: &str = "the method dogru-marques";
    let recording = &*recording.thinned_watched(watch)?;
    let drives = Drives::watched(robot, recording, watch)?;
    if drives.form != Some(PowerForm::Sides) {
        return Err(Error::Needs { method: METHOD, needs: "power_left_w and power_right_w" });
    }
    let (robot, slip_track) = crate::calibrate::with_slip_track(robot, &drives)?;
    drives.go_on()?;
    let steady = steady(&robot, &drives);
    drives.go_on()?;
    if steady.is_empty() {
        return Err(Error::Needs { method: METHOD, needs: "seconds of driving at constant wheel speeds" });
    }
    let (fitted, mut parameters) = fit(&robot, &drives, &steady)?;
    parameters.insert(0, slip_track);
    let halves = folds::halves(&drives)?.map(|half| half.judged_runs());
    let held_out = by_the_printed_form(&robot, &drives, &steady, &halves);
    drives.go_on()?;
    let notes = vec![format!(
        "{} steady seconds; errors are those of the paper's printed form on them",
        steady.len()
    )];
    let coverage = DrivesCoverage::default();
    let as_written = Some(held_out::as_written(&fitted, recording, watch)?);
    Ok(Calibration { parameters, held_out, as_written, notes, robot: fitted, coverage }
        .covering(recording, &drives))
}

/// Seconds whose neighbours have the same rim speeds.
fn steady(robot: &Robot, drives: &Drives) -> Vec<Steady> {
    let mean = |f: &(dyn Fn(usize) -> f64 + Sync)| drives.averaged_by(f);
    let rows = &drives.rows;
    let (left, right) = (mean(&|i| rows[i].rim_mps.left), mean(&|i| rows[i].rim_mps.right));
    let (pitch, roll) = (mean(&|i| rows[i].pitch_rad), mean(&|i| rows[i].roll_rad));
    let (warm_left, warm_right) = (mean(&|i| rows[i].motor_c.left), mean(&|i| rows[i].motor_c.right));
    let power = [0, 1].map(|side| drives.averaged(&drives.recorded[side]));
    let alike = |a: usize, b: usize| {
        drives.averages[a].run == drives.averages[b].run
            && (left[a] - left[b]).abs() < STEADY_MPS
            && (right[a] - right[b]).abs() < STEADY_MPS
    };
    let is_steady = |i: &usize| {
        *i > 0
            && *i + 1 < drives.averages.len()
            && alike(*i - 1, *i)
            && alike(*i, *i + 1)
            && left[*i].abs().max(right[*i].abs()) > STEADY_MPS
    };
    (0..drives.averages.len())
        .filter(is_steady)
        .map(|i| Steady {
            run: drives.averages[i].run,
            surface: drives.averages[i].surface,
            motion: Motion::of_wheels(robot, Sides { left: left[i], right: right[i] }),
            attitude: Attitude { pitch_rad: pitch[i], roll_rad: roll[i] },
            motor_c: Sides { left: warm_left[i], right: warm_right[i] },
            recorded_w: Sides { left: power[0][i], right: power[1][i] },
            duration_s: drives.averages[i].duration_s,
        })
        .collect()
}

/// What one steady second says of friction: a row for eq. 16, and the friction of the inner side where it is that of R ≤ R_c.
fn friction(robot: &Robot, steady: &Steady) -> Option<(FrictionSample, Option<f64>)> {
    let of = |left: bool| {
        let (motor, temperature_c, rim_mps, power_w) = if left {
            let m = &steady.motion.rim_speeds_mps;
            (robot.motors.left, steady.motor_c.left, m.left, steady.recorded_w.left)
        } else {
            let m = &steady.motion.rim_speeds_mps;
            (robot.motors.right, steady.motor_c.right, m.right, steady.recorded_w.right)
        };
        let side = SideOnSlope {
            motor: motor.at_temperature(&robot.motors, temperature_c),
            mass_kg: robot.mass_kg,
            inclination_rad: steady.attitude.weight_normal().clamp(-1.0, 1.0).acos(),
            // Gravity is taken off below, where it is known which side carries it.
            heading_from_contour_rad: 0.0,
            rim_speed_mps: rim_mps.abs(),
        };
        // A power that no friction explains is a transient or a mistake of the sensor.
        side.friction_from_power(power_w, SlopeSign::Plus).ok().map(|roots| roots.friction)
    };
    let rims = steady.motion.rim_speeds_mps;
    let left_is_outer = rims.left.abs() > rims.right.abs();
    let slope =
        steady.attitude.weight_along() / steady.attitude.weight_normal() * steady.motion.speed_mps.signum();
    let com_m = robot.center_of_mass.left_m;
    let outward_m = if left_is_outer { com_m } else { -com_m };
    let (outer, inner) = (of(left_is_outer)?, of(!left_is_outer));
    let radius_m = steady.motion.turning_radius_m().abs();
    Some(match region(robot, &steady.motion) {
        Region::Straight => {
            let friction = outer + inner? - slope;
            (FrictionSample { radius_m: STRAIGHT_RADIUS_M, outward_m: 0.0, friction }, None)
        }
        Region::OuterDrags => (FrictionSample { radius_m, outward_m, friction: outer - slope }, None),
        Region::OppositeSides => (FrictionSample { radius_m, outward_m, friction: outer }, inner),
    })
}

fn fit(robot: &Robot, drives: &Drives, steady: &[Steady]) -> Result<(Robot, Vec<FittedParameter>), Error> {
    let mut fitted = robot.clone();
    let mut parameters = Vec::new();
    for (index, name) in drives.surfaces.iter().enumerate() {
        let here: Vec<_> = steady.iter().filter(|s| s.surface == index).collect();
        let found: Vec<_> =
            here.iter().filter_map(|s| Some((s.motion.speed_mps.abs(), friction(robot, s)?))).collect();
        if found.is_empty() {
            continue;
        }
        let samples: Vec<FrictionSample> = found.iter().map(|(_, (sample, _))| *sample).collect();
        let (mu_roll, mu_skid) = rolling_and_skid(robot, &samples)?;
        let inner: Vec<f64> = found.iter().filter_map(|(_, (_, inner))| *inner).collect();
        let inner_friction = (!inner.is_empty()).then(|| median(&inner).max(0.0));
        let by_speed = by_speed(robot, &found);
        let mut add = |field: &str, value: f64| {
            let name = format!("surfaces.{name}.{field}");
            parameters.push(FittedParameter {
                name,
                value,
                unit: "1".into(),
                interval_95: None,
                determined: true,
            });
        };
        add("mu_roll", mu_roll);
        add("mu_skid", mu_skid);
        for (i, row) in by_speed.iter().enumerate() {
            add(&format!("dogru_marques.by_speed[{i}].mu_roll"), row.mu_roll);
            add(&format!("dogru_marques.by_speed[{i}].mu_skid"), row.mu_skid);
        }
        if let Some(inner) = inner_friction {
            add("dogru_marques.inner_friction", inner);
        }
        let surface = Surface {
            mu_roll: mu_roll.max(0.0),
            mu_skid: mu_skid.max(0.0),
            // The paper's skid is Coulomb's.
            slip_angle_scale_rad: 0.0,
            dogru_marques: Some(PaperSurface { inner_friction, by_speed }),
            mechanisms: Vec::new(),
        };
        fitted.surfaces.insert(name.clone(), surface);
    }
    fitted.validate()?;
    Ok((fitted, parameters))
}

/// Eq. 16 fitted at each speed at which radii differ enough.
fn by_speed(robot: &Robot, found: &[(f64, (FrictionSample, Option<f64>))]) -> Vec<SpeedFriction> {
    let step = |speed_mps: f64| (speed_mps / SPEED_STEP_MPS).round() as i64;
    let mut steps: Vec<i64> = found.iter().map(|(speed_mps, _)| step(*speed_mps)).collect();
    steps.sort_unstable();
    steps.dedup();
    let row = |at: i64| {
        let samples: Vec<FrictionSample> = found
            .iter()
            .filter(|(speed_mps, _)| step(*speed_mps) == at)
            .map(|(_, (sample, _))| *sample)
            .collect();
        let (mu_roll, mu_skid) = rolling_and_skid(robot, &samples).ok()?;
        let possible = (-1.0..=2.0).contains(&mu_roll) && (0.0..=3.0).contains(&mu_skid);
        possible.then_some(SpeedFriction { speed_mps: at as f64 * SPEED_STEP_MPS, mu_roll, mu_skid })
    };
    steps.into_iter().filter_map(row).collect()
}

/// Each half of the runs judged by the printed form with the other half's coefficients.
fn by_the_printed_form(
    robot: &Robot,
    drives: &Drives,
    steady: &[Steady],
    halves: &[Vec<usize>; 2],
) -> Option<HeldOut> {
    let (mut predicted_w, mut recorded_w, mut energies) = (Vec::new(), Vec::new(), Vec::new());
    for i in 0..2 {
        let part =
            |runs: &[usize]| steady.iter().filter(|s| runs.contains(&s.run)).cloned().collect::<Vec<_>>();
        let (fitted, _) = fit(robot, drives, &part(&halves[i])).ok()?;
        for run in &halves[1 - i] {
            // The caller asks again and says so.
            drives.go_on().ok()?;
            let (mut predicted_j, mut recorded_j) = (0.0, 0.0);
            for s in part(&[*run]) {
                let surface = fitted.surfaces.get(&drives.surfaces[s.surface])?;
                let power =
                    model::power(PowerModel::DogruMarques, &fitted, surface, s.motion, s.attitude, s.motor_c);
                predicted_w.push(power.side_w.sum());
                recorded_w.push(s.recorded_w.sum());
                predicted_j += power.side_w.sum() * s.duration_s;
                recorded_j += s.recorded_w.sum() * s.duration_s;
            }
            if recorded_j > 0.0 {
                energies.push(100.0 * (predicted_j / recorded_j - 1.0).abs());
            }
        }
    }
    let score = Score::of(&predicted_w, &recorded_w);
    (score.count > 0).then(|| HeldOut {
        rmse_w: score.rmse,
        r2: score.r2,
        bias_w: Some(score.bias),
        median_energy_error_percent: median(&energies),
        ..HeldOut::default()
    })
}
