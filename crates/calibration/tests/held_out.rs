//! What a calibration says of its skill is what `predict` finds of the robot files that it writes.

#![allow(clippy::unwrap_used)]

use std::path::PathBuf;

use calibration::{Calibration, Options, Skill, calibrate, predict};
use model::{Robot, builtin};
use recording::{Channel, Recording};

mod simulated;
use simulated::{
    drives, over_two_grounds, seeded, with_battery_power, with_power,
    worlds::{current_truth, file, truth, with_currents},
};

fn assert_alike(said: f64, found: f64, what: &str) {
    assert!((said - found).abs() <= 1e-9 * found.abs().max(1e-9), "{what}: {said} is said, {found} is found");
}

fn assert_same(said: &Skill, robot: &Robot, recording: &Recording) {
    let found = predict(robot, recording).unwrap().prediction.total;
    assert_eq!(said.rows, found.rows);
    assert_alike(said.rmse_w, found.rmse_w, "rmse_w");
    assert_alike(said.bias_w, found.bias_w, "bias_w");
    assert_eq!((said.r2.is_some(), said.r2_a.is_some()), (found.r2.is_some(), found.r2_a.is_some()));
    for (said, found, what) in
        [(said.r2, found.r2, "r2"), (said.r2_a, found.r2_a, "r2_a"), (said.rmse_a, found.rmse_a, "rmse_a")]
    {
        assert_alike(said.unwrap_or(0.0), found.unwrap_or(0.0), what);
    }
}

/// Every figure of a calibration is that of a file: of the one that it writes, and of those that halves of the runs give.
fn assert_honest(robot: &Robot, recording: &Recording) -> Calibration {
    let found = calibrate(robot, recording, &Options::default()).unwrap();
    // What is read again is what was written.
    let text = serde_json::to_string(&found.robot).unwrap();
    let written = Robot::from_json(&text).unwrap();
    assert_same(found.as_written.as_ref().unwrap(), &written, recording);
    let held_out = found.held_out.as_ref().unwrap();
    assert_eq!(held_out.folds.len(), 2);
    for fold in &held_out.folds {
        let part = |names: &[String]| recording.of_runs(|run| names.contains(&run.name));
        // A single run of currents is not calibrated on by itself.
        let Ok(half) = calibrate(robot, &part(&fold.fitted_runs), &Options::default()) else {
            assert!(fold.fitted_runs.len() == 1);
            continue;
        };
        assert_same(&fold.skill, &half.robot, &part(&fold.judged_runs));
    }
    let squares = held_out.folds.iter().map(|fold| fold.skill.rows as f64 * fold.skill.rmse_w.powi(2));
    let rows: usize = held_out.folds.iter().map(|fold| fold.skill.rows).sum();
    assert_alike(held_out.rmse_w, (squares.sum::<f64>() / rows as f64).sqrt(), "rmse_w of both halves");
    found
}

#[test]
fn power_of_both_sides_is_predicted_as_well_as_is_said() {
    let mut random = seeded(901);
    let truth = truth(&mut random);
    let plain = over_two_grounds(drives(&mut random, 8, 200), ["marble", "sandy_loam"]);
    // Every half drives on both.
    let mut plain = plain;
    plain
        .surface
        .as_mut()
        .unwrap()
        .index
        .iter_mut()
        .enumerate()
        .for_each(|(row, at)| *at = (row / 100 % 2) as u32);
    let recording = with_power(&truth, plain, &mut random);
    let found = assert_honest(&file(), &recording);
    assert_eq!(found.held_out.unwrap().surfaces.len(), 2);
}

#[test]
fn power_of_the_battery_is_predicted_as_well_as_is_said() {
    let mut random = seeded(902);
    let mut truth = truth(&mut random);
    truth.hotel_power_w = 45.0;
    let plain = drives(&mut random, 6, 200);
    let mut recording = with_battery_power(&truth, plain, &mut random);
    let found = assert_honest(&file(), &recording);
    assert!(found.robot.hotel_power_w > 20.0, "its hotel load is in the file");
    let power_w = recording.channels.remove(&Channel::Power).unwrap();
    recording.channels.insert(Channel::Current, power_w.iter().map(|w| w / 25.0).collect());
    recording.channels.insert(Channel::Voltage, vec![25.0; power_w.len()]);
    assert_honest(&file(), &recording);
}

#[test]
fn currents_are_predicted_as_well_as_is_said_although_they_have_what_no_file_holds() {
    let mut random = seeded(903);
    let truth = current_truth(&mut random);
    let plain = drives(&mut random, 8, 200);
    let recording = with_currents(&truth, plain, &mut random);
    let found = assert_honest(&builtin::husky_a200(), &recording);
    assert!(
        found.robot.motors.left.idle_current_a.unwrap() > 0.1,
        "what meters read at standstill is in the file"
    );
}

#[test]
fn the_real_huskys_currents_are_predicted_as_well_as_is_said() {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings");
    let folder = std::env::var_os("JOULEPATH_RECORDINGS").map_or(beside, PathBuf::from);
    for surface in ["flooring", "sandy-loam", "ice", "asphalt"] {
        let file = folder.join(format!("husky-{surface}.csv"));
        if !file.exists() {
            eprintln!("SKIPPED: {} is not there", file.display());
            continue;
        }
        let (recording, _) = recording::read_paths(&[file], None).unwrap();
        assert_honest(&builtin::husky_a200(), &recording);
    }
}
