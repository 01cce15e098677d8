//! What is asked of the planner and what it answers.

use std::time::Duration;

use crate::{
    grid::heading::{HEADINGS, Heading},
    lattice::{edge::Edge, graph::Settings, objective::Objective},
    path::route::Route,
    patience::Patience,
    refinement::refine::RefinedPath,
    search::astar::Found,
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
    /// Whether the opposite heading will do as well.
    pub either_way: bool,
    /// Any pose this close to the goal will do; 0 means the goal's cell [m].
    pub tolerance_m: f64,
}

impl Goal {
    /// Headings that are accepted; `None` stands for all.
    pub(crate) fn headings(&self) -> Option<Vec<Heading>> {
        let wanted = Heading::nearest(self.heading_rad?);
        let opposite = wanted.turned(HEADINGS as i32 / 2);
        Some(if self.either_way { vec![wanted, opposite] } else { vec![wanted] })
    }
}

/// A question to the planner.
#[derive(Clone, Debug)]
pub struct Query {
    /// Where the robot stands.
    pub start: Start,
    /// Where it is to go.
    pub goal: Goal,
    /// Other places that will do as well: the path leads to the one that is best to reach.
    pub other_goals: Vec<Goal>,
    /// How it is driven.
    pub settings: Settings,
    /// How far a start or goal may be moved to ground where the robot can stand; `None` means one cell [m].
    ///
    /// The nearest place that is connected to the other end is preferred to nearer ones that are not. Without a radius an end
    /// where the robot can stand stays where it is.
    pub snap_radius_m: Option<f64>,
    /// The path may cost so many times the least, 1 to [`Query::LOOSEST_BOUND`]; 1 asks for the least itself.
    pub bound: f64,
    /// Whether to refine the path off the lattice too.
    pub refine: bool,
    /// Whether the path is to begin and end exactly where it is asked to, by curves to and from the lattice's path, where ground and
    /// obstacles allow them; else it does so at the centres of cells and under one of sixteen headings.
    pub exact_ends: bool,
    /// When to give up: the best path so far is the answer then, with the bound proven of it.
    pub patience: Patience,
}

impl Query {
    /// All places that will do.
    pub(crate) fn goals(&self) -> impl Iterator<Item = &Goal> {
        std::iter::once(&self.goal).chain(&self.other_goals)
    }

    /// The loosest bound that can be asked for.
    pub const LOOSEST_BOUND: f64 = 10.0;
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
    /// Proven: the answer has at most so many times the least of the objective that any path of the lattice takes, with the
    /// rounding of costs in the table and what preferences add included. `None` where the least may be nothing or a gain, which no factor bounds.
    pub bound: Option<f64>,
    /// By how much the answer may exceed the least, in the objective's unit, rounding included.
    pub excess: f64,
    /// Whether no path of the lattice costs less, to the rounding of the table. False where its costs do not tell, as of a wind that pushes
    /// for nothing: [`SearchReport::excess`] then says how much less one may take.
    pub optimal: bool,
    /// Whether patience ended before the bound asked for was proven.
    pub timed_out: bool,
}

/// Share of the energy that flows, either way, up to which rounding keeps the best path of the table from being proven the best: a thousandth
/// as a rule, and some hundredths where most motions take next to nothing. More is what the table's costs, which are never negative, leave out.
const UNTOLD_SHARE: f64 = 0.05;
/// The same where hardly any flows [J].
const UNTOLD_J: f64 = 1.0;

impl SearchReport {
    /// What is proven of a path that takes `amount` of the objective, where none takes less than `least`.
    pub(crate) fn proven(found: &Found, objective: Objective, total: &Edge, duration: Duration) -> Self {
        let amount = objective.compared(total);
        let excess = (amount - found.least).max(0.0);
        let drawn_j = total.energy_j + 2.0 * total.recovered_j;
        let is_told = objective != Objective::Energy || excess <= (UNTOLD_SHARE * drawn_j).max(UNTOLD_J);
        SearchReport {
            expanded: found.expanded,
            duration,
            bound: match found.least {
                least if amount <= least => Some(1.0),
                least => (least > 0.0).then(|| amount / least),
            },
            excess,
            optimal: found.optimal && is_told,
            timed_out: found.late,
        }
    }

    /// Whether the path is proven to be the best of the lattice, to the rounding of the table.
    pub fn is_optimal(&self) -> bool {
        self.optimal
    }
}

/// A least-cost path.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Totals, poses and steps of the lattice's path, with the curves to its ends where these are to be exact.
    pub route: Route,
    /// The same way with shortcuts and freely placed arcs, never worse than `route`, where it was asked for and time was left.
    pub refined: Option<RefinedPath>,
    /// Central 95 % interval of the energy, from the robot's parameter uncertainty [J].
    pub energy_interval_j: [f64; 2],
    /// How far the start was moved; nothing where the path begins exactly where it was asked to.
    pub start_snap: Snap,
    /// How far the goal was moved; the distance to where the path ends where a tolerance allowed it.
    pub goal_snap: Snap,
    /// Which goal the path leads to: 0, or the position of another one from 1 on.
    pub goal: usize,
    /// How far from the goal the path ends where it leads only part of the way [m].
    pub short_of_goal_m: Option<f64>,
    /// What the search did.
    pub search: SearchReport,
}

impl Plan {
    /// Every route of the answer: that of the lattice, and the refined one where there is one.
    pub fn routes(&self) -> impl Iterator<Item = &Route> {
        std::iter::once(&self.route).chain(self.refined.iter().map(|refined| &refined.route))
    }

    /// The route to drive: the refined one where there is one, else that of the lattice.
    pub fn best_route(&self) -> &Route {
        self.refined.as_ref().map_or(&self.route, |refined| &refined.route)
    }
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
        saved_share(&self.energy.route, &self.distance.route)
    }

    /// The same of the refined paths; `None` where one of both is missing.
    pub fn refined_saving_fraction(&self) -> Option<f64> {
        let (energy, distance) = (self.energy.refined.as_ref()?, self.distance.refined.as_ref()?);
        Some(saved_share(&energy.route, &distance.route))
    }
}

/// What a route saves of another's energy, as a share of its size; 0 where that is nothing.
fn saved_share(route: &Route, other: &Route) -> f64 {
    let (takes_j, other_j) = (route.total.energy_j, other.total.energy_j);
    if other_j == 0.0 { 0.0 } else { (other_j - takes_j) / other_j.abs() }
}
