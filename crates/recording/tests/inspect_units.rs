//! The map that `inspect` writes: units that the numbers bear out, columns that are one quantity, times of common logs.

#![allow(clippy::unwrap_used)]

use std::{fs, path::PathBuf};

use recording::{Channel, Map, Reading, inspect::inspect, read_path};

const ROWS: usize = 400;

/// A table of columns by their names, as functions of time \[s\].
fn table(name: &str, columns: &[(&str, &dyn Fn(f64) -> String)]) -> PathBuf {
    let path = std::env::temp_dir().join(format!("joulepath-units-{name}-{}.csv", std::process::id()));
    let names: Vec<&str> = columns.iter().map(|column| column.0).collect();
    let mut text = names.join(",") + "\n";
    for row in 0..ROWS {
        let cells: Vec<String> = columns.iter().map(|column| (column.1)(0.1 * row as f64)).collect();
        text += &(cells.join(",") + "\n");
    }
    fs::write(&path, text).unwrap();
    path
}

fn speed(t_s: f64) -> String {
    format!("{:.3}", 0.5 + 0.3 * t_s.sin())
}

fn power(t_s: f64) -> String {
    format!("{:.2}", 80.0 + 20.0 * t_s.sin())
}

/// The log as it is read by the map that is proposed, and what was said.
fn read(path: &PathBuf) -> (Reading, String) {
    let found = inspect(path).unwrap();
    let read = read_path(path, Some(&Map::from_value(&found.map).unwrap()));
    fs::remove_file(path).unwrap();
    (read.unwrap(), format!("{:?} {:?}", found.fields, found.notes))
}

#[test]
fn times_of_any_common_clock_are_written_with_their_unit() {
    let whole = |factor: f64, from: f64| move |t_s: f64| format!("{}", (factor * t_s + from).round() as i64);
    for (name, time) in [
        ("timestamp", &whole(1e3, 0.0) as &dyn Fn(f64) -> String),
        ("timestamp", &whole(1e6, 0.0)),
        ("timestamp", &whole(1e9, 0.0)),
        ("timestamp", &whole(1e3, 1.7e12)),
        ("%time", &whole(1e9, 1.7e18)),
        ("t_s", &whole(1e3, 0.0)),
        ("time_ms", &whole(1e3, 0.0)),
        ("time_us", &whole(1e6, 1.7e15)),
        ("time_min", &|t_s| format!("{:.6}", t_s / 60.0)),
        ("time_h", &|t_s| format!("{:.9}", t_s / 3600.0)),
        ("Time (s)", &|t_s| format!("{t_s:.1}")),
    ] {
        let path =
            table("time", &[(name, time), ("vel_left", &speed), ("vel_right", &speed), ("power", &power)]);
        let (reading, said) = read(&path);
        assert!((reading.recording.duration_s() - 39.9).abs() < 1e-3, "{name}: {said}");
    }
}

#[test]
fn times_in_two_columns_are_read_together() {
    // Two stamps, of which those of one message belong together; the other's nanoseconds are not beside its seconds.
    for [whole, parts] in [["secs", "nsecs"], ["header.stamp.sec", "header.stamp.nanosec"]] {
        let path = table(
            "secs",
            &[
                ("other_nsecs", &|_| "7".to_owned()),
                (whole, &|t_s| format!("{}", 1_700_000_000 + t_s as i64)),
                (parts, &|t_s| format!("{}", (1e9 * t_s.fract()).round() as i64)),
                ("vel_left", &speed),
                ("vel_right", &speed),
                ("power", &power),
            ],
        );
        let (reading, said) = read(&path);
        assert!((reading.recording.duration_s() - 39.9).abs() < 1e-3, "{said}");
        let steps = reading.recording.t_s.windows(2).map(|pair| pair[1] - pair[0]);
        assert!(steps.into_iter().all(|step_s| (step_s - 0.1).abs() < 1e-6), "{said}");
    }
}

#[test]
fn a_column_of_an_unknown_or_contradicted_unit_is_left_out_and_said() {
    let of = |other: &str, value: &dyn Fn(f64) -> String| {
        let time = |t_s: f64| format!("{t_s:.1}");
        let path = table(
            "unit",
            &[
                ("time", &time),
                ("vel_left", &speed),
                ("vel_right", &speed),
                ("power", &power),
                (other, value),
            ],
        );
        read(&path)
    };
    for (name, value) in [
        ("power_Wh", &(|t_s: f64| format!("{:.4}", 0.02 * t_s)) as &dyn Fn(f64) -> String),
        ("battery_power_hp", &|_| "0.11".into()),
        ("wheel_left_kn", &speed),
        ("wheel_left_ticks", &|t_s| format!("{}", (900.0 * t_s) as i64)),
        ("battery_power", &|t_s| format!("{:.4}", 0.08 + 1e-3 * t_s.sin())),
        ("left_wheel_encoder", &|t_s| format!("{}", (900.0 * t_s) as i64)),
    ] {
        let (reading, said) = of(name, value);
        let mean = |channel| {
            let values = reading.recording.channel(channel).unwrap();
            values.iter().sum::<f64>() / values.len() as f64
        };
        assert!((70.0..90.0).contains(&mean(Channel::Power)), "{name}: {said}");
        assert!((0.4..0.6).contains(&mean(Channel::LeftSpeed)), "{name}: {said}");
        assert!(said.contains(&format!("column `{name}` is left out")), "{name}: {said}");
    }
    let (reading, _) = of("motor_temp_left_F", &|_| "77".into());
    assert!((reading.recording.channel(Channel::LeftMotorTemperature).unwrap()[0] - 25.0).abs() < 1e-9);
}
