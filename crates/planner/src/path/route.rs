//! The path found, pose by pose, and what it costs under any robot.

use crate::{
    error::Error,
    grid::state::State,
    lattice::{edge::Edge, graph::Lattice, objective::Objective, step::Step},
    path::unlimited::{cheapest, drive_unlimited},
    patience::{Patience, work},
};

/// One pose along a path, with what the path has cost up to it.
///
/// Pitch, power and radius are those of the stretch that ends here; the first pose stands still.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pose {
    /// East [m].
    pub x_m: f64,
    /// North [m].
    pub y_m: f64,
    /// Up [m].
    pub z_m: f64,
    /// Counter-clockwise from east, −π to π [rad].
    pub heading_rad: f64,
    /// Since the start [s].
    pub t_s: f64,
    /// Along the ground since the start [m].
    pub distance_m: f64,
    /// Drawn from the battery since the start [J].
    pub energy_j: f64,
    /// Drawn from the battery [W].
    pub power_w: f64,
    /// Positive nose-up [rad].
    pub pitch_rad: f64,
    /// Positive with the left side up [rad].
    pub roll_rad: f64,
    /// Signed turning radius, positive with the centre on the left; `None` when straight, 0 on the spot [m].
    pub radius_m: Option<f64>,
}

/// A path as driven: its totals, its poses and its steps.
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// Sums over all steps.
    pub total: Edge,
    /// One more than there are steps.
    pub poses: Vec<Pose>,
    /// Stretches of constant grade, surface and curvature.
    pub steps: Vec<Step>,
    /// Sums of each motion, in order.
    pub edges: Vec<Edge>,
}

/// Motions that are driven whether patience is over or not, so that an answer that a search came to at its deadline is not
/// lost: some ten milliseconds.
const DRIVEN_AT_LEAST: usize = 1 << 12;

impl Route {
    /// Drives a chain of motions from a state, each in the way that costs least.
    ///
    /// # Errors
    /// Patience that ends first on a path of more than [`DRIVEN_AT_LEAST`] motions, or one that cannot be driven.
    pub(crate) fn drive(
        lattice: &Lattice,
        objective: Objective,
        (start, motions): (State, &[usize]),
        patience: &Patience,
    ) -> Result<Self, Error> {
        let weights = lattice.weights(objective);
        let ways = motions.iter().map(|&motion| (motion, None));
        Self::drive_by(
            lattice,
            start,
            ways,
            |state, motion| cheapest(lattice, &weights, state, motion),
            patience,
        )
    }

    /// Drives a chain of motions from a state, each in the variant given with it, or else in that which `choose` names.
    ///
    /// # Errors
    /// As [`Route::drive`].
    pub(crate) fn drive_by(
        lattice: &Lattice,
        start: State,
        ways: impl Iterator<Item = (usize, Option<usize>)>,
        choose: impl Fn(State, usize) -> Option<usize>,
        patience: &Patience,
    ) -> Result<Self, Error> {
        let mut route = Route {
            total: Edge::default(),
            poses: vec![first_pose(lattice, start)],
            steps: Vec::new(),
            edges: Vec::new(),
        };
        let (mut state, mut steps) = (start, Vec::new());
        let mut pacer = patience.pacer();
        for (count, (motion, variant)) in ways.enumerate() {
            if pacer.after(work::MOTION).is_none() && count > DRIVEN_AT_LEAST {
                return Err(Error::Timeout { expanded: 0 });
            }
            let variant = variant.or_else(|| choose(state, motion)).ok_or(Error::Untraceable)?;
            let end = lattice.successor(state, motion).ok_or(Error::Untraceable)?;
            let origin_m = lattice.terrain.grid.center_m(state.cell);
            let chain = lattice.chain(state.heading, motion, variant);
            steps.clear();
            if chain.drive(lattice, state.cell, |step| steps.push(*step)).is_none() {
                steps.clear();
                drive_unlimited(lattice, chain, state.cell, |step| steps.push(*step))
                    .ok_or(Error::Untraceable)?;
            }
            let mut edge = Edge::default();
            for step in &steps {
                edge.add(step);
                route.push([origin_m[0] + step.end_m[0], origin_m[1] + step.end_m[1]], step);
            }
            route.edges.push(edge);
            state = end;
        }
        Ok(route)
    }

    /// Adds a step that ends at a place of the map.
    pub(crate) fn push(&mut self, [x_m, y_m]: [f64; 2], step: &Step) {
        self.total.add(step);
        let Some(&last) = self.poses.last() else { return };
        let radius_m = step.motion.turning_radius_m();
        self.poses.push(Pose {
            x_m,
            y_m,
            z_m: last.z_m + step.rise_m,
            heading_rad: crate::grid::heading::turn_rad(0.0, step.heading_rad),
            t_s: self.total.duration_s,
            distance_m: self.total.length_m,
            energy_j: self.total.energy_j,
            power_w: step.bus_w,
            pitch_rad: step.grade.along.asin(),
            roll_rad: step.grade.tilt.atan(),
            radius_m: radius_m.is_finite().then_some(radius_m),
        });
        self.steps.push(*step);
    }
}

fn first_pose(lattice: &Lattice, start: State) -> Pose {
    let [x_m, y_m] = lattice.terrain.grid.center_m(start.cell);
    let (pitch_rad, roll_rad) = lattice.tilt_rad(start);
    Pose {
        x_m,
        y_m,
        z_m: lattice.terrain.base_m() + f64::from(lattice.height_m(start.cell)),
        heading_rad: start.heading.angle_rad(),
        t_s: 0.0,
        distance_m: 0.0,
        energy_j: 0.0,
        power_w: lattice.robot.hotel_power_w,
        pitch_rad,
        roll_rad,
        radius_m: None,
    }
}
