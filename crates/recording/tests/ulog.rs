//! Logs of PX4 are read with their axes turned, and those that were cut off as far as they go.

#![allow(clippy::unwrap_used)]

use recording::{Channel, Format, read};

fn record(kind: u8, body: &[u8]) -> Vec<u8> {
    [&(body.len() as u16).to_le_bytes(), &[kind][..], body].concat()
}

fn topic(id: u16, name: &str, fields: &str) -> Vec<u8> {
    let format = record(b'F', format!("{name}:uint64_t timestamp;{fields}").as_bytes());
    let subscribed = [&[0][..], &id.to_le_bytes(), name.as_bytes()].concat();
    [format, record(b'A', &subscribed)].concat()
}

fn message(id: u16, t_us: u64, values: &[f32]) -> Vec<u8> {
    let values: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
    record(b'D', &[&id.to_le_bytes()[..], &t_us.to_le_bytes(), &values].concat())
}

/// A rover that climbs with its nose up by 0.1 rad and turns right.
fn log() -> Vec<u8> {
    let mut file = [b"ULog\x01\x12\x35\x01".to_vec(), 0u64.to_le_bytes().to_vec()].concat();
    file.extend(topic(0, "wheel_encoders", "float[2] wheel_speed;float[2] wheel_angle;"));
    file.extend(topic(
        1,
        "battery_status",
        "float voltage_v;float current_a;bool connected;uint8_t[7] _padding0;",
    ));
    file.extend(topic(2, "vehicle_attitude", "float[4] q;"));
    file.extend(topic(3, "sensor_combined", "float[3] gyro_rad;float[3] accelerometer_m_s2;"));
    let half_rad = 0.05f32;
    for row in 0..100 {
        let t_us = 5_000_000 + 100_000 * row;
        file.extend(message(0, t_us, &[4.0, 3.0, 0.0, 0.0]));
        // The flag behind the numbers is one byte.
        let battery: Vec<u8> = [16.0f32, 5.0].iter().flat_map(|x| x.to_le_bytes()).chain([1]).collect();
        file.extend(record(b'D', &[&1u16.to_le_bytes()[..], &t_us.to_le_bytes(), &battery].concat()));
        file.extend(message(2, t_us, &[half_rad.cos(), 0.0, half_rad.sin(), 0.0]));
        file.extend(message(3, t_us, &[0.0, 0.0, 0.2, 0.1, 0.0, -9.8]));
    }
    file
}

#[test]
fn a_rovers_log_is_read_in_this_programs_signs() {
    let reading = read(log(), Format::Ulog, "log", None).unwrap();
    let recording = &reading.recording;
    assert_eq!((recording.rows(), reading.report.format.as_str()), (100, "PX4 ULog"));
    let of = |channel: Channel| recording.channel(channel).unwrap()[50];
    assert!((of(Channel::LeftSpeed) - 0.66).abs() < 1e-6 && (of(Channel::RightSpeed) - 0.495).abs() < 1e-6);
    assert!((of(Channel::Pitch) - 0.1).abs() < 1e-6 && of(Channel::Roll).abs() < 1e-6);
    assert!((of(Channel::YawRate) + 0.2).abs() < 1e-6, "a turn to the right is negative");
    assert!((of(Channel::Current) - 5.0).abs() < 1e-6 && (of(Channel::Voltage) - 16.0).abs() < 1e-6);
}

#[test]
fn a_log_that_was_cut_off_is_read_as_far_as_it_goes_and_lost_time_is_told() {
    let mut bytes = log();
    bytes.extend(record(b'O', &120u16.to_le_bytes()));
    bytes.extend(&message(0, 99_000_000, &[4.0, 3.0, 0.0, 0.0])[..9]);
    let reading = read(bytes, Format::Ulog, "log", None).unwrap();
    assert_eq!(reading.recording.rows(), 100);
    let said: Vec<&str> = reading.report.repairs.iter().map(|repair| repair.what.as_str()).collect();
    assert!(said[0].contains("120 ms") && said[1].contains("breaks off"), "{said:?}");
    for length in 0..400 {
        let _ = read(log()[..length].to_vec(), Format::Ulog, "log", None);
    }
}
