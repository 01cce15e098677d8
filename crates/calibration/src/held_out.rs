//! How well the robot files that a calibration writes predict drives, by the code of the command `predict`.
//!
//! Each half of the runs is fitted alone, as if the other half did not exist, and the robot that would be written predicts the other
//! half. No figure here is that of a model which the robot file cannot hold.

use std::collections::BTreeMap;

use model::Robot;
use recording::{Recording, Watch};
use serde::Serialize;

use crate::{
    Drives, Error,
    field::with_new_ground,
    predict::{Judged, JudgedDrives, judge_drives},
    score::median,
};

/// Root mean square errors and shares of variance of a robot file on drives, as `predict` tells them.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Skill {
    /// Rows compared.
    pub rows: usize,
    /// Root mean square error of power by row \[W\].
    pub rmse_w: f64,
    /// R² of power by row; `null` where the recorded power is constant.
    pub r2: Option<f64>,
    /// Root mean square error of one-second averages of power \[W\].
    pub second_rmse_w: f64,
    /// R² of the same.
    pub second_r2: Option<f64>,
    /// Mean of predicted less recorded power by row \[W\].
    pub bias_w: f64,
    /// Root mean square error of one-second averages of side current, where motor currents were recorded \[A\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rmse_a: Option<f64>,
    /// R² of the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub r2_a: Option<f64>,
}

/// The robot of one half of the runs, judged on the other half.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Fold {
    /// Runs that were fitted.
    pub fitted_runs: Vec<String>,
    /// Runs that the robot file of these predicts.
    pub judged_runs: Vec<String>,
    /// How well.
    #[serde(flatten)]
    pub skill: Skill,
}

/// One surface, over all runs, each judged by the fit of the half that it is not in.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct SurfaceSkill {
    /// The surface.
    pub surface: String,
    /// How well.
    #[serde(flatten)]
    pub skill: Skill,
}

/// How well the robot file holds on runs that it was not fitted to.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct HeldOut {
    /// Root mean square error of power by row \[W\].
    pub rmse_w: f64,
    /// R² of the same; NaN, `null` in JSON, where the recorded power is constant.
    pub r2: f64,
    /// Root mean square error of one-second averages of power \[W\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second_rmse_w: Option<f64>,
    /// R² of the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub second_r2: Option<f64>,
    /// Mean of predicted less recorded \[W\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub bias_w: Option<f64>,
    /// Median magnitude of the energy error by run \[%\].
    pub median_energy_error_percent: f64,
    /// Root mean square error of one-second averages of side current, where currents were recorded \[A\].
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rmse_a: Option<f64>,
    /// R² of the same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub r2_a: Option<f64>,
    /// Surface by surface, where there are several.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub surfaces: Vec<SurfaceSkill>,
    /// Half by half.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub folds: Vec<Fold>,
}

impl HeldOut {
    /// R² of what was recorded: of side current where that was, else of power. The power that eq. 2 makes of currents leans on the sign that
    /// the prediction gives them.
    pub fn recorded_r2(&self) -> f64 {
        self.r2_a.unwrap_or(self.r2)
    }
}

/// Fits each half of the runs and predicts the other by the robot that is found; `None` of fewer than two runs.
///
/// # Errors
/// Those of the fit, and [`Error::Stopped`] soon after the watch breaks.
pub(crate) fn held_out(
    known: &Robot,
    recording: &Recording,
    drives: &Drives,
    fit: &dyn Fn(&Recording) -> Result<Robot, Error>,
    watch: &Watch,
) -> Result<Option<HeldOut>, Error> {
    let names: Vec<String> = drives.judged_runs().into_iter().map(|run| drives.runs[run].clone()).collect();
    if names.len() < 2 {
        return Ok(None);
    }
    // First, third, … and second, fourth, … by name.
    let half = |parity: usize| names.iter().skip(parity).step_by(2).cloned().collect::<Vec<String>>();
    let halves = [half(0), half(1)];
    let of_half = |i: usize| recording.of_runs(|run| halves[i].contains(&run.name));
    let (mut folds, mut all, mut energies) = (Vec::new(), Judged::default(), Vec::new());
    let mut by_surface: BTreeMap<String, Judged> = BTreeMap::new();
    for i in 0..2 {
        let fitted = match fit(&of_half(i)) {
            // Half of little may be nothing that can be fitted: then there is no judge.
            Err(Error::NothingToFit { .. }) => return Ok(None),
            fitted => fitted?,
        };
        let judging = judging(known, fitted, drives);
        let JudgedDrives { judged, surfaces } = judge_drives(&judging, &of_half(1 - i), watch)?;
        let together = judged.iter().fold(Judged::default(), Judged::join);
        energies.extend(judged.iter().filter_map(Judged::energy_error_percent));
        folds.push(Fold {
            fitted_runs: halves[i].clone(),
            judged_runs: halves[1 - i].clone(),
            skill: together.skill(),
        });
        all = all.join(&together);
        for (surface, judged) in surfaces {
            let sum = by_surface.entry(surface).or_default();
            *sum = sum.join(&judged);
        }
    }
    let several = by_surface.len() > 1;
    let surfaces = by_surface.into_iter().filter(|_| several);
    let skill = all.skill();
    Ok(Some(HeldOut {
        rmse_w: skill.rmse_w,
        r2: skill.r2.unwrap_or(f64::NAN),
        second_rmse_w: Some(skill.second_rmse_w),
        second_r2: skill.second_r2,
        bias_w: Some(skill.bias_w),
        median_energy_error_percent: median(&energies),
        rmse_a: skill.rmse_a,
        r2_a: skill.r2_a,
        surfaces: surfaces.map(|(surface, judged)| SurfaceSkill { surface, skill: judged.skill() }).collect(),
        folds,
    }))
}

/// How well a robot file predicts the drives that it was fitted to.
///
/// # Errors
/// As [`crate::predict_watched()`].
pub(crate) fn as_written(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Skill, Error> {
    let JudgedDrives { judged, .. } = judge_drives(robot, recording, watch)?;
    Ok(judged.iter().fold(Judged::default(), Judged::join).skill())
}

/// A fitted robot that knows all ground of the drives: what its half did not drive on is judged by the robot file, or by what is assumed of
/// new ground.
fn judging(known: &Robot, fitted: Robot, drives: &Drives) -> Robot {
    let mut judging = fitted;
    for (name, surface) in with_new_ground(known, drives).surfaces {
        judging.surfaces.entry(name).or_insert(surface);
    }
    judging
}
