//! Channels that are made of several parts: encoders of a side, counters, battery packs.

#![allow(clippy::unwrap_used)]

mod written;

use recording::{Channel, Format, Map, Reading, read};
use written::{DRIVE, Type, drive, mcap_of_topics};

/// A table of a drive of a minute, of which a function tells the columns behind power.
fn table(header: &str, columns: impl Fn(usize) -> String) -> Vec<u8> {
    let mut text = format!("t_s,power_w,v_right_mps,{header}\n");
    for row in 0..600 {
        text += &format!("{:.1},{},{:.4},{}\n", 0.1 * row as f64, 50 + row % 7, turns_mps(row), columns(row));
    }
    text.into_bytes()
}

fn turns_mps(row: usize) -> f64 {
    0.5 + 0.1 * (0.3 * row as f64).sin()
}

fn read_by(map: &str, bytes: Vec<u8>, format: Format) -> Reading {
    read(bytes, format, "drive", Some(&Map::from_json(map).unwrap())).unwrap()
}

fn speeds(reading: &Reading) -> Vec<f64> {
    reading.recording.channel(Channel::LeftSpeed).unwrap().to_vec()
}

#[test]
fn no_speed_is_taken_from_where_one_encoder_of_a_side_stands_and_the_other_turns() {
    let map = r#"{"name": "own", "sources": [{"channel": "v_left_mps", "columns": ["front", "rear"]}]}"#;
    let dead = table("front,rear", |row| {
        format!("{:.4},{:.4}", turns_mps(row), if row < 360 { turns_mps(row) } else { 0.0 })
    });
    let reading = read_by(map, dead, Format::Csv);
    let known = speeds(&reading).iter().filter(|v| !v.is_nan()).count();
    assert_eq!(known, 361, "{}", reading.report);
    let told = reading.report.repairs.iter().find(|repair| repair.place == "rear").unwrap();
    assert!(told.what.starts_with("it stands while front turns, from 36.1 s"), "{}", told.what);

    // As positions, from a bag: wheels turn at 2 m/s.
    let map = r#"{"name": "own", "sources": [
        {"channel": "v_left_mps", "topic": "/drive", "fields": ["left", "right"], "derivative": true},
        {"channel": "v_right_mps", "topic": "/drive", "fields": ["right"], "derivative": true},
        {"channel": "power_w", "topic": "/drive", "fields": ["watts"]}]}"#;
    let messages: Vec<(u64, Vec<u8>)> = drive(100, 1..=400)
        .into_iter()
        .enumerate()
        .map(|(row, (at_ns, _))| {
            let turned_m = 0.2 * row as f64;
            let numbers = [turned_m.min(40.0), turned_m, 80.0 + (row % 5) as f64].map(f64::to_le_bytes);
            (at_ns, [&[0, 1, 0, 0][..], &numbers.concat()].concat())
        })
        .collect();
    let reading = read_by(map, mcap_of_topics(&[("/drive", DRIVE, &messages)]), Format::Mcap);
    let left = speeds(&reading);
    assert!((0..199).all(|row| (left[row] - 2.0).abs() < 1e-9), "{}", reading.report);
    assert!((201..400).all(|row| left[row].is_nan()), "{}", reading.report);
}

