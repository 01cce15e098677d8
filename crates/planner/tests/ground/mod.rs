//! Small random ground and the explicit graph over it, for tests that compare with a second implementation.

#![allow(dead_code)]

use model::{Robot, builtin};
use petgraph::graph::{DiGraph, NodeIndex};
use planner::{CostTable, Goal, Lattice, Objective, Patience, Query, Settings, Start};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use terrain::{Grid, Surfaces, Terrain, synthetic};

pub(crate) fn random(seed: u64) -> Pcg64Mcg {
    Pcg64Mcg::seed_from_u64(seed)
}

/// A few metres of hilly ground with obstacles, unknown cells and sometimes two surfaces.
pub(crate) fn small_terrain(random: &mut impl Rng, side: usize) -> Terrain {
    let grid = Grid { rows: side, columns: side + 1, cell_size_m: 1.0, origin_m: [100.0, -50.0] };
    let height_m = random.random_range(0.0..3.0);
    let mut z = synthetic::relief(grid, random.random(), 6.0, height_m);
    for cell in &mut z {
        if random.random_bool(0.02) {
            *cell = f64::NAN;
        }
    }
    z[0] = 0.0;
    let mut terrain = Terrain::new(grid, &z).unwrap();
    if random.random_bool(0.5) {
        let class = (0..grid.cells()).map(|_| random.random_range(0..2)).collect();
        terrain =
            terrain.with_surfaces(Surfaces { names: vec!["marble".into(), "sandy_loam".into()], class });
    }
    let share = random.random_range(0.0..0.15);
    synthetic::scatter_obstacles(terrain, random.random(), share)
}

/// A Husky with its own whims: regeneration, hotel load, slip track, centre of mass.
pub(crate) fn some_robot(random: &mut impl Rng, regeneration: f64) -> Robot {
    let mut robot = builtin::husky_a200();
    robot.motors.regeneration = regeneration;
    robot.hotel_power_w = if random.random_bool(0.5) { 0.0 } else { random.random_range(0.0..40.0) };
    robot.slip_track_m = random.random_range(0.54..0.9);
    robot.center_of_mass.left_m = random.random_range(-0.1..0.1);
    robot
}

pub(crate) fn some_query(random: &mut impl Rng, terrain: &Terrain, robot: &Robot) -> Query {
    let mut place =
        || terrain.grid.at_fraction_m(random.random_range(0.05..0.95), random.random_range(0.05..0.95));
    let (start, goal) = (place(), place());
    let heading = |free: bool, angle: f64| (!free).then_some(angle);
    Query {
        start: Start {
            x_m: start[0],
            y_m: start[1],
            heading_rad: heading(random.random_bool(0.3), random.random_range(-3.1..3.1)),
        },
        goal: Goal {
            x_m: goal[0],
            y_m: goal[1],
            heading_rad: heading(random.random_bool(0.5), random.random_range(-3.1..3.1)),
            tolerance_m: if random.random_bool(0.3) { 1.6 } else { 0.0 },
        },
        settings: Settings { reverse: random.random_bool(0.3), ..Settings::of(robot) },
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        patience: Patience::default(),
    }
}

/// Every state and drivable motion as an explicit graph; the weight is (cost less potential, energy) by the edge's own sums.
pub(crate) fn explicit_graph(lattice: &Lattice, objective: Objective) -> DiGraph<(), (f64, f64)> {
    let mut graph = states(lattice);
    for index in 0..lattice.states() {
        let state = lattice.state(index);
        for motion in 0..lattice.motions_per_state() {
            let Some(end) = lattice.successor(state, motion) else { continue };
            let lifted_j = lattice.potential_j(end.cell) - lattice.potential_j(state.cell);
            for edge in lattice.variants(state.cell, state.heading, motion).flatten() {
                let weight = (lattice.cost(objective, &edge, lifted_j), edge.energy_j);
                graph.add_edge(NodeIndex::new(index), NodeIndex::new(lattice.index(end)), weight);
            }
        }
    }
    graph
}

/// The same graph with the costs that a table holds.
pub(crate) fn table_graph(lattice: &Lattice, table: &CostTable) -> DiGraph<(), f64> {
    let mut graph = states(lattice);
    for index in 0..lattice.states() {
        let state = lattice.state(index);
        for motion in 0..lattice.motions_per_state() {
            let cost = table.cost(state, motion);
            if let Some(end) = lattice.successor(state, motion).filter(|_| cost.is_finite()) {
                graph.add_edge(NodeIndex::new(index), NodeIndex::new(lattice.index(end)), cost);
            }
        }
    }
    graph
}

fn states<E>(lattice: &Lattice) -> DiGraph<(), E> {
    let mut graph = DiGraph::with_capacity(lattice.states(), lattice.states() * lattice.motions_per_state());
    for _ in 0..lattice.states() {
        graph.add_node(());
    }
    graph
}
