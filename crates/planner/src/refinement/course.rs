//! A path as waypoints and the links between them, part given by a route and part free.

use std::ops::Range;

use crate::{
    grid::{
        heading::{Heading, turn_rad},
        state::State,
    },
    lattice::{edge::Edge, step::Step},
    path::route::{Pose, Route},
    refinement::{
        connection::{Connection, Waypoint},
        free::FreeGround,
    },
};

/// How a path gets from one waypoint to the next.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Way {
    /// Along steps of the route that was there first.
    Given(Range<usize>),
    /// Along a curve of its own.
    Free(Connection),
}

/// One stretch of a path and its cost in the objective's own unit.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Link {
    pub(crate) way: Way,
    pub(crate) cost: f64,
}

/// A path; one more waypoint than there are links.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Course {
    pub(crate) waypoints: Vec<Waypoint>,
    pub(crate) links: Vec<Link>,
}

impl Course {
    /// A route's poses, each a waypoint, and its steps as they are.
    pub(crate) fn of(ground: &FreeGround<'_>, route: &Route) -> Self {
        let [west_m, south_m] = first_center_m(ground);
        let waypoint = |pose: &Pose| Waypoint {
            x_m: pose.x_m - west_m,
            y_m: pose.y_m - south_m,
            heading_rad: pose.heading_rad,
        };
        let link = |(i, step): (usize, &Step)| {
            let mut edge = Edge::default();
            edge.add(step);
            Link { way: Way::Given(i..i + 1), cost: ground.weighed(&edge) }
        };
        Course {
            waypoints: route.poses.iter().map(waypoint).collect(),
            links: route.steps.iter().enumerate().map(link).collect(),
        }
    }

    /// Drives the course; `given` is the route that its given links are of. `None` where it cannot be driven.
    pub(crate) fn drive(&self, ground: &FreeGround<'_>, given: &Route) -> Option<Route> {
        let [west_m, south_m] = first_center_m(ground);
        let first = self.first_pose(ground, given)?;
        let mut route =
            Route { total: Edge::default(), poses: vec![first], steps: Vec::new(), edges: Vec::new() };
        for (link, ends) in self.links.iter().zip(self.waypoints.windows(2)) {
            let mut edge = Edge::default();
            let mut push = |place_m: [f64; 2], step: &Step| {
                edge.add(step);
                route.push(place_m, step);
                Some(())
            };
            match &link.way {
                Way::Given(steps) => {
                    for (step, pose) in
                        given.steps.get(steps.clone())?.iter().zip(&given.poses[steps.start + 1..])
                    {
                        push([pose.x_m, pose.y_m], step)?;
                    }
                }
                Way::Free(connection) => {
                    let pieces = connection.pieces(&ends[0], &ends[1])?;
                    ground.drive(&pieces, connection.reverse, |step| {
                        push([west_m + step.end_m[0], south_m + step.end_m[1]], step)
                    })?;
                }
            }
            route.edges.push(edge);
        }
        // Curves close to rounding; the answer ends in the very pose that it was asked to end in.
        let (end, wanted) = (route.poses.last_mut()?, self.waypoints.last()?);
        let [x_m, y_m] = [west_m + wanted.x_m, south_m + wanted.y_m];
        debug_assert!((end.x_m - x_m).hypot(end.y_m - y_m) < 1e-6);
        debug_assert!(turn_rad(end.heading_rad, wanted.heading_rad).abs() < 1e-6);
        (end.x_m, end.y_m) = (x_m, y_m);
        end.heading_rad = turn_rad(0.0, wanted.heading_rad);
        Some(route)
    }

    /// The pose in which the course begins: that of the route, or one beside it.
    fn first_pose(&self, ground: &FreeGround<'_>, given: &Route) -> Option<Pose> {
        let ([west_m, south_m], from, first) =
            (first_center_m(ground), self.waypoints.first()?, given.poses.first()?);
        let [x_m, y_m] = [west_m + from.x_m, south_m + from.y_m];
        let given_m = [first.x_m - west_m, first.y_m - south_m];
        let given = Waypoint { x_m: given_m[0], y_m: given_m[1], heading_rad: first.heading_rad };
        if is_same(&given, from) {
            return Some(*first);
        }
        let lattice = ground.lattice;
        let heading = Heading::nearest(from.heading_rad);
        let cell = lattice.terrain.grid.cell_at(x_m, y_m)?;
        let (pitch_rad, roll_rad) = lattice.tilt_rad(State { cell, heading });
        let z_m = lattice.terrain.base_m() + f64::from(ground.height_at_m([from.x_m, from.y_m])?);
        let heading_rad = turn_rad(0.0, from.heading_rad);
        Some(Pose { x_m, y_m, z_m, heading_rad, pitch_rad, roll_rad, ..*first })
    }
}

/// Whether two waypoints are one, to rounding.
pub(crate) fn is_same(a: &Waypoint, b: &Waypoint) -> bool {
    (a.x_m - b.x_m).hypot(a.y_m - b.y_m) < SAME_M && turn_rad(a.heading_rad, b.heading_rad).abs() < SAME_RAD
}

/// Places that are nearer to each other are the same [m].
const SAME_M: f64 = 1e-9;
/// Headings that are nearer to each other are the same [rad].
const SAME_RAD: f64 = 1e-9;

/// Centre of cell (0, 0), from which waypoints count [m].
pub(crate) fn first_center_m(ground: &FreeGround<'_>) -> [f64; 2] {
    ground.lattice.terrain.grid.center_m(terrain::Cell { row: 0, column: 0 })
}
