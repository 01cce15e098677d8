//! Cells and columns that are no measurement are doubted with their rows and the energies with and without them.

#![allow(clippy::unwrap_used)]

use calibration::{Error, Method, Options, doubts, predict};
use recording::{Channel, Recording, unwatched};

mod simulated;
use simulated::doubted::{found, robot};
use simulated::{changed, drives, healthy, seeded, with_battery_power};

/// A recording with a value in the place of what some rows of channels hold.
fn filled(
    mut recording: Recording,
    channels: &[Channel],
    value: f64,
    is_filled: impl Fn(usize) -> bool,
) -> Recording {
    for channel in channels {
        let values = recording.channels.get_mut(channel).unwrap();
        values.iter_mut().enumerate().filter(|(row, _)| is_filled(*row)).for_each(|(_, x)| *x = value);
    }
    recording
}

fn battery() -> Recording {
    let mut random = seeded(6);
    let plain = drives(&mut random, 3, 400);
    with_battery_power(&robot(), plain, &mut random)
}

/// Battery power as current and voltage of a battery of 24 V.
fn current_and_voltage() -> Recording {
    let mut recording = battery();
    let power_w = recording.channels.remove(&Channel::Power).unwrap();
    let voltage_v: Vec<f64> = (0..power_w.len()).map(|i| 25.0 - 0.001 * i as f64).collect();
    let current_a = power_w.iter().zip(&voltage_v).map(|(w, v)| w / v).collect();
    recording.channels.insert(Channel::Current, current_a);
    recording.channels.insert(Channel::Voltage, voltage_v);
    recording
}

#[test]
fn zeros_and_minus_ones_between_measurements_are_no_measurements() {
    let cases: [(Recording, &[Channel], f64); 4] = [
        (battery(), &[Channel::Power], 0.0),
        (battery(), &[Channel::Power], -1.0),
        (healthy(), &[Channel::RightPower], 0.0),
        (current_and_voltage(), &[Channel::Current], 0.0),
    ];
    for (recording, channels, value) in cases {
        for every in [2, 3, 10] {
            let told = found(&filled(recording.clone(), channels, value, |row| row % every == 1));
            assert!(told.len() == 1 && told[0].name == "placeholders", "{value} {every}: {told:?}");
            let said = &told[0].statement;
            assert!(said.contains(channels[0].name()) && said.contains("kJ without"), "{said}");
        }
    }
}

#[test]
fn a_join_that_fills_holes_with_zeros_is_told_by_power_and_wheels() {
    let plain = battery();
    let mut joined = Recording { runs: plain.runs.clone(), ..Recording::default() };
    for (channel, values) in &plain.channels {
        // Power has stamps of its own, after every fifth row.
        let at = |i: usize| values[i / 6 * 5 + i % 6];
        let rows = 0..values.len() / 5 * 6;
        let is_power_row = |i: usize| i % 6 == 5;
        let filled = rows.map(|i| match (is_power_row(i), *channel == Channel::Power) {
            (true, true) => values[(i / 6 * 5 + 5).min(values.len() - 1)],
            (false, false) => at(i),
            _ => 0.0,
        });
        joined.channels.insert(*channel, filled.collect());
    }
    for run in &mut joined.runs {
        run.rows = run.rows.start / 5 * 6..run.rows.end / 5 * 6;
        joined.t_s.extend(
            run.rows.clone().enumerate().map(|(i, _)| {
                0.1 * (i / 6 * 5) as f64 + if i % 6 == 5 { 0.413 } else { 0.1 * (i % 6) as f64 }
            }),
        );
    }
    let told = found(&joined);
    assert_eq!(told[0].name, "placeholders", "{told:?}");
    assert!(told[0].statement.contains("`power_w` is 0 to the last digit"), "{told:?}");
}

