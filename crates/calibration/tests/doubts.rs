//! What physics forbids of a recording is doubted by name before anything is fitted, and healthy drives are not.

#![allow(clippy::unwrap_used)]

use calibration::{Error, Method, Options, doubts, predict};
use model::{Robot, builtin};
use recording::{Channel, Labels, Recording, unwatched};

mod simulated;
use simulated::{changed, drives, healthy, seeded, with_battery_power, with_power};

fn robot() -> Robot {
    builtin::husky_a200()
}

fn names(recording: &Recording) -> Vec<&'static str> {
    doubts(&robot(), recording, &unwatched()).unwrap().iter().map(|doubt| doubt.name).collect()
}

#[test]
fn healthy_drives_are_not_doubted() {
    assert_eq!(names(&healthy()), [""; 0]);
    let mut random = seeded(6);
    let plain = drives(&mut random, 3, 400);
    assert_eq!(names(&with_battery_power(&robot(), plain, &mut random)), [""; 0]);
}

#[test]
fn each_fault_is_named_with_its_number_and_what_mends_it() {
    use Channel as C;
    let (wheels, powers) = ([C::LeftSpeed, C::RightSpeed], [C::LeftPower, C::RightPower]);
    assert_eq!(names(&changed(healthy(), &powers, |w| -w)), ["power_sign"]);
    assert_eq!(names(&changed(healthy(), &[C::RightPower], |w| -w)), ["right_power_sign"]);
    assert_eq!(names(&changed(healthy(), &[C::LeftPower], |w| -w)), ["left_power_sign"]);
    assert_eq!(names(&changed(healthy(), &[C::Pitch], |rad| -rad)), ["pitch_sign"]);
    assert_eq!(names(&changed(healthy(), &powers, |w| 1000.0 * w)), ["power_scale"]);
    for (unit, factor) in [("km/h", 3.6), ("rad/s", 1.0 / robot().wheel_radius_m), ("cm/s", 100.0)] {
        let found = doubts(&robot(), &changed(healthy(), &wheels, |v| factor * v), &unwatched()).unwrap();
        assert!(found[0].name == "speed_scale" && found[0].cure.contains(unit), "{unit}: {found:?}");
    }
    let mut turned = healthy();
    let (pitch, roll) = (turned.channels[&C::Pitch].clone(), turned.channels[&C::Roll].clone());
    turned.channels.insert(C::Pitch, roll);
    turned.channels.insert(C::Roll, pitch);
    assert_eq!(names(&turned), ["imu_turned_left"]);
}

#[test]
fn a_doubtful_recording_is_predicted_with_its_doubt_and_not_calibrated_unless_overruled() {
    let wrong = changed(healthy(), &[Channel::LeftPower, Channel::RightPower], |w| -w);
    assert_eq!(predict(&robot(), &wrong).unwrap().prediction.doubts[0].name, "power_sign");
    let calibrated = |options| Method::Fit.calibrate(&robot(), &wrong, &options);
    let refused = calibrated(Options::default()).unwrap_err();
    assert!(
        matches!(refused, Error::Doubtful { .. }) && refused.to_string().contains("--despite power_sign")
    );
    let despite = Options { despite: vec!["power_sign".into(), "held_out".into()], ..Options::default() };
    let found = calibrated(despite).unwrap();
    assert!(found.notes.iter().any(|note| note.contains("despite a doubt: power_sign")), "{:?}", found.notes);
}

#[test]
fn a_fit_that_other_runs_contradict_is_refused_with_its_skill() {
    let wrong = changed(healthy(), &[Channel::LeftPower, Channel::RightPower], |w| -w);
    let options = Options { despite: vec!["power_sign".into()], ..Options::default() };
    let refused = Method::Fit.calibrate(&robot(), &wrong, &options).unwrap_err();
    assert!(matches!(refused, Error::Contradicted { r2, .. } if r2 < 0.0), "{refused}");
    let said = refused.to_string();
    assert!(said.contains("worse than their mean") && said.contains("--despite held_out"), "{said}");
}

