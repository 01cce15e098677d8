//! One plan across a map in a process of its own with nothing at hand, then the same again, and what each took, as JSON.
//!
//!     cargo run --release -p joulepath-bench --example from_nothing -- maps/minnesota.tif 1000 1.01
//!
//! The map is a GeoTIFF mirrored to a side in cells, or `hills`, `steep`, `level`, `obstacles` or `areas`; the last argument is the bound. CPU time is that of all threads since the
//! process began, from Linux; elsewhere it is null.

use std::{error::Error, fs, time::Instant};

use model::builtin;
use planner::{Goal, Objective, Patience, Planner, Query, Settings, Start};
use serde_json::json;
use terrain::{Grid, Terrain, areas::Areas, io, synthetic};

fn main() -> Result<(), Box<dyn Error>> {
    let began = Instant::now();
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [map, side, bound] = &arguments[..] else {
        return Err(
            "three arguments are needed: a GeoTIFF or hills, a side in cells, a bound such as 1.05".into()
        );
    };
    let (side, bound): (usize, f64) = (side.parse()?, bound.parse()?);
    let terrain = ground(map, side)?;
    let robot = builtin::husky_a200();
    let query = across(&terrain, Settings::of(&robot), bound);
    let planner = Planner::new(&terrain, &robot, query.settings)?;
    for plan in ["nothing at hand", "everything at hand"] {
        let (wall, cpu_before_s) = (Instant::now(), cpu_s());
        let found = planner.plan(&query, Objective::Energy)?;
        let plan_ms = wall.elapsed().as_secs_f64() * 1e3;
        let report = json!({
            "plan": plan,
            "cells_per_side": side,
            "bound": bound,
            "proven": found.search.bound,
            "energy_j": found.route.total.energy_j,
            "expanded": found.search.expanded,
            "plan_ms": plan_ms,
            "plan_cpu_s": cpu_s().zip(cpu_before_s).map(|(after_s, before_s)| after_s - before_s),
            "process_s": began.elapsed().as_secs_f64(),
            "process_cpu_s": cpu_s(),
            "peak_mb": peak_mb(),
        });
        println!("{report}");
    }
    Ok(())
}

/// The ground of a name, or of a file.
fn ground(name: &str, side: usize) -> Result<Terrain, Box<dyn Error>> {
    const SEED: u64 = 7;
    let grid = Grid { rows: side, columns: side, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let hills = |longest_m, height_m| Terrain::new(grid, &synthetic::relief(grid, SEED, longest_m, height_m));
    let level = || Terrain::new(grid, &vec![0.0; grid.cells()]);
    Ok(match name {
        "hills" => hills(120.0, 10.0)?,
        "steep" => hills(60.0, 22.0)?,
        "level" => level()?,
        "obstacles" => synthetic::scatter_obstacles(level()?, SEED, 0.05),
        "areas" => with_areas(level()?)?,
        file => synthetic::mirrored(&io::geotiff::read(&fs::read(file)?, Terrain::MAX_CELLS)?, side, side)?,
    })
}

/// Every other one of 25 squares costs twice as much.
fn with_areas(terrain: Terrain) -> Result<Terrain, Box<dyn Error>> {
    let square = |i: usize| {
        let at =
            |x: f64, y: f64| terrain.grid.at_fraction_m((i % 5) as f64 / 5.0 + x, (i / 5) as f64 / 5.0 + y);
        let corners = [at(0.0, 0.0), at(0.18, 0.0), at(0.18, 0.18), at(0.0, 0.18), at(0.0, 0.0)];
        json!({
            "type": "Feature",
            "geometry": { "type": "Polygon", "coordinates": [corners] },
            "properties": { "cost_factor": 2.0 },
        })
    };
    let features: Vec<_> = (0..25).step_by(2).map(square).collect();
    let areas = Areas::of(&json!({ "type": "FeatureCollection", "features": features }), &terrain)?;
    Ok(terrain.with_areas(areas))
}

/// Corner to corner, clear of the edges.
fn across(terrain: &Terrain, settings: Settings, bound: f64) -> Query {
    let [x_m, y_m] = terrain.grid.at_fraction_m(0.1, 0.12);
    let [goal_x_m, goal_y_m] = terrain.grid.at_fraction_m(0.9, 0.88);
    Query {
        start: Start { x_m, y_m, heading_rad: None },
        goal: Goal { x_m: goal_x_m, y_m: goal_y_m, heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings,
        other_goals: Vec::new(),
        snap_radius_m: Some(10.0 * terrain.grid.cell_size_m),
        bound,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    }
}

/// CPU time of this process's threads [s]; those of the planner live as long as it does.
fn cpu_s() -> Option<f64> {
    let ran_ns = |task: fs::DirEntry| -> Option<u64> {
        fs::read_to_string(task.path().join("schedstat")).ok()?.split_whitespace().next()?.parse().ok()
    };
    let ns: Option<u64> = fs::read_dir("/proc/self/task").ok()?.map(|task| ran_ns(task.ok()?)).sum();
    ns.map(|ns| ns as f64 * 1e-9)
}

/// Most memory that this process ever held [MB].
fn peak_mb() -> Option<f64> {
    let status = fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<f64>().ok()? / 1024.0)
}
