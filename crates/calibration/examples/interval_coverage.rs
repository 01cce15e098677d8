//! How often 95 % intervals hold the truth, parameter by parameter, in simulated recordings of robots that are known:
//! `cargo run --release -p joulepath-calibration --example interval_coverage [FIRST_SEED [TRIALS]]`.

#![allow(clippy::unwrap_used)]

#[path = "../tests/simulated/mod.rs"]
mod simulated;

use simulated::worlds::World;

/// Seeds that nothing was worked out on.
const FIRST_SEED: u64 = 9_000_000;

fn main() {
    let mut arguments = std::env::args().skip(1).map(|a| a.parse::<u64>().unwrap());
    let first = arguments.next().unwrap_or(FIRST_SEED);
    let trials = arguments.next().unwrap_or(100);
    println!("{trials} recordings each, seeds from {first} on");
    for world in World::ALL {
        let coverage = world.coverage(first..first + trials);
        println!("\n{world:?}: of what most recordings determine");
        println!("{:<40} determined  inside   share  mean (found - true)/σ  spread", "parameter");
        for (name, tally) in coverage.identifiable() {
            let n = tally.determined as f64;
            let mean = tally.sum / n;
            println!(
                "{name:<40} {:>10} {:>7} {:>5.0} % {mean:>22.2} {:>7.2}",
                tally.determined,
                tally.inside,
                100.0 * tally.inside as f64 / n,
                (tally.squares / n - mean * mean).sqrt()
            );
        }
    }
}