#[test]
fn counters_of_a_side_begin_anew_each_at_its_own_time() {
    let map = r#"{"name": "own", "sources": [
        {"channel": "v_left_mps", "columns": ["front", "rear"], "derivative": true, "scale": 0.01, "wraps_at": 256}]}"#;
    let bytes = table("front,rear", |row| format!("{},{}", (5 * row) % 256, (100 + 5 * row) % 256));
    let left = speeds(&read_by(map, bytes, Format::Csv));
    assert!(left.iter().all(|v_mps| (v_mps - 0.5).abs() < 1e-9), "{left:?}");

    let map = r#"{"name": "own", "sources": [
        {"channel": "v_left_mps", "topic": "/drive", "fields": ["left", "right"], "derivative": true, "wraps_at": 10},
        {"channel": "v_right_mps", "topic": "/drive", "fields": ["right"], "derivative": true, "wraps_at": 10},
        {"channel": "power_w", "topic": "/drive", "fields": ["watts"]}]}"#;
    let messages: Vec<(u64, Vec<u8>)> = drive(100, 1..=200)
        .into_iter()
        .enumerate()
        .map(|(row, (at_ns, _))| {
            let counts = |from: f64| (from + 0.25 * row as f64).rem_euclid(10.0);
            let numbers = [counts(0.0), counts(4.0), 80.0 + (row % 5) as f64].map(f64::to_le_bytes);
            (at_ns, [&[0, 1, 0, 0][..], &numbers.concat()].concat())
        })
        .collect();
    let left = speeds(&read_by(map, mcap_of_topics(&[("/drive", DRIVE, &messages)]), Format::Mcap));
    assert!(left.iter().all(|v_mps| (v_mps - 2.5).abs() < 1e-9), "{left:?}");
}

/// A message of a pack that draws so many amperes at so many volts.
fn pack(serial: &str, current_a: f64, voltage_v: f64) -> Vec<u8> {
    let text = [&(serial.len() as u32 + 1).to_le_bytes()[..], serial.as_bytes(), &[0]].concat();
    [&[0, 1, 0, 0][..], &current_a.to_le_bytes(), &voltage_v.to_le_bytes(), &text].concat()
}

const BATTERY: Type<'static> = Type {
    name: "my_msgs/msg/Battery",
    definition: b"float64 current\nfloat64 voltage\nstring serial_number\n",
    ..DRIVE
};

const WITH_BATTERY: &str = r#"{"name": "own", "sources": [
    {"channel": "v_left_mps", "topic": "/drive", "fields": ["left"]},
    {"channel": "v_right_mps", "topic": "/drive", "fields": ["right"]},
    {"channel": "power_w", "topic": "/battery", "fields": ["current", "voltage"], "combine": "product"},
    {"channel": "current_a", "topic": "/battery", "fields": ["current"]},
    {"channel": "voltage_v", "topic": "/battery", "fields": ["voltage"]}]}"#;

#[test]
fn packs_that_tell_of_themselves_on_one_topic_share_what_the_robot_draws() {
    let wheels = drive(100, 1..=200);
    let of = |packs: &[(u64, Vec<u8>)]| {
        let topics = [("/drive", DRIVE, &wheels[..]), ("/battery", BATTERY, packs)];
        let Reading { recording, report } = read_by(WITH_BATTERY, mcap_of_topics(&topics), Format::Mcap);
        let middle = |channel| {
            let values = recording.channel(channel).unwrap();
            values[values.len() / 4]
        };
        let found = [Channel::Power, Channel::Current, Channel::Voltage].map(middle);
        (found, report.repairs.iter().filter(|repair| repair.place == "topic /battery").count())
    };
    let at_ns = |row: u64, shift_ms: u64| 100_000_000_000 + row * 100_000_000 + shift_ms * 1_000_000;
    // At the same stamps, and between one another's.
    for shift_ms in [0, 40] {
        let both = (0..200).flat_map(|row| {
            [(at_ns(row, 0), pack("A", 3.0, 25.0)), (at_ns(row, shift_ms), pack("B", 2.0, 24.0))]
        });
        let both: Vec<(u64, Vec<u8>)> = both.collect();
        assert_eq!(of(&both), ([3.0 * 25.0 + 2.0 * 24.0, 5.0, 24.5], 1), "{shift_ms} ms apart");
    }
    // One that takes the other's place, and one that has no name.
    let name = |row: u64, other: &'static str| if row < 100 { "A" } else { other };
    for other in ["B", "A"] {
        let one: Vec<(u64, Vec<u8>)> =
            (0..200).map(|row| (at_ns(row, 0), pack(name(row, other), 3.0, 25.0))).collect();
        assert_eq!(of(&one), ([75.0, 3.0, 25.0], 0), "{other}");
    }
}
