//! Known numbers of the current model are found again in simulated recordings of unsigned motor currents.

#![allow(clippy::unwrap_used)]

use calibration::{Options, calibrate};
use model::builtin;

mod simulated;
use recording::Channel;
use simulated::{
    drives, seeded,
    worlds::{World, current_truth, with_currents},
};

#[test]
fn determined_numbers_lie_in_their_95_per_cent_intervals_about_as_often_as_promised() {
    World::Currents.assert_as_promised();
}

#[test]
fn what_level_drives_leave_open_keeps_the_value_of_the_robot_file() {
    let mut random = seeded(5);
    let truth = current_truth(&mut random);
    let mut level = drives(&mut random, 6, 300);
    level.channels.remove(&Channel::Pitch);
    let recording = with_currents(&truth, level, &mut random);
    let mut file = builtin::husky_a200();
    let open = calibrate(&file, &recording, &Options::default()).unwrap();
    let value = |found: &calibration::Calibration, ending: &str| {
        let parameter = found.parameters.iter().find(|p| p.name.ends_with(ending)).unwrap();
        (parameter.value, parameter.determined)
    };
    let marble = file.surfaces["marble"].clone();
    assert!(!value(&open, "force_n_per_a").1, "no slope weighs the robot");
    assert_eq!(value(&open, "marble.mu_roll"), (marble.mu_roll, false));
    assert_eq!(value(&open, "marble.mu_skid"), (marble.mu_skid, false));
    assert_eq!(value(&open, "current_model.load_height"), (0.25, false), "no roll shifts its load");
    assert!(open.notes.iter().any(|note| note.contains("motors.force_n_per_a") && note.contains("held")));
    assert!(open.notes.iter().any(|note| note.contains("slopes of known pitch")));

    // With force per ampere in the file, the same drives tell friction, and the force stays the file's.
    file.motors.left.force_n_per_a = Some(18.0);
    file.motors.right.force_n_per_a = Some(18.0);
    let told = calibrate(&file, &recording, &Options::default()).unwrap();
    assert!(!value(&told, "force_n_per_a").1);
    assert!((value(&told, "force_n_per_a").0 - 18.0).abs() < 1e-9);
    assert!(value(&told, "marble.mu_skid").1);
    let weight_n = file.mass_kg * model::STANDARD_GRAVITY_MPS2;
    let mu_roll = truth.rolling_a * 2.0 * 18.0 / weight_n;
    // Currents that relax and lean as no file's do leave some of that in the file's rolling resistance.
    assert!((value(&told, "marble.mu_roll").0 - mu_roll).abs() < 0.10 * mu_roll, "{mu_roll} {told:#?}");
}
