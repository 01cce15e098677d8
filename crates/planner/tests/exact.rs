//! Exact fields, to goals and from starts, hold the least costs of petgraph's Dijkstra.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use petgraph::{
    algo::dijkstra,
    graph::{DiGraph, NodeIndex},
};
use planner::{CostTable, ExactField, HEADINGS, Heading, Lattice, Objective, Patience, Settings, State};
use rand::{Rng, RngExt};

mod ground;

/// The lattice's graph in the table's units, turned round for costs to goals, with an edge from node `states` to each seed.
fn graph(table: &CostTable, seeds: &[(State, f64)], to_goals: bool) -> DiGraph<(), u64> {
    let lattice = table.lattice();
    let (mut graph, states) = (DiGraph::new(), lattice.states());
    let nodes: Vec<NodeIndex> = (0..=states).map(|_| graph.add_node(())).collect();
    for index in 0..states {
        for (next, cost) in table.successors(lattice.state(index)) {
            let next = lattice.index(next);
            let (from, to) = if to_goals { (next, index) } else { (index, next) };
            graph.add_edge(nodes[from], nodes[to], u64::from(cost));
        }
    }
    for (seed, beyond) in seeds {
        graph.add_edge(nodes[states], nodes[lattice.index(*seed)], (beyond * table.units()) as u64);
    }
    graph
}

fn seeds(random: &mut impl Rng, lattice: &Lattice) -> Vec<(State, f64)> {
    let level_j = 50.0;
    let cells = [1, 1, 3][random.random_range(0..3)];
    (0..cells)
        .flat_map(|_| {
            let cell = lattice.terrain.grid.cell(random.random_range(0..lattice.terrain.grid.cells()));
            let headings = [1, 3, HEADINGS][random.random_range(0..3)];
            let (first, beyond) = (random.random_range(0..HEADINGS), random.random_range(0.0..level_j));
            (0..headings)
                .map(move |turn| (State { cell, heading: Heading::new(first + turn) }, beyond))
                .collect::<Vec<_>>()
        })
        .collect()
}

/// Compares every state; the number of those that were reached.
fn check(table: &CostTable, seeds: &[(State, f64)], to_goals: bool, limit: f64) -> usize {
    let lattice = table.lattice();
    let patience = Patience::default();
    let field = match to_goals {
        true => ExactField::to_goals(table, seeds, limit, &patience),
        false => ExactField::from_starts(table, seeds, limit, &patience),
    }
    .unwrap();
    let graph = graph(table, seeds, to_goals);
    let least = dijkstra(&graph, NodeIndex::new(lattice.states()), None, |edge| *edge.weight());
    let mut reached = 0;
    for index in 0..lattice.states() {
        let known = least.get(&NodeIndex::new(index)).map(|units| *units as f64 / table.units());
        let known = known.filter(|cost| *cost <= limit);
        let found = field.cost(lattice.state(index));
        assert_eq!(found, known, "{:?}, to goals: {to_goals}, limit {limit}", lattice.state(index));
        reached += usize::from(found.is_some());
    }
    reached
}

#[test]
fn every_state_of_random_maps_costs_what_petgraph_says_in_both_directions_and_within_limits() {
    let mut random = ground::random(70);
    let mut reached = 0;
    for case in 0..48 {
        let terrain = ground::small_terrain(&mut random, 24);
        let robot = ground::some_robot(&mut random, [0.0, 0.5, 1.0][case % 3]);
        let mut settings = Settings::of(&robot);
        settings.reverse = case % 4 == 0;
        let lattice = Lattice::new(&terrain, &robot, settings).unwrap();
        let objective =
            [Objective::Energy, Objective::Energy, Objective::Distance, Objective::Time][case % 4];
        let table = CostTable::new(&lattice, objective, &Patience::default()).unwrap();
        let seeds = seeds(&mut random, &lattice);
        for to_goals in [true, false] {
            let limit = if case % 2 == 0 { f64::INFINITY } else { random.random_range(0.0..2000.0) };
            reached += check(&table, &seeds, to_goals, limit);
        }
    }
    assert!(reached > 20_000, "{reached} states were reached");
}
