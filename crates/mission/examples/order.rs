//! What a mission of twelve waypoints takes beside its matrix, and how much of it the order.
//!
//!     cargo run --release -p joulepath-mission --example order [-- MAP [SEED]]

use std::{error::Error, path::PathBuf, time::Instant};

use mission::{Doubt, MissionQuestion, Site, mission};
use model::builtin;
use planner::{Objective, Patience, Planner, Settings};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use routing::Waypoint;
use terrain::io;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let map = arguments.next().unwrap_or_else(|| "maps/minnesota.tif".into());
    let seed: u64 = arguments.next().map_or(Ok(1), |n| n.parse())?;
    let terrain = io::read_path(&PathBuf::from(&map))?;
    let robot = builtin::husky_a200();
    let planner = Planner::new(&terrain, &robot, Settings::of(&robot))?;
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let mut places = Vec::new();
    while places.len() < 13 {
        let [x_m, y_m] =
            terrain.grid.at_fraction_m(random.random_range(0.05..0.95), random.random_range(0.05..0.95));
        let place = Waypoint { x_m, y_m, heading_rad: None };
        if routing::matrix(&planner, &[place], &[place], &routing::Question::default()).is_ok() {
            places.push(place);
        }
    }
    let question = MissionQuestion {
        start: places[0],
        waypoints: places[1..].iter().map(|place| Site { place: *place, stops: Vec::new() }).collect(),
        chargers: Vec::new(),
        in_order: false,
        back: true,
        deadline_s: f64::INFINITY,
        charge: 1.0,
        ambient_c: 20.0,
        doubt: Doubt::default(),
        samples: 1000,
        seed: 1,
        snap_radius_m: None,
        patience: Patience::default(),
    };
    let ms = |began: Instant| began.elapsed().as_secs_f64() * 1e3;
    let began = Instant::now();
    let asked = routing::Question { objective: Objective::Energy, ..Default::default() };
    routing::matrix(&planner, &places, &places, &asked)?;
    println!("matrix of 13 × 13 places in {:.0} ms", ms(began));
    let began = Instant::now();
    let found = mission(&planner, &question)?;
    println!(
        "mission in {:.0} ms, of which its order took {:.1} ms: ways take {:.2} kJ, none less than {:.2} kJ; feasible: {}, success {:.1} %",
        ms(began),
        found.order_time.as_secs_f64() * 1e3,
        found.ways_j / 1e3,
        found.bound_j / 1e3,
        found.feasible,
        100.0 * found.likely.success_probability
    );
    Ok(())
}
