//! What a thousand draws over a path of some five hundred poses take.
//!
//!     cargo run --release -p joulepath-mission --example draws [-- MAP]

use std::{error::Error, path::PathBuf, time::Instant};

use mission::{Conditions, Doubt, Drawn, Journey, draws};
use model::builtin;
use planner::{Goal, Objective, Patience, Planner, Query, Settings, Start};
use terrain::io;

fn main() -> Result<(), Box<dyn Error>> {
    let map = std::env::args().nth(1).unwrap_or_else(|| "maps/minnesota.tif".into());
    let terrain = io::read_path(&PathBuf::from(&map))?;
    let robot = builtin::husky_a200();
    let battery = robot.battery.ok_or("the robot has a battery")?;
    let planner = Planner::new(&terrain, &robot, Settings::of(&robot))?;
    let ([sx, sy], [gx, gy]) =
        (terrain.grid.at_fraction_m(0.08, 0.12), terrain.grid.at_fraction_m(0.9, 0.88));
    let query = Query {
        start: Start { x_m: sx, y_m: sy, heading_rad: None },
        goal: Goal { x_m: gx, y_m: gy, heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings: planner.lattice().settings,
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    };
    let route = planner.plan(&query, Objective::Energy)?.route;
    let mut journey = Journey::new(planner.lattice().settings.power_model);
    journey.drive(&robot, &route.steps, &planner::surface_names(planner.lattice()))?;
    let doubt = Doubt::default();
    let drawn = Drawn { robot: &robot, battery: &battery, charge: 1.0, doubt: &doubt, seed: 1 };
    let conditions = Conditions { ambient_c: 20.0, motor_c: 20.0, reserve: 0.2 };
    println!("{} poses, {:.1} m", route.poses.len(), route.total.length_m);
    for _ in 0..5 {
        let began = Instant::now();
        let outcomes = draws(&journey, &drawn, &conditions, 1000, &Patience::default())?;
        let mean_j = outcomes.iter().map(|o| o.energy_j).sum::<f64>() / outcomes.len() as f64;
        println!("1000 draws in {:.1} ms, mean {:.2} kJ", began.elapsed().as_secs_f64() * 1e3, mean_j / 1e3);
    }
    Ok(())
}
