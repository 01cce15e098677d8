//! What is doubtful about a path because of the map it lies on and of the robot that takes it.

use model::{Robot, worth::remedy};
use planner::{Lattice, Patience, Planner, is_coarse, surface_names};
use terrain::{Terrain, Warning, WarningKind};

use super::{PlanAnswer, PlanRequest, PoseAnswer, stance};

/// Doubts about a planner's map that hold for every path over it.
pub(crate) fn map_warnings(planner: &Planner) -> Vec<Warning> {
    let lattice = planner.lattice();
    let coarse = coarse_cells(lattice);
    lattice.terrain.warnings().iter().cloned().chain(coarse).collect()
}

impl PlanAnswer {
    /// The answer with its place on earth and doubts about the map and about this path over it.
    pub(crate) fn warned(self, planner: &Planner, request: &PlanRequest, patience: &Patience) -> Self {
        let lattice = planner.lattice();
        let mut answer = self.placed(&lattice.terrain);
        answer.warnings = map_warnings(planner);
        let own = [
            moved_ends(&answer, request, lattice.terrain.grid.cell_size_m),
            one_coarse_cell(&answer, lattice),
            filled_ground(&lattice.terrain, &answer.poses),
            stops(&answer, request),
            borrowed_constants(lattice),
        ];
        answer.warnings.extend(own.into_iter().flatten());
        answer.warnings.extend(stance::between_poses(&answer, lattice, patience));
        answer
    }
}

fn coarse_cells(lattice: &Lattice) -> Option<Warning> {
    is_coarse(lattice).then(|| {
        let (cell_size_m, wheelbase_m) = (lattice.terrain.grid.cell_size_m, lattice.robot.wheelbase_m);
        let detail = format!(
            "cells of {cell_size_m} m are far coarser than the robot, whose wheelbase is {wheelbase_m} m: the energy misses all ups, downs and turns within a cell, which only the upper end of the interval of a plan or comparison and the draws of a range or mission allow for, by how much the slopes of neighbouring cells differ; use a finer map"
        );
        Warning::new(WarningKind::CoarseCells, detail)
    })
}

/// A warning where a path begins and ends in one cell far larger than the robot, of which the map knows a single slope.
fn one_coarse_cell(answer: &PlanAnswer, lattice: &Lattice) -> Option<Warning> {
    let grid = &lattice.terrain.grid;
    let (cell_size_m, first, last) = (grid.cell_size_m, answer.poses.first()?, answer.poses.last()?);
    let cell = |pose: &PoseAnswer| grid.cell_at(pose.x_m, pose.y_m);
    let apart_m = (last.x_m - first.x_m).hypot(last.y_m - first.y_m);
    let is_one = cell(first) == cell(last) && apart_m > 0.0;
    (is_one && is_coarse(lattice)).then(|| {
        let detail = format!(
            "both ends lie in one cell of {cell_size_m} m: of the {apart_m:.1} m between them the map knows a single slope; use a map of finer cells"
        );
        Warning::new(WarningKind::MovedEnds, detail)
    })
}

/// A warning where the moves of the ends, at the path's energy per metre, come to more than the uncertainty that is stated.
fn moved_ends(answer: &PlanAnswer, request: &PlanRequest, cell_size_m: f64) -> Option<Warning> {
    let (start_m, goal_m) = (answer.snapped.start.distance_m, answer.snapped.goal.distance_m);
    let apart_m = (request.goal.x_m - request.start.x_m).hypot(request.goal.y_m - request.start.y_m);
    let moves =
        format!("the start was moved by {start_m:.1} m and the goal by {goal_m:.1} m to centres of cells");
    if answer.distance_m == 0.0 {
        let is_asked = apart_m > request.goal.tolerance_m;
        return is_asked.then(|| {
            let detail = format!(
                "{moves}, and both came to lie in one cell of {cell_size_m} m: the {apart_m:.1} m between them are in no figure of the answer; use a map of finer cells"
            );
            Warning::new(WarningKind::MovedEnds, detail)
        });
    }
    let [low_j, high_j] = answer.energy_interval_j;
    let missed_j = (start_m + goal_m) * answer.energy_j.abs() / answer.distance_m;
    (missed_j > (high_j - low_j) / 2.0).then(|| {
        let detail =
            format!("{moves}, which matters more to the energy than the uncertainty that is stated of it");
        Warning::new(WarningKind::MovedEnds, detail)
    })
}

/// A warning where the stops on the way, which the energy leaves out, take more than the uncertainty that is stated of it.
fn stops(answer: &PlanAnswer, request: &PlanRequest) -> Option<Warning> {
    let [low_j, high_j] = answer.energy_interval_j;
    (answer.stops_j > (high_j - low_j) / 2.0).then(|| {
        let (stops_j, count) = (answer.stops_j, answer.stops);
        let cure = match request.prices.is_some_and(|prices| prices.stops) {
            true => "add stops_j to it",
            false => "add stops_j to it, and weigh stops with prices.stops",
        };
        let detail = format!(
            "{count} stops and changes of speed on the way take some {stops_j:.0} J, which energy_j leaves out: {cure}"
        );
        Warning::new(WarningKind::Stops, detail)
    })
}

/// A warning where the robot has constants of other robots, with the drive that would tell the one that matters most.
pub(crate) fn borrowed_constants(lattice: &Lattice) -> Option<Warning> {
    let robot = on_its_ground(lattice);
    let (worst, borrowed) = (robot.worst_borrowed()?, robot.borrowed());
    let detail = format!(
        "{} of `{}` {} borrowed from other robots or assumed; most would be gained by {worst}: `joulepath calibrate` with {}",
        borrowed.join(", "),
        robot.name,
        if borrowed.len() == 1 { "is" } else { "are" },
        remedy(worst)
    );
    Some(Warning::new(WarningKind::BorrowedConstants, detail))
}

/// The robot without what its file says of grounds that the map does not have.
fn on_its_ground(lattice: &Lattice) -> Robot {
    let grounds = surface_names(lattice);
    let mut robot = lattice.robot.clone();
    robot.provenance.retain(|field, _| {
        let of_ground = field.strip_prefix("surfaces.").and_then(|rest| rest.rsplit_once('.'));
        of_ground.is_none_or(|(ground, _)| grounds.iter().any(|name| name == ground))
    });
    robot
}

/// A warning where the path leads over ground that was filled in, with how much of it.
fn filled_ground(terrain: &Terrain, poses: &[PoseAnswer]) -> Option<Warning> {
    let filled = terrain.filled()?;
    let is_filled = |pose: &PoseAnswer| {
        let cell = terrain.grid.cell_at(pose.x_m, pose.y_m);
        cell.and_then(|cell| filled.get(terrain.grid.index(cell))).is_some_and(|filled| *filled)
    };
    let over_m: f64 = poses
        .array_windows()
        .filter(|[from, to]| is_filled(from) || is_filled(to))
        .map(|[from, to]| to.distance_m - from.distance_m)
        .sum();
    (over_m > 0.0).then(|| {
        let detail = format!("{over_m:.1} m of the path lead over ground that was filled in, not measured");
        Warning::new(WarningKind::FilledGround, detail)
    })
}
