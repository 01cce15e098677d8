//! Known parameters are found again in simulated recordings, as often as the intervals promise.

#![allow(clippy::unwrap_used)]

use calibration::{Drives, Options, calibrate, predict};
use model::{Attitude, Motion, Robot, Sides, builtin, power};
use proptest::prelude::*;
use rand_pcg::Pcg64Mcg;
use recording::{Channel, Recording};

mod simulated;
use simulated::{
    ROWS, RUNS, drives, normal, seeded, with_battery_power, with_power,
    worlds::{World, file, truth},
};

#[test]
fn determined_parameters_lie_in_their_95_per_cent_intervals_about_as_often_as_promised() {
    World::Sides.assert_as_promised();
}

#[test]
fn motors_that_warm_tell_their_temperature_coefficients_and_each_ground_its_friction() {
    World::Warming.assert_as_promised();
}

#[test]
fn the_battery_alone_tells_hotel_power_and_friction() {
    World::Battery.assert_as_promised();
}

#[test]
fn a_hotel_load_that_the_file_does_not_state_is_found_from_drives_that_hardly_stand() {
    let mut inside = 0;
    const TRIALS: u64 = 20;
    for trial in 0..TRIALS {
        let mut random = seeded(700 + trial);
        let mut truth = truth(&mut random);
        truth.hotel_power_w = [15.0, 60.0, 140.0, 250.0][trial as usize % 4];
        let plain = hardly_standing(drives(&mut random, 6, 300));
        let recording = with_battery_power(&truth, plain, &mut random);
        let stands = Drives::new(&file(), &recording).unwrap().rows;
        let share = stands.iter().filter(|row| row.stands()).count() as f64 / stands.len() as f64;
        assert!((0.02..0.07).contains(&share), "{share} of the time it stands");
        assert_eq!(file().hotel_power_w, 0.0);
        let found = calibrate(&file(), &recording, &Options::default()).unwrap();
        let hotel = found.parameters.iter().find(|p| p.name == "hotel_power_w").unwrap();
        let [low, high] = hotel.interval_95.unwrap();
        assert!(hotel.determined, "{hotel:?}");
        inside += u64::from((low..=high).contains(&truth.hotel_power_w));
        // Half of a 95 % interval, over its value, is 1.96 of what the file then states.
        let stated = found.robot.uncertainty.hotel_power_w;
        assert!(stated > 0.0 && stated < (high - low) / hotel.value, "{stated}");
    }
    // Of intervals that hold in 95 % of cases, 17 or more of 20 hold in 98 %.
    assert!(inside >= 17, "{inside} of {TRIALS}");
}

/// The drives with halts driven through but for the last twentieth of each run, in which the robot stands.
fn hardly_standing(mut recording: Recording) -> Recording {
    let runs = recording.runs.clone();
    for side in [Channel::LeftSpeed, Channel::RightSpeed] {
        let speeds = recording.channels.get_mut(&side).unwrap();
        speeds.iter_mut().filter(|mps| mps.abs() < 0.02).for_each(|mps| *mps = 0.05);
        for run in &runs {
            speeds[run.rows.end - run.rows.len() / 20..run.rows.end].fill(0.0);
        }
    }
    recording
}

#[test]
fn cold_motors_hold_their_temperature_coefficients_and_say_so() {
    let mut random = seeded(1);
    let truth = truth(&mut random);
    let plain = drives(&mut random, RUNS, ROWS);
    let mut warm = with_power(&truth, plain, &mut random);
    let held = |recording: &Recording| {
        let found = calibrate(&file(), recording, &Options::default()).unwrap();
        let of = |name: &str| found.parameters.iter().find(|p| p.name == name).unwrap().clone();
        let (copper, magnets) = (of("motors.resistance_per_k"), of("motors.motor_constant_per_k"));
        assert_eq!((copper.value, copper.determined), (0.0039, false));
        assert_eq!((magnets.value, magnets.determined), (-0.0012, false));
        assert!(found.notes.iter().any(|note| note.contains("motors.resistance_per_k")), "{:?}", found.notes);
    };
    held(&warm);
    for channel in [Channel::LeftMotorTemperature, Channel::RightMotorTemperature] {
        let lukewarm = (0..warm.t_s.len()).map(|i| 40.0 + 4.0 * (i as f64 / 100.0).sin().abs());
        warm.channels.insert(channel, lukewarm.collect());
    }
    held(&warm);
}

