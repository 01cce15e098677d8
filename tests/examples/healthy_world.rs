//! How well the model describes healthy drives of the independent world, before and after calibration.
//!
//! `cargo run --release -p joulepath-tests --example healthy_world`

#![allow(clippy::unwrap_used)]

use calibration::{Drives, Options, calibrate, predict};
use recording::read_path;
use world::{Drive, DriveKind, RobotFile, World, simulate};

fn main() {
    let robot = model::builtin::husky_a200();
    let file = RobotFile::from_json(&serde_json::to_string(&robot).unwrap()).unwrap();
    for (kind, grade) in [
        (DriveKind::Rich, 0.0),
        (DriveKind::Rich, 0.02),
        (DriveKind::Rich, 0.04),
        (DriveKind::LawnMower, 0.03),
        (DriveKind::StopAndGo, 0.02),
        (DriveKind::Hill, 0.04),
    ] {
        let sensors = std::env::args().nth(1).unwrap_or_default();
        let text = format!(r#"{{"terrain": {{"rolling": {{"grade": {grade}}}}}, "seed": 3 {sensors}}}"#);
        let drive = Drive { runs: 6, ..Drive::new(kind, 300.0, 5) };
        let log = simulate(&World::from_json(&text).unwrap(), &file, &drive).unwrap();
        let path = std::env::temp_dir().join(format!("joulepath-healthy-{}.csv", std::process::id()));
        log.write_csv(std::fs::File::create(&path).unwrap()).unwrap();
        let recording = read_path(&path, None).unwrap().recording;
        std::fs::remove_file(&path).unwrap();
        let before = predict(&robot, &recording).unwrap();
        let found = calibrate(&robot, &recording, &Options::default()).unwrap();
        let after = predict(&found.robot, &recording).unwrap();
        let held_out = found.held_out.clone().unwrap();
        let mean_w = before.prediction.total.recorded_j / (300.0 * 6.0);
        println!(
            "{kind:?} grade {grade}: mean {mean_w:.1} W; file R² {:.4} RMSE {:.2} bias {:.2} W; fitted R² {:.4} RMSE {:.2} bias {:.2} W; held out 1 s R² {:.4} RMSE {:.2} W",
            before.prediction.total.r2.unwrap(),
            before.prediction.total.rmse_w,
            before.prediction.total.bias_w,
            after.prediction.total.r2.unwrap(),
            after.prediction.total.rmse_w,
            after.prediction.total.bias_w,
            held_out.r2,
            held_out.rmse_w
        );
        for p in &found.parameters {
            print!("  {} {:.4};", p.name, p.value);
        }
        println!();
        regimes(&after.drives, &after.predicted_w, &after.recorded_w);
    }
}

/// Mean error by kind of motion.
fn regimes(drives: &Drives, predicted_w: &[f64], recorded_w: &[f64]) {
    let mut sums = std::collections::BTreeMap::<String, [f64; 4]>::new();
    for (i, row) in drives.rows.iter().enumerate().filter(|(_, row)| row.used) {
        let (v, d) = (row.speed_mps(), row.difference_mps() / 0.55);
        let radius = (v / d).abs();
        let steady = row.rim_mps2.left.abs() < 0.1 && row.rim_mps2.right.abs() < 0.1;
        let turn = if row.stands() {
            "stand"
        } else if d.abs() < 0.05 {
            "straight"
        } else if radius < 0.1 {
            "spin"
        } else if radius < 0.35 {
            "tight"
        } else if radius < 1.0 {
            "arc"
        } else {
            "wide"
        };
        let speed = if v.abs() < 0.3 { "slow" } else { "fast" };
        let side = if row.roll_rad.abs() < 0.025 { "level" } else { "aside" };
        let entry = sums
            .entry(if steady { format!("{turn:8} {speed} {side}") } else { "changing".into() })
            .or_default();
        let error = predicted_w[i] - recorded_w[i];
        *entry = [entry[0] + 1.0, entry[1] + recorded_w[i], entry[2] + error, entry[3] + error * error];
    }
    let mut normal = [[0.0; 3]; 2];
    for (i, row) in drives.rows.iter().enumerate().filter(|(_, row)| row.used) {
        let a = row.acceleration(0.55);
        let (v, d) = (row.speed_mps(), row.difference_mps() / 0.55);
        let (x, y) = (90.0 * v * a.forward_mps2, 5.0 * d * a.yaw_radps2);
        let e = recorded_w[i] - predicted_w[i];
        normal[0] = [normal[0][0] + x * x, normal[0][1] + x * y, normal[0][2] + x * e];
        normal[1] = [normal[1][0] + x * y, normal[1][1] + y * y, normal[1][2] + y * e];
    }
    let det = normal[0][0] * normal[1][1] - normal[0][1].powi(2);
    println!(
        "    more per kinetic power: forward {:.3}, turning {:.3}",
        (normal[0][2] * normal[1][1] - normal[1][2] * normal[0][1]) / det,
        (normal[1][2] * normal[0][0] - normal[0][2] * normal[0][1]) / det
    );
    for (name, [n, p, e, e2]) in sums {
        println!(
            "    {name}: {n:5} rows, {:6.1} W, error {:+6.2} W, RMSE {:5.2} W",
            p / n,
            e / n,
            (e2 / n).sqrt()
        );
    }
}
