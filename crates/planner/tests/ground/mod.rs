//! Small random ground and the explicit graph over it, for tests that compare with a second implementation.

#![allow(dead_code)]

use model::{Robot, builtin};
use petgraph::graph::{DiGraph, NodeIndex};
use planner::{CostTable, Goal, Lattice, Objective, Patience, Query, Settings, Start};
use rand::{Rng, RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use terrain::{Cell, Grid, Surfaces, Terrain, synthetic};

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

/// A few metres of small cells: blocks of some centimetres, which a robot passes over or not, and a few unknown cells.
pub(crate) fn rough_terrain(random: &mut impl Rng, side: usize) -> Terrain {
    let grid = Grid { rows: side, columns: side, cell_size_m: 0.12, origin_m: [3.0, 4.0] };
    let slope = [random.random_range(-0.2..0.2), random.random_range(-0.2..0.2)];
    let noise_m = random.random_range(0.0..0.004);
    let mut z: Vec<f64> = (0..grid.cells())
        .map(|i| {
            let [x, y] = grid.center_m(grid.cell(i));
            slope[0] * x + slope[1] * y + random.random_range(-1.0..1.0) * noise_m
        })
        .collect();
    for _ in 0..random.random_range(0..5) {
        let (row, column) = (random.random_range(0..side), random.random_range(0..side));
        let (size, height_m) = (random.random_range(1..4), random.random_range(0.02..0.25));
        for cell in (row..(row + size).min(side))
            .flat_map(|r| (column..(column + size).min(side)).map(move |c| (r, c)))
        {
            z[cell.0 * side + cell.1] += height_m;
        }
    }
    if random.random_bool(0.3) {
        z[random.random_range(0..side * side)] = f64::NAN;
    }
    Terrain::new(grid, &z).unwrap()
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
            either_way: false,
            tolerance_m: if random.random_bool(0.3) { 1.6 } else { 0.0 },
        },
        settings: Settings { reverse: random.random_bool(0.3), ..Settings::of(robot) },
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        exact_ends: false,
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

/// Samples on a side of a square, or along a radius and a turn, of the means below.
const SAMPLES: usize = 40;

/// The ground under a robot by the definition: the mean over the disc that its wheels go round, of bilinear heights; `None`
/// where some of it is not known [m].
pub(crate) fn mean_under_m(terrain: &Terrain, robot: &Robot, cell: Cell) -> Option<f64> {
    let [x, y] = terrain.grid.center_m(cell);
    let radius_m = robot.wheelbase_m.hypot(robot.track_m) / 2.0;
    let mut sum_m = 0.0;
    for i in 0..SAMPLES {
        // Rings of equal area.
        let r = radius_m * ((i as f64 + 0.5) / SAMPLES as f64).sqrt();
        for j in 0..4 * SAMPLES {
            let (sin, cos) = (std::f64::consts::TAU * (j as f64 + 0.5) / (4 * SAMPLES) as f64).sin_cos();
            sum_m += terrain.elevation_at_m(x + r * cos, y + r * sin)?;
        }
    }
    Some(sum_m / (4 * SAMPLES * SAMPLES) as f64)
}

/// The same between cell centres: bilinear.
pub(crate) fn standing_m(terrain: &Terrain, robot: &Robot, x_m: f64, y_m: f64) -> Option<f64> {
    let grid = &terrain.grid;
    let at = |v: f64, origin: f64| ((v - origin) / grid.cell_size_m - 0.5 + 1e-9).max(0.0);
    let (column, row) = (at(x_m, grid.origin_m[0]), at(y_m, grid.origin_m[1]));
    let mut sum_m = 0.0;
    for (dr, by_row) in [(0, 1.0 - row.fract()), (1, row.fract())] {
        for (dc, by_column) in [(0, 1.0 - column.fract()), (1, column.fract())] {
            if by_row * by_column > 1e-6 {
                let cell = Cell { row: row as usize + dr, column: column as usize + dc };
                sum_m += by_row * by_column * mean_under_m(terrain, robot, cell)?;
            }
        }
    }
    Some(sum_m)
}

/// Grades along and to the left of a robot on four wheels, from the mean ground under each; `None` where some is not known.
pub(crate) fn wheel_grades(
    terrain: &Terrain,
    robot: &Robot,
    cell: Cell,
    heading_rad: f64,
) -> Option<(f64, f64)> {
    let [x, y] = terrain.grid.center_m(cell);
    let (sin, cos) = heading_rad.sin_cos();
    let (half_a, half_b) = (robot.wheelbase_m / 2.0, robot.track_m / 2.0);
    let wheel_m = |front: f64, left: f64| {
        let offset_m = |n: usize| robot.wheel_radius_m * ((n as f64 + 0.5) / SAMPLES as f64 - 0.5);
        let mut sum_m = 0.0;
        for i in 0..SAMPLES {
            for j in 0..SAMPLES {
                let (ahead, aside) = (front * half_a + offset_m(i), left * half_b + offset_m(j));
                sum_m +=
                    terrain.elevation_at_m(x + ahead * cos - aside * sin, y + ahead * sin + aside * cos)?;
            }
        }
        Some(sum_m / (SAMPLES * SAMPLES) as f64)
    };
    let [fl, fr, rl, rr] =
        [wheel_m(1.0, 1.0)?, wheel_m(1.0, -1.0)?, wheel_m(-1.0, 1.0)?, wheel_m(-1.0, -1.0)?];
    Some(((fl + fr - rl - rr) / (4.0 * half_a), (fl + rl - fr - rr) / (4.0 * half_b)))
}
