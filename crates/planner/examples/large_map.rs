//! Plans across two kilometres of a seeded map of ten by ten, and prints what that takes.
//!
//!     cargo run --release -p joulepath-planner --example large_map [-- SIDE [METRES]]

use std::{error::Error, time::Instant};

use model::builtin;
use planner::{Goal, Objective, Patience, Planner, Query, Settings, Start};
use terrain::{Grid, Terrain, synthetic};

const SEED: u64 = 11;
/// Hills of this length and height, as in gentle farmland.
const HILLS_M: (f64, f64) = (400.0, 25.0);

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let side: usize = arguments.next().map_or(Ok(10_000), |n| n.parse())?;
    let across_m: f64 = arguments.next().map_or(Ok(2000.0), |n| n.parse())?;
    let grid = Grid { rows: side, columns: side, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let began = Instant::now();
    let terrain = Terrain::new(grid, &synthetic::relief(grid, SEED, HILLS_M.0, HILLS_M.1))?;
    println!("map        {side} × {side} cells of 1 m, made in {:.1} s", began.elapsed().as_secs_f64());
    let robot = builtin::husky_a200();
    let began = Instant::now();
    let planner = Planner::new(&terrain, &robot, Settings::of(&robot))?;
    println!("planner    {:.0} ms", began.elapsed().as_secs_f64() * 1e3);
    let middle_m = side as f64 / 2.0;
    // Three to four to five.
    let query = Query {
        start: Start { x_m: middle_m - 0.4 * across_m, y_m: middle_m - 0.3 * across_m, heading_rad: None },
        goal: Goal {
            x_m: middle_m + 0.4 * across_m,
            y_m: middle_m + 0.3 * across_m,
            heading_rad: None,
            either_way: false,
            tolerance_m: 0.0,
        },
        settings: Settings::of(&robot),
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    };
    for what in ["plan", "again"] {
        let began = Instant::now();
        let found = planner.plan(&query, Objective::Energy)?;
        println!(
            "{what:<10} {:.1} kJ over {:.0} m, {} states expanded, {:.2} s",
            found.route.total.energy_j / 1e3,
            found.route.total.length_m,
            found.search.expanded,
            began.elapsed().as_secs_f64()
        );
    }
    println!("costs      {:.2} GB held", planner.table(Objective::Energy).bytes() as f64 / 1e9);
    if let Some(peak_bytes) = peak_memory_bytes() {
        println!("memory     {:.2} GB at most, the making of the map included", peak_bytes as f64 / 1e9);
    }
    Ok(())
}

/// Most memory this process ever held, where the system tells.
fn peak_memory_bytes() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(line.split_whitespace().nth(1)?.parse::<u64>().ok()? * 1024)
}