#[test]
fn a_calibrated_robot_predicts_better_than_its_file_and_level_straights_do_not_tell_skid() {
    let mut random = Pcg64Mcg::new(7);
    let mut truth = truth(&mut random);
    truth.surfaces.get_mut("marble").unwrap().mu_roll = 0.09;
    let plain = drives(&mut random, RUNS, ROWS);
    let recording = with_power(&truth, plain, &mut random);
    let found = calibrate(&file(), &recording, &Options::default()).unwrap();
    let rmse_w = |robot: &Robot| predict(robot, &recording).unwrap().prediction.total.rmse_w;
    assert!(rmse_w(&found.robot) < 0.7 * rmse_w(&file()), "{} {}", rmse_w(&found.robot), rmse_w(&file()));
    assert!(found.held_out.unwrap().r2 > 0.97);

    let mut straight = drives(&mut random, RUNS, ROWS);
    let left = straight.channels[&Channel::LeftSpeed].clone();
    straight.channels.insert(Channel::RightSpeed, left);
    let recording = with_power(&truth, straight, &mut random);
    let found = calibrate(&file(), &recording, &Options::default()).unwrap();
    let skid = found.parameters.iter().find(|p| p.name.ends_with("mu_skid")).unwrap();
    assert!(!skid.determined);
    assert_eq!(skid.value, file().surfaces["marble"].mu_skid, "held at the file's value");
    let track = found.parameters.iter().find(|p| p.name == "slip_track_m").unwrap();
    assert!(!track.determined, "there was no gyroscope");
}

#[test]
fn friction_far_from_that_of_the_file_is_found_from_any_file() {
    let mut random = seeded(3);
    let with = |mu_roll: f64, mu_skid: f64, slip_angle_scale_rad: f64| {
        let mut robot = file();
        let marble = robot.surfaces.get_mut("marble").unwrap();
        (marble.mu_roll, marble.mu_skid) = (mu_roll, mu_skid);
        marble.slip_angle_scale_rad = slip_angle_scale_rad;
        // Returned power and standing loads are at their bounds, where a search may stand still.
        robot.motors.regeneration = 1.0;
        (robot.drive_electronics_w, robot.hotel_power_w) = (0.0, 0.0);
        robot.uncertainty.mu_roll = 1.0;
        robot.uncertainty.mu_skid = 1.0;
        robot
    };
    let truth = with(0.085, 0.284, 0.03);
    let plain = drives(&mut random, RUNS, 4 * ROWS);
    let recording = with_power(&truth, plain, &mut random);
    for start in [with(0.063, 0.29, 0.05), with(0.08, 0.31, 0.03), with(0.12, 0.5, 0.30)] {
        let found = calibrate(&start, &recording, &Options::default()).unwrap().robot;
        let of = |robot: &Robot| {
            let marble = &robot.surfaces["marble"];
            [marble.mu_roll, marble.mu_skid, marble.slip_angle_scale_rad]
        };
        for (found, true_value) in of(&found).into_iter().zip(of(&truth)) {
            assert!((found / true_value - 1.0).abs() < 0.15, "{found} instead of {true_value}");
        }
    }
}

