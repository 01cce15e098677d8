//! The model holds in a world that shares no physics with it, as long as nothing is concealed there.

#![allow(clippy::unwrap_used)]

#[path = "../shared/logs.rs"]
mod logs;

use calibration::{Options, calibrate, predict};
use logs::read_back;
use recording::Recording;
use world::{Drive, DriveKind, Effect, EffectName, RobotFile, World, simulate};

fn record(world: &World, drive: &Drive) -> Recording {
    let robot = serde_json::to_string(&model::builtin::husky_a200()).unwrap();
    let log = simulate(world, &RobotFile::from_json(&robot).unwrap(), drive).unwrap();
    let reading = read_back(&log);
    assert!(reading.report.aside.is_empty(), "every column is known: {:?}", reading.report.aside);
    assert!(reading.report.suspicions.is_empty(), "{:?}", reading.report.suspicions);
    reading.recording
}

fn hills(grade: f64) -> World {
    World::from_json(&format!(r#"{{"terrain": {{"rolling": {{"grade": {grade}}}}}, "seed": 3}}"#)).unwrap()
}

#[test]
fn healthy_drives_over_gentle_hills_are_described_after_calibration() {
    let robot = model::builtin::husky_a200();
    for (grade, kind) in [(0.0, DriveKind::Rich), (0.02, DriveKind::Rich), (0.03, DriveKind::LawnMower)] {
        let drive = Drive { runs: 6, ..Drive::new(kind, 300.0, 5) };
        let recording = record(&hills(grade), &drive);
        let found = calibrate(&robot, &recording, &Options::default()).unwrap();
        let held_out = found.held_out.unwrap();
        // Runs that were not fitted, averaged over a second.
        assert!(held_out.second_r2.unwrap() > 0.993, "{kind:?} on {grade}: {held_out:?}");
        let after = predict(&found.robot, &recording).unwrap().prediction.total;
        let share = (after.predicted_j / after.recorded_j - 1.0).abs();
        assert!(share < 0.02, "{kind:?} on {grade}: energy off by {share}");
        assert!(after.r2.unwrap() > 0.98, "{kind:?} on {grade}: {after:?}");
    }
}

#[test]
fn the_robot_file_itself_describes_a_healthy_robot_and_not_one_that_conceals_a_load() {
    let robot = model::builtin::husky_a200();
    let drive = Drive { runs: 2, ..Drive::new(DriveKind::Rich, 300.0, 5) };
    let healthy = predict(&robot, &record(&hills(0.02), &drive)).unwrap().prediction.total;
    assert!((healthy.predicted_j / healthy.recorded_j - 1.0).abs() < 0.03, "{healthy:?}");
    let loaded = World { effects: vec![Effect::new(EffectName::Payload, 15.0)], ..hills(0.02) };
    let loaded = predict(&robot, &record(&loaded, &drive)).unwrap().prediction.total;
    assert!(loaded.recorded_j > 1.15 * healthy.recorded_j, "{loaded:?}");
    assert!(loaded.predicted_j < 0.92 * loaded.recorded_j, "{loaded:?}");
}
