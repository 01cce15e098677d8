//! Sensors err as they are asked to, and in no other way.

#![allow(clippy::unwrap_used)]

use world::{Drive, DriveKind, Log, PowerChannels, Sensors, World, example_robot, simulate, simulate_all};

fn record(sensors: Sensors, seed: u64) -> Log {
    let world = World::from_json(r#"{"terrain": {"rolling": {"grade": 0.05}}}"#).unwrap();
    simulate(&World { sensors, seed, ..world }, &example_robot(), &Drive::new(DriveKind::Rich, 200.0, 4))
        .unwrap()
}

#[test]
fn the_same_seed_records_the_same_and_another_seed_other_noise_on_the_same_drive() {
    let bits = |seed| format!("{:?}", record(Sensors::default(), seed).rows);
    assert!(bits(1) == bits(1));
    assert!(bits(1) != bits(2));
    let silent = |seed| format!("{:?}", record(Sensors::perfect(), seed).rows);
    assert!(silent(1) == silent(2));
}

#[test]
fn drives_of_one_recording_follow_one_another_and_each_has_noise_of_its_own() {
    let drive = Drive::new(DriveKind::Rich, 60.0, 4);
    let recorded = |sensors: Sensors, drives: &[Drive]| {
        let world =
            World { sensors, ..World::from_json(r#"{"terrain": {"rolling": {"grade": 0.03}}}"#).unwrap() };
        simulate_all(&world, &example_robot(), drives).unwrap()
    };
    let both = recorded(Sensors::default(), &[drive.clone(), drive.clone()]);
    assert!(both.rows.windows(2).all(|w| w[1].t_s > w[0].t_s && w[1].run >= w[0].run));
    let (first, second) = both.rows.split_at(both.rows.len() / 2);
    assert!(first.iter().all(|row| row.run == 1) && second.iter().all(|row| row.run == 2));
    let power = |rows: &[world::Row]| rows.iter().map(|row| row.battery_w.to_bits()).collect::<Vec<_>>();
    assert_ne!(power(first), power(second));
    // Without noise the same drive is the same again, by the same robot.
    let both = recorded(Sensors::perfect(), &[drive.clone(), drive.clone()]);
    let (first, second) = both.rows.split_at(both.rows.len() / 2);
    assert_eq!(power(first), power(second));
    assert!(recorded(Sensors::default(), &[]).rows.is_empty());
}

#[test]
fn sensors_without_gaps_leave_no_gap() {
    let log = record(Sensors { dropouts: 0.0, ..Sensors::default() }, 1);
    let columns = log.columns();
    assert!(log.rows.iter().all(|row| columns.iter().all(|(_, value)| value(row).is_finite())));
    assert!(log.rows.windows(2).all(|w| w[1].t_s > w[0].t_s));
}

#[test]
fn a_delay_shifts_power_by_its_rows() {
    let (on_time, late) =
        (record(Sensors::perfect(), 1), record(Sensors { power_delay_s: 0.5, ..Sensors::perfect() }, 1));
    for (row, later) in on_time.rows.iter().zip(&late.rows[5..]) {
        assert!((row.battery_w - later.battery_w).abs() < 1e-6);
        assert_ne!(row.t_s, later.t_s);
    }
    assert_eq!(on_time.rows[50].rim_mps, late.rows[50].rim_mps, "only power is late");
}

#[test]
fn readings_come_in_their_steps() {
    let log = record(Sensors { power_step_w: 5.0, encoder_step_m: 0.01, ..Sensors::perfect() }, 1);
    let whole = |value: f64| (value - value.round()).abs() < 1e-6;
    assert!(log.rows.iter().all(|row| whole(row.side_w[0] / 5.0) && whole(row.rim_mps[1] * 0.1 / 0.01)));
    let rolled = |log: &Log| log.rows.iter().map(|row| row.rim_mps[0] * 0.1).sum::<f64>();
    let fine = record(Sensors::perfect(), 1);
    assert!((rolled(&log) - rolled(&fine)).abs() < 0.01, "counts are not lost between rows");
}

#[test]
fn gaps_are_as_frequent_as_asked_and_of_one_group_at_a_time() {
    let log = record(Sensors { dropouts: 0.1, dropout_rows: 4.0, ..Sensors::default() }, 3);
    let share = |gap: fn(&world::Row) -> bool| {
        log.rows.iter().filter(|row| gap(row)).count() as f64 / log.rows.len() as f64
    };
    for share in
        [share(|r| r.rim_mps[0].is_nan()), share(|r| r.battery_w.is_nan()), share(|r| r.pitch_rad.is_nan())]
    {
        assert!((0.04..0.17).contains(&share), "{share}");
    }
    assert!(share(|r| r.rim_mps[0].is_nan() && r.battery_w.is_nan()) < 0.06);
}

#[test]
fn noise_and_bias_have_the_size_they_are_given() {
    let (noisy, fine) =
        (record(Sensors { dropouts: 0.0, ..Sensors::default() }, 5), record(Sensors::perfect(), 5));
    let spread = |value: fn(&world::Row) -> f64| {
        let errors: Vec<f64> = noisy.rows.iter().zip(&fine.rows).map(|(a, b)| value(a) - value(b)).collect();
        let mean = errors.iter().sum::<f64>() / errors.len() as f64;
        (mean, (errors.iter().map(|e| (e - mean).powi(2)).sum::<f64>() / errors.len() as f64).sqrt())
    };
    let (bias_rad, noise_rad) = spread(|r| r.pitch_rad);
    assert!(bias_rad.abs() < 0.002 && (noise_rad / 0.002 - 1.0).abs() < 0.1, "{bias_rad} {noise_rad}");
    let (_, noise_w) = spread(|r| r.side_w[0]);
    assert!((1.4..2.2).contains(&noise_w), "{noise_w}");
    let (_, noise_mps) = spread(|r| r.rim_mps[0]);
    assert!((0.0015..0.0021).contains(&noise_mps), "{noise_mps}");
}

#[test]
fn columns_are_those_that_the_sensors_tell() {
    let names = |power, motor_temperature| {
        let log = record(Sensors { power, motor_temperature, ..Sensors::default() }, 1);
        let mut text = Vec::new();
        log.write_csv(&mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        assert_eq!(text.lines().count(), 2001);
        text.lines().next().unwrap().to_owned()
    };
    let plain = names(PowerChannels::SidesAndBattery, false);
    assert_eq!(
        plain,
        "t_s,v_left_mps,v_right_mps,power_left_w,power_right_w,power_w,voltage_v,yaw_rate_radps,pitch_rad,roll_rad,x_m,y_m,z_m,surface,run"
    );
    assert!(names(PowerChannels::MotorCurrents, false).contains("motor_current_left_a"));
    assert!(names(PowerChannels::CurrentAndVoltage, true).contains("current_a,voltage_v"));
    assert!(names(PowerChannels::Battery, true).contains("motor_temp_left_c"));
}

#[test]
fn any_rate_keeps_the_clock() {
    let mean_w = |rate_hz: f64| {
        let log = record(Sensors { rate_hz, ..Sensors::perfect() }, 1);
        assert!((log.rows.len() as f64 - 200.0 * rate_hz).abs() < 1.0);
        assert!((log.rows.last().unwrap().t_s - 200.0).abs() < 1.0 / rate_hz);
        let rolled_m: f64 = log.rows.iter().map(|row| row.rim_mps[0] / rate_hz).sum();
        (log.rows.iter().map(|row| row.battery_w).sum::<f64>() / log.rows.len() as f64, rolled_m)
    };
    let (ten, odd, fast) = (mean_w(10.0), mean_w(6.5), mean_w(20.0));
    for other in [odd, fast] {
        assert!(
            (other.0 / ten.0 - 1.0).abs() < 0.02 && (other.1 / ten.1 - 1.0).abs() < 0.01,
            "{other:?} {ten:?}"
        );
    }
}
