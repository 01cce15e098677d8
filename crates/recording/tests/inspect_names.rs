//! The columns that `inspect` takes for channels: by the quantity that a name says, never by a place alone, and of equals none.

#![allow(clippy::unwrap_used)]

use std::{f64::consts::TAU, fs};

use recording::inspect::{Inspection, inspect};
use serde_json::Value;

const ROWS: usize = 600;

type Numbers<'n> = &'n dyn Fn(f64) -> f64;

/// A drive back and forth, with other columns beside it, as it is inspected.
fn inspected(name: &str, columns: &[(&str, Numbers<'_>)]) -> Inspection {
    let path = std::env::temp_dir().join(format!("joulepath-names-{name}-{}.csv", std::process::id()));
    let names: Vec<&str> = ["time"].into_iter().chain(columns.iter().map(|column| column.0)).collect();
    let mut text = names.join(",") + "\n";
    for row in 0..ROWS {
        let t_s = 0.1 * row as f64;
        let cells = columns.iter().map(|column| format!("{:.4}", (column.1)(t_s)));
        text += &(std::iter::once(format!("{t_s:.1}")).chain(cells).collect::<Vec<_>>().join(",") + "\n");
    }
    fs::write(&path, text).unwrap();
    let found = inspect(&path).unwrap();
    fs::remove_file(path).unwrap();
    found
}

/// The source of a channel, as `column, column [unit]`.
fn source(found: &Inspection, channel: &str) -> Option<String> {
    let sources = found.map["sources"].as_array().unwrap();
    let source = sources.iter().find(|source| source["channel"] == channel)?;
    let names: Vec<&str> = source["columns"].as_array().unwrap().iter().filter_map(Value::as_str).collect();
    let combine = source["combine"].as_str().map_or(String::new(), |combine| format!(" {combine}"));
    Some(format!("{} [{}]{combine}", names.join(", "), source["unit"].as_str().unwrap()))
}

fn speed(t_s: f64) -> f64 {
    0.4 * (0.3 * t_s).sin() + 0.1 * (0.07 * t_s).cos()
}

fn power(t_s: f64) -> f64 {
    30.0 + 150.0 * speed(t_s).abs()
}

fn voltage(t_s: f64) -> f64 {
    26.0 - 0.01 * t_s
}

fn current(t_s: f64) -> f64 {
    power(t_s) / voltage(t_s)
}

const SPEEDS: [(&str, Numbers<'_>); 2] = [("vel_left", &speed), ("vel_right", &speed)];
const POWER: (&str, Numbers<'_>) = ("power", &power);

fn with<'n>(columns: &[(&'n str, Numbers<'n>)]) -> Vec<(&'n str, Numbers<'n>)> {
    SPEEDS.into_iter().chain(columns.iter().copied()).collect()
}

#[test]
fn a_column_of_another_quantity_at_a_wheel_is_no_speed_of_it() {
    for name in [
        "left_wheel_slip",
        "left_ref_speed",
        "left_encoder_ok",
        "left_wheel_angle",
        "left_wheel_pos",
        "left_wheel_status",
        "left_wheel_duty",
        "left_motor_health",
        "left_wheel",
        "left_speed_target",
        "left_encoder_rad",
        "/joint_states/front_left_wheel_joint/effort",
        "/joint_states/front_left_wheel_joint/position",
    ] {
        // The column in question comes first in the file.
        let columns: Vec<(&str, Numbers<'_>)> =
            [(name, &speed as Numbers<'_>)].into_iter().chain(with(&[POWER])).collect();
        let found = inspected("other", &columns);
        assert_eq!(
            source(&found, "v_left_mps").as_deref(),
            Some("vel_left [m/s]"),
            "{name}: {:?}",
            found.notes
        );
        let alone = inspected("alone", &[(name, &|t_s| (7.0 * t_s) % TAU), ("right_speed", &speed), POWER]);
        assert_eq!(source(&alone, "v_left_mps"), None, "{name}");
    }
}

#[test]
fn a_path_of_topics_says_the_place_and_its_last_part_the_quantity() {
    let path = |side: &str, of: &str| format!("/joint_states/front_{side}_wheel_joint/{of}");
    let names = ["left", "right"].map(|side| ["effort", "position", "velocity"].map(|of| path(side, of)));
    let wheels = names.iter().flatten().map(|name| (name.as_str(), &speed as Numbers<'_>));
    let battery = [("/battery_state/current", &current as Numbers<'_>), ("/battery_state/voltage", &voltage)];
    let found = inspected("path", &wheels.chain(battery).collect::<Vec<_>>());
    assert_eq!(source(&found, "v_left_mps").unwrap(), format!("{} [rad/s]", path("left", "velocity")));
    assert_eq!(source(&found, "current_a").unwrap(), "/battery_state/current [A]");
}

#[test]
fn flags_and_enumerations_are_no_power() {
    let flattened: [(&str, Numbers<'_>); 6] = [
        ("field.voltage", &voltage),
        ("field.current", &current),
        ("field.power_supply_status", &|_| 2.0),
        ("field.power_supply_health", &|_| 1.0),
        ("field.power_supply_technology", &|_| 3.0),
        ("power_mode", &|t_s| (t_s / 20.0).floor()),
    ];
    let found = inspected("flags", &with(&flattened));
    assert_eq!(source(&found, "power_w"), None, "{:?}", found.map);
    assert_eq!(source(&found, "current_a").unwrap(), "field.current [A]");
    let constant_and_small: [Numbers<'_>; 2] = [&|_| 80.0, &|t_s| (t_s / 20.0).floor()];
    for constant_or_small in constant_and_small {
        let found = inspected("small", &with(&[("battery_power", constant_or_small)]));
        assert_eq!(source(&found, "power_w"), None);
        assert!(
            found.notes.iter().any(|note| note.contains("`battery_power` is left out")),
            "{:?}",
            found.notes
        );
    }
}

#[test]
fn of_two_columns_that_are_equally_good_none_is_taken_and_both_are_named() {
    let found = inspected(
        "equal",
        &with(&[
            ("voltage_12v", &|_| 12.1),
            ("voltage_24v", &voltage),
            ("current_12v", &|t_s| 2.0 + 0.01 * t_s.sin()),
            ("current_24v", &current),
        ]),
    );
    for (channel, columns) in
        [("current_a", ["current_12v", "current_24v"]), ("voltage_v", ["voltage_12v", "voltage_24v"])]
    {
        assert_eq!(source(&found, channel), None, "{channel}");
        let named = |note: &&String| columns.iter().all(|column| note.contains(&format!("`{column}`")));
        let note = found.notes.iter().find(named).unwrap();
        assert!(note.contains("choose") && note.contains(channel), "{note}");
    }
}

#[test]
fn what_is_the_batterys_or_the_bodys_comes_before_parts_and_other_sensors() {
    let found = inspected(
        "rail",
        &with(&[
            ("current_12v", &|_| 2.0),
            ("motor_current", &current),
            ("current", &current),
            ("voltage", &voltage),
        ]),
    );
    assert_eq!(source(&found, "current_a").unwrap(), "current [A]");
    let found = inspected(
        "camera",
        &with(&[POWER, ("camera_pitch", &|_| -0.3), ("imu_pitch", &|t_s| 0.05 * t_s.sin())]),
    );
    assert_eq!(source(&found, "pitch_rad").unwrap(), "imu_pitch [rad]");
    let found = inspected("gimbal", &with(&[POWER, ("gimbal_pitch", &|_| -0.3)]));
    assert_eq!(source(&found, "pitch_rad"), None, "a gimbal's pitch is never the robot's");
    let axes = ["x", "y", "z"].map(|axis| format!("gyro_{axis}_dps"));
    let gyro = axes.iter().map(|name| (name.as_str(), &speed as Numbers<'_>));
    let found = inspected("gyro", &with(&[POWER]).into_iter().chain(gyro).collect::<Vec<_>>());
    assert_eq!(source(&found, "yaw_rate_radps").unwrap(), "gyro_z_dps [deg/s]");
}

#[test]
fn columns_alike_but_for_a_number_are_parts_of_a_whole() {
    let half = |t_s: f64| 0.5 * current(t_s);
    let found = inspected(
        "packs",
        &with(&[
            ("pack1_current", &half),
            ("pack2_current", &half),
            ("pack1_voltage", &voltage),
            ("pack2_voltage", &voltage),
        ]),
    );
    assert_eq!(source(&found, "current_a").unwrap(), "pack1_current, pack2_current [A] sum");
    assert_eq!(source(&found, "voltage_v").unwrap(), "pack1_voltage, pack2_voltage [V]");
    assert!(found.notes.iter().any(|note| note.contains("added up") && note.contains("`pack2_current`")));
    let found = inspected("powers", &with(&[("battery_1_power", &power), ("battery_2_power", &power)]));
    assert_eq!(source(&found, "power_w").unwrap(), "battery_1_power, battery_2_power [W] sum");
    // Voltages that never meet are not of packs side by side.
    let found =
        inspected("series", &with(&[("pack1_voltage", &|_| 12.0), ("pack2_voltage", &voltage), POWER]));
    assert_eq!(source(&found, "voltage_v"), None);
    let found = inspected(
        "motors",
        &with(&[("motor1_current", &half), ("motor2_current", &half), ("battery_voltage", &voltage)]),
    );
    assert_eq!(source(&found, "current_a").unwrap(), "motor1_current, motor2_current [A] sum");
    assert!(
        found.notes.iter().any(|note| note.contains("`motor1_current` is of a part")),
        "{:?}",
        found.notes
    );
}

#[test]
fn columns_of_the_sides_that_explain_nothing_of_the_batterys_power_are_none() {
    let duty = |t_s: f64| 100.0 * speed(t_s);
    let battery: [(&str, Numbers<'_>); 2] = [("battery_voltage", &voltage), ("battery_current", &current)];
    let sides: [(&str, Numbers<'_>); 2] = [("left_power", &duty), ("right_power", &duty)];
    let found = inspected("duty", &with(&[sides, battery].concat()));
    assert_eq!(source(&found, "power_left_w"), None, "{:?}", found.map);
    assert!(found.notes.iter().any(|note| note.contains("`left_power`")), "{:?}", found.notes);
    let half = |t_s: f64| 75.0 * speed(t_s).abs();
    let sides: [(&str, Numbers<'_>); 2] = [("left_power", &half), ("right_power", &half)];
    let found = inspected("halves", &with(&[sides, battery].concat()));
    assert_eq!(source(&found, "power_left_w").unwrap(), "left_power [W]");
}

#[test]
fn a_current_that_discharge_makes_negative_is_drawn() {
    let of = |current: Numbers<'_>| {
        inspected("sign", &with(&[("field.voltage", &voltage), ("field.current", current)]))
    };
    let sign = |found: &Inspection| {
        let sources = found.map["sources"].as_array().unwrap().iter();
        sources.clone().find(|source| source["channel"] == "current_a").unwrap()["sign"].clone()
    };
    let found = of(&|t_s| -current(t_s));
    assert_eq!(sign(&found), "drawn");
    assert!(found.notes.iter().any(|note| note.contains("negative on the whole")), "{:?}", found.notes);
    assert!(sign(&of(&current)).is_null());
}

#[test]
fn prefixed_units_are_read_or_said_to_be_unknown() {
    let hundredths = |t_s: f64| (100.0 * current(t_s)).round();
    let of = |name: &str, numbers: Numbers<'_>| {
        inspected("prefix", &with(&[(name, numbers), ("voltage_V", &voltage)]))
    };
    for (name, unit, scale) in
        [("current_cA", "cA", 100.0), ("battery_current_dA", "dA", 10.0), ("current_ca", "cA", 100.0)]
    {
        let found = of(name, &|t_s| (scale * current(t_s)).round());
        assert_eq!(source(&found, "current_a").unwrap(), format!("{name} [{unit}]"));
    }
    for name in ["current_daA", "current_hA", "current_uA", "battery_current_nA"] {
        let found = of(name, &hundredths);
        assert_eq!(source(&found, "current_a"), None, "{name}");
        let is_said = |note: &String| note.contains(&format!("column `{name}` is left out"));
        assert!(found.notes.iter().any(is_said), "{name}: {:?}", found.notes);
    }
    let found = inspected(
        "volts",
        &with(&[("current", &current), ("battery_cV", &|t_s| (100.0 * voltage(t_s)).round())]),
    );
    assert_eq!(source(&found, "voltage_v").unwrap(), "battery_cV [cV]");
}

#[test]
fn a_battery_as_mavlink_tells_it_is_in_its_units() {
    let found = inspected(
        "mavlink",
        &with(&[
            ("voltage_battery", &|t_s| (1000.0 * voltage(t_s)).round()),
            ("current_battery", &|t_s| (100.0 * current(t_s)).round()),
        ]),
    );
    assert_eq!(source(&found, "current_a").unwrap(), "current_battery [cA]");
    assert_eq!(source(&found, "voltage_v").unwrap(), "voltage_battery [mV]");
    let found = inspected("amperes", &with(&[("voltage_battery", &voltage), ("current_battery", &current)]));
    assert_eq!(source(&found, "current_a").unwrap(), "current_battery [A]");
}