#[test]
fn meters_that_rest_at_zero_are_not_doubted() {
    // Meters that cannot tell what is given back, and tell whole watts.
    let mut one_way = healthy();
    for channel in [Channel::LeftPower, Channel::RightPower] {
        one_way.channels.get_mut(&channel).unwrap().iter_mut().for_each(|w| *w = w.max(0.0).round());
    }
    assert_eq!(found(&one_way), []);
    let coarse = filled(battery(), &[Channel::Power], 0.0, |_| false);
    let mut coarse = coarse;
    coarse
        .channels
        .get_mut(&Channel::Power)
        .unwrap()
        .iter_mut()
        .for_each(|w| *w = 12.0 * (*w / 12.0).round());
    assert_eq!(found(&coarse), []);
}

#[test]
fn currents_without_a_sign_are_zero_where_their_force_turns_round() {
    let robot = robot();
    let mut recording = healthy();
    let powers =
        [Channel::LeftPower, Channel::RightPower].map(|side| recording.channels.remove(&side).unwrap());
    for (side, power_w) in [Channel::LeftMotorCurrent, Channel::RightMotorCurrent].into_iter().zip(powers) {
        let current_a = |(row, w): (usize, &f64)| if row % 60 == 7 { 0.0 } else { (w / 24.0).abs() };
        recording.channels.insert(side, power_w.iter().enumerate().map(current_a).collect());
    }
    let found = doubts(&robot, &recording, &unwatched()).unwrap();
    assert!(found.iter().all(|doubt| doubt.name != "placeholders"), "{found:?}");
}

#[test]
fn cells_beyond_what_the_robot_can_do_are_told_by_row_and_energy_and_nothing_is_fitted_to_them() {
    let rows = |wanted: &'static [usize]| move |row: usize| wanted.contains(&row);
    let cases: [(Recording, Channel, f64, &[usize], &str); 6] = [
        (healthy(), Channel::LeftPower, 1e6, &[500], "1 of 1200 rows, first in row 101 of run `run-1`"),
        (healthy(), Channel::LeftPower, -9999.0, &[30, 31, 32, 700, 900], "5 of 1200 rows"),
        (battery(), Channel::Power, 65535.0, &[0, 500], "2 of 1200 rows, first in row 1 of run `run-0`"),
        (healthy(), Channel::LeftSpeed, 999.0, &[500], "999 in 1 of 1200 rows"),
        (healthy(), Channel::RightSpeed, -174.5, &[500, 501], "-174.5 in 2 of 1200 rows"),
        (current_and_voltage(), Channel::Voltage, 0.0, &[5, 500, 502], "3 of 1200 rows"),
    ];
    for (recording, channel, value, wanted, said) in cases {
        let doubtful = filled(recording, &[channel], value, rows(wanted));
        let told = found(&doubtful);
        assert!(told.len() == 1 && told[0].name == "beyond_the_robot", "{channel}: {told:?}");
        assert!(told[0].statement.contains(said) && told[0].statement.contains("without"), "{told:?}");
        let refused = Method::Fit.calibrate(&robot(), &doubtful, &Options::default()).unwrap_err();
        assert!(matches!(refused, Error::Doubtful { .. }), "{refused}");
    }
    let told = found(&filled(healthy(), &[Channel::LeftPower], 1e6, rows(&[500])));
    let without = predict(&robot(), &healthy()).unwrap().prediction.total.recorded_j;
    assert!(told[0].statement.contains(&format!("{:.1} kJ without", without / 1e3)), "{told:?} {without}");
}

#[test]
fn other_faults_are_told_beside_a_glitch() {
    let mut wrong = filled(healthy(), &[Channel::LeftPower], 1e6, |row| row == 500);
    for channel in [Channel::LeftPower, Channel::RightPower] {
        wrong.channels.get_mut(&channel).unwrap().iter_mut().for_each(|w| *w = -*w);
    }
    let names: Vec<_> = found(&wrong).iter().map(|doubt| doubt.name).collect();
    assert_eq!(names, ["beyond_the_robot", "power_sign"]);
}

