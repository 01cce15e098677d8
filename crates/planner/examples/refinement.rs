//! How much energy refinement takes off the lattice's energy-minimal paths, and how long it takes, over seeded pairs.
//!
//!     cargo run --release -p joulepath-planner --example refinement [-- MAP [PAIRS [SEED]]]

use std::{error::Error, path::PathBuf, time::Instant};

use model::builtin;
use planner::{Lattice, Objective, Patience, Refined, Route, Settings, plan, refine};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use terrain::io;

/// Times each route is refined.
const RUNS: usize = 5;

mod pairs;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let map = arguments.next().unwrap_or_else(|| "maps/minnesota.tif".into());
    let pairs: usize = arguments.next().map_or(Ok(20), |n| n.parse())?;
    let seed: u64 = arguments.next().map_or(Ok(1), |n| n.parse())?;
    let terrain = io::read_path(&PathBuf::from(&map))?;
    let robot = builtin::husky_a200();
    let settings = Settings::of(&robot);
    let lattice = Lattice::new(&terrain, &robot, settings)?;
    println!("{map}, {}, {pairs} pairs, seed {seed}\n", robot.name);
    println!(
        "{:>4} {:>7} {:>10} {:>12} {:>7} {:>9} {:>9} {:>9} {:>9}",
        "pair", "motions", "E* [kJ]", "refined [kJ]", "gained", "turns*", "turns", "links", "time"
    );
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let (mut gains, mut times_ms) = (Vec::new(), Vec::new());
    while gains.len() < pairs {
        let query = pairs::random_query(&mut random, &terrain, settings);
        let Ok(found) = plan(&terrain, &robot, &query, Objective::Energy) else { continue };
        let (route, time_ms) =
            timed(|| refine(&lattice, Objective::Energy, &found.route, &Patience::default()));
        let (lattice_j, refined_j) = (found.route.total.energy_j, route.total.energy_j);
        let gain = (lattice_j - refined_j) / lattice_j.abs();
        println!(
            "{:>4} {:>7} {:>10.3} {:>12.3} {:>5.2} % {:>5.1} rad {:>5.1} rad {:>9} {time_ms:>6.1} ms",
            gains.len() + 1,
            found.route.edges.len(),
            lattice_j / 1e3,
            refined_j / 1e3,
            100.0 * gain,
            turned_rad(&found.route),
            turned_rad(&route),
            route.edges.len(),
        );
        gains.push(gain);
        times_ms.push(time_ms);
    }
    println!(
        "\nmedian gain {:.2} %, median time {:.1} ms, longest {:.1} ms",
        100.0 * median(&mut gains),
        median(&mut times_ms),
        times_ms.last().copied().unwrap_or_default()
    );
    Ok(())
}

/// The refined route and the least time of several runs, which other load on the machine disturbs least [ms].
fn timed(refined: impl Fn() -> Refined) -> (Route, f64) {
    let run = || {
        let began = Instant::now();
        let route = refined().route;
        (route, began.elapsed().as_secs_f64() * 1e3)
    };
    (0..RUNS - 1).map(|_| run()).fold(run(), |best, next| if next.1 < best.1 { next } else { best })
}

/// Sum of all changes of heading, whichever way.
fn turned_rad(route: &Route) -> f64 {
    route.steps.iter().map(|step| (step.motion.yaw_rate_radps * step.duration_s).abs()).sum()
}

/// Sorts and takes the middle.
fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    (values[(values.len() - 1) / 2] + values[values.len() / 2]) / 2.0
}
