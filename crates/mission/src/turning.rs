//! The last point of a way from which turning back still works.

use planner::{Heading, Lattice, Patience, Planner, Route, State};
use rayon::prelude::*;

use crate::{
    Error,
    chance::Chance,
    journey::Journey,
    meter::Meter,
    round_trip::Homeward,
    run::{Conditions, Outcome},
};

/// A place on the way from which the robot still gets back with its reserve, and from no later one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TurningPoint {
    /// Number of its pose on the way.
    pub pose: usize,
    /// East and north [m].
    pub x_m: f64,
    /// See `x_m` [m].
    pub y_m: f64,
    /// Along the ground since the start [m].
    pub distance_m: f64,
    /// Charge there.
    pub charge: f64,
    /// Energy of the best way back [J].
    pub homeward_j: f64,
    /// Time of that way [s].
    pub homeward_s: f64,
    /// Charge back at the start.
    pub charge_at_home: f64,
}

/// Positions that are looked at side by side.
const BATCH: usize = 16;

/// The last lattice pose of a way out from which the best way back, by the exact field of the start, leaves the reserve; `None`
/// where not even standing at the start does. Everything is as the files say, motors as warm as they are by then.
pub(crate) fn last_turning_point(
    planner: &Planner,
    (route, homeward): (&Route, &Homeward<'_>),
    chance: &Chance,
    conditions: &Conditions,
    patience: &Patience,
) -> Result<Option<TurningPoint>, Error> {
    let lattice = planner.lattice();
    let surfaces = planner::surface_names(lattice);
    let back = |pose: usize| -> Result<Option<TurningPoint>, Error> {
        let mut meter = Meter::new(patience, "looking for the last turning point");
        meter.look()?;
        let Some(state) = state_at(lattice, route, pose) else { return Ok(None) };
        let Some(way) = homeward.route(state, patience)? else { return Ok(None) };
        let mut journey = Journey::new(lattice.settings.power_model);
        journey.drive(&lattice.robot, &route.steps[..pose], &surfaces)?;
        journey.drive(&lattice.robot, &way.steps, &surfaces)?;
        let mut charge = chance.charge;
        let mut spent_j = 0.0;
        let outcome: Outcome = journey.run(chance, conditions, &mut meter, |passage| {
            if passage.part < pose {
                (charge, spent_j) = (passage.charge, passage.energy_j);
            }
        })?;
        let place = &route.poses[pose];
        Ok(outcome.succeeds().then_some(TurningPoint {
            pose,
            x_m: place.x_m,
            y_m: place.y_m,
            distance_m: place.distance_m,
            charge,
            homeward_j: outcome.energy_j - spent_j,
            homeward_s: way.total.duration_s,
            charge_at_home: outcome.arrival_charge,
        }))
    };
    let places = lattice_poses(route);
    for batch in places.rchunks(BATCH) {
        let found: Result<Vec<_>, Error> = batch.par_iter().map(|&pose| back(pose)).collect();
        if let Some(latest) = found?.into_iter().flatten().next_back() {
            return Ok(Some(latest));
        }
    }
    Ok(None)
}

/// Numbers of the poses of a route that lie on the lattice: its start and the end of every motion.
pub(crate) fn lattice_poses(route: &Route) -> Vec<usize> {
    /// Sums of the same times in another order differ by less, as a share of them.
    const ROUNDING: f64 = 1e-9;
    let (mut places, mut pose, mut t_s) = (vec![0], 0, 0.0);
    for edge in &route.edges {
        t_s += edge.duration_s;
        while pose + 1 < route.poses.len() && route.poses[pose].t_s < t_s * (1.0 - ROUNDING) {
            pose += 1;
        }
        places.push(pose);
    }
    places
}

/// The lattice's state at a pose of a route.
pub(crate) fn state_at(lattice: &Lattice, route: &Route, pose: usize) -> Option<State> {
    let place = route.poses.get(pose)?;
    let cell = lattice.terrain.grid.cell_at(place.x_m, place.y_m)?;
    Some(State { cell, heading: Heading::nearest(place.heading_rad) })
}
