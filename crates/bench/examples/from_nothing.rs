//! One plan across a map in a process of its own, and what it took.
//!
//!     cargo run --release -p joulepath-bench --example from_nothing -- MAP.tif SIDE BOUND

use std::{error::Error, time::Instant};

use model::builtin;
use planner::{Goal, Objective, Patience, Planner, Query, Settings, Start};
use terrain::{Terrain, io, synthetic};

fn cpu_s() -> f64 {
    let mut ns = 0u64;
    for task in std::fs::read_dir("/proc/self/task").into_iter().flatten().flatten() {
        let text = std::fs::read_to_string(task.path().join("schedstat")).unwrap_or_default();
        ns += text.split_whitespace().next().and_then(|n| n.parse::<u64>().ok()).unwrap_or(0);
    }
    ns as f64 * 1e-9
}

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [map, side, bound] = &arguments[..] else { return Err("MAP SIDE BOUND".into()) };
    let (side, bound): (usize, f64) = (side.parse()?, bound.parse()?);
    let tile = io::geotiff::read(&std::fs::read(map)?, Terrain::MAX_CELLS)?;
    let terrain = synthetic::mirrored(&tile, side, side)?;
    println!("map {:.3} s CPU", cpu_s());
    let robot = builtin::husky_a200();
    let place = |x: f64, y: f64| terrain.grid.at_fraction_m(x, y);
    let ([sx, sy], [gx, gy]) = (place(0.1, 0.12), place(0.9, 0.88));
    let query = Query {
        start: Start { x_m: sx, y_m: sy, heading_rad: None },
        goal: Goal { x_m: gx, y_m: gy, heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings: Settings::of(&robot),
        other_goals: Vec::new(),
        snap_radius_m: Some(10.0),
        bound,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    };
    let (began, cpu) = (Instant::now(), cpu_s());
    let planner = Planner::new(&terrain, &robot, query.settings)?;
    for what in ["cold", "warm"] {
        let found = planner.plan(&query, Objective::Energy)?;
        println!(
            "{what} {:.3} s CPU {:.3} s wall: {:.4} kJ, {} expanded, {:?} proven, {} tiles, {:.0} MB",
            cpu_s() - cpu,
            began.elapsed().as_secs_f64(),
            found.route.total.energy_j / 1e3,
            found.search.expanded,
            found.search.bound,
            planner.table(Objective::Energy).tiles_held(),
            planner.bytes() as f64 / 1e6,
        );
    }
    let status = std::fs::read_to_string("/proc/self/status")?;
    println!("{} total {:.3} s CPU", status.lines().find(|l| l.starts_with("VmHWM")).unwrap_or(""), cpu_s());
    Ok(())
}