#[test]
fn ground_without_a_name_is_said_to_be_the_robots_default() {
    let of = |recording: &Recording| {
        let found = Method::Fit.calibrate(&robot(), recording, &Options::default()).unwrap();
        found.notes.into_iter().find(|note| note.contains("name their ground"))
    };
    let mut recording = healthy();
    recording.surface = None;
    assert!(of(&recording).unwrap().contains("`marble`, the robot's default"));
    let rows = recording.rows();
    let mut labels = Labels::constant("marble", rows);
    recording.surface = Some(labels.clone());
    assert_eq!(of(&recording), None);
    labels.index[..7].fill(Labels::NONE);
    recording.surface = Some(labels);
    assert!(of(&recording).unwrap().starts_with(&format!("7 of {rows} rows")));
}

#[test]
fn seconds_that_are_not_counted_are_said_with_their_reason() {
    let mut recording = healthy();
    let rows = recording.runs[0].rows.clone();
    let right_w = recording.channels.get_mut(&Channel::RightPower).unwrap();
    right_w[rows.start + 100..rows.start + 200].fill(f64::NAN);
    let pitch = recording.channels.get_mut(&Channel::Pitch).unwrap();
    pitch[rows.start + 300..rows.end].fill(f64::NAN);
    let found = predict(&robot(), &recording).unwrap().prediction;
    let coverage = &found.runs[0].coverage;
    assert!((coverage.recorded_s - 39.9).abs() < 1e-9, "{coverage:?}");
    assert!((coverage.recorded_s - coverage.used_s - 10.1).abs() < 1e-6, "{coverage:?}");
    assert!((coverage.level_s - 10.0).abs() < 0.11, "{coverage:?}");
    assert!(coverage.left_out[0].reason.contains("power_right_w"), "{coverage:?}");
    assert!(coverage.words().unwrap().contains("29.8 of 39.9 s are counted"), "{coverage:?}");
    assert!(found.runs[1].coverage.words().is_none());
    let nothing = changed(healthy(), &[Channel::RightPower], |_| f64::NAN);
    assert!(predict(&robot(), &nothing).is_err());
}

#[test]
fn a_calibration_says_of_every_run_what_was_fitted_and_which_channel_left_the_rest_out() {
    let mut recording = healthy();
    let rows = recording.runs[0].rows.clone();
    let right_w = recording.channels.get_mut(&Channel::RightPower).unwrap();
    right_w[rows.start + 100..rows.start + 200].fill(f64::NAN);
    let pitch = recording.channels.get_mut(&Channel::Pitch).unwrap();
    pitch[rows.start + 300..rows.end].fill(f64::NAN);
    let found = Method::Fit.calibrate(&robot(), &recording, &Options::default()).unwrap();
    let first = &found.coverage.runs[0];
    let left_out: Vec<_> = first.coverage.left_out.iter().map(|left| left.channel).collect();
    assert_eq!(left_out, [Some(Channel::RightPower), Some(Channel::Pitch)], "{first:?}");
    assert!((first.coverage.used_s - 19.8).abs() < 1e-6 && first.coverage.level_s == 0.0, "{first:?}");
    assert_eq!(found.coverage.runs.len(), 3);
    assert!(found.coverage.runs[1].coverage.left_out.is_empty());
    assert!((found.coverage.total.recorded_s - 3.0 * 39.9).abs() < 1e-6);
    let said = found.notes.iter().find(|note| note.contains("are counted")).unwrap();
    assert!(said.contains("10.1 s `power_right_w` has no value"), "{said}");
    assert_eq!(found.coverage.words_by_run().len(), 1);
    let document = serde_json::to_value(&found).unwrap();
    assert_eq!(document["coverage"]["runs"][0]["left_out"][1]["channel"], "pitch_rad");
}

