//! Places opened into all headings that the robot can have there, so that legs through them join up.

use planner::{ExactField, Objective, Planner, State};
use rayon::prelude::*;

use crate::{
    error::Error,
    matrix::Question,
    waypoint::{Waypoint, states_of},
};

/// Least costs between the poses of several places, pose by pose.
///
/// A chain of legs drives through a place when one leg ends in the pose that the next begins in. Choosing one pose of every
/// place, the sum of its entries is what driving the chain takes: no turn at a place is left out, because turning on the
/// spot there is a motion like any other and counts in the entries.
#[derive(Clone, Debug, PartialEq)]
pub struct Joints {
    /// The poses: those of the first place first, each place's by heading. A place with a heading has one.
    pub poses: Vec<Joint>,
    /// Least of the objective, J, m or s, from the pose of the row to that of the column; `None` where no path leads.
    ///
    /// Costs are the planner's table's, at most 1/2048 above those of driving the path; without height, for energy.
    pub cost: Vec<Vec<Option<f64>>>,
}

/// A pose of a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Joint {
    /// Position of the place in the list.
    pub waypoint: usize,
    /// The pose itself: with its coordinates and heading a waypoint stands for this pose alone.
    pub pose: Waypoint,
}

/// Opens places into their poses and works out the least costs between all of them, by one exact field for each pose.
///
/// # Errors
/// A place off the map or where the robot cannot stand, by list (`waypoints`) and position, or patience that ended first.
pub fn joints(planner: &Planner, waypoints: &[Waypoint], question: &Question) -> Result<Joints, Error> {
    let places = states_of(planner, "waypoints", waypoints, question.snap_radius_m, &question.patience)?;
    let states: Vec<(usize, State)> = places
        .iter()
        .enumerate()
        .flat_map(|(i, states)| states.iter().map(move |state| (i, *state)))
        .collect();
    let columns: Vec<Vec<Option<f64>>> = states
        .par_iter()
        .map(|(_, goal)| column(planner, &states, *goal, question))
        .collect::<Result<_, _>>()?;
    let row = |from: usize| columns.iter().map(|column| column[from]).collect();
    let grid = &planner.lattice().terrain.grid;
    let joint = |&(waypoint, state): &(usize, State)| {
        let [x_m, y_m] = grid.center_m(state.cell);
        Joint { waypoint, pose: Waypoint { x_m, y_m, heading_rad: Some(state.heading.angle_rad()) } }
    };
    Ok(Joints { poses: states.iter().map(joint).collect(), cost: (0..states.len()).map(row).collect() })
}

/// Least costs from all poses to one.
fn column(
    planner: &Planner,
    states: &[(usize, State)],
    goal: State,
    question: &Question,
) -> Result<Vec<Option<f64>>, Error> {
    let table = planner.table(question.objective);
    let field = ExactField::to_goals(table, &[(goal, 0.0)], f64::INFINITY, &question.patience)
        .ok_or(planner::Error::Timeout { expanded: 0 })?;
    let potential_j = |state: State| match question.objective {
        Objective::Energy => planner.lattice().potential_j(state.cell),
        Objective::Distance | Objective::Time => 0.0,
    };
    let cost = |from: State| Some(field.cost(from)? + potential_j(goal) - potential_j(from));
    Ok(states.iter().map(|(_, from)| cost(*from)).collect())
}
