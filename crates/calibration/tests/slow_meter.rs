//! A power meter that is slower than the wheels is compared over its own period, wherever its stamps stand in it.

#![allow(clippy::unwrap_used)]

use std::fmt::Write as _;

use calibration::{Calibration, Method, Options, meter::Placement, predict};
use model::{Robot, builtin};
use recording::{Channel, Format, Recording, read};

mod simulated;
use simulated::{drives, seeded, with_battery_power};

/// Rows of the wheels in a period of the meter: 10 Hz beside 0.5 Hz.
const PERIOD: usize = 20;

/// A Husky on ground that takes more than its file says.
fn truth() -> Robot {
    let mut robot = builtin::husky_a200();
    let ground = robot.surfaces.get_mut(&robot.default_surface).unwrap();
    ground.mu_roll *= 1.3;
    ground.mu_skid *= 1.25;
    robot
}

fn driven() -> Recording {
    let mut random = seeded(17);
    let plain = drives(&mut random, 4, 1200);
    with_battery_power(&truth(), plain, &mut random)
}

/// What a log has whose meter reads at the ends, the middles or the beginnings of its periods, or single moments.
fn logged(recording: &Recording, placement: Placement) -> Vec<u8> {
    let column = |channel| recording.channel(channel).unwrap();
    let power_w = column(Channel::Power);
    let mut text = String::from("run,t_s,v_left_mps,v_right_mps,pitch_rad,power_w\n");
    for run in &recording.runs {
        for row in run.rows.clone() {
            let place = (row - run.rows.start) % PERIOD;
            let start = row - place;
            let mean_w = power_w[start..start + PERIOD].iter().sum::<f64>() / PERIOD as f64;
            let (at, reading_w) = match placement {
                Placement::Before => (PERIOD - 1, mean_w),
                Placement::Around => (PERIOD / 2 - 1, mean_w),
                Placement::After => (0, mean_w),
                Placement::Moment => (PERIOD - 1, power_w[row]),
            };
            let power = if place == at { reading_w.to_string() } else { String::new() };
            let [left, right, pitch] =
                [Channel::LeftSpeed, Channel::RightSpeed, Channel::Pitch].map(|channel| column(channel)[row]);
            let (name, t_s) = (&run.name, recording.t_s[row]);
            writeln!(text, "{name},{t_s:.1},{left},{right},{pitch},{power}").unwrap();
        }
    }
    text.into_bytes()
}

fn read_back(placement: Placement) -> Recording {
    read(logged(&driven(), placement), Format::Csv, "drive.csv", None).unwrap().recording
}

fn calibrated(recording: &Recording) -> Calibration {
    Method::Fit.calibrate(&builtin::husky_a200(), recording, &Options::default()).unwrap()
}

/// How far fitted skid friction is from the true one, as a share, and whether that lies in its interval.
fn error_of(found: &Calibration) -> (f64, bool) {
    let robot = truth();
    let truth = robot.surfaces[&robot.default_surface].mu_skid;
    let skid = found.parameters.iter().find(|parameter| parameter.name.ends_with("mu_skid")).unwrap();
    let [low, high] = skid.interval_95.unwrap();
    ((skid.value / truth - 1.0).abs(), low <= truth && truth <= high)
}

/// The same readings beside what the wheels did in the moment of the stamp alone.
fn by_moments(recording: &Recording) -> Recording {
    let mut thin = Recording::default();
    for run in &recording.runs {
        let start = thin.t_s.len();
        for row in run.rows.clone().filter(|row| recording.reading_ends[*row]) {
            thin.t_s.push(recording.t_s[row]);
            for (channel, values) in &recording.channels {
                thin.channels.entry(*channel).or_default().push(values[row]);
            }
        }
        let rows = start..thin.t_s.len();
        thin.runs.push(recording::Run { rows, gap_s: 6.0, ..run.clone() });
    }
    thin
}

#[test]
fn friction_by_means_over_two_seconds_is_right_and_nearer_than_by_moments() {
    let recording = read_back(Placement::Before);
    let (error, is_covered) = error_of(&calibrated(&recording));
    let (by_moments, _) = error_of(&calibrated(&by_moments(&recording)));
    assert!(is_covered && error < 0.03, "{error}");
    assert!(error < 0.5 * by_moments, "{error} against {by_moments}");
}

#[test]
fn where_stamps_stand_in_their_period_is_found_and_said() {
    for placement in Placement::ALL {
        let recording = read_back(placement);
        let found = calibrated(&recording);
        let (error, is_covered) = error_of(&found);
        assert!(is_covered && error < 0.05, "{placement:?}: {error}");
        let said = found.notes.iter().find(|note| note.contains("power meter")).unwrap();
        assert!(said.contains(placement.words()), "{placement:?}: {said}");
    }
}

#[test]
fn energy_and_coverage_of_a_slow_meter_are_those_of_the_drive() {
    let full = predict(&truth(), &driven()).unwrap().prediction;
    let slow = predict(&truth(), &read_back(Placement::Before)).unwrap().prediction;
    assert!((slow.total.recorded_j / full.total.recorded_j - 1.0).abs() < 0.01, "{:?}", slow.total);
    assert!((slow.total.predicted_j / full.total.predicted_j - 1.0).abs() < 0.01, "{:?}", slow.total);
    assert!(slow.total.coverage.words().is_none(), "{:?}", slow.total.coverage);
    assert!(slow.total.r2.unwrap() > 0.9 && slow.total.rmse_w < full.total.rmse_w, "{:?}", slow.total);
    assert!(slow.notes[0].contains("slower than the wheels"));
}
