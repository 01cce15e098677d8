//! The stops of a mission and the ways between them, as a graph.

use petgraph::graph::{DiGraph, NodeIndex};
use planner::{Objective, Patience, Planner};
use routing::{Question, Waypoint, matrix};

use super::{MissionError, Site};
use crate::pack::Pack;

/// What a node stands for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// Where the robot sets out.
    Start,
    /// A waypoint, by its position in the question.
    Waypoint(usize),
    /// A charger that is driven to where that helps, by its position in the question.
    Charger(usize),
    /// The start again.
    Home,
}

/// A stop.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    pub(crate) role: Role,
    pub(crate) site: Site,
}

/// The best way from one stop to another, whatever the headings that are left open at both.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Way {
    pub(crate) energy_j: f64,
    pub(crate) duration_s: f64,
    /// Fraction of the capacity that it takes.
    pub(crate) charge: f64,
}

/// Start, waypoints and home in this order, then chargers.
pub(crate) struct Network {
    pub(crate) graph: DiGraph<Node, Way>,
    pub(crate) waypoints: usize,
    pub(crate) returns: bool,
}

impl Network {
    /// Works out the ways between all stops.
    pub(crate) fn new(
        planner: &Planner,
        nodes: Vec<Node>,
        pack: &Pack,
        charge: f64,
        patience: &Patience,
        snap_radius_m: Option<f64>,
    ) -> Result<Self, MissionError> {
        let places: Vec<Waypoint> = nodes.iter().map(|node| node.site.place).collect();
        let question = Question { objective: Objective::Energy, snap_radius_m, patience: patience.clone() };
        let found = matrix(planner, &places, &places, &question).map_err(|error| named(&nodes, error))?;
        let waypoints = nodes.iter().filter(|node| matches!(node.role, Role::Waypoint(_))).count();
        let returns = nodes.iter().any(|node| node.role == Role::Home);
        let mut graph = DiGraph::new();
        let indices: Vec<NodeIndex> = nodes.into_iter().map(|node| graph.add_node(node)).collect();
        for (from, &a) in indices.iter().enumerate() {
            for (to, &b) in indices.iter().enumerate() {
                let (Some(energy_j), Some(duration_s)) =
                    (found.energy_j[from][to], found.duration_s[from][to])
                else {
                    continue;
                };
                if from != to {
                    let taken = charge_of(pack, charge, energy_j, duration_s);
                    graph.add_edge(a, b, Way { energy_j, duration_s, charge: taken });
                }
            }
        }
        let network = Network { graph, waypoints, returns };
        network.refuse_unreachable(&found)?;
        Ok(network)
    }

    /// The way between two nodes.
    pub(crate) fn way(&self, from: usize, to: usize) -> Option<&Way> {
        let edge = self.graph.find_edge(NodeIndex::new(from), NodeIndex::new(to))?;
        self.graph.edge_weight(edge)
    }

    pub(crate) fn node(&self, node: usize) -> &Node {
        &self.graph[NodeIndex::new(node)]
    }

    /// The node of the end, if the mission has one.
    pub(crate) fn home(&self) -> Option<usize> {
        self.returns.then_some(self.waypoints + 1)
    }

    /// Nodes of chargers.
    pub(crate) fn chargers(&self) -> std::ops::Range<usize> {
        self.waypoints + 1 + usize::from(self.returns)..self.graph.node_count()
    }

    /// Costs between start, waypoints and home as a dense matrix; infinite where no way leads.
    pub(crate) fn dense(&self, cost: impl Fn(&Way) -> f64) -> Vec<Vec<f64>> {
        let count = self.chargers().start;
        let row = |from: usize| {
            (0..count).map(|to| self.way(from, to).map_or(f64::INFINITY, &cost)).collect::<Vec<f64>>()
        };
        (0..count).map(row).collect()
    }

    /// A waypoint to which no way leads from anywhere, or from which none leads on.
    fn refuse_unreachable(&self, found: &routing::Matrix) -> Result<(), MissionError> {
        for waypoint in 1..=self.waypoints {
            let gap =
                |from: usize, to: usize| found.gaps.iter().find(|gap| gap.source == from && gap.target == to);
            if let Some(gap) = gap(0, waypoint) {
                return Err(MissionError::Unreachable { waypoint: waypoint - 1, reason: gap.reason.clone() });
            }
            if let Some(gap) = self.home().and_then(|home| gap(waypoint, home)) {
                return Err(MissionError::NoWayHome { waypoint: waypoint - 1, reason: gap.reason.clone() });
            }
        }
        Ok(())
    }
}

/// Charge that an even power over a time takes of a pack that is half way down.
fn charge_of(pack: &Pack, charge: f64, energy_j: f64, duration_s: f64) -> f64 {
    let middle = charge / 2.0;
    let power_w = if duration_s > 0.0 { energy_j / duration_s } else { 0.0 };
    middle - pack.deliver(middle, power_w, duration_s).charge
}

/// The planner's errors name positions among all stops; here they are given back their own names.
pub(crate) fn named(nodes: &[Node], error: routing::Error) -> MissionError {
    use planner::{Error as E, Place};
    let routing::Error::Planner(mut error) = error else { return MissionError::Routing(error) };
    if let E::OutsideMap { place, .. } | E::PlaceBlocked { place, .. } | E::Heading { place, .. } = &mut error
        && let Place::Listed { index, .. } = *place
    {
        *place = match nodes.get(index).map(|node| node.role) {
            Some(Role::Waypoint(index)) => Place::Listed { list: "waypoints", index },
            Some(Role::Charger(index)) => Place::Listed { list: "chargers", index },
            _ => Place::Start,
        };
    }
    MissionError::Question(crate::Error::Plan(error))
}
