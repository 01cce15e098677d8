//! Questions that are asked once.

use model::Robot;
use terrain::Terrain;

use crate::{
    error::Error,
    lattice::objective::Objective,
    question::{
        ends::check,
        planner::Planner,
        query::{Comparison, Plan, Query},
    },
};

/// Finds a path that has least of an objective, or as little as the query's bound asks for.
///
/// # Errors
/// Ends off the map or where the robot cannot stand, no path, patience that ended before there was one, or a robot and map
/// that do not fit.
pub fn plan(terrain: &Terrain, robot: &Robot, query: &Query, objective: Objective) -> Result<Plan, Error> {
    check(query)?;
    Planner::prepare(terrain, robot, query.settings, &query.patience)?.plan(query, objective)
}

/// Finds the energy-minimal, shortest and fastest paths.
///
/// # Errors
/// As [`plan`].
pub fn compare(terrain: &Terrain, robot: &Robot, query: &Query) -> Result<Comparison, Error> {
    check(query)?;
    Planner::prepare(terrain, robot, query.settings, &query.patience)?.compare(query)
}
