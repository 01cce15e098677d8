//! How well the model describes healthy drives of the independent world, before and after calibration.
//!
//! `cargo run --release -p joulepath-tests --example healthy_world`

#![allow(clippy::unwrap_used)]

#[path = "../shared/logs.rs"]
mod logs;

use std::collections::BTreeMap;

use calibration::{Options, PredictedDrives, RunPrediction, calibrate, predict};
use logs::read_back;
use model::Robot;
use recording::Recording;
use world::{Case, CaseKind, Drive, DriveKind, RobotFile, World, simulate};

fn main() {
    let robot = model::builtin::husky_a200();
    for (kind, grade) in [
        (DriveKind::Rich, 0.0),
        (DriveKind::Rich, 0.02),
        (DriveKind::Rich, 0.04),
        (DriveKind::LawnMower, 0.03),
        (DriveKind::StopAndGo, 0.02),
        (DriveKind::Hill, 0.04),
    ] {
        let text = format!(r#"{{"terrain": {{"rolling": {{"grade": {grade}}}}}, "seed": 3}}"#);
        let recording =
            record(&World::from_json(&text).unwrap(), &Drive { runs: 6, ..Drive::new(kind, 300.0, 5) });
        let found = calibrate(&robot, &recording, &Options::default()).unwrap();
        println!("{kind:?} on slopes of {grade} (root mean square)");
        say("  by the robot's file", &predict(&robot, &recording).unwrap().prediction.total);
        let after = predict(&found.robot, &recording).unwrap();
        say("  calibrated", &after.prediction.total);
        let held_out = found.held_out.unwrap();
        println!(
            "  held out, 1 s: R² {:.4}, RMSE {:.2} W",
            held_out.second_r2.unwrap(),
            held_out.second_rmse_w.unwrap()
        );
        regimes(&after);
    }
    let file = file(&robot);
    for seed in 0..8 {
        let case = Case::draw(seed, CaseKind::Healthy, 0.0, &file).unwrap();
        let reference = read_back(&case.reference(&file).unwrap()).recording;
        let recording = record(&case.world, &case.drive);
        let found = calibrate(&robot, &reference, &Options::default()).unwrap();
        println!("healthy case {seed}: {:?} on {:?}", case.drive.kind, case.world.terrain);
        say("  by the robot's file", &predict(&robot, &recording).unwrap().prediction.total);
        say("  calibrated on its reference", &predict(&found.robot, &recording).unwrap().prediction.total);
    }
}

fn file(robot: &Robot) -> RobotFile {
    RobotFile::from_json(&serde_json::to_string(robot).unwrap()).unwrap()
}

fn record(world: &World, drive: &Drive) -> Recording {
    read_back(&simulate(world, &file(&model::builtin::husky_a200()), drive).unwrap()).recording
}

fn say(what: &str, total: &RunPrediction) {
    let energy = 100.0 * (total.predicted_j / total.recorded_j - 1.0);
    let (r2, rmse_w) = (total.r2.unwrap_or(f64::NAN), total.rmse_w);
    println!("{what}: R² {r2:.4}, RMSE {rmse_w:.2} W, bias {:+.2} W, energy {energy:+.2} %", total.bias_w);
}

/// Mean error by kind of motion.
fn regimes(found: &PredictedDrives) {
    let mut sums = BTreeMap::<String, [f64; 4]>::new();
    for (i, row) in found.drives.rows.iter().enumerate().filter(|(_, row)| row.used) {
        let (speed_mps, yaw_radps) = (row.speed_mps(), row.difference_mps() / 0.55);
        let radius_m = (speed_mps / yaw_radps).abs();
        let turn = match () {
            () if row.rim_mps2.left.abs() > 0.1 || row.rim_mps2.right.abs() > 0.1 => "changing",
            () if row.stands() => "standing",
            () if yaw_radps.abs() < 0.05 => "straight",
            () if radius_m < 0.1 => "spin",
            () if radius_m < 0.35 => "tight arc",
            () if radius_m < 1.0 => "arc",
            () => "wide arc",
        };
        let tilt = if row.roll_rad.abs() < 0.025 { "level" } else { "across a slope" };
        let error_w = found.predicted_w[i] - found.recorded_w[i];
        let entry = sums.entry(format!("{turn}, {tilt}")).or_default();
        let seen = [1.0, found.recorded_w[i], error_w, error_w * error_w];
        entry.iter_mut().zip(seen).for_each(|(sum, value)| *sum += value);
    }
    for (name, [rows, power_w, error_w, square]) in sums {
        let (mean_w, off_w, rmse_w) = (power_w / rows, error_w / rows, (square / rows).sqrt());
        println!(
            "    {name:<26} {rows:6} rows of {mean_w:6.1} W: off by {off_w:+6.2} W, RMSE {rmse_w:5.2} W"
        );
    }
}
