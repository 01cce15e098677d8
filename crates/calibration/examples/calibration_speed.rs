//! How long predicting and calibrating take: `cargo run --release -p joulepath-calibration --example calibration_speed`.

#![allow(clippy::unwrap_used)]

use std::{collections::BTreeMap, time::Instant};

use calibration::{Options, calibrate, predict};
use model::builtin;
use recording::{Channel, Recording, Run};

/// Rows of a recording at 10 Hz, in runs of 1000 s.
fn recording(rows: usize) -> Recording {
    let run_rows = (rows / 4).min(10_000);
    let t_s: Vec<f64> = (0..rows).map(|i| (i % run_rows) as f64 * 0.1).collect();
    let wave = |period: f64| move |i: usize| (i as f64 / period).sin();
    let column = |f: &dyn Fn(usize) -> f64| (0..rows).map(f).collect::<Vec<f64>>();
    let (slow, fast, hill) = (wave(97.0), wave(31.0), wave(211.0));
    let channels = BTreeMap::from([
        (Channel::LeftSpeed, column(&|i| 0.4 * slow(i) - 0.25 * fast(i))),
        (Channel::RightSpeed, column(&|i| 0.4 * slow(i) + 0.25 * fast(i))),
        (Channel::YawRate, column(&|i| 0.5 * fast(i) / 0.7)),
        (Channel::Pitch, column(&|i| 0.1 * hill(i))),
        (Channel::LeftPower, vec![0.0; rows]),
        (Channel::RightPower, vec![0.0; rows]),
    ]);
    let runs = (0..rows / run_rows)
        .map(|run| Run {
            name: format!("run-{run:04}"),
            rows: run * run_rows..(run + 1) * run_rows,
            gap_s: 0.5,
            start_unix_s: None,
        })
        .collect();
    let mut recording = Recording { t_s, channels, runs, ..Recording::default() };
    let robot = builtin::husky_a200();
    let watts = predict(&robot, &recording).unwrap().predicted_w;
    for (channel, share) in [(Channel::LeftPower, 0.52), (Channel::RightPower, 0.48)] {
        let noise = wave(0.37);
        recording
            .channels
            .insert(channel, watts.iter().enumerate().map(|(i, w)| share * w + 3.0 * noise(i)).collect());
    }
    recording
}

/// The same drives with motor currents for powers.
fn with_currents(mut recording: Recording) -> Recording {
    for (power, current) in
        [(Channel::LeftPower, Channel::LeftMotorCurrent), (Channel::RightPower, Channel::RightMotorCurrent)]
    {
        // About the voltage of a Husky: it makes currents of a likely size, and nothing more is asked of them.
        let watts = recording.channels.remove(&power).unwrap();
        recording.channels.insert(current, watts.iter().map(|w| w / 24.0).collect());
    }
    recording
}

fn peak_mb() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|l| l.split_whitespace().next()?.parse::<f64>().ok()).map_or(f64::NAN, |kb| kb / 1024.0)
}

fn main() {
    let robot = builtin::husky_a200();
    for rows in [10_000, 1_000_000] {
        let recording = recording(rows);
        let mut times_s = [0.0; 9];
        for time_s in &mut times_s {
            let began = Instant::now();
            let predicted = predict(&robot, &recording).unwrap();
            *time_s = began.elapsed().as_secs_f64();
            drop(predicted);
        }
        times_s.sort_by(f64::total_cmp);
        println!("predict   {rows:>8} rows: {:.3} s, middle of {}", times_s[4], times_s.len());
        time_calibration("", &recording);
        time_calibration("by motor currents", &with_currents(recording));
    }
}

fn time_calibration(label: &str, recording: &Recording) {
    let began = Instant::now();
    calibrate(&builtin::husky_a200(), recording, &Options::default()).unwrap();
    println!(
        "calibrate {:>8} rows: {:.3} s, peak {:.0} MB {label}",
        recording.rows(),
        began.elapsed().as_secs_f64(),
        peak_mb()
    );
}
