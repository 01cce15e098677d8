//! Lidar ground: the optimum of a reference search, and memory that follows the search instead of the map.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::Path;

use model::builtin;
use petgraph::{algo::dijkstra, graph::NodeIndex};
use planner::{Goal, Heading, Objective, Patience, Planner, Query, Settings, Start, State};
use rand::RngExt;
use terrain::{Cell, Grid, Terrain, io, synthetic};

mod ground;

fn lidar() -> Terrain {
    io::read_path(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../maps/minnesota.tif")).unwrap()
}

/// A square piece of the ground.
fn tile(terrain: &Terrain, south_west: Cell, side: usize) -> Terrain {
    let grid = Grid { rows: side, columns: side, ..terrain.grid };
    let at = |i: usize| Cell { row: south_west.row + i / side, column: south_west.column + i % side };
    let z: Vec<f64> = (0..side * side).map(|i| terrain.elevation_m(at(i)).unwrap_or(f64::NAN)).collect();
    Terrain::new(grid, &z).unwrap()
}

fn query(terrain: &Terrain, ends: [[f64; 2]; 2], settings: Settings) -> Query {
    let [start, goal] = ends.map(|[east, north]| terrain.grid.at_fraction_m(east, north));
    Query {
        start: Start { x_m: start[0], y_m: start[1], heading_rad: None },
        goal: Goal { x_m: goal[0], y_m: goal[1], heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings,
        other_goals: Vec::new(),
        snap_radius_m: Some(0.0),
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    }
}

#[test]
fn on_twenty_lidar_tiles_the_plan_is_the_optimum_of_petgraphs_dijkstra() {
    let (map, robot) = (lidar(), builtin::husky_a200());
    let mut random = ground::random(60);
    let mut compared = 0;
    while compared < 20 {
        // Five by four overlapping windows of 200 cells.
        let south_west = Cell { row: compared / 5 * 66, column: compared % 5 * 50 };
        let terrain = tile(&map, south_west, 200);
        let ends = [[0.1, 0.1], [0.9, 0.9]].map(|[east, north]: [f64; 2]| {
            [east + random.random_range(-0.08..0.08), north + random.random_range(-0.08..0.08)]
        });
        let planner = Planner::new(&terrain, &robot, Settings::of(&robot)).unwrap();
        let lattice = planner.lattice();
        let Ok(found) = planner.plan(&query(&terrain, ends, lattice.settings), Objective::Energy) else {
            continue;
        };
        compared += 1;
        let table = planner.table(Objective::Energy);
        let graph = ground::table_graph(lattice, table);
        let [start, goal] = ends.map(|[east, north]| {
            let [x_m, y_m] = terrain.grid.at_fraction_m(east, north);
            terrain.grid.cell_at(x_m, y_m).unwrap()
        });
        let standing = |cell: Cell| {
            let poses = Heading::all().map(move |heading| State { cell, heading });
            poses.filter(|state| lattice.stand(*state).is_ok()).collect::<Vec<_>>()
        };
        // One source before all starts.
        let mut graph = graph;
        let source = graph.add_node(());
        for state in standing(start) {
            graph.add_edge(source, NodeIndex::new(lattice.index(state)), 0.0);
        }
        let reached = dijkstra(&graph, source, None, |edge| *edge.weight());
        let best = standing(goal)
            .iter()
            .filter_map(|state| reached.get(&NodeIndex::new(lattice.index(*state))))
            .copied()
            .fold(f64::INFINITY, f64::min);
        let lifted_j = lattice.potential_j(goal) - lattice.potential_j(start);
        let cost_j = found.route.total.energy_j - lifted_j;
        // The table's costs are rounded up, the route's are not.
        assert!(cost_j <= best * (1.0 + 1e-6) + 0.1, "tile {compared}: {cost_j} J, the best is {best} J");
        assert!(cost_j >= best * (1.0 - 1.5e-3), "tile {compared}: {cost_j} J beats the best, {best} J");
    }
}

#[test]
fn memory_follows_the_search_and_not_the_map() {
    let (side, robot) = (2400, builtin::husky_a200());
    let grid = Grid { rows: side, columns: side, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let terrain = Terrain::new(grid, &synthetic::relief(grid, 4, 200.0, 12.0)).unwrap();
    let planner = Planner::new(&terrain, &robot, Settings::of(&robot)).unwrap();
    let found = planner
        .plan(&query(&terrain, [[0.48, 0.49], [0.53, 0.52]], planner.lattice().settings), Objective::Energy);
    assert!(found.unwrap().search.is_optimal());
    let tiles = (side / 64) * (side / 64);
    let held = planner.table(Objective::Energy).tiles_held();
    assert!(held * 20 < tiles, "{held} of {tiles} tiles are held for a path across a twentieth of the map");
}
