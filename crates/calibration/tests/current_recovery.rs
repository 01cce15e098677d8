//! Known numbers of the current model are found again in simulated recordings of unsigned motor currents.

#![allow(clippy::unwrap_used)]

use calibration::{
    Drives, Options, calibrate,
    current::{CurrentModel, CurrentParameters, YawSource},
    current_fit::fit_reference,
};
use model::builtin;
use rand_pcg::Pcg64Mcg;
use rayon::prelude::*;
use recording::{Channel, Recording};

mod simulated;
use simulated::{Coverage, drives, normal, seeded};

/// Numbers of a robot of a Husky's size: what is known of them before is what they are drawn from.
fn truth(random: &mut Pcg64Mcg) -> CurrentParameters {
    let mut about = |mean: f64, sigma: f64| mean + sigma * normal(random).clamp(-2.0, 2.0);
    CurrentParameters {
        rolling_a: about(2.5, 0.5),
        split_a: about(0.0, 0.5),
        skid_a: about(8.0, 1.5),
        slip_angle_scale_rad: about(0.15, 0.03),
        slip_shape: about(1.3, 0.2),
        lifting_a: about(25.0, 5.0),
        inertia_a_per_mps2: about(3.0, 1.0),
        turning_inertia_a_per_mps2: about(0.5, 0.5),
        relaxation_length_m: about(0.1, 0.03),
        load_height_m: about(0.25, 0.15),
        wheel_mismatch: about(0.0, 0.03),
        offset_a: about(0.0, 0.25),
    }
}

/// Currents that drivers would read: white noise of 0.8 A on 10 Hz, and 0.5 A that stays for about two seconds.
fn with_currents(truth: &CurrentParameters, mut recording: Recording, random: &mut Pcg64Mcg) -> Recording {
    const SIDES: [Channel; 2] = [Channel::LeftMotorCurrent, Channel::RightMotorCurrent];
    for channel in SIDES {
        recording.channels.insert(channel, vec![0.0; recording.t_s.len()]);
    }
    let robot = builtin::husky_a200();
    let prepared = Drives::new(&robot, &recording).unwrap();
    let model = CurrentModel::new(&robot, &prepared, robot.slip_track_m, YawSource::Wheels, 0.3);
    let readings = model.readings_a(truth);
    let stays = (-0.1f64 / 2.0).exp();
    for (side, channel) in SIDES.into_iter().enumerate() {
        let mut slow_a = 0.0;
        let noisy = readings.iter().map(|reading| {
            slow_a = stays * slow_a + 0.5 * (1.0 - stays * stays).sqrt() * normal(random);
            [reading.left, reading.right][side] + slow_a + 0.8 * normal(random)
        });
        let noisy: Vec<f64> = noisy.collect();
        recording.channels.insert(channel, noisy);
    }
    recording
}

#[test]
fn determined_numbers_lie_in_their_95_per_cent_intervals_about_as_often_as_promised() {
    const TRIALS: u64 = 100;
    let trial = |seed: u64| {
        let mut random = seeded(seed);
        let truth = truth(&mut random);
        let plain = drives(&mut random, 12, 250);
        let recording = with_currents(&truth, plain, &mut random);
        let robot = builtin::husky_a200();
        let found = fit_reference(&robot, &Drives::new(&robot, &recording).unwrap()).fit;
        let of = |i: usize| {
            let [low, high] = found.interval_95(i);
            let inside = (low..=high).contains(&truth.to_array()[i]);
            found.determined(i).then(|| (found.parameters[i].name.clone(), inside))
        };
        (0..found.values.len()).filter_map(of).collect::<Vec<_>>()
    };
    let trials: Vec<_> = (2000..2000 + TRIALS).into_par_iter().map(trial).collect();
    let mut coverage = Coverage::default();
    trials.into_iter().for_each(|trial| coverage.add(trial));
    coverage.assert_as_promised(&[
        "rolling_current",
        "rolling_split",
        "skid_current",
        "slip_angle_scale",
        "slip_shape",
        "lifting_current",
        "inertia",
    ]);
}

#[test]
fn what_level_drives_leave_open_keeps_the_value_of_the_robot_file() {
    let mut random = seeded(5);
    let truth = truth(&mut random);
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
    assert!((value(&told, "marble.mu_roll").0 - mu_roll).abs() < 0.05 * mu_roll, "{told:#?}");
}
