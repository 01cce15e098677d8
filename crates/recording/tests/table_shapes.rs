//! Tables in shapes that other programs write: packages that break off, durations with their unit, long tables, encoders of two signs.

#![allow(clippy::unwrap_used)]

use std::{fs, io::Write};

use recording::{Format, Map, inspect::inspect, read, read_path};

/// More than one block of zstd (128 KiB) as text.
const ROWS: usize = 12_000;

fn table(header: &str, row: impl Fn(usize) -> String) -> String {
    let rows: String = (0..ROWS).map(|at| row(at) + "\n").collect();
    format!("{header}\n{rows}")
}

fn drive() -> String {
    table("t_s,v_left_mps,v_right_mps,power_w", |row| {
        let speed_mps = 0.5 + 0.1 * (0.013 * row as f64).sin();
        format!(
            "{:.1},{speed_mps:.4},{:.4},{:.3}",
            0.1 * row as f64,
            speed_mps + 0.01,
            60.0 + 9.0 * speed_mps
        )
    })
}

fn gzip(text: &str) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    encoder.write_all(text.as_bytes()).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn a_package_that_breaks_off_is_read_up_to_its_last_whole_line_and_said() {
    let whole = read(drive().into_bytes(), Format::Csv, "drive", None).unwrap();
    for packed in [gzip(&drive()), zstd::encode_all(drive().as_bytes(), 3).unwrap()] {
        let cut = packed[..packed.len() * 3 / 4].to_vec();
        let part = read(cut, Format::Csv, "drive", None).unwrap();
        let rows = part.recording.rows();
        assert!((10..ROWS).contains(&rows), "{rows}");
        assert_eq!(part.recording.t_s, whole.recording.t_s[..rows]);
        for (channel, values) in &part.recording.channels {
            assert_eq!(values[..], whole.recording.channels[channel][..rows], "no number is cut");
        }
        let told = &part.report.repairs.last().unwrap();
        assert!(told.what.contains("breaks off") && told.place == format!("line {}", rows + 1), "{told:?}");
        let all = read(packed, Format::Csv, "drive", None).unwrap();
        assert!(all.recording.rows() == ROWS && all.report.repairs.is_empty());
    }
    // A package that is damaged in its middle is no cut one.
    let mut damaged = gzip(&drive());
    let at = damaged.len() / 2;
    damaged[at..at + 64].fill(0xaa);
    assert!(read(damaged, Format::Csv, "drive", None).is_err());
}

#[test]
fn a_packed_file_of_no_other_ending_is_text_or_refused_by_its_ending() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.gz");
    fs::write(&path, gzip(&drive())).unwrap();
    assert_eq!(read_path(&path, None).unwrap().recording.rows(), ROWS);
    assert!(Format::of("drive.zst".as_ref()).unwrap_err().to_string().contains("`.zst`"));
}

#[test]
fn durations_with_a_unit_behind_them_are_seconds() {
    let columns =
        drive().lines().skip(1).map(|line| line.split_once(',').unwrap().1.to_owned()).collect::<Vec<_>>();
    for (unit, per_second) in [("sec", 1.0), ("min", 1.0 / 60.0), ("ms", 1e3)] {
        let text = table("t_s,v_left_mps,v_right_mps,power_w", |row| {
            format!("{:.6} {unit},{}", 0.1 * row as f64 * per_second, columns[row])
        });
        let reading = read(text.into_bytes(), Format::Csv, "drive", None).unwrap();
        assert!((reading.recording.duration_s() - 0.1 * (ROWS - 1) as f64).abs() < 1e-2, "{unit}");
    }
    let row_of_units = drive().replacen('\n', "\ns,m/s,m/s,W\n", 1);
    assert_eq!(read(row_of_units.into_bytes(), Format::Csv, "drive", None).unwrap().recording.rows(), ROWS);
}

#[test]
fn a_long_table_is_called_one_and_how_it_is_made_wide() {
    let names = ["v_left_mps", "v_right_mps", "power_w"];
    let by_time = table("t_s,field,value", |row| {
        format!("{:.1},{},0.{}", 0.1 * (row / 3) as f64, names[row % 3], 100 + row % 800)
    });
    let by_name = table("t_s,field,value", |row| {
        format!("{:.1},{},0.{}", 0.1 * (row % (ROWS / 2)) as f64, names[row / (ROWS / 2)], 100 + row % 800)
    });
    for text in [by_time, by_name] {
        let refused = read(text.clone().into_bytes(), Format::Csv, "drive", None).unwrap_err().to_string();
        assert!(refused.contains("`field`") && refused.contains("pivot"), "{refused}");
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("drive.csv");
        fs::write(&path, text).unwrap();
        assert!(inspect(&path).unwrap_err().to_string().contains("pivot"));
    }
    // Times that are rounded in a wide table are still called so.
    let rounded = drive().replace(".1,", ".0,").replace(".2,", ".0,");
    let refused = read(rounded.into_bytes(), Format::Csv, "drive", None).unwrap_err().to_string();
    assert!(refused.contains("rounded"), "{refused}");
}

#[test]
fn two_columns_that_a_map_names_for_one_channel_are_said_with_the_cure() {
    let text =
        table("time,left,right,p1,p2", |row| format!("{:.1},0.5,0.6,40.{},40.5", 0.1 * row as f64, row % 10));
    let wheel = r#"{"channel": "t_s", "column": "time"}, {"channel": "v_left_mps", "column": "left"}, {"channel": "v_right_mps", "column": "right"}"#;
    let by = |power: &str| {
        let map = Map::from_json(&format!(r#"{{"name": "lab", "sources": [{wheel}, {power}]}}"#)).unwrap();
        read(text.clone().into_bytes(), Format::Csv, "drive", Some(&map)).unwrap().report
    };
    let two = by(r#"{"channel": "power_w", "column": "p1"}, {"channel": "power_w", "column": "p2"}"#);
    let told = two.repairs.iter().find(|repair| repair.place == "power_w").unwrap();
    assert!(["`p1`", "`p2`", "columns", "\"sum\""].iter().all(|word| told.what.contains(word)), "{told:?}");
    let one = by(
        r#"{"channel": "power_w", "columns": ["p1", "p2"], "combine": "sum"}, {"channel": "power_w", "column": "p3"}"#,
    );
    assert!(one.repairs.is_empty(), "{one}");
}

#[test]
fn encoders_of_one_side_with_two_signs_are_refused_by_name() {
    let text = |sign: f64| {
        table("time,fl,rl,right,power_w", |row| {
            let speed = 3.0 * (0.013 * row as f64).sin();
            format!("{:.1},{speed:.4},{:.4},{speed:.4},60.5", 0.1 * row as f64, sign * speed)
        })
    };
    let map = Map::from_json(
        r#"{"name": "lab", "wheel_radius_m": 0.165, "sources": [
            {"channel": "t_s", "column": "time"},
            {"channel": "v_left_mps", "columns": ["fl", "rl"], "unit": "rad/s"},
            {"channel": "v_right_mps", "column": "right", "unit": "rad/s"}]}"#,
    )
    .unwrap();
    let refused = read(text(-1.0).into_bytes(), Format::Csv, "drive", Some(&map)).unwrap_err().to_string();
    assert!(refused.contains("`fl` and `rl`") && refused.contains("opposite"), "{refused}");
    assert!(read(text(1.0).into_bytes(), Format::Csv, "drive", Some(&map)).is_ok());
}
