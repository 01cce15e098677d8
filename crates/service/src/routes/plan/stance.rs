//! Doubts about how the robot stands between the poses of a path.

use planner::{Lattice, Most, Patience, Stances, stances};
use terrain::{Warning, WarningKind};

use super::{PlanAnswer, PoseAnswer};

/// Limits are given to a degree [rad], and heights of maps to a centimetre [m].
const DEGREE_RAD: f64 = std::f64::consts::PI / 180.0;
const CENTIMETRE_M: f64 = 0.01;

/// A warning where the path, or the refined one, leads over ground beyond the robot's limits.
pub(crate) fn between_poses(answer: &PlanAnswer, lattice: &Lattice, patience: &Patience) -> Option<Warning> {
    let refined = answer.refined.as_ref().map(|refined| ("the refined path", refined.poses.as_slice()));
    let paths = [Some(("the path", answer.poses.as_slice())), refined];
    // The refined path is the one that is driven.
    paths.into_iter().flatten().rev().find_map(|(which, poses)| {
        let poses: Vec<[f64; 3]> = poses.iter().map(pose).collect();
        match stances(lattice, &poses, patience) {
            Some(stances) => beyond_limits(lattice, which, &stances),
            None => Some(Warning::new(
                WarningKind::BeyondLimits,
                format!("whether {which} keeps the robot's limits between its poses was not looked at: the time was over; give more time"),
            )),
        }
    })
}

fn pose(pose: &PoseAnswer) -> [f64; 3] {
    [pose.x_m, pose.y_m, pose.heading_rad]
}

fn beyond_limits(lattice: &Lattice, which: &str, stances: &Stances) -> Option<Warning> {
    let limits = &lattice.robot.limits;
    let angle = |name: &str, most: Most, limit_rad: f64| {
        (most.value > limit_rad + DEGREE_RAD).then(|| {
            format!("a {name} of {:.2} rad at {}, where {limit_rad:.2} is allowed", most.value, place(most))
        })
    };
    let above = (stances.above_m.value > stances.allowed_above_m + CENTIMETRE_M).then(|| {
        format!(
            "ground {:.2} m above the plane of the wheels at {}, where {:.2} is allowed",
            stances.above_m.value,
            place(stances.above_m),
            stances.allowed_above_m
        )
    });
    let all = [
        angle("pitch", stances.pitch_rad, limits.max_pitch_rad),
        angle("roll", stances.roll_rad, limits.max_roll_rad),
        above,
    ];
    let all: Vec<String> = all.into_iter().flatten().collect();
    let cell_size_m = lattice.terrain.grid.cell_size_m;
    (!all.is_empty()).then(|| {
        let detail = format!(
            "between its poses {which} comes to {}: limits are kept at the centres of cells, {cell_size_m} m apart; use a map of finer cells, or lower limits",
            all.join(" and ")
        );
        Warning::new(WarningKind::BeyondLimits, detail)
    })
}

/// East and north.
fn place(most: Most) -> String {
    format!("x {:.1}, y {:.1} m", most.at_m[0], most.at_m[1])
}
