//! Times of every type and unit: read in seconds once, or refused by what shows that they are none.

#![allow(clippy::unwrap_used)]

use std::{fmt::Write as _, fs, path::Path};

use recording::{Error, Format, Map, Reading, SuspicionKind, read};

fn typed(name: &str, map: Option<&Map>) -> Result<Reading, Error> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files").join(format!("{name}.parquet"));
    read(fs::read(path).unwrap(), Format::Parquet, name, map)
}

fn map_with(unit: &str) -> Map {
    let source = format!(r#"{{"channel": "t_s", "column": "t_s", "unit": "{unit}"}}"#);
    Map::from_json(&format!(r#"{{"name": "lab", "sources": [{source}]}}"#)).unwrap()
}

fn csv(t: impl IntoIterator<Item = String>) -> Vec<u8> {
    let mut text = String::from("t_s,v_left_mps,v_right_mps,power_w\n");
    t.into_iter().enumerate().for_each(|(row, t)| writeln!(text, "{t},0.5,0.5,{}", 80 + row % 7).unwrap());
    text.into_bytes()
}

/// Written by pyarrow, pandas and polars (`write_times.py`), 0.25 s apart.
#[test]
fn durations_and_timestamps_are_read_in_seconds_by_their_types() {
    for (name, start_s) in [
        ("duration-ms", 10.0),
        ("duration-us", 10.0),
        ("duration-ns", 10.0),
        ("pandas", 10.0),
        ("polars", 10.0),
        ("timestamp-ms", 1.7e9),
        ("timestamp-us", 1.7e9),
        ("timestamp-ns", 1.7e9),
        ("timestamp-v1", 1.7e9),
        ("timestamp-int96", 1.7e9),
    ] {
        let t_s = typed(name, None).unwrap().recording.t_s;
        let expected = [0.0, 0.25, 0.5, 0.75].map(|t| start_s + t);
        assert!(t_s.iter().zip(expected).all(|(t, e)| (t - e).abs() < 1e-6), "{name}: {t_s:?}");
    }
    for (name, start_s) in [("duration-s", 10.0), ("timestamp-s", 1.7e9)] {
        let t_s = typed(name, None).unwrap().recording.t_s;
        assert_eq!(t_s, [0.0, 1.0, 2.0, 3.0].map(|t| start_s + t), "{name}");
    }
}

#[test]
fn a_map_does_not_apply_the_unit_of_a_type_again_and_may_not_contradict_it() {
    for (name, unit) in
        [("duration-ns", "ns"), ("polars", "us"), ("timestamp-ms", "ms"), ("duration-us", "s")]
    {
        let t_s = typed(name, Some(&map_with(unit))).unwrap().recording.t_s;
        assert!((t_s[3] - t_s[0] - 0.75).abs() < 1e-6, "{name} with {unit}: {t_s:?}");
    }
    let message = typed("duration-ns", Some(&map_with("ms"))).unwrap_err().to_string();
    assert!(message.contains("column `t_s` is given as `ms`") && message.contains("`ns`"), "{message}");
}

#[test]
fn plain_numbers_in_another_unit_are_refused_by_line_and_read_with_their_unit_in_a_map() {
    let ns = || csv((0..20).map(|row| format!("{}", 1_700_000_000_000_000_000_i64 + row * 100_000_000)));
    let message = read(ns(), Format::Csv, "drive", None).unwrap_err().to_string();
    assert!(message.starts_with("line 2, run `drive`: 1700000000000000000 s"), "{message}");
    assert!(message.contains("rows are 100000000 s apart") && message.contains("nanoseconds"), "{message}");
    assert!(message.contains(r#""unit": "ns""#), "{message}");
    let t_s = read(ns(), Format::Csv, "drive", Some(&map_with("ns"))).unwrap().recording.t_s;
    assert!((t_s[19] - t_s[0] - 1.9).abs() < 1e-5, "{t_s:?}");
    let message = read(ns(), Format::Csv, "drive", Some(&map_with("ms"))).unwrap_err().to_string();
    assert!(message.contains("the map gives its unit as `ms`"), "{message}");
}

#[test]
fn rows_far_apart_are_read_where_a_map_names_seconds_and_times_beyond_every_clock_are_not() {
    let slow = |start: f64| csv((0..20).map(|row| format!("{}", start + 20.0 * f64::from(row))));
    let message = read(slow(0.0), Format::Csv, "drive", None).unwrap_err().to_string();
    assert!(
        message.contains("rows are 20 s apart") && message.contains("`s` if rows are so far"),
        "{message}"
    );
    let silent = r#"{"name": "lab", "sources": [{"channel": "t_s", "column": "t_s"}]}"#;
    let silent = Map::from_json(silent).unwrap();
    assert!(read(slow(0.0), Format::Csv, "drive", Some(&silent)).is_err(), "this map names no unit");
    let seconds = map_with("s");
    let t_s = read(slow(0.0), Format::Csv, "drive", Some(&seconds)).unwrap().recording.t_s;
    assert_eq!(t_s[19], 380.0);
    let message = read(slow(1.7e12), Format::Csv, "drive", Some(&seconds)).unwrap_err().to_string();
    assert!(message.contains("year 2200") && message.contains("look like milliseconds"), "{message}");
}

#[test]
fn a_run_of_milliseconds_behind_one_of_seconds_is_named_with_its_line() {
    let mut text = String::from("run,t_s,v_left_mps,v_right_mps,power_w\n");
    for row in 0..20 {
        writeln!(text, "a,{:.1},0.5,0.5,80", f64::from(row) * 0.1).unwrap();
    }
    for row in 0..20 {
        writeln!(text, "b,{},0.5,0.5,80", row * 100).unwrap();
    }
    let message = read(text.into_bytes(), Format::Csv, "two", None).unwrap_err().to_string();
    assert!(message.starts_with("line 22, run `b`: rows are 100 s apart"), "{message}");
}

/// A robot that starts and stops, at 200 Hz: in milliseconds its rows are 5 apart, as those of a slow fleet logger are.
#[test]
fn speeds_that_change_too_slowly_for_their_times_are_doubted() {
    let drive = |step: f64, unit_s: f64| {
        let mut text = String::from("t_s,v_left_mps,v_right_mps,power_w\n");
        for row in 0..4000 {
            let t_s = f64::from(row) * step * unit_s;
            let v_mps = (0.5 * (t_s % 20.0)).min(0.5 * (12.0 - t_s % 20.0)).clamp(0.0, 0.8);
            let noise_mps = 0.01 * f64::from(row * 37 % 11 - 5) / 5.0;
            writeln!(text, "{},{},{},{}", f64::from(row) * step, v_mps + noise_mps, v_mps, 80 + row % 7)
                .unwrap();
        }
        let Reading { report, .. } = read(text.into_bytes(), Format::Csv, "drive", None).unwrap();
        let doubts = report.suspicions.into_iter().filter(|doubt| doubt.kind == SuspicionKind::Unit);
        doubts.map(|doubt| doubt.statement).collect::<Vec<_>>()
    };
    for step in [10.0, 5.0, 1.0] {
        let doubts = drive(step, 1e-3);
        assert!(
            doubts.iter().any(|doubt| doubt.contains("`t_s`") && doubt.contains("milliseconds")),
            "{step}"
        );
    }
    for step in [0.1, 1.0, 5.0, 10.0] {
        assert!(drive(step, 1.0).is_empty(), "{step}");
    }
}

#[test]
fn rows_that_were_stamped_in_bursts_keep_their_drive_whole() {
    let burst = |i: u32| 0.25 * f64::from(i / 5 + 1) + 0.0004 * f64::from(i % 5);
    let bytes = csv((0..300).map(|i| format!("{:.4}", burst(i))));
    let Reading { recording, report } = read(bytes, Format::Csv, "drive", None).unwrap();
    assert_eq!(report.runs[0].gaps, 0, "{report}");
    assert!((report.runs[0].rate_hz.unwrap() - 20.0).abs() < 0.5, "{report}");
    assert!(report.repairs[0].what.contains("60 bursts, about 0.248 s"), "{report}");
    assert_eq!(recording.rows(), 300);
}