#[test]
fn the_papers_procedure_gives_the_coefficients_of_the_printed_form_back() {
    let mut random = Pcg64Mcg::new(3);
    let robot = builtin::husky_a200();
    let marble = &robot.surfaces["marble"];
    let mut recording = drives(&mut random, 8, 800);
    recording.channels.remove(&Channel::Pitch);
    let speeds =
        [Channel::LeftSpeed, Channel::RightSpeed].map(|channel| recording.channels[&channel].clone());
    let watts = speeds[0].iter().zip(&speeds[1]).map(|(left, right)| {
        let motion = Motion::of_wheels(&robot, Sides { left: *left, right: *right });
        power(model::PowerModel::DogruMarques, &robot, marble, motion, Attitude::LEVEL, Sides::both(20.0))
            .side_w
    });
    let (left, right): (Vec<f64>, Vec<f64>) =
        watts.map(|w| (w.left + normal(&mut random), w.right + normal(&mut random))).unzip();
    recording.channels.insert(Channel::LeftPower, left);
    recording.channels.insert(Channel::RightPower, right);
    let found = calibration::dogru_marques::calibrate(&robot, &recording, &recording::unwatched()).unwrap();
    let value = |ending: &str| found.parameters.iter().find(|p| p.name.ends_with(ending)).unwrap().value;
    assert!((value("marble.mu_skid") - marble.mu_skid).abs() < 0.02, "{}", value("marble.mu_skid"));
    assert!((value("marble.mu_roll") - marble.mu_roll).abs() < 0.02, "{}", value("marble.mu_roll"));
    assert!(found.held_out.unwrap().r2 > 0.9);
}

#[test]
fn what_cannot_be_used_is_refused_with_a_way_out() {
    let mut random = Pcg64Mcg::new(1);
    let plain = drives(&mut random, 1, 100);
    let refused = calibrate(&file(), &plain, &Options::default()).unwrap_err().to_string();
    assert!(refused.contains("power"), "{refused}");
    let mut currents = plain.clone();
    for channel in [Channel::LeftMotorCurrent, Channel::RightMotorCurrent] {
        currents.channels.insert(channel, vec![3.0; 100]);
    }
    let refused = predict(&file(), &currents).unwrap_err().to_string();
    assert!(refused.contains("force_n_per_a"), "{refused}");
    let refused = calibrate(&file(), &currents, &Options::default()).unwrap_err().to_string();
    assert!(refused.contains("two or more"), "{refused}");
    let mut moss = with_power(&file(), plain, &mut random);
    let index = (0..100).map(|row| u32::from(row >= 60)).collect();
    moss.surface = Some(recording::Labels { names: vec!["marble".into(), "moss".into()], index });
    let refused = predict(&file(), &moss).unwrap_err().to_string();
    assert!(refused.contains("run-0") && refused.contains("row 61") && refused.contains("moss"), "{refused}");
    assert!(refused.contains("marble"), "{refused}");
    assert!(calibrate(&file(), &moss, &Options::default()).unwrap().robot.surfaces.contains_key("moss"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(16))]
    #[test]
    fn a_robot_predicts_its_own_noiseless_power_exactly(seed in any::<u64>()) {
        let mut random = Pcg64Mcg::new(u128::from(seed));
        let truth = truth(&mut random);
        let mut recording = drives(&mut random, 2, 120);
        for channel in [Channel::LeftPower, Channel::RightPower] {
            recording.channels.insert(channel, vec![0.0; recording.t_s.len()]);
        }
        let predicted = predict(&truth, &recording).unwrap();
        recording.channels.insert(Channel::LeftPower, predicted.predicted_w.clone());
        let again = predict(&truth, &recording).unwrap().prediction.total;
        prop_assert!(again.rmse_w < 1e-9);
        prop_assert!((again.predicted_j - again.recorded_j).abs() < 1e-6 * again.recorded_j.abs().max(1.0));
    }
}

#[test]
fn one_thread_and_two_find_the_same_robot() {
    let mut random = Pcg64Mcg::new(11);
    let truth = truth(&mut random);
    let plain = drives(&mut random, RUNS, ROWS);
    let recording = with_power(&truth, plain, &mut random);
    let found = [1, 2].map(|threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| {
            let calibration = calibrate(&file(), &recording, &Options::default()).unwrap();
            (predict(&calibration.robot, &recording).unwrap().prediction, calibration)
        })
    });
    assert_eq!(found[0], found[1], "to the last bit");
}
