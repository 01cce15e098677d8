//! The same question put to general-purpose searches: the same states, motions, costs and estimates.

use petgraph::{
    algo::astar,
    graph::{DiGraph, NodeIndex},
};
use planner::State;
use serde::Serialize;

use crate::{
    Case, Error,
    parts::{Built, timed},
    scene::Scene,
};

/// Another library's A* for the least-cost path, on the graph and with the estimate of the planner's own.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Peer {
    /// Library and function.
    pub name: &'static str,
    /// Side of the map [cells].
    pub cells_per_side: usize,
    /// Its search, without the time to build the graph where it needs one [ms].
    pub ms: f64,
    /// Its time over the planner's with the field at hand.
    pub ratio: f64,
}

/// Both peers, whose least costs must be the planner's.
pub(crate) fn measure(scene: &Scene, built: &Built, exact: &Case) -> Result<Vec<Peer>, Error> {
    let (implicit_units, implicit_ms) = pathfinding_astar(scene, built)?;
    let (explicit_units, explicit_ms) = petgraph_astar(scene, built)?;
    for (name, found) in [("pathfinding", implicit_units), ("petgraph", explicit_units)] {
        if found != exact.cost_units {
            return Err(Error::Disagreement { name, found, expected: exact.cost_units });
        }
    }
    let peer = |name, ms| Peer { name, cells_per_side: scene.side, ms, ratio: ms / exact.warm_ms };
    Ok(vec![
        peer("pathfinding::directed::astar::astar", implicit_ms),
        peer("petgraph::algo::astar", explicit_ms),
    ])
}

/// `pathfinding` asks for the successors of a state as it goes.
fn pathfinding_astar(scene: &Scene, built: &Built) -> Result<(u64, f64), Error> {
    let successors = |state: &State| -> Vec<(State, u64)> {
        built.table.successors(*state).map(|(next, units)| (next, u64::from(units))).collect()
    };
    let ahead = |state: &State| u64::from(built.field.units(*state));
    let start = scene.starts[0];
    let goal = |state: &State| scene.goals.contains(state);
    let (found, time) = timed(|| pathfinding::directed::astar::astar(&start, successors, ahead, goal));
    let (_, units) = found.ok_or_else(|| scene.no_path())?;
    Ok((units, time.as_secs_f64() * 1e3))
}

/// petgraph wants the graph in memory, edge by edge.
fn petgraph_astar(scene: &Scene, built: &Built) -> Result<(u64, f64), Error> {
    let lattice = &scene.lattice;
    let mut graph =
        DiGraph::<(), u32>::with_capacity(lattice.states(), lattice.states() * lattice.motions_per_state());
    for _ in 0..lattice.states() {
        graph.add_node(());
    }
    for index in 0..lattice.states() {
        for (next, units) in built.table.successors(lattice.state(index)) {
            graph.add_edge(NodeIndex::new(index), NodeIndex::new(lattice.index(next)), units);
        }
    }
    let start = NodeIndex::new(lattice.index(scene.starts[0]));
    let is_goal = |node: NodeIndex| scene.goals.contains(&lattice.state(node.index()));
    let ahead = |node: NodeIndex| u64::from(built.field.units(lattice.state(node.index())));
    let (found, time) = timed(|| astar(&graph, start, is_goal, |edge| u64::from(*edge.weight()), ahead));
    let (units, _) = found.ok_or_else(|| scene.no_path())?;
    Ok((units, time.as_secs_f64() * 1e3))
}
