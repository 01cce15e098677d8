//! Of several things that would look alike the one that is wrong is doubted: signs, units, dead sensors and mountings before wheels in the air.

#![allow(clippy::unwrap_used)]

use std::f64::consts::PI;

use calibration::{Error, Method, Options, doubts};
use rand::RngExt;
use recording::{Channel, Recording, unwatched};

mod simulated;
use simulated::doubted::{found, only, robot};
use simulated::{
    changed, drives, healthy, healthy_of, normal, placed, seeded, with_battery_power, with_power,
};

const WHEELS: [Channel; 2] = [Channel::LeftSpeed, Channel::RightSpeed];
const POWERS: [Channel; 2] = [Channel::LeftPower, Channel::RightPower];

fn swapped(mut recording: Recording, [one, other]: [Channel; 2]) -> Recording {
    let [a, b] = [one, other].map(|channel| recording.channels.remove(&channel).unwrap());
    recording.channels.extend([(one, b), (other, a)]);
    recording
}

fn battery() -> Recording {
    let mut random = seeded(6);
    let plain = drives(&mut random, 3, 800);
    with_battery_power(&robot(), plain, &mut random)
}

#[test]
fn sides_or_a_yaw_rate_of_the_wrong_sign_come_first_and_nothing_is_fitted_to_them() {
    let gyroscope = changed(placed(healthy()), &[Channel::YawRate], |rate| -rate);
    let told = only(&gyroscope, "turning_sign");
    assert!(told.cure.contains("yaw rate or heading"), "{told:?}");
    let sides = swapped(placed(healthy()), WHEELS);
    let told = &found(&sides)[0];
    assert!(told.name == "turning_sign" && told.statement.contains("speeds seem swapped"), "{told:?}");
    let refused = Method::Fit.calibrate(&robot(), &sides, &Options::default());
    assert!(matches!(refused, Err(Error::Doubtful { .. })));
    assert_eq!(found(&changed(healthy(), &[Channel::LeftSpeed], |v| -v))[0].name, "left_speed_sign");
    let places = swapped(placed(healthy()), [Channel::X, Channel::Y]);
    assert!(only(&places, "positions_mirrored").cure.contains("swapped"));
}

#[test]
fn power_of_another_sign_source_or_sensor_is_no_lack_of_ground() {
    let turned_from = |mut recording: Recording, from: usize| {
        let rows = from..recording.runs[1].rows.end;
        recording.channels.get_mut(&Channel::Power).unwrap()[rows].iter_mut().for_each(|w| *w = -*w);
        recording
    };
    let told = only(&turned_from(battery(), 1200), "power_sign_changes");
    assert!(told.statement.contains("to 80 s of run `run-1`"), "{told:?}");
    assert_eq!(only(&changed(battery(), &[Channel::Power], |w| -w), "power_sign").name, "power_sign");
    let dead = changed(battery(), &[Channel::Power], |_| 0.0);
    assert!(only(&dead, "power_stuck").statement.contains("stands at 0 (it is 0 in every row of 2400)"));
    // The power of another drive.
    let mut random = seeded(77);
    let other = drives(&mut random, 3, 800);
    let other = with_battery_power(&robot(), other, &mut random);
    let mut joined = battery();
    joined.channels.insert(Channel::Power, other.channels[&Channel::Power].clone());
    assert!(only(&joined, "power_unrelated").cure.contains("the same drive"));
}

#[test]
fn pitch_that_is_worse_than_level_ground_is_not_called_degrees() {
    let small = changed(healthy(), &[Channel::Pitch], |rad| 0.3 * rad.to_degrees());
    assert!(only(&small, "angle_unit").cure.contains("`deg`"));
    // Elements of a quaternion in another order: pitch is then more of a heading.
    let mut heading = healthy();
    let pitch = heading.channels.get_mut(&Channel::Pitch).unwrap();
    pitch.iter_mut().enumerate().for_each(|(i, rad)| *rad = 1.2 * (0.07 * i as f64).sin());
    let told = only(&heading, "pitch_misleads");
    assert!(told.cure.contains("order of a quaternion"), "{told:?}");
    let over = changed(healthy(), &[Channel::Roll], |rad| if rad > 0.0 { rad - PI } else { rad + PI });
    assert_eq!(only(&over, "imu_upside_down").name, "imu_upside_down");
    let mut copied = healthy();
    copied.channels.insert(Channel::Pitch, copied.channels[&Channel::Roll].clone());
    assert!(only(&copied, "angles_alike").statement.contains("1200 of 1200 rows"));
}

#[test]
fn two_powers_that_contradict_each_other_are_told_with_their_ratio() {
    let beside = |factor: f64, offset_w: f64| {
        let mut recording = healthy();
        let [left, right] = POWERS.map(|side| recording.channel(side).unwrap());
        let total = left.iter().zip(right).map(|(l, r)| factor * (l + r) + offset_w).collect();
        recording.channels.insert(Channel::Power, total);
        recording
    };
    // Drivers take a tenth, and electronics stand by.
    assert_eq!(found(&beside(1.1, 25.0)), []);
    assert!(only(&beside(0.5, 0.0), "powers_contradict").statement.contains("varies 2.00 times as much"));
    let mut currents = battery();
    let power_w = currents.channels[&Channel::Power].clone();
    currents.channels.insert(Channel::Current, power_w.iter().map(|w| w / 25.0).collect());
    currents.channels.insert(Channel::Voltage, vec![25.0; power_w.len()]);
    assert_eq!(found(&currents), []);
    let told = only(&changed(currents, &[Channel::Power], |w| 0.3 * w), "powers_contradict");
    assert!(told.cure.contains("3.333"), "{told:?}");
}

