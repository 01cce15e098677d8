//! What refining saves and takes on random pairs of a map, as JSON: a line for each pair and one for all.
//!
//!     cargo run --release -p joulepath-bench --example refined -- maps/minnesota.tif 1000 20
//!
//! The map is a GeoTIFF mirrored to a side in cells, the last argument the number of pairs. Pairs come from a fixed sequence, so that runs
//! of different builds can be compared pair by pair. Each pair is planned with everything at hand, without refining and with it. Times are
//! CPU times of the thread that asks, from Linux, which other work lengthens least; elsewhere they are times by the clock.

use std::{error::Error, fs, time::Instant};

use model::builtin;
use planner::{Goal, Objective, Patience, Planner, Query, Settings, Start};
use serde_json::json;
use terrain::{Terrain, io, synthetic};

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [map, side, pairs] = &arguments[..] else {
        return Err("three arguments are needed: a GeoTIFF, a side in cells, a number of pairs".into());
    };
    let (side, pairs): (usize, usize) = (side.parse()?, pairs.parse()?);
    let tile = io::geotiff::read(&fs::read(map)?, Terrain::MAX_CELLS)?;
    let terrain = synthetic::mirrored(&tile, side, side)?;
    let robot = builtin::husky_a200();
    let planner = Planner::new(&terrain, &robot, Settings::of(&robot))?;
    let (mut planned, mut lattice_j, mut refined_j, mut refine_ms) = (0, 0.0, 0.0, Vec::new());
    for pair in 0..pairs {
        let plan = |refine: bool| {
            let query = Query { refine, ..between(&terrain, &robot, pair) };
            let (began, began_s) = (Instant::now(), cpu_s());
            let found = planner.plan(&query, Objective::Energy)?;
            let by_clock_s = began.elapsed().as_secs_f64();
            let ms = 1e3 * cpu_s().zip(began_s).map_or(by_clock_s, |(ended_s, began_s)| ended_s - began_s);
            let energy_j = found.best_route().total.energy_j;
            Ok::<_, planner::Error>((energy_j, ms))
        };
        // The first plan leaves everything at hand.
        if let Err(error) = plan(false) {
            println!("{}", json!({"pair": pair, "error": error.to_string()}));
            continue;
        }
        let ((coarse_j, coarse_ms), (fine_j, fine_ms)) = (plan(false)?, plan(true)?);
        println!(
            "{}",
            json!({"pair": pair, "lattice_j": coarse_j, "refined_j": fine_j, "lattice_ms": coarse_ms, "refined_ms": fine_ms})
        );
        (planned, lattice_j, refined_j) = (planned + 1, lattice_j + coarse_j, refined_j + fine_j);
        refine_ms.push(fine_ms - coarse_ms);
    }
    refine_ms.sort_by(f64::total_cmp);
    println!(
        "{}",
        json!({
            "planned": planned,
            "lattice_j": lattice_j,
            "refined_j": refined_j,
            "saved": 1.0 - refined_j / lattice_j,
            "refine_median_ms": refine_ms.get(refine_ms.len() / 2),
            "refine_most_ms": refine_ms.last(),
        })
    );
    Ok(())
}

/// CPU time of the first thread, which refines; what it shares out among others is at hand by then [s].
fn cpu_s() -> Option<f64> {
    let ran_ns: u64 =
        fs::read_to_string("/proc/self/schedstat").ok()?.split_whitespace().next()?.parse().ok()?;
    Some(ran_ns as f64 * 1e-9)
}

/// A pair of places of the fixed sequence, clear of the edges; the first is from corner to corner.
fn between(terrain: &Terrain, robot: &model::Robot, pair: usize) -> Query {
    // Weyl sequences: multiples of irrational numbers, of which the fractions fill a range evenly.
    let fraction = |irrational: f64| 0.1 + 0.8 * (pair as f64 * irrational).fract();
    let [x_m, y_m] =
        terrain.grid.at_fraction_m(fraction(std::f64::consts::SQRT_2), fraction(std::f64::consts::E));
    let goal = match pair {
        0 => [0.9, 0.88],
        _ => [fraction(std::f64::consts::PI), fraction(std::f64::consts::LN_2)],
    };
    let [goal_x_m, goal_y_m] = terrain.grid.at_fraction_m(goal[0], goal[1]);
    Query {
        start: Start { x_m, y_m, heading_rad: None },
        goal: Goal { x_m: goal_x_m, y_m: goal_y_m, heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings: Settings::of(robot),
        other_goals: Vec::new(),
        snap_radius_m: Some(10.0 * terrain.grid.cell_size_m),
        bound: 1.05,
        refine: true,
        exact_ends: false,
        patience: Patience::default(),
    }
}
