//! Which order to drive first: the one of least energy.

use std::time::{Duration, Instant};

use planner::{Objective, Planner, State};
use routing::{Waypoint, joints};

use super::{
    MOST_EXACT, MissionError, MissionQuestion,
    graph::Network,
    held_karp::{Poses, cheapest_order},
    local_search::{good_order, lower_bound},
};
use crate::meter::Meter;

/// An order of nodes, the start first and home last, and what no order takes less than.
pub(crate) struct Order {
    pub(crate) nodes: Vec<usize>,
    /// Least energy of the ways of any order [J].
    pub(crate) bound_j: f64,
    /// Time for finding it, costs at hand.
    pub(crate) time: Duration,
}

/// States, over all poses that fields would be worked out for, up to which an order is searched over poses: some ten seconds on
/// one core. Beyond, it is searched over places, each way with the headings that suit it best.
const MOST_FIELD_STATES: usize = 100_000_000;

/// The long step in the words of an error.
const STEP: &str = "looking for the best order";

/// The order of least energy: as given, exact over poses or places, or good with a bound.
///
/// # Errors
/// No chain of motions through all places, or patience that ends first.
pub(crate) fn best_order(
    planner: &Planner,
    network: &Network,
    states: &[Vec<State>],
    question: &MissionQuestion,
) -> Result<Order, MissionError> {
    let count = network.chargers().start;
    let cost = network.dense(|way| way.energy_j);
    // One stop has one order.
    if question.in_order || network.waypoints <= 1 {
        let bound_j = (1..count).map(|node| cost[node - 1][node]).sum();
        return Ok(Order { nodes: (0..count).collect(), bound_j, time: Duration::ZERO });
    }
    let visits = network.waypoints;
    let mut meter = Meter::new(&question.patience, STEP);
    if visits > MOST_EXACT {
        let began = Instant::now();
        let (_, mut nodes) = good_order(&cost, visits, &mut meter)?.ok_or(MissionError::NoChain)?;
        nodes.insert(0, 0);
        nodes.extend(network.home());
        let bound_j = lower_bound(&cost, visits).unwrap_or(f64::NEG_INFINITY);
        return Ok(Order { nodes, bound_j, time: began.elapsed() });
    }
    let poses: usize = states[..count].iter().map(Vec::len).sum();
    if poses * planner.lattice().states() <= MOST_FIELD_STATES {
        return over_poses(planner, states, count, question);
    }
    let places: Vec<Vec<usize>> = (0..count).map(|node| vec![node]).collect();
    let poses = Poses { places: &places, ends: question.back, cost: &cost };
    let began = Instant::now();
    let (bound_j, nodes) = cheapest_order(&poses, &mut meter)?.ok_or(MissionError::NoChain)?;
    Ok(Order { nodes, bound_j, time: began.elapsed() })
}

/// Over poses, so that the order is that of least energy with headings that join.
fn over_poses(
    planner: &Planner,
    states: &[Vec<State>],
    count: usize,
    question: &MissionQuestion,
) -> Result<Order, MissionError> {
    let grid = &planner.lattice().terrain.grid;
    let mut places = Vec::new();
    let mut waypoints = Vec::new();
    for states in &states[..count] {
        places.push((waypoints.len()..waypoints.len() + states.len()).collect::<Vec<usize>>());
        waypoints.extend(states.iter().map(|state| {
            let [x_m, y_m] = grid.center_m(state.cell);
            Waypoint { x_m, y_m, heading_rad: Some(state.heading.angle_rad()) }
        }));
    }
    let asked = routing::Question {
        objective: Objective::Energy,
        snap_radius_m: question.snap_radius_m,
        patience: question.patience.clone(),
    };
    let found = joints(planner, &waypoints, &asked).map_err(MissionError::Routing)?;
    let cost: Vec<Vec<f64>> =
        found.cost.iter().map(|row| row.iter().map(|cost| cost.unwrap_or(f64::INFINITY)).collect()).collect();
    let poses = Poses { places: &places, ends: question.back, cost: &cost };
    let began = Instant::now();
    let mut meter = Meter::new(&question.patience, STEP);
    let (bound_j, order) = cheapest_order(&poses, &mut meter)?.ok_or(MissionError::NoChain)?;
    let time = began.elapsed();
    let node = |pose: &usize| places.iter().position(|place| place.contains(pose)).unwrap_or(0);
    Ok(Order { nodes: order.iter().map(node).collect(), bound_j, time })
}

/// Time of the fastest order of the ways at hand, or a bound of it where there are many [s].
///
/// # Errors
/// Patience that ends first.
pub(crate) fn least_driving_s(network: &Network, question: &MissionQuestion) -> Result<f64, MissionError> {
    let cost = network.dense(|way| way.duration_s);
    let count = cost.len();
    if question.in_order {
        return Ok((1..count).map(|node| cost[node - 1][node]).sum());
    }
    if network.waypoints > MOST_EXACT {
        return Ok(lower_bound(&cost, network.waypoints).unwrap_or(0.0));
    }
    let places: Vec<Vec<usize>> = (0..count).map(|node| vec![node]).collect();
    let poses = Poses { places: &places, ends: network.returns, cost: &cost };
    let mut meter = Meter::new(&question.patience, STEP);
    Ok(cheapest_order(&poses, &mut meter)?.map_or(0.0, |(least_s, _)| least_s))
}
