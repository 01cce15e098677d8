//! What the energy-minimal path saves against the shortest one, over seeded pairs, for three grounds and two standing loads.
//!
//!     cargo run --release -p joulepath-tests --example savings_by_ground [-- PAIRS [SEED]]

use std::error::Error;

use joulepath_tests::file;
use model::{Robot, builtin, data_sheet::GroundSheet};
use planner::{Settings, compare};
use rand::SeedableRng;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use terrain::{Terrain, io};

#[path = "../../crates/planner/examples/pairs/mod.rs"]
mod pairs;

/// The map of the demo: real ground whose surface it does not name.
const MAP: &str = "maps/minnesota.tif";
/// The robot as it drives in the field.
const ROBOT: &str = "husky-a200-field";
/// Ground as measured under a Husky A200: hard and smooth, hard and rough, soft.
const GROUNDS: [&str; 3] = ["marble", "asphalt", "sandy_loam"];
/// Nothing, and the field robot's electronics \[W\].
const STANDING_LOADS_W: [f64; 2] = [0.0, 60.0];

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let pairs: usize = arguments.next().map_or(Ok(20), |n| n.parse())?;
    let seed: u64 = arguments.next().map_or(Ok(7), |n| n.parse())?;
    let terrain = io::read_path(&file(MAP))?;
    let field = builtin::by_name(ROBOT)?;
    println!("{MAP}, {ROBOT}, {pairs} pairs, seed {seed}\n");
    println!(
        "{:<12} {:>13} {:>14} {:>22} {:>12}",
        "ground", "standing load", "median saving", "middle half of pairs", "cheaper on"
    );
    for ground in GROUNDS {
        let (surface, _) = GroundSheet::Known(ground.to_owned()).surface()?;
        for standing_load_w in STANDING_LOADS_W {
            let mut robot = field.clone();
            robot.surfaces.insert(ground.to_owned(), surface.clone());
            robot.default_surface = ground.to_owned();
            robot.hotel_power_w = standing_load_w;
            let savings = savings(&terrain, &robot, pairs, seed);
            let at = |share: f64| 100.0 * savings[((savings.len() - 1) as f64 * share).round() as usize];
            let better = savings.iter().filter(|saving| **saving > 0.0).count();
            println!(
                "{ground:<12} {standing_load_w:>11.0} W {:>12.1} % {:>8.1} % to {:>6.1} % {better:>6} of {pairs}",
                at(0.5),
                at(0.25),
                at(0.75)
            );
        }
    }
    Ok(())
}

/// Savings of so many pairs that a path joins, as shares of the shortest path's energy, in rising order.
fn savings(terrain: &Terrain, robot: &Robot, pairs: usize, seed: u64) -> Vec<f64> {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut found = Vec::new();
    while found.len() < pairs {
        let queries: Vec<_> =
            (0..pairs).map(|_| pairs::random_query(&mut random, terrain, Settings::of(robot))).collect();
        let compared: Vec<Option<f64>> = queries
            .par_iter()
            .map(|query| Some(compare(terrain, robot, query).ok()?.saving_fraction()))
            .collect();
        found.extend(compared.into_iter().flatten());
    }
    found.truncate(pairs);
    found.sort_by(f64::total_cmp);
    found
}
