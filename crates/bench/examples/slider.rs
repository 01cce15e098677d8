//! What a change of speed, payload, standing load or surface takes on a map that was planned over before, as JSON.
//!
//!     cargo run --release -p joulepath-bench --example slider -- maps/minnesota.tif 1000 1.05 [1]
//!
//! The map is a GeoTIFF mirrored to a side in cells; then comes the bound, and that of the plan before the change, 1 where it is not
//! given. Each change is a planner of its own that knows of the first one, as the service keeps it. CPU time is that of all threads, from Linux; elsewhere it is null. Bytes are what the planner holds of costs,
//! fields and memory to search in.

use std::{error::Error, fs, sync::Arc, time::Instant};

use model::{Robot, builtin};
use planner::{Goal, Objective, Patience, Planner, Query, Settings, Start};
use serde_json::json;
use terrain::{Terrain, io, synthetic};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (map, side, bound, before) = match &arguments[..] {
        [map, side, bound] => (map, side, bound, "1"),
        [map, side, bound, before] => (map, side, bound, before.as_str()),
        _ => {
            return Err(
                "arguments: a GeoTIFF, a side in cells, a bound such as 1.05, the bound before".into()
            );
        }
    };
    let (side, bound, before): (usize, f64, f64) = (side.parse()?, bound.parse()?, before.parse()?);
    let tile = io::geotiff::read(&fs::read(map)?, Terrain::MAX_CELLS)?;
    let terrain = synthetic::mirrored(&tile, side, side)?;
    let robot = builtin::by_name("husky-a200-field")?;
    let usual = Settings::of(&robot);
    let first = Arc::new(Planner::new(&terrain, &robot, usual)?);
    first.plan(&across(&terrain, usual, before), Objective::Energy)?;
    let faster = Settings { speed_mps: 1.1 * usual.speed_mps, ..usual };
    let changes: [(&str, Robot, Settings); 4] = [
        ("speed", robot.clone(), faster),
        ("payload", Robot { mass_kg: robot.mass_kg + 10.0, ..robot.clone() }, usual),
        ("standing load", Robot { hotel_power_w: robot.hotel_power_w + 20.0, ..robot.clone() }, usual),
        ("surface", Robot { default_surface: "marble".into(), ..builtin::husky_a200() }, usual),
    ];
    for (change, robot, settings) in changes {
        let (wall, before_s) = (Instant::now(), cpu_s());
        let planner = Arc::new(Planner::new(&terrain, &robot, settings)?);
        planner.relate(&first);
        let prepared_ms = wall.elapsed().as_secs_f64() * 1e3;
        let found = planner.plan(&across(&terrain, settings, bound), Objective::Energy)?;
        println!(
            "{}",
            json!({
                "change": change,
                "prepared_ms": prepared_ms,
                "ms": wall.elapsed().as_secs_f64() * 1e3,
                "cpu_ms": cpu_s().zip(before_s).map(|(after_s, before_s)| 1e3 * (after_s - before_s)),
                "mb": planner.bytes() as f64 / 1e6,
                "expanded": found.search.expanded,
                "energy_j": found.route.total.energy_j,
                "bound": found.search.bound,
            })
        );
    }
    Ok(())
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
