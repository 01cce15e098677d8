//! From a question in metres to a path.

use std::time::{Duration, Instant};

use model::Robot;
use terrain::{Cell, Terrain};

use crate::{
    astar::{Outcome, Search, search},
    error::{Error, Place},
    heading::Heading,
    heuristic::{FieldEnds, GoalField},
    lattice::{Lattice, Settings, State},
    patience::Patience,
    route::Route,
    snap::{Asked, Snapped, cells_within, snap},
    table::{CostTable, Objective},
    uncertainty::energy_interval_j,
};

/// Where the robot stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Start {
    /// East [m].
    pub x_m: f64,
    /// North [m].
    pub y_m: f64,
    /// Counter-clockwise from east; `None` leaves the choice to the planner [rad].
    pub heading_rad: Option<f64>,
}

/// Where it is to go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    /// East [m].
    pub x_m: f64,
    /// North [m].
    pub y_m: f64,
    /// Counter-clockwise from east; `None` accepts any [rad].
    pub heading_rad: Option<f64>,
    /// Any pose this close to the goal will do; 0 means the goal's cell [m].
    pub tolerance_m: f64,
}

/// A question to the planner.
#[derive(Clone, Debug)]
pub struct Query {
    /// Where the robot stands.
    pub start: Start,
    /// Where it is to go.
    pub goal: Goal,
    /// How it is driven.
    pub settings: Settings,
    /// How far a start or goal may be moved to ground where the robot can stand; `None` means one cell [m].
    pub snap_radius_m: Option<f64>,
    /// When to give up.
    pub patience: Patience,
}

/// How far an end was moved to the lattice.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Snap {
    /// From the asked place to the cell's centre [m].
    pub distance_m: f64,
    /// From the asked heading to the lattice's [rad].
    pub turn_rad: f64,
}

/// What the search did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchReport {
    /// States expanded.
    pub expanded: u64,
    /// Time for preparing and searching.
    pub duration: Duration,
}

/// A least-cost path.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Totals, poses and steps.
    pub route: Route,
    /// Central 95 % interval of the energy, from the robot's parameter uncertainty [J].
    pub energy_interval_j: [f64; 2],
    /// How far the start was moved.
    pub start_snap: Snap,
    /// How far the goal was moved; the distance to where the path ends where a tolerance allowed it.
    pub goal_snap: Snap,
    /// What the search did.
    pub search: SearchReport,
}

/// The energy-minimal, shortest and fastest paths between the same ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// Least energy.
    pub energy: Plan,
    /// Least length.
    pub distance: Plan,
    /// Least time.
    pub time: Plan,
}

impl Comparison {
    /// What the energy-minimal path saves, as a share of the size of the shortest path's energy.
    ///
    /// Above 1 where the energy-minimal path returns energy and the shortest takes some; 0 between equal places.
    pub fn saving_fraction(&self) -> f64 {
        let shortest_j = self.distance.route.total.energy_j;
        let saved_j = shortest_j - self.energy.route.total.energy_j;
        if shortest_j == 0.0 { 0.0 } else { saved_j / shortest_j.abs() }
    }
}

/// Finds the path that has least of an objective.
///
/// # Errors
/// Ends off the map or where the robot cannot stand, no path, a passed deadline, or a robot and map that do not fit.
pub fn plan(terrain: &Terrain, robot: &Robot, query: &Query, objective: Objective) -> Result<Plan, Error> {
    let began = Instant::now();
    let lattice = Lattice::new(terrain, robot, query.settings)?;
    let ends = Ends::find(&lattice, query)?;
    plan_between(&lattice, &ends, query, objective, began)
}

/// Finds the energy-minimal, shortest and fastest paths.
///
/// # Errors
/// As [`plan`].
pub fn compare(terrain: &Terrain, robot: &Robot, query: &Query) -> Result<Comparison, Error> {
    let began = Instant::now();
    let lattice = Lattice::new(terrain, robot, query.settings)?;
    let ends = Ends::find(&lattice, query)?;
    let one = |objective, began| plan_between(&lattice, &ends, query, objective, began);
    Ok(Comparison {
        energy: one(Objective::Energy, began)?,
        distance: one(Objective::Distance, Instant::now())?,
        time: one(Objective::Time, Instant::now())?,
    })
}

/// Both ends on the lattice.
struct Ends {
    start: Snapped,
    goal: Snapped,
    starts: Vec<State>,
    goals: Vec<State>,
}

impl Ends {
    fn find(lattice: &Lattice<'_>, query: &Query) -> Result<Self, Error> {
        let cell_m = lattice.terrain.grid.cell_size_m;
        let snap_radius_m = query.snap_radius_m.unwrap_or(cell_m);
        within("snap_radius_m", snap_radius_m, 0.0, 1000.0)?;
        within("goal.tolerance_m", query.goal.tolerance_m, 0.0, 10_000.0)?;
        let start = snap(
            lattice,
            &Asked {
                place: Place::Start,
                x_m: query.start.x_m,
                y_m: query.start.y_m,
                heading_rad: query.start.heading_rad,
                snap_radius_m,
            },
        )?;
        let goal = snap(
            lattice,
            &Asked {
                place: Place::Goal,
                x_m: query.goal.x_m,
                y_m: query.goal.y_m,
                heading_rad: query.goal.heading_rad,
                snap_radius_m: snap_radius_m.max(query.goal.tolerance_m),
            },
        )?;
        let starts = start.headings.iter().map(|&heading| State { cell: start.cell, heading }).collect();
        let goals = goal_states(lattice, &goal, &query.goal);
        Ok(Ends { start, goal, starts, goals })
    }
}