/// The rows of the first run between two of its seconds.
fn seconds(recording: &Recording, from_s: usize, until_s: usize) -> std::ops::Range<usize> {
    let start = recording.runs[0].rows.start;
    start + 10 * from_s..start + 10 * until_s
}

#[test]
fn a_sensor_of_one_side_that_stands_still_is_named_with_its_side_and_value() {
    for (channel, value, name) in [
        (Channel::LeftSpeed, 0.0, "left_sensor_stuck"),
        (Channel::RightSpeed, 0.31, "right_sensor_stuck"),
        (Channel::RightPower, 0.0, "right_sensor_stuck"),
        (Channel::LeftPower, 55.5, "left_sensor_stuck"),
    ] {
        let mut stuck = healthy();
        let rows = seconds(&stuck, 5, 35);
        stuck.channels.get_mut(&channel).unwrap()[rows].fill(value);
        let found = doubts(&robot(), &stuck, &unwatched()).unwrap();
        assert_eq!(found[0].name, name, "{found:?}");
        let said = &found[0].statement;
        assert!(said.contains(channel.name()) && said.contains(&format!("stands at {value} for")), "{said}");
    }
}

#[test]
fn wheels_that_turn_in_the_air_are_told_by_the_gyroscope_and_by_power_alone() {
    for with_gyroscope in [true, false] {
        let mut lifted = healthy();
        let rows = seconds(&lifted, 4, 38);
        // Free wheels take a few watts whatever they do.
        for channel in [Channel::LeftPower, Channel::RightPower] {
            lifted.channels.get_mut(&channel).unwrap()[rows.clone()]
                .iter_mut()
                .enumerate()
                .for_each(|(i, w)| *w = 1.0 + 0.5 * (0.7 * i as f64).sin());
        }
        lifted.channels.get_mut(&Channel::YawRate).unwrap()[rows].fill(0.001);
        if !with_gyroscope {
            lifted.channels.remove(&Channel::YawRate);
        }
        let found = doubts(&robot(), &lifted, &unwatched()).unwrap();
        assert!(found.len() == 1 && found[0].name == "wheels_in_air", "{with_gyroscope}: {found:?}");
        assert!(found[0].statement.contains("W where driving takes"), "{found:?}");
    }
}

#[test]
fn a_battery_that_is_charged_on_the_way_is_doubted_and_one_that_recovers_power_downhill_is_not() {
    let mut random = seeded(6);
    let plain = drives(&mut random, 3, 400);
    let healthy = with_battery_power(&robot(), plain, &mut random);
    assert!(healthy.channel(Channel::Power).unwrap().iter().any(|w| *w < 0.0), "some ground falls");
    assert_eq!(names(&healthy), [""; 0]);
    let mut charged = healthy;
    charged.channels.get_mut(&Channel::Power).unwrap().iter_mut().for_each(|w| *w -= 150.0);
    let found = doubts(&robot(), &charged, &unwatched()).unwrap();
    assert!(found.len() == 1 && found[0].name == "charging", "{found:?}");
    assert!(found[0].statement.contains("the battery takes up"), "{found:?}");
}

#[test]
fn a_side_that_truly_keeps_its_speed_is_not_doubted() {
    for with_gyroscope in [true, false] {
        let mut random = seeded(9);
        let mut steered = drives(&mut random, 3, 400);
        let rows = steered.runs[0].rows.clone();
        steered.channels.get_mut(&Channel::LeftSpeed).unwrap()[rows].fill(0.4);
        if with_gyroscope {
            let of = |channel| steered.channel(channel).unwrap().to_vec();
            let (left, right) = (of(Channel::LeftSpeed), of(Channel::RightSpeed));
            let rate = left.iter().zip(&right).map(|(l, r)| (r - l) / robot().slip_track_m).collect();
            steered.channels.insert(Channel::YawRate, rate);
        }
        assert_eq!(names(&with_power(&robot(), steered, &mut random)), [""; 0], "{with_gyroscope}");
    }
}
