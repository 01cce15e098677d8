//! Exact fields, to goals and from starts, hold the least costs of petgraph's Dijkstra.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use petgraph::{
    algo::dijkstra,
    graph::{DiGraph, NodeIndex},
};
use planner::{CostTable, ExactField, HEADINGS, Heading, Lattice, Objective, Patience, Settings, State};
use rand::{Rng, RngExt};
use terrain::{Cell, Grid, Terrain, synthetic};

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
            let limit = match case % 8 {
                7 => -1.0,
                1 | 3 | 5 => random.random_range(0.0..2000.0),
                _ => f64::INFINITY,
            };
            reached += check(&table, &seeds, to_goals, limit);
        }
    }
    assert!(reached > 20_000, "{reached} states were reached");
}

#[test]
fn costs_run_on_from_tile_to_tile() {
    let mut random = ground::random(71);
    let mut reached = 0;
    for case in 0..3 {
        let terrain = synthetic::mirrored(&ground::small_terrain(&mut random, 40), 131, 90).unwrap();
        let mut settings = Settings::of(&ground::some_robot(&mut random, 0.5));
        settings.reverse = case == 2;
        let lattice = Lattice::new(&terrain, &ground::some_robot(&mut random, 0.5), settings).unwrap();
        let table = CostTable::lazy(&lattice, Objective::Energy);
        let seeds = seeds(&mut random, &lattice);
        let limit = if case == 1 { 5000.0 } else { f64::INFINITY };
        reached += check(&table, &seeds, true, limit) + check(&table, &seeds, false, limit);
    }
    assert!(reached > 100_000, "{reached} states were reached");
}

#[test]
fn arcs_that_lead_past_the_next_tile_count_too() {
    let grid = Grid { rows: 90, columns: 95, cell_size_m: 0.05, origin_m: [0.0, 0.0] };
    let terrain = Terrain::new(grid, &synthetic::relief(grid, 4, 2.0, 0.2)).unwrap();
    let mut robot = model::builtin::husky_a200();
    robot.slip_track_m = 8.5;
    let lattice = Lattice::new(&terrain, &robot, Settings::of(&robot)).unwrap();
    let farthest = lattice.motions.iter().flatten().map(|m| m.columns.abs().max(m.rows.abs())).max();
    assert!(farthest > Some(64), "{farthest:?} cells");
    let table = CostTable::lazy(&lattice, Objective::Energy);
    let seeds = [(State { cell: Cell { row: 44, column: 47 }, heading: Heading::new(3) }, 0.0)];
    let reached = check(&table, &seeds, true, f64::INFINITY) + check(&table, &seeds, false, f64::INFINITY);
    assert!(reached > 10_000, "{reached} states were reached");
}

#[test]
fn energies_follow_from_costs_and_the_height_potentials_of_both_ends() {
    let mut random = ground::random(72);
    let mut compared = 0;
    for _ in 0..12 {
        let terrain = ground::small_terrain(&mut random, 20);
        let robot = ground::some_robot(&mut random, 0.5);
        let query = ground::some_query(&mut random, &terrain, &robot);
        let Ok(found) = planner::plan(&terrain, &robot, &query, Objective::Energy) else { continue };
        let lattice = Lattice::new(&terrain, &robot, query.settings).unwrap();
        let table = CostTable::lazy(&lattice, Objective::Energy);
        let state = |pose: &planner::Pose| State {
            cell: terrain.grid.cell_at(pose.x_m, pose.y_m).unwrap(),
            heading: Heading::nearest(pose.heading_rad),
        };
        let [first, last] =
            [found.route.poses.first(), found.route.poses.last()].map(|pose| state(pose.unwrap()));
        let [start_j, goal_j] = [first, last].map(|state| lattice.potential_j(state.cell));
        let patience = Patience::default();
        let outwards = ExactField::from_starts(&table, &[(first, 0.0)], f64::INFINITY, &patience).unwrap();
        let homewards = ExactField::to_goals(&table, &[(last, 0.0)], f64::INFINITY, &patience).unwrap();
        // c is φ of the start, and minus φ of the goal.
        let outwards_j = outwards.cost(last).unwrap() + goal_j - start_j;
        let homewards_j = homewards.cost(first).unwrap() - start_j + goal_j;
        let energy_j = found.route.total.energy_j;
        let room_j = 1e-3 * (energy_j - (goal_j - start_j)).abs() + 1e-2;
        assert_eq!(outwards.cost(last), homewards.cost(first));
        assert!((outwards_j - energy_j).abs() <= room_j, "{outwards_j} J, driven {energy_j} J");
        assert!((homewards_j - energy_j).abs() <= room_j, "{homewards_j} J, driven {energy_j} J");
        compared += 1;
    }
    assert!(compared > 4, "{compared} paths");
}

#[test]
fn patience_that_ends_leaves_no_field() {
    let mut random = ground::random(73);
    let terrain = synthetic::mirrored(&ground::small_terrain(&mut random, 40), 131, 150).unwrap();
    let robot = model::builtin::husky_a200();
    let lattice = Lattice::new(&terrain, &robot, Settings::of(&robot)).unwrap();
    let table = CostTable::new(&lattice, Objective::Energy, &Patience::default()).unwrap();
    let seeds: Vec<(State, f64)> =
        (0..terrain.grid.cells()).step_by(17).map(|cell| (lattice.state(cell * HEADINGS), 0.0)).collect();
    for looks in 0..4 {
        assert!(ExactField::to_goals(&table, &seeds, f64::INFINITY, &Patience::for_looks(looks)).is_none());
        assert!(
            ExactField::from_starts(&table, &seeds, f64::INFINITY, &Patience::for_looks(looks)).is_none()
        );
    }
}
