//! How well the current model holds on runs that it was not fitted to.

use model::{Robot, WarmMotor};
use serde::Serialize;

use crate::{
    Drives, Error,
    current::YawSource,
    current_fit::{CurrentFit, fit_surface},
    folds,
    score::{Score, median},
};

/// One surface, each half of its runs judged by the fit of the other.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct SurfaceVerdict {
    /// The surface.
    pub surface: String,
    /// Runs judged.
    pub runs: usize,
    /// Rows, and those of them in which the wheels turned against each other and the robot did not: these are neither fitted nor judged.
    pub rows: usize,
    /// Stuck rows.
    pub stuck_rows: usize,
    /// R² of side current, fitted on the first, third, … run and judged on the others, and the other way round.
    pub r2_a: [f64; 2],
    /// R² over both together.
    pub pooled_r2_a: f64,
    /// Root mean square error of side current over both \[A\].
    pub rmse_a: f64,
    /// R² of the power that eq. 2 makes of the currents, over both.
    pub r2: f64,
    /// Root mean square error of that power, both sides together \[W\].
    pub rmse_w: f64,
    /// Normalised error of that power, eq. 17 of Dogru & Marques (2018) as in their Table IV \[%\].
    pub normalized_error_percent: f64,
    /// Energy error by run: 100 (predicted − recorded) / recorded \[%\].
    pub energy_error_percent: Vec<(String, f64)>,
    /// Median of their magnitudes \[%\].
    pub median_energy_error_percent: f64,
}

/// What a fit of one half says of the other.
#[derive(Default)]
struct Judged {
    predicted_a: Vec<f64>,
    recorded_a: Vec<f64>,
    predicted_w: Vec<f64>,
    recorded_w: Vec<f64>,
    energies: Vec<(String, f64)>,
}

/// Fits each half of the runs on one surface and judges the other half by it.
///
/// The references are fits of the reference surface's own halves: the half that is fitted leans on the reference's half of the same
/// parity. On the reference surface itself, they are the fits.
///
/// # Errors
/// [`Error::Stopped`] when the drives' watch breaks.
pub fn judge(
    robot: &Robot,
    drives: &Drives,
    references: &[CurrentFit; 2],
    on_reference: bool,
    yaw: YawSource,
) -> Result<(SurfaceVerdict, [CurrentFit; 2]), Error> {
    let halves = folds::halves(drives)?;
    let fit = |i: usize| {
        if on_reference {
            Ok(references[i].clone())
        } else {
            fit_surface(robot, &halves[i], &references[i], yaw)
        }
    };
    let fits = [fit(0)?, fit(1)?];
    let judge = |i: usize| Judged::of(robot, &halves[1 - i], &fits[i], references[i].force_n_per_a(robot));
    let judged = [judge(0)?, judge(1)?];
    Ok((verdict(drives, &judged), fits))
}

fn verdict(drives: &Drives, judged: &[Judged; 2]) -> SurfaceVerdict {
    let both = |f: fn(&Judged) -> &Vec<f64>| [f(&judged[0]).as_slice(), f(&judged[1]).as_slice()].concat();
    let pooled = Score::of(&both(|j| &j.predicted_a), &both(|j| &j.recorded_a));
    let watts = Score::of(&both(|j| &j.predicted_w), &both(|j| &j.recorded_w));
    let mut energies: Vec<(String, f64)> = judged.iter().flat_map(|j| j.energies.clone()).collect();
    energies.sort_by(|a, b| a.0.cmp(&b.0));
    let magnitudes: Vec<f64> = energies.iter().map(|(_, e)| e.abs()).collect();
    let surface = drives.stretches.first().map(|s| drives.surfaces[s.surface].clone()).unwrap_or_default();
    SurfaceVerdict {
        surface,
        runs: energies.len(),
        rows: drives.rows.len(),
        stuck_rows: drives.rows.iter().filter(|row| row.stuck).count(),
        r2_a: judged.each_ref().map(|j| Score::of(&j.predicted_a, &j.recorded_a).r2),
        pooled_r2_a: pooled.r2,
        rmse_a: pooled.rmse,
        r2: watts.r2,
        rmse_w: watts.rmse,
        normalized_error_percent: watts.normalized_error_percent,
        energy_error_percent: energies,
        median_energy_error_percent: median(&magnitudes),
    }
}

impl Judged {
    fn of(robot: &Robot, drives: &Drives, fit: &CurrentFit, force_n_per_a: f64) -> Result<Judged, Error> {
        let (predicted_a, recorded_a) = (fit.predict_a(robot, drives)?, drives.recorded_averages());
        drives.go_on()?;
        let left = drives.averaged_by(|row| drives.rows[row].rim_mps.left.abs());
        let right = drives.averaged_by(|row| drives.rows[row].rim_mps.right.abs());
        let count = drives.averages.len();
        let watts = |amperes: &[f64]| -> Vec<f64> {
            let motors = [robot.motors.left, robot.motors.right]
                .map(|m| WarmMotor { k1_w_per_n2: m.k1_w_per_n2, k2: m.k2 });
            let side = |i: usize, side: usize, rim_mps: f64| {
                motors[side].printed_power_w(force_n_per_a * amperes[side * count + i], rim_mps)
            };
            (0..count).map(|i| side(i, 0, left[i]) + side(i, 1, right[i])).collect()
        };
        let (predicted_w, recorded_w) = (watts(&predicted_a), watts(&recorded_a));
        let energy_error = |run: &usize| {
            (drives.runs[*run].clone(), drives.energy_error_percent(*run, &predicted_w, &recorded_w))
        };
        let energies = drives.judged_runs().iter().map(energy_error).collect();
        Ok(Judged { predicted_a, recorded_a, predicted_w, recorded_w, energies })
    }
}
