//! What a diagnosis of a long recording takes: `cargo run --release -p joulepath-tests --example long_diagnosis -- [ROWS]`.

#![allow(clippy::unwrap_used)]

#[path = "../shared/logs.rs"]
mod logs;

use std::time::Instant;

use diagnosis::{Question, diagnose};
use logs::read_back;
use model::Robot;
use recording::Recording;
use world::{Drive, DriveKind, Effect, EffectName, RobotFile, World, simulate};

/// Rows of a second.
const RATE_HZ: f64 = 10.0;
/// Healthy driving beside the rest, as a share of it.
const HEALTHY: f64 = 0.3;

fn main() {
    let rows: f64 = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(100_000.0);
    let duration_s = rows / RATE_HZ;
    let load = Effect { onset_s: duration_s / 2.0, ..Effect::new(EffectName::Payload, 6.0) };
    let suspect = record(13, vec![load], duration_s);
    let healthy = record(14, vec![], HEALTHY * duration_s);
    let robot = model::builtin::husky_a200();
    let before = joulepath_tests::peak_memory_bytes("self").map_or(f64::NAN, |bytes| bytes as f64 / 1e6);
    let began = Instant::now();
    let found = diagnose(&Question::new(&robot, &suspect, Some(&healthy)), &|name, share| {
        if std::env::args().nth(2).is_some() {
            eprintln!("{:6.2} s {share:4.2} {name}", began.elapsed().as_secs_f64());
        }
    })
    .unwrap();
    println!(
        "{} rows beside {} healthy ones: {:.1} s, {:.0} MB at most ({before:.0} MB to make the drives)",
        suspect.rows(),
        healthy.rows(),
        began.elapsed().as_secs_f64(),
        joulepath_tests::peak_memory_bytes("self").map_or(f64::NAN, |bytes| bytes as f64 / 1e6)
    );
    println!("{}: {}", found.verdict, found.sentence);
}

fn record(seed: u64, effects: Vec<Effect>, duration_s: f64) -> Recording {
    let text = format!(r#"{{"terrain": {{"rolling": {{"grade": 0.04}}}}, "seed": {seed}, "robot_seed": 5}}"#);
    let world = World { effects, ..World::from_json(&text).unwrap() };
    let robot: Robot = model::builtin::husky_a200();
    let file = RobotFile::from_json(&serde_json::to_string(&robot).unwrap()).unwrap();
    read_back(&simulate(&world, &file, &Drive::new(DriveKind::Rich, duration_s, seed)).unwrap()).recording
}
