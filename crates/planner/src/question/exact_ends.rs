//! Curves from exactly where the robot stands to the lattice's path, and from there to exactly where it is to go.

use std::f64::consts::{FRAC_PI_2, PI};

use crate::{
    grid::heading::turn_rad,
    lattice::objective::Objective,
    path::route::Route,
    patience::{Patience, work},
    question::{
        ends::Ends,
        planner::Planner,
        query::{Goal, Query},
    },
    refinement::{
        connection::Waypoint,
        course::{Course, Link, first_center_m, is_same},
        free::FreeGround,
        rates::{LevelRates, Radii},
        shortcut::best_link,
    },
};

/// How far along the path a curve may join it, in cells: a robot that stands beside the line joins it at a flat angle.
const JOINS_WITHIN_CELLS: f64 = 8.0;
/// Work of a curve that is tried.
const CURVE: u64 = 64 * work::MOTION;

impl Planner {
    /// The route with the best curves from the asked start to one of its first poses and from one of its last to the asked goal. An end
    /// that was moved to another cell, that a tolerance leaves open or to which no curve can be driven stays where it is.
    pub(crate) fn with_exact_ends(
        &self,
        route: Route,
        (ends, goal): (&Ends, &Goal),
        query: &Query,
        objective: Objective,
    ) -> Route {
        let lattice = self.lattice();
        let ground = FreeGround::new(lattice, objective);
        let rates = LevelRates::new(&ground);
        let mut course = Course::of(&ground, &route);
        let before = course.clone();
        let (Some(first), Some(end)) = (course.waypoints.first().copied(), course.waypoints.last().copied())
        else {
            return route;
        };
        let [west_m, south_m] = first_center_m(&ground);
        let at = |x_m: f64, y_m: f64, heading_rad: f64| Waypoint {
            x_m: x_m - west_m,
            y_m: y_m - south_m,
            heading_rad,
        };
        if ends.start.is_home {
            let start = &query.start;
            let asked = at(start.x_m, start.y_m, start.heading_rad.unwrap_or(first.heading_rad));
            join(&ground, &rates, &mut course, (asked, Side::Start), &query.patience);
        }
        let asked = at(goal.x_m, goal.y_m, heading_near(goal, end.heading_rad));
        let is_home = lattice.terrain.grid.cell_at(goal.x_m, goal.y_m)
            == lattice.terrain.grid.cell_at(end.x_m + west_m, end.y_m + south_m);
        if is_home && goal.tolerance_m == 0.0 {
            join(&ground, &rates, &mut course, (asked, Side::Goal), &query.patience);
        }
        if course == before { route } else { course.drive(&ground, &route).unwrap_or(route) }
    }
}

/// The heading that a goal accepts and that is nearest to one of the lattice [rad].
fn heading_near(goal: &Goal, lattice_rad: f64) -> f64 {
    match goal.heading_rad {
        None => lattice_rad,
        Some(asked_rad) if goal.either_way && turn_rad(asked_rad, lattice_rad).abs() > FRAC_PI_2 => {
            asked_rad + PI
        }
        Some(asked_rad) => asked_rad,
    }
}

/// Which end of a course.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Side {
    Start,
    Goal,
}

/// Puts a curve in the place of the first or last links of a course, the one with which it costs least in all; leaves it as it is where
/// none can be driven.
fn join(
    ground: &FreeGround<'_>,
    rates: &LevelRates,
    course: &mut Course,
    (asked, side): (Waypoint, Side),
    patience: &Patience,
) {
    let is_start = side == Side::Start;
    let last = course.waypoints.len() - 1;
    let place = |k: usize| if is_start { k } else { last - k };
    if is_same(&course.waypoints[place(0)], &asked) {
        return;
    }
    let within_m = JOINS_WITHIN_CELLS * ground.lattice.terrain.grid.cell_size_m;
    let mut best: Option<(f64, usize, Link)> = None;
    let mut replaced = 0.0;
    let mut pacer = patience.pacer();
    for k in 0..=last {
        let joint = course.waypoints[place(k)];
        if (joint.x_m - asked.x_m).hypot(joint.y_m - asked.y_m) > within_m || pacer.after(CURVE).is_none() {
            break;
        }
        if k > 0 {
            replaced += course.links[if is_start { k - 1 } else { last - k }].cost;
        }
        let ways = if is_start { [&asked, &joint] } else { [&joint, &asked] };
        let most = best.as_ref().map_or(f64::INFINITY, |(more, ..)| more + replaced);
        if let Some(link) = best_link(ground, rates, ways, Radii::EveryPair, most) {
            best = Some((link.cost - replaced, k, link));
        }
    }
    let Some((_, k, link)) = best else { return };
    if is_start {
        course.waypoints.splice(..k, [asked]);
        course.links.splice(..k, [link]);
    } else {
        course.waypoints.splice(last - k + 1.., [asked]);
        course.links.splice(last - k.., [link]);
    }
}