#[test]
fn a_meter_at_its_limit_is_told_where_more_was_drawn_and_nothing_is_fitted_to_it() {
    let limited = changed(battery(), &[Channel::Power], |w| w.min(120.0));
    assert!(only(&limited, "meter_saturated").statement.contains("its limit of 120"));
    let refused = Method::Fit.calibrate(&robot(), &limited, &Options::default());
    assert!(matches!(refused, Err(Error::Doubtful { .. })));
    let sides = changed(healthy_of(800), &POWERS, |w| w.min(60.0));
    assert_eq!(only(&sides, "meter_saturated").name, "meter_saturated");
}

#[test]
fn fill_values_of_angles_are_no_measurements() {
    for (value, name) in [(-1.0, "placeholders"), (0.0, "placeholders"), (327.67, "beyond_the_robot")] {
        let mut recording = battery();
        let pitch = recording.channels.get_mut(&Channel::Pitch).unwrap();
        let mut random = seeded(2);
        pitch.iter_mut().for_each(|rad| {
            *rad = if random.random_range(0..25) == 0 { value } else { *rad + 0.002 * normal(&mut random) }
        });
        assert!(only(&recording, name).statement.contains("`pitch_rad`"), "{value}");
    }
}

#[test]
fn encoders_that_stop_counting_while_the_robot_turns_are_told() {
    let mut recording = healthy();
    for channel in WHEELS {
        recording.channels.get_mut(&channel).unwrap()[40..390].fill(0.0);
    }
    let told = found(&recording);
    assert!(told.iter().any(|doubt| ["wheels_stopped", "turning"].contains(&doubt.name)), "{told:?}");
    // A robot that stands, and one that is turned by hand.
    let mut by_hand = healthy();
    for channel in WHEELS.into_iter().chain(POWERS) {
        by_hand.channels.get_mut(&channel).unwrap()[40..160].fill(0.0);
    }
    let told = found(&by_hand);
    assert!(told.iter().all(|doubt| doubt.name != "wheels_stopped"), "{told:?}");
}

#[test]
fn pitch_that_is_askew_of_heights_is_told_with_its_angle() {
    let drives = || placed(healthy_of(1200));
    assert_eq!(found(&drives()), []);
    let told = only(&changed(drives(), &[Channel::Pitch], |rad| rad - 0.05), "pitch_bias");
    assert!(told.statement.contains("-2.8") || told.statement.contains("-2.9"), "{told:?}");
    assert!(told.cure.contains("-0.05 rad") || told.cure.contains("-0.0"), "{told:?}");
    let downwards = changed(drives(), &[Channel::Z], |z_m| -z_m);
    assert_eq!(only(&downwards, "pitch_or_heights_sign").name, "pitch_or_heights_sign");
}

#[test]
fn half_of_the_power_is_doubted_on_ground_that_the_file_knows_by_name() {
    let half = |ground: Option<&str>| {
        let mut recording = changed(battery(), &[Channel::Power], |w| w / 2.5);
        recording.surface = ground.map(|name| recording::Labels::constant(name, recording.rows()));
        recording
    };
    assert!(only(&half(Some("marble")), "power_level").statement.contains("ground that it knows"));
    assert_eq!(found(&half(None)), [], "unknown ground may be any");
    let mut unsure = robot();
    unsure.uncertainty.mu_roll = 0.5;
    assert_eq!(doubts(&unsure, &half(Some("marble")), &unwatched()).unwrap(), []);
}

#[test]
fn wheels_of_another_radius_are_told_by_the_map_and_by_positions() {
    let mut recording = healthy();
    recording.wheel_radius_m = Some(robot().wheel_radius_m);
    assert_eq!(found(&recording), []);
    recording.wheel_radius_m = Some(0.13);
    let told = only(&recording, "wheel_radius");
    assert!(told.statement.contains("0.13 m") && told.statement.contains("0.165 m"), "{told:?}");
    let mut random = seeded(5);
    let plain = placed(drives(&mut random, 3, 1200));
    let factor = 1.27;
    let wrong = changed(with_power(&robot(), plain, &mut random), &WHEELS, |v| factor * v);
    assert!(found(&wrong).iter().any(|doubt| doubt.name == "way_by_positions"), "{:?}", found(&wrong));
}

#[test]
fn a_yaw_rate_in_degrees_and_another_wheel_separation_are_no_unit_of_wheel_speeds() {
    let degrees = changed(healthy(), &[Channel::YawRate], f64::to_degrees);
    assert!(only(&degrees, "yaw_rate_unit").cure.contains("`deg/s`"));
    let mut narrow = healthy();
    let [left, right] = WHEELS.map(|side| narrow.channel(side).unwrap().to_vec());
    for (side, sign) in WHEELS.into_iter().zip([-1.0, 1.0]) {
        let rim = |(l, r): (&f64, &f64)| (l + r) / 2.0 + sign * 0.6 * (r - l) / 2.0;
        narrow.channels.insert(side, left.iter().zip(&right).map(rim).collect());
    }
    let told = &found(&narrow)[0];
    assert!(told.name == "wheel_separation" && !told.cure.contains("turns of a wheel"), "{told:?}");
}

#[test]
fn zero_is_a_step_of_a_coarse_meter_and_the_end_of_one_that_cannot_read_below() {
    let coarse = changed(battery(), &[Channel::Power], |w| 50.0 * (w / 50.0).round());
    assert_eq!(found(&coarse), []);
    let mut one_way = healthy_of(800);
    // A long descent, in which the ground drives the right side.
    one_way = changed(one_way, &POWERS, |w| w.max(0.0));
    assert_eq!(found(&one_way), []);
    let notes = calibration::predict(&robot(), &one_way).unwrap().prediction.notes;
    assert!(notes.iter().any(|note| note.contains("the model gives power back")), "{notes:?}");
}
