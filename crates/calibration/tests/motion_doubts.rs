//! Times, turning, slopes and temperatures that contradict the rest of a recording are doubted, and healthy ones are not.

#![allow(clippy::unwrap_used)]

use calibration::{Error, Method, Options, predict};
use rand::RngExt;
use recording::{Channel, Recording};

mod simulated;
use simulated::doubted::{found, only, robot};
use simulated::{
    changed, drives, healthy, normal, placed, seeded, with_battery_power, with_heat, with_power,
};

const WHEELS: [Channel; 2] = [Channel::LeftSpeed, Channel::RightSpeed];

fn timed(mut recording: Recording, factor: f64) -> Recording {
    recording.t_s.iter_mut().for_each(|t_s| *t_s *= factor);
    recording.runs.iter_mut().for_each(|run| run.gap_s *= factor);
    recording
}

#[test]
fn times_in_another_unit_are_told_by_positions() {
    assert_eq!(found(&placed(healthy())), []);
    for (seconds, name) in [(60.0, "minutes"), (0.1, "tenths"), (1e-3, "milliseconds")] {
        let told = only(&timed(placed(healthy()), 1.0 / seconds), "time_scale");
        assert!(told.cure.contains(name), "{told:?}");
    }
}

#[test]
fn times_in_another_unit_are_told_by_wheels_alone() {
    // A second and a half for every change of speed, and noise, at ten rows a second.
    let mut random = seeded(3);
    let mut plain = drives(&mut random, 3, 400);
    for channel in WHEELS {
        let values = plain.channels.get_mut(&channel).unwrap();
        let commanded: Vec<f64> =
            values.iter().enumerate().map(|(i, _)| [0.0, 0.7, 0.3, -0.4, 0.8][i / 60 % 5]).collect();
        let mut speed = 0.0_f64;
        for (value, to) in values.iter_mut().zip(commanded) {
            speed += (to - speed).clamp(-0.05, 0.05);
            *value = speed;
        }
    }
    let recording = with_power(&robot(), plain, &mut random);
    assert_eq!(found(&recording), []);
    let told = only(&timed(recording.clone(), 1.0 / 60.0), "time_scale");
    assert!(told.statement.contains("tyres hold no more"), "{told:?}");
    let told = only(&timed(recording, 10.0), "time_scale");
    assert!(told.cure.contains("0.1 for tenths"), "{told:?}");
}

#[test]
fn rows_that_lie_seconds_apart_are_said_to_miss_what_is_between_them() {
    let notes = |recording: &Recording| predict(&robot(), recording).unwrap().prediction.notes;
    let is_said = |note: &String| note.contains("apart");
    assert!(!notes(&healthy()).iter().any(is_said));
    let mut sparse = timed(healthy(), 60.0);
    sparse.channels.remove(&Channel::YawRate);
    assert!(notes(&sparse).iter().any(|note| note.contains("rows lie 6.0 s apart")), "{:?}", notes(&sparse));
}

#[test]
fn a_fit_that_short_drives_contradict_is_refused() {
    let wrong = changed(healthy(), &[Channel::LeftPower, Channel::RightPower], |w| 150.0 - w);
    let mut short = timed(wrong, 0.2);
    short.channels.remove(&Channel::YawRate);
    let despite = ["power_sign", "power_scale", "time_scale"].map(String::from).to_vec();
    let options = Options { despite, ..Options::default() };
    let refused = Method::Fit.calibrate(&robot(), &short, &options).unwrap_err();
    assert!(matches!(refused, Error::Contradicted { r2, .. } if r2 < 0.0), "{refused}");
}

#[test]
fn turning_that_wheels_do_not_drive_is_told_with_what_they_look_like() {
    let mut chassis = healthy();
    let [left, right] = WHEELS.map(|side| chassis.channel(side).unwrap().to_vec());
    let mean: Vec<f64> = left.iter().zip(&right).map(|(l, r)| (l + r) / 2.0).collect();
    for side in WHEELS {
        chassis.channels.insert(side, mean.clone());
    }
    assert!(only(&chassis, "turning").statement.contains("both columns hold one speed in 1200 of 1200 rows"));
    let unsigned = changed(healthy(), &WHEELS, f64::abs);
    assert!(only(&unsigned, "turning").cure.contains("sign"));
}

