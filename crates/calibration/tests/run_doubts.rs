//! A wrong run among good ones is doubted by its name, and good ones are not, however short.

#![allow(clippy::unwrap_used)]

use calibration::{Doubt, Error, Method, Options, doubts};
use model::builtin;
use recording::{Channel, Recording, unwatched};

mod simulated;
use simulated::{drives, healthy_of, placed, seeded, with_battery_power, with_power};

const POWERS: [Channel; 2] = [Channel::LeftPower, Channel::RightPower];

fn found(recording: &Recording) -> Vec<Doubt> {
    doubts(&builtin::husky_a200(), recording, &unwatched()).unwrap()
}

/// A recording whose second run has some channels changed by row of the run and value.
fn second_changed(
    mut recording: Recording,
    channels: &[Channel],
    change: impl Fn(&[f64], usize) -> f64,
) -> Recording {
    let rows = recording.runs[1].rows.clone();
    for channel in channels {
        let values = recording.channels.get_mut(channel).unwrap();
        let before = values[rows.clone()].to_vec();
        (0..rows.len()).for_each(|row| values[rows.start + row] = change(&before, row));
    }
    recording
}

#[test]
fn a_wrong_run_among_good_ones_is_named_and_nothing_is_fitted_to_it() {
    let healthy = || healthy_of(1200);
    let late = |before: &[f64], row: usize| before[row.saturating_sub(12)];
    let cases = [
        (second_changed(healthy(), &[Channel::Pitch], |before, row| -before[row]), "pitch_sign"),
        (second_changed(healthy(), &POWERS, late), "power_delay"),
        (second_changed(healthy(), &POWERS, |before, row| before[row] / 25.0), "power_scale"),
        (second_changed(healthy(), &[Channel::YawRate], |before, row| -before[row]), "turning_sign"),
    ];
    for (recording, name) in cases {
        let told = found(&recording);
        assert!(told.len() == 1 && told[0].name == name, "{name}: {told:?}");
        assert!(told[0].statement.contains("run `run-1`"), "{told:?}");
        let refused = Method::Fit.calibrate(&builtin::husky_a200(), &recording, &Options::default());
        assert!(matches!(refused, Err(Error::Doubtful { .. })), "{name}");
    }
}

#[test]
fn a_doubt_that_all_runs_share_is_told_once_and_of_all() {
    let told = found(&simulated::changed(healthy_of(1200), &[Channel::Pitch], |rad| -rad));
    assert!(told.len() == 1 && !told[0].statement.contains("alone"), "{told:?}");
}

#[test]
fn short_healthy_runs_are_not_doubted() {
    for (seed, rows) in [(11, 60), (12, 120), (13, 250), (14, 400)] {
        let mut random = seeded(seed);
        let plain = placed(drives(&mut random, 12, rows));
        let sides = with_power(&builtin::husky_a200(), plain.clone(), &mut random);
        assert_eq!(found(&sides), [], "{rows} rows, sides");
        let battery = with_battery_power(&builtin::husky_a200(), plain, &mut random);
        assert_eq!(found(&battery), [], "{rows} rows, battery");
    }
}
