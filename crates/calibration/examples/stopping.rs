//! The longest stretches of work between two looks at the watch, of predictions and calibrations of a long recording.
//!
//!     RAYON_NUM_THREADS=1 cargo run --release -p joulepath-calibration --example stopping -- [ROWS]
//!
//! Prints where the work went on after each stretch of more than 20 ms.

#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::{
    backtrace::Backtrace,
    ops::ControlFlow,
    sync::{Arc, Mutex},
    time::{Duration, Instant},
};

use calibration::{Method, Options, predict_watched};
use model::builtin;
use recording::{Channel, Format, Recording, Watch, read};

/// A stretch without a look that is worth a line.
const LONG: Duration = Duration::from_millis(20);

/// A drive of weaving, stopping and turning at 10 Hz.
fn drive(rows: usize, heights: bool) -> Recording {
    let mut text = String::from("run,t_s,v_left_mps,v_right_mps,power_left_w,power_right_w,yaw_rate_radps,");
    text += if heights { "z_m\n" } else { "pitch_rad\n" };
    for row in 0..rows {
        let t = (row % (rows / 2)) as f64 * 0.1;
        let pause = f64::from(u8::from(row % 400 > 40));
        let (left, right) = (pause * (0.5 + 0.3 * t.sin()), pause * (0.5 + 0.3 * (t * 0.7).cos()));
        let noise = ((row * 7919) % 1000) as f64 / 1000.0 - 0.5;
        let power = [left, right].map(|v| 3.0 + 60.0 * v + 4.0 * noise);
        let last = if heights { 2.0 * (t * 0.02).sin() + 0.01 * noise } else { 0.05 * (t * 0.05).sin() };
        let run = row * 2 / rows;
        text += &format!(
            "{run},{t:.1},{left:.4},{right:.4},{:.3},{:.3},{:.4},{last:.4}\n",
            power[0],
            power[1],
            (right - left) / 0.9
        );
    }
    read(text.into_bytes(), Format::Csv, "long", None).unwrap().recording
}

/// Last look, and the longest stretches with the place where each ended.
type Seen = Arc<Mutex<(Instant, Vec<(Duration, String)>)>>;

fn timing() -> (Watch, Seen) {
    let seen: Seen = Arc::new(Mutex::new((Instant::now(), Vec::new())));
    let told = Arc::clone(&seen);
    let watch: Watch = Arc::new(move |_| {
        let mut seen = told.lock().unwrap();
        let passed = seen.0.elapsed();
        if passed > LONG {
            let trace = Backtrace::force_capture().to_string();
            let ours =
                trace.lines().filter(|line| line.contains("calibration") || line.contains("recording"));
            let place: Vec<&str> = ours.map(str::trim).take(4).collect();
            seen.1.push((passed, place.join(" < ")));
        }
        seen.0 = Instant::now();
        ControlFlow::Continue(())
    });
    (watch, seen)
}

fn report(name: &str, run: impl FnOnce(&Watch)) {
    let (watch, seen) = timing();
    let begun = Instant::now();
    run(&watch);
    let _ = watch(0);
    let mut seen = seen.lock().unwrap();
    println!(
        "{name}: {:.1} s in all, {} stretches above {LONG:?}",
        begun.elapsed().as_secs_f64(),
        seen.1.len()
    );
    seen.1.sort();
    for (passed, place) in seen.1.iter().rev().take(8) {
        println!("  {:6.1} ms until {place}", passed.as_secs_f64() * 1e3);
    }
}

fn main() {
    let rows = std::env::args().nth(1).and_then(|rows| rows.parse().ok()).unwrap_or(1_000_000);
    let robot = builtin::husky_a200();
    for heights in [false, true] {
        let recording = drive(rows, heights);
        report(&format!("predict, heights {heights}"), |watch| {
            predict_watched(&robot, &recording, watch).unwrap();
        });
        for method in [Method::Fit, Method::DogruMarques] {
            report(&format!("calibrate {method:?}, heights {heights}"), |watch| {
                let _ = method.calibrate_watched(&robot, &recording, &Options::default(), watch);
            });
        }
    }
    let mut currents = drive(rows, false);
    for (power, current) in
        [(Channel::LeftPower, Channel::LeftMotorCurrent), (Channel::RightPower, Channel::RightMotorCurrent)]
    {
        let watts = currents.channels.remove(&power).unwrap();
        currents.channels.insert(current, watts.into_iter().map(|w| w / 24.0).collect());
    }
    report("calibrate currents", |watch| {
        let _ = Method::Fit.calibrate_watched(&robot, &currents, &Options::default(), watch);
    });
}