#[test]
fn angles_in_degrees_are_called_so() {
    for channels in [&[Channel::Pitch][..], &[Channel::Pitch, Channel::Roll]] {
        let told = only(&changed(healthy(), channels, f64::to_degrees), "angle_unit");
        assert!(told.cure.contains("`deg`"), "{told:?}");
    }
    // An inclinometer that is askew is none of these.
    let askew = found(&changed(healthy(), &[Channel::Pitch], |rad| rad + 0.15));
    assert!(askew.iter().all(|doubt| doubt.name != "angle_unit"), "{askew:?}");
}

#[test]
fn power_that_lags_or_leads_is_told_with_its_delay_and_a_usual_delay_is_not() {
    let mut random = seeded(8);
    let plain = drives(&mut random, 3, 600);
    for (recording, channels) in [
        (with_power(&robot(), plain.clone(), &mut random), vec![Channel::LeftPower, Channel::RightPower]),
        (with_battery_power(&robot(), plain, &mut random), vec![Channel::Power]),
    ] {
        let shifted = |rows: isize| {
            let mut recording = recording.clone();
            for channel in &channels {
                let values = recording.channels[channel].clone();
                for run in &recording.runs {
                    for row in run.rows.clone() {
                        let from =
                            (row as isize - rows).clamp(run.rows.start as isize, run.rows.end as isize - 1);
                        recording.channels.get_mut(channel).unwrap()[row] = values[from as usize];
                    }
                }
            }
            recording
        };
        assert_eq!(found(&shifted(2)), []);
        for (rows, said) in [
            (6, "lags behind the wheels by 0.6 s"),
            (20, "by 2.0 s"),
            (-20, "ahead of the wheels by 2.0 s"),
            (50, "by 5.0 s"),
        ] {
            assert!(only(&shifted(rows), "power_delay").statement.contains(said), "{rows}");
        }
    }
}

#[test]
fn heights_that_wander_are_doubted_and_those_of_the_ground_are_taken_and_said() {
    let mut good = placed(healthy());
    good.channels.remove(&Channel::Pitch);
    assert_eq!(found(&good), []);
    let notes = predict(&robot(), &good).unwrap().prediction.notes;
    assert!(
        notes.iter().any(|note| note.contains("slopes along the way are those of the heights")),
        "{notes:?}"
    );
    let mut random = seeded(4);
    let mut poor = good.clone();
    let (mut error_m, stays) = (0.0, (-0.1_f64 / 60.0).exp());
    for z_m in poor.channels.get_mut(&Channel::Z).unwrap() {
        error_m = stays * error_m + 1.5 * (1.0 - stays * stays).sqrt() * normal(&mut random);
        *z_m += error_m;
    }
    let told = only(&poor, "heights");
    assert!(
        told.statement.contains("more error than ground") && told.statement.contains("on level ground"),
        "{told:?}"
    );
    let downwards = changed(good, &[Channel::Z], |z_m| -z_m);
    assert!(only(&downwards, "heights").statement.contains("downwards"));
}

#[test]
fn temperatures_in_kelvin_or_fahrenheit_are_told_and_warm_motors_are_not() {
    let mut random = seeded(5);
    let motors = [Channel::LeftMotorTemperature, Channel::RightMotorTemperature];
    let plain = with_heat(drives(&mut random, 3, 400), &mut random);
    let warm = with_power(&robot(), plain, &mut random);
    assert_eq!(found(&warm), []);
    assert_eq!(found(&changed(warm.clone(), &motors, |c| c + 273.15))[0].name, "temperature_unit");
    let mut steady = healthy();
    for channel in motors {
        steady
            .channels
            .insert(channel, (0..steady.rows()).map(|_| random.random_range(20.0..20.5)).collect());
    }
    assert_eq!(found(&steady), []);
    let told = only(&changed(steady.clone(), &motors, |c| 1.8 * c + 32.0), "temperature_unit");
    assert!(told.cure.contains("`degF`"), "{told:?}");
    let mut air = steady;
    air.channels.insert(Channel::AmbientTemperature, vec![293.0; air.rows()]);
    assert!(only(&air, "temperature_unit").cure.contains("20 °C"));
    // Motors that are as warm as that, and draw as such motors do.
    let mut hot = drives(&mut random, 3, 400);
    for channel in motors {
        hot.channels.insert(channel, vec![77.0; hot.rows()]);
    }
    assert_eq!(found(&with_power(&robot(), hot, &mut random)), []);
}
