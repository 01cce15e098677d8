//! Why no path leads to a goal: the question asked anew without the robot's limits.

use std::f64::consts::FRAC_PI_2;

use model::{Acceleration, Manoeuvre, Robot, Sides};

use crate::{
    error::Error,
    grid::heading::{Heading, turn_rad},
    hindrance::{Hindrance, Limit},
    lattice::{graph::Lattice, ground_class::surface_names, objective::Objective},
    path::route::Route,
    question::{ends::Ends, planner::Planner, query::Query},
};

impl Limit {
    const ALL: [Limit; 4] = [Limit::SideForce, Limit::Pitch, Limit::Roll, Limit::Clearance];

    /// The robot's value; `None` where it has no such limit, or the ground does not tell.
    fn of(self, lattice: &Lattice) -> Option<f64> {
        let robot = &lattice.robot;
        match self {
            Limit::Clearance => lattice.ground.has_body().then(|| robot.clearance_m()),
            Limit::SideForce => robot.limits.max_side_force_n,
            Limit::Pitch => Some(robot.limits.max_pitch_rad),
            Limit::Roll => Some(robot.limits.max_roll_rad),
        }
    }

    fn lift(self, robot: &mut Robot) {
        match self {
            Limit::SideForce => robot.limits.max_side_force_n = None,
            Limit::Pitch => robot.limits.max_pitch_rad = STEEPEST_RAD,
            Limit::Roll => robot.limits.max_roll_rad = STEEPEST_RAD,
            Limit::Clearance => robot.ground_clearance_m = Some(f64::INFINITY),
        }
    }

    /// The largest value along a route.
    fn largest(self, lattice: &Lattice, route: &Route) -> f64 {
        let of_poses = |angle_rad: fn(&crate::path::route::Pose) -> f64| {
            route.poses.iter().map(|pose| angle_rad(pose).abs()).fold(0.0, f64::max)
        };
        match self {
            Limit::SideForce => largest_side_force_n(lattice, route),
            Limit::Pitch => {
                let of_stance = route.steps.iter().map(|step| step.stance_pitch_rad().abs());
                of_stance.fold(of_poses(|pose| pose.pitch_rad), f64::max)
            }
            Limit::Roll => of_poses(|pose| pose.roll_rad),
            Limit::Clearance => highest_under_m(lattice, route),
        }
    }
}

/// A slope that no ground of finite elevations reaches, and whose tangent is a number.
const STEEPEST_RAD: f64 = FRAC_PI_2 - 1e-6;

/// The highest ground under the body along a route, above the plane of the wheels [m].
fn highest_under_m(lattice: &Lattice, route: &Route) -> f64 {
    let rise_m = |x_m: f64, y_m: f64, heading_rad: f64| {
        let cell = lattice.terrain.grid.cell_at(x_m, y_m)?;
        lattice.ground.rises_m(&lattice.terrain, cell, Heading::nearest(heading_rad))
    };
    // A step is held against the ground half way, and a motion at its end.
    let halves = route.poses.windows(2).filter_map(|pair| {
        let heading_rad = pair[0].heading_rad + turn_rad(pair[0].heading_rad, pair[1].heading_rad) / 2.0;
        rise_m((pair[0].x_m + pair[1].x_m) / 2.0, (pair[0].y_m + pair[1].y_m) / 2.0, heading_rad)
    });
    let ends = route.poses.iter().filter_map(|pose| rise_m(pose.x_m, pose.y_m, pose.heading_rad));
    halves.chain(ends).fold(0.0, f64::max)
}

/// The largest force of either side along a route [N].
fn largest_side_force_n(lattice: &Lattice, route: &Route) -> f64 {
    let (robot, settings) = (&lattice.robot, &lattice.settings);
    let names = surface_names(lattice);
    let force_n = route.steps.iter().filter_map(|step| {
        let surface = robot.surfaces.get(names.get(step.surface)?)?;
        let temperature_c = Sides::both(settings.motor_temperature_c);
        let manoeuvre = Manoeuvre::new(settings.power_model, robot, surface, step.motion, temperature_c);
        let force_n = manoeuvre.power_on_grade(step.grade, Acceleration::NONE).force_n;
        Some(force_n.left.abs().max(force_n.right.abs()))
    });
    force_n.fold(0.0, f64::max)
}

impl Planner {
    /// An error with what keeps the robot from the goal, where it says that there is no path.
    ///
    /// The question is asked anew without the robot's limits: without all of them, then without each.
    pub(crate) fn explained(&self, error: Error, ends: &Ends, query: &Query, objective: Objective) -> Error {
        let (gap_m, [x_m, y_m]) = match error {
            Error::NoPath { gap_m, x_m, y_m, .. } => (gap_m, [x_m, y_m]),
            Error::NoRoomToTurn { x_m, y_m } => (0.0, [x_m, y_m]),
            other => return other,
        };
        match self.hindrance(ends, query, objective) {
            Hindrance::Ground | Hindrance::Unexplained if gap_m == 0.0 => error,
            hindrance => Error::NoPath { gap_m, x_m, y_m, hindrance },
        }
    }

    fn hindrance(&self, ends: &Ends, query: &Query, objective: Objective) -> Hindrance {
        match self.without(&Limit::ALL, ends, query, objective) {
            Err(Error::NoPath { .. } | Error::NoRoomToTurn { .. }) => return Hindrance::Ground,
            Err(_) => return Hindrance::Unexplained,
            Ok(_) => {}
        }
        for limit in Limit::ALL {
            let Some(allowed) = limit.of(self.lattice()) else { continue };
            match self.without(&[limit], ends, query, objective) {
                Ok((planner, route)) => {
                    let needed = limit.largest(planner.lattice(), &route);
                    return Hindrance::OneLimit { limit, allowed, needed };
                }
                Err(Error::NoPath { .. } | Error::NoRoomToTurn { .. }) => {}
                Err(_) => return Hindrance::Unexplained,
            }
        }
        Hindrance::SeveralLimits
    }

    /// The best path of a robot without some limits.
    fn without(
        &self,
        limits: &[Limit],
        ends: &Ends,
        query: &Query,
        objective: Objective,
    ) -> Result<(Planner, Route), Error> {
        let lattice = self.lattice();
        let mut robot = lattice.robot.clone();
        limits.iter().for_each(|limit| limit.lift(&mut robot));
        let planner = Planner::prepare(&lattice.terrain, &robot, lattice.settings, &query.patience)?;
        let route = planner.best_between(ends, query, objective)?;
        Ok((planner, route))
    }
}
