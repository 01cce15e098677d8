//! What a matrix between random places of a map takes, and how many of its entries hold a path.
//!
//!     cargo run --release -p joulepath-routing --example matrix [-- MAP [PLACES [SEED]]]

use std::{error::Error, path::PathBuf, time::Instant};

use model::builtin;
use planner::{Planner, Settings};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use routing::{Question, Waypoint, matrix};
use terrain::io;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let map = arguments.next().unwrap_or_else(|| "maps/minnesota.tif".into());
    let places: usize = arguments.next().map_or(Ok(20), |n| n.parse())?;
    let seed: u64 = arguments.next().map_or(Ok(1), |n| n.parse())?;
    let terrain = io::read_path(&PathBuf::from(&map))?;
    let robot = builtin::husky_a200();
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut waypoints = Vec::new();
    let planner = Planner::new(&terrain, &robot, Settings::of(&robot))?;
    while waypoints.len() < places {
        let [x_m, y_m] =
            terrain.grid.at_fraction_m(random.random_range(0.02..0.98), random.random_range(0.02..0.98));
        let one = [Waypoint { x_m, y_m, heading_rad: None }];
        // Places where the robot cannot stand are drawn again.
        if matrix(&planner, &one, &one, &Question::default()).is_ok() {
            waypoints.extend(one);
        }
    }
    for (state, planner) in
        [("cold", Planner::new(&terrain, &robot, Settings::of(&robot))?), ("warm", planner)]
    {
        let began = Instant::now();
        let found = matrix(&planner, &waypoints, &waypoints, &Question::default())?;
        let taken_s = began.elapsed().as_secs_f64();
        let paths = found.energy_j.iter().flatten().flatten().count();
        println!(
            "{map}: {places} × {places} {state} in {taken_s:.2} s, {paths} of {} entries with a path",
            places * places
        );
    }
    Ok(())
}
