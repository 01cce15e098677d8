//! Whatever little drives tell, a calibration holds the rest at the robot file and writes a robot that can be.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::path::PathBuf;

use calibration::{Calibration, Error, Options, calibrate};
use model::{Robot, builtin};
use proptest::prelude::*;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use recording::{Channel, Labels, Recording};

mod simulated;
use simulated::{
    drives, seeded, with_battery_power, with_power,
    worlds::{current_truth, file, truth, with_currents},
};

/// Some rows of every run, and what may be wrong with them.
fn mangled(mut recording: Recording, random: &mut Pcg64Mcg) -> Recording {
    let mut runs = recording.runs.clone();
    for run in &mut runs {
        let rows = run.rows.len();
        let length = random.random_range(3..rows.clamp(4, 300));
        let start = run.rows.start + random.random_range(0..rows - length);
        run.rows = start..start + length;
    }
    recording.runs = runs;
    let all = recording.rows();
    let left = recording.channels[&Channel::LeftSpeed].clone();
    match random.random_range(0..7) {
        0 => drop(recording.channels.insert(Channel::RightSpeed, left)),
        1 => drop(recording.channels.remove(&Channel::Pitch)),
        2 => drop(recording.channels.insert(Channel::Pitch, vec![0.02; all])),
        3 => {
            for side in [Channel::RightMotorCurrent, Channel::RightPower] {
                if let Some(values) = recording.channels.get_mut(&side) {
                    values[all / 3..].fill(f64::NAN);
                }
            }
        }
        4 => {
            for side in [Channel::LeftMotorCurrent, Channel::LeftPower, Channel::Power] {
                if let Some(values) = recording.channels.get_mut(&side) {
                    values.fill(0.0);
                }
            }
        }
        5 => {
            // Slopes that have nothing to do with the drive.
            let pitch_rad = (0..all).map(|_| random.random_range(-0.1..0.1)).collect();
            recording.channels.insert(Channel::Pitch, pitch_rad);
        }
        _ => {}
    }
    if random.random() {
        let name = ["marble", "moss"][random.random_range(0..2)];
        recording.surface = Some(Labels::constant(name, all));
    }
    recording.of_runs(|_| true)
}

fn robot_of(random: &mut Pcg64Mcg, file: Robot) -> Robot {
    let mut robot = file;
    let share = [0.0, 1e-9, 0.1, 1.0][random.random_range(0..4)];
    let u = &mut robot.uncertainty;
    (u.mu_roll, u.mu_skid, u.k1, u.k2) = (share, share, share, share);
    if random.random() {
        let force_n_per_a = Some(10f64.powf(random.random_range(0.5..2.0)));
        robot.motors.left.force_n_per_a = force_n_per_a;
        robot.motors.right.force_n_per_a = force_n_per_a;
    }
    robot
}

/// Drives may tell nothing at all; what is written is a robot, and what is not determined is the file's.
fn assert_possible(robot: &Robot, recording: &Recording) {
    let found: Calibration = match calibrate(robot, recording, &Options::default()) {
        Ok(found) => found,
        Err(Error::Robot(error)) => panic!("no fit makes a robot that cannot be: {error}"),
        Err(Error::NothingToFit { .. } | Error::TooFewRuns { .. }) => return,
        Err(other) => panic!("{other}"),
    };
    let written = serde_json::to_string(&found.robot).unwrap();
    Robot::from_json(&written).unwrap_or_else(|error| panic!("{error} in {written}"));
    let before = serde_json::to_value(robot).unwrap();
    for p in &found.parameters {
        assert!(p.value.is_finite(), "{p:?}");
        let known = before.pointer(&format!("/{}", p.name.replace('.', "/")));
        if let Some(known) = known.and_then(serde_json::Value::as_f64).filter(|_| !p.determined) {
            // A search begins a little within limits.
            assert!((p.value - known).abs() <= 1e-3 * known.abs().max(0.02), "{p:?} is held at {known}");
        }
    }
}

fn world(random: &mut Pcg64Mcg) -> (Robot, Recording) {
    let plain = {
        let runs = random.random_range(1..4);
        drives(random, runs, 310)
    };
    match random.random_range(0..3) {
        0 => {
            let truth = truth(random);
            (file(), with_power(&truth, plain, random))
        }
        1 => {
            let truth = truth(random);
            (file(), with_battery_power(&truth, plain, random))
        }
        _ => {
            let truth = current_truth(random);
            (builtin::husky_a200(), with_currents(&truth, plain, random))
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]
    #[test]
    fn pieces_of_simulated_drives_give_a_robot_or_say_that_they_tell_nothing(seed in any::<u64>()) {
        let mut random = seeded(seed);
        let (file, recording) = world(&mut random);
        let recording = mangled(recording, &mut random);
        assert_possible(&robot_of(&mut random, file), &recording);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn pieces_of_real_drives_give_a_robot_or_say_that_they_tell_nothing(seed in any::<u64>()) {
        let mut random = seeded(seed);
        let surface = ["flooring", "sandy-loam", "ice", "asphalt", "snow"][random.random_range(0..5)];
        let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings");
        let folder = std::env::var_os("JOULEPATH_RECORDINGS").map_or(beside, PathBuf::from);
        let path = folder.join(format!("husky-{surface}.csv"));
        if path.exists() {
            let (mut recording, _) = recording::read_paths(&[path], None).unwrap();
            let most = random.random_range(1..4);
            recording.runs.truncate(most);
            let recording = mangled(recording, &mut random);
            assert_possible(&robot_of(&mut random, builtin::husky_a200()), &recording);
        }
    }
}
