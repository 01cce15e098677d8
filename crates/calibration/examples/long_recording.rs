//! Memory and time that a recording takes which does not fit in memory:
//! `cargo run --release -p joulepath-calibration --example long_recording [ROWS]`.
//!
//! Writes a CSV file of drives at 1 kHz into the folder for temporary files (5 GB without an argument), reads it, predicts its power
//! and fits a robot to it, and removes it.

#![allow(clippy::unwrap_used)]

use std::{
    fs::File,
    io::{BufWriter, Write},
    path::Path,
    time::Instant,
};

use calibration::{Drives, Options, calibrate, power, predict};
use model::{Robot, builtin};
use recording::{Channel, PowerForm, Recording, Run};

/// Rows of a run: 1000 s.
const RUN_ROWS: usize = 1_000_000;
/// With eight numbers a row 6 · 10⁸, more than 2²⁹.
const ROWS: usize = 75_000_000;
const CHANNELS: [Channel; 6] = [
    Channel::LeftSpeed,
    Channel::RightSpeed,
    Channel::YawRate,
    Channel::Pitch,
    Channel::LeftPower,
    Channel::RightPower,
];

/// One run with the power that a robot draws.
fn run(robot: &Robot) -> Recording {
    let wave = |period_s: f64, i: usize| (i as f64 * 1e-3 / period_s).sin();
    let column = |of: &dyn Fn(usize) -> f64| (0..RUN_ROWS).map(of).collect::<Vec<f64>>();
    let turn = |i: usize| 0.25 * wave(3.1, i);
    let inputs = [
        column(&|i| 0.4 * wave(9.7, i) - turn(i)),
        column(&|i| 0.4 * wave(9.7, i) + turn(i)),
        column(&|i| 2.0 * turn(i) / 0.7),
        column(&|i| 0.1 * wave(21.1, i)),
        vec![0.0; RUN_ROWS],
        vec![0.0; RUN_ROWS],
    ];
    let mut recording = Recording {
        t_s: column(&|i| i as f64 * 1e-3),
        channels: CHANNELS.into_iter().zip(inputs).collect(),
        runs: vec![Run { name: "run".into(), rows: 0..RUN_ROWS, gap_s: 0.003, start_unix_s: None }],
        ..Recording::default()
    };
    let drives = Drives::new(robot, &recording).unwrap();
    let seen =
        |i: usize, power: &model::Power| power::seen_w(robot, PowerForm::Sides, &drives.rows[i], power);
    let watts = power::by_row(&drives, robot, seen).unwrap();
    for (side, channel) in [Channel::LeftPower, Channel::RightPower].into_iter().enumerate() {
        let noisy = |(i, w): (usize, &[f64; 2])| w[side] + 3.0 * wave(0.000_37, i);
        recording.channels.insert(channel, watts.iter().enumerate().map(noisy).collect());
    }
    recording
}

fn write(path: &Path, rows: usize, robot: &Robot) {
    let run = run(robot);
    let lines: Vec<String> = (0..RUN_ROWS)
        .map(|i| {
            let cells = CHANNELS.map(|channel| format!("{:.4}", run.channels[&channel][i]));
            format!("{:.3},{}", run.t_s[i], cells.join(","))
        })
        .collect();
    let mut file = BufWriter::with_capacity(1 << 20, File::create(path).unwrap());
    let names = CHANNELS.map(Channel::name).join(",");
    writeln!(file, "run,t_s,{names}").unwrap();
    for row in 0..rows {
        writeln!(file, "{},{}", row / RUN_ROWS, lines[row % RUN_ROWS]).unwrap();
    }
    file.flush().unwrap();
}

/// Peak memory of this process since it was last asked to forget it.
fn peak_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse::<f64>().ok()).map_or(f64::NAN, |kb| kb / 1024.0)
}

fn main() {
    let rows = std::env::args().nth(1).map_or(ROWS, |rows| rows.parse().unwrap());
    let mut truth = builtin::husky_a200();
    let marble = truth.surfaces.get_mut("marble").unwrap();
    (marble.mu_roll, marble.mu_skid) = (0.07, 0.32);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("long.csv");
    write(&path, rows, &truth);
    // Writing held a whole run at once; what counts is what reading takes.
    let _ = std::fs::write("/proc/self/clear_refs", "5");
    let gigabytes = std::fs::metadata(&path).unwrap().len() as f64 / 1e9;
    println!("{rows} rows of 8 columns, {gigabytes:.1} GB; peak memory {:.0} MB before", peak_mb());

    let told = |what: &str, began: Instant| {
        println!("{what:<10} {:>6.0} s, peak memory {:.0} MB", began.elapsed().as_secs_f64(), peak_mb());
    };
    let began = Instant::now();
    let reading = recording::read_path(&path, None).unwrap();
    told("read", began);
    reading.report.repairs.iter().for_each(|repair| println!("  {}: {}", repair.place, repair.what));
    let began = Instant::now();
    let total = predict(&truth, &reading.recording).unwrap().prediction.total;
    told("predict", began);
    println!(
        "  {} rows, bias {:.2} W, recorded {:.1} kJ, predicted {:.1} kJ by the robot that was driven",
        total.rows,
        total.bias_w,
        total.recorded_j / 1e3,
        total.predicted_j / 1e3
    );
    let began = Instant::now();
    let found = calibrate(&builtin::husky_a200(), &reading.recording, &Options::default()).unwrap();
    told("calibrate", began);
    for parameter in found.parameters.iter().filter(|p| p.name.contains("marble.mu")) {
        println!("  {} {:.4}, driven with 0.07 and 0.32", parameter.name, parameter.value);
    }
}
