//! How much energy the energy-minimal path saves against the shortest one, over seeded pairs on a map.
//!
//!     cargo run --release -p joulepath-planner --example savings [-- MAP [PAIRS [SEED]]]

use std::{error::Error, path::PathBuf, time::Instant};

use model::builtin;
use planner::{Comparison, Settings, compare};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use terrain::io;

mod pairs;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let map = arguments.next().unwrap_or_else(|| "maps/minnesota.tif".into());
    let pairs: usize = arguments.next().map_or(Ok(10), |n| n.parse())?;
    let seed: u64 = arguments.next().map_or(Ok(1), |n| n.parse())?;
    let terrain = io::read_path(&PathBuf::from(&map))?;
    let robot = builtin::husky_a200();
    println!("{map}, {}, {pairs} pairs, seed {seed}\n", robot.name);
    println!(
        "{:>4} {:>9} {:>9} {:>9} {:>9} {:>8} {:>8}",
        "pair", "E* [kJ]", "E(d) [kJ]", "d* [m]", "d(E) [m]", "saved", "time"
    );
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut savings = Vec::new();
    let mut asked = 0;
    while savings.len() < pairs {
        asked += 1;
        let query = pairs::random_query(&mut random, &terrain, Settings::of(&robot));
        let began = Instant::now();
        let Ok(both) = compare(&terrain, &robot, &query) else { continue };
        savings.push(both.saving_fraction());
        print_pair(savings.len(), &both, began.elapsed().as_secs_f64());
    }
    savings.sort_by(f64::total_cmp);
    let median = (savings[(pairs - 1) / 2] + savings[pairs / 2]) / 2.0;
    let better = savings.iter().filter(|s| **s > 0.0).count();
    println!(
        "\nmedian saving {:.1} %, cheaper on {better} of {pairs}; {} pairs drawn had no path or blocked ends",
        100.0 * median,
        asked - pairs
    );
    Ok(())
}

fn print_pair(number: usize, both: &Comparison, seconds: f64) {
    let (e, d) = (&both.energy.route.total, &both.distance.route.total);
    println!(
        "{number:>4} {:>9.2} {:>9.2} {:>9.1} {:>9.1} {:>6.1} % {seconds:>6.2} s",
        e.energy_j / 1e3,
        d.energy_j / 1e3,
        d.length_m,
        e.length_m,
        100.0 * both.saving_fraction()
    );
}