/// The snapped goal and, within the tolerance, every other pose of an accepted heading where the robot can stand.
fn goal_states(lattice: &Lattice<'_>, snapped: &Snapped, goal: &Goal) -> Vec<State> {
    let wanted = goal.heading_rad.map(Heading::nearest);
    let mut states: Vec<State> =
        snapped.headings.iter().map(|&heading| State { cell: snapped.cell, heading }).collect();
    if goal.tolerance_m > 0.0 {
        for cell in cells_within(lattice, snapped.cell, 2.0 * goal.tolerance_m) {
            let [x, y] = lattice.terrain.grid.center_m(cell);
            if cell == snapped.cell || (x - goal.x_m).hypot(y - goal.y_m) > goal.tolerance_m {
                continue;
            }
            let headings = Heading::all().filter(|h| wanted.is_none_or(|w| w == *h));
            states.extend(
                headings.map(|heading| State { cell, heading }).filter(|s| lattice.stand(*s).is_ok()),
            );
        }
    }
    states
}

fn plan_between(
    lattice: &Lattice<'_>,
    ends: &Ends,
    query: &Query,
    objective: Objective,
    began: Instant,
) -> Result<Plan, Error> {
    let late = Error::Timeout { expanded: 0 };
    let table = CostTable::lazy(lattice, objective);
    let goals = goals_with_potential(lattice, ends, objective);
    let cells: Vec<(Cell, f64)> = goals.iter().map(|(state, after)| (state.cell, *after)).collect();
    let field_ends = FieldEnds { goals: &cells, start: Some(ends.start.cell) };
    let field = GoalField::new(lattice, &table, field_ends, &query.patience).ok_or(late)?;
    let question = Search { starts: &ends.starts, goals: &goals, patience: &query.patience };
    let (start, motions, expanded) = match search(lattice, &table, &field, &question) {
        Outcome::Found { start, motions, expanded, .. } => (start, motions, expanded),
        Outcome::Timeout { expanded } => return Err(Error::Timeout { expanded }),
        Outcome::Unreachable => return Err(nearest_connected(lattice, &field, ends)),
    };
    let duration = began.elapsed();
    let route = Route::drive(lattice, objective, start, &motions);
    let settings = &query.settings;
    let energy_interval_j = energy_interval_j(
        &route,
        lattice.robot,
        settings.power_model,
        &surface_names(lattice),
        settings.motor_temperature_c,
    );
    let goal_snap = goal_snap(&route, ends, query);
    Ok(Plan {
        route,
        energy_interval_j,
        start_snap: Snap { distance_m: ends.start.distance_m, turn_rad: ends.start.turn_rad },
        goal_snap,
        search: SearchReport { expanded, duration },
    })
}

/// Goals with what is to be added there: for energy, the height that the potential has left out.
fn goals_with_potential(lattice: &Lattice<'_>, ends: &Ends, objective: Objective) -> Vec<(State, f64)> {
    let lowest_j = ends.goals.iter().map(|s| lattice.potential_j(s.cell)).fold(f64::INFINITY, f64::min);
    ends.goals
        .iter()
        .map(|&state| {
            let above_j = lattice.potential_j(state.cell) - lowest_j;
            (state, if objective == Objective::Energy { above_j } else { 0.0 })
        })
        .collect()
}

/// Where the ground that leads to the goal comes nearest to the start.
fn nearest_connected(lattice: &Lattice<'_>, field: &GoalField, ends: &Ends) -> Error {
    let grid = &lattice.terrain.grid;
    let [sx, sy] = grid.center_m(ends.start.cell);
    let nearest = (0..grid.cells())
        .map(|i| grid.cell(i))
        .filter(|&cell| field.at(cell).is_finite())
        .map(|cell| grid.center_m(cell))
        .map(|[x, y]| ((x - sx).hypot(y - sy), x, y))
        .min_by(|a, b| a.0.total_cmp(&b.0));
    let [gx, gy] = grid.center_m(ends.goal.cell);
    let (gap_m, x_m, y_m) = nearest.unwrap_or(((gx - sx).hypot(gy - sy), gx, gy));
    if gap_m == 0.0 {
        return Error::NoRoomToTurn { x_m, y_m };
    }
    Error::NoPath { gap_m, x_m, y_m }
}

fn goal_snap(route: &Route, ends: &Ends, query: &Query) -> Snap {
    let end =
        route.poses.last().map_or((query.goal.x_m, query.goal.y_m, 0.0), |p| (p.x_m, p.y_m, p.heading_rad));
    Snap {
        distance_m: (end.0 - query.goal.x_m).hypot(end.1 - query.goal.y_m),
        turn_rad: query.goal.heading_rad.map_or(ends.goal.turn_rad, |h| crate::heading::turn_rad(h, end.2)),
    }
}

/// Names of the surfaces that steps index: the map's, then the robot's default.
pub(crate) fn surface_names(lattice: &Lattice<'_>) -> Vec<String> {
    let mut names = lattice.terrain.surfaces().map_or(Vec::new(), |s| s.names.clone());
    names.push(lattice.robot.default_surface.clone());
    names
}

fn within(field: &'static str, value: f64, min: f64, max: f64) -> Result<(), Error> {
    if (min..=max).contains(&value) { Ok(()) } else { Err(Error::OutOfRange { field, value, min, max }) }
}
