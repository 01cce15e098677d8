//! How much faster than real time a drive is simulated, and where its energy went.
//!
//! `cargo run --release -p joulepath-world --example world_speed`

use std::time::Instant;

use world::{Drive, DriveKind, Error, World, example_robot, simulate_closely};

fn main() -> Result<(), Error> {
    let duration_s = 3600.0;
    for (name, world) in [
        ("level", r#"{"terrain": "level"}"#),
        ("rolling", r#"{"terrain": {"rolling": {"grade": 0.05}}}"#),
        (
            "three effects",
            r#"{"terrain": {"rolling": {"grade": 0.05}}, "effects": [{"effect": "wind", "strength": 8},
            {"effect": "motor_heating", "strength": 1}, {"effect": "puddles", "strength": 100}]}"#,
        ),
    ] {
        let world = World::from_json(world)?;
        let started = Instant::now();
        let simulation =
            simulate_closely(&world, &example_robot(), &Drive::new(DriveKind::Rich, duration_s, 1))?;
        let factor = duration_s / started.elapsed().as_secs_f64();
        let ledger = simulation.ledger;
        println!("{name}: {factor:.0} times real time, {} rows", simulation.log.rows.len());
        println!("  {ledger:?}, missing {:.2} %", 100.0 * (1.0 - ledger.spent_j() / ledger.given_j));
    }
    Ok(())
}