#[test]
fn cells_of_fast_logs_are_looked_at_before_they_become_means() {
    let slow = battery();
    let mut fast = Recording { runs: slow.runs.clone(), ..Recording::default() };
    fast.t_s = (0..slow.rows() * 5).map(|i| slow.t_s[i / 5] + 0.02 * (i % 5) as f64).collect();
    fast.runs.iter_mut().for_each(|run| run.rows = run.rows.start * 5..run.rows.end * 5);
    for (channel, values) in &slow.channels {
        let noise =
            |i: usize| if *channel == Channel::Power { ((i * 7919) % 101) as f64 / 100.0 } else { 0.0 };
        fast.channels.insert(*channel, (0..values.len() * 5).map(|i| values[i / 5] + noise(i)).collect());
    }
    assert_eq!(found(&fast), []);
    let told = found(&filled(fast, &[Channel::Power], 0.0, |row| row % 2 == 1));
    assert!(told.len() == 1 && told[0].name == "placeholders", "{told:?}");
}

#[test]
fn channels_that_stand_still_while_the_robot_drives_are_frozen() {
    let rows = 20..380;
    let value = |recording: &Recording, channel| recording.channel(channel).unwrap()[20];
    let battery = battery();
    let told = found(&filled(battery.clone(), &[Channel::Power], 61.7, |row| rows.contains(&row)));
    assert!(told[0].name == "frozen" && told[0].statement.contains("`power_w` at 61.7"), "{told:?}");
    let ammeter = filled(current_and_voltage(), &[Channel::Current], 3.3, |row| rows.contains(&row));
    assert_eq!(found(&ammeter)[0].name, "frozen");
    // Readings that are held for a second, and meters of whole steps, stay as well.
    let mut held = battery.clone();
    let power_w = held.channels.get_mut(&Channel::Power).unwrap();
    (0..power_w.len()).for_each(|row| power_w[row] = power_w[row / 10 * 10]);
    assert!(found(&held).iter().all(|doubt| doubt.name != "frozen"), "{:?}", found(&held));
    let mut wheels = healthy();
    // Measured speeds have noise in every row.
    for channel in [Channel::LeftSpeed, Channel::RightSpeed] {
        let values = wheels.channels.get_mut(&channel).unwrap();
        values.iter_mut().enumerate().for_each(|(i, v)| *v += 1e-4 * (i as f64 * 1.7).sin());
    }
    for channel in [Channel::LeftSpeed, Channel::RightSpeed] {
        let stays = value(&wheels, channel);
        wheels = filled(wheels, &[channel], stays + 0.3, |row| rows.contains(&row));
    }
    let told = found(&wheels);
    assert!(told.len() == 1 && told[0].name == "frozen", "{told:?}");
    // Coarse encoders stay at a steady speed.
    let coarse = changed(wheels, &[Channel::LeftSpeed, Channel::RightSpeed], |v| 0.05 * (v / 0.05).round());
    assert!(found(&coarse).iter().all(|doubt| doubt.name != "frozen"), "{:?}", found(&coarse));
    assert!(told[0].statement.contains("of both sides stands still to the last digit for 3"), "{told:?}");
}

#[test]
fn one_measurement_in_the_columns_of_both_sides_is_told() {
    let mut wrong = healthy();
    let total: Vec<f64> = {
        let [left, right] =
            [Channel::LeftPower, Channel::RightPower].map(|side| wrong.channel(side).unwrap());
        left.iter().zip(right).map(|(l, r)| l + r).collect()
    };
    for channel in [Channel::LeftPower, Channel::RightPower, Channel::Power] {
        wrong.channels.insert(channel, total.clone());
    }
    let told = found(&wrong);
    assert!(told.len() == 1 && told[0].name == "sides_alike", "{told:?}");
    assert!(told[0].statement.contains("and so is `power_w`"), "{told:?}");
}

#[test]
fn a_voltage_of_one_cell_is_told_by_power_and_another_battery_that_is_right_is_not() {
    let mut cell = current_and_voltage();
    cell.channels.get_mut(&Channel::Voltage).unwrap().iter_mut().for_each(|v| *v /= 7.0);
    let told = found(&cell);
    assert!(told.len() == 1 && told[0].name == "voltage", "{told:?}");
    let mut twice = current_and_voltage();
    twice.channels.get_mut(&Channel::Voltage).unwrap().iter_mut().for_each(|v| *v *= 2.0);
    twice.channels.get_mut(&Channel::Current).unwrap().iter_mut().for_each(|a| *a /= 2.0);
    assert_eq!(found(&twice), []);
}
