//! MCAP files, folders of rosbag2 and ROS 1 bags written by the formats' own tools (PyPI `mcap`, `mcap-ros2-support`, `rosbags`) are read back
//! equal, cut off or damaged ones as far as they can be read.
//!
//! Needs the Python environment that `tests/run` makes in `target/python`; without it the tests say that they skip.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stderr)]

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
    process::Command,
    sync::OnceLock,
};

use proptest::prelude::*;
use recording::{Channel, Format, Map, PowerForm, Reading, read, read_path};

/// The folder of the files, written once; `None` without a Python environment.
fn files() -> Option<&'static Path> {
    static FOLDER: OnceLock<Option<tempfile::TempDir>> = OnceLock::new();
    let folder = FOLDER.get_or_init(|| {
        let package = Path::new(env!("CARGO_MANIFEST_DIR"));
        let target = std::env::var_os("CARGO_TARGET_DIR").map_or(package.join("../../target"), PathBuf::from);
        let python = target.join("python/bin/python");
        if !python.exists() {
            eprintln!("SKIPPED: there is no Python environment in {}; tests/run makes it", target.display());
            return None;
        }
        let folder = tempfile::tempdir().unwrap();
        let script = package.join("tests/write_reference.py");
        let output = Command::new(python).arg(script).arg(folder.path()).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        Some(folder)
    });
    folder.as_ref().map(tempfile::TempDir::path)
}

fn assert_equal(reading: &Reading, folder: &Path, map_adds: &[(&str, &str)]) {
    let text = std::fs::read_to_string(folder.join("expected.json")).unwrap();
    let rows: Vec<BTreeMap<String, f64>> = serde_json::from_str(&text).unwrap();
    let recording = &reading.recording;
    let mut compared = 0;
    for (row, expected) in rows.iter().enumerate() {
        assert!((recording.t_s[row] - expected["t_s"]).abs() < 1e-9);
        for (name, expected) in expected {
            let values = match Channel::from_name(name) {
                Some(channel) => recording.channel(channel),
                None => recording.aside.get(name).map(Vec::as_slice),
            };
            let Some(values) = values else {
                let known = name == "t_s" || name == "battery_current_a" && map_adds.is_empty();
                assert!(known, "{name} was not read");
                continue;
            };
            // Rows are power's stamps (5 Hz), which those of all other topics (10, 20 and 50 Hz) meet exactly.
            let float32 = if name.starts_with("battery") { 1e-6 } else { 0.0 };
            let near = (values[row] - expected).abs() <= 1e-9 + float32;
            assert!(near, "{name} in row {row} is {}, was written as {expected}", values[row]);
            compared += 1;
        }
    }
    assert_eq!(recording.rows(), rows.len());
    assert!(compared > 1500, "only {compared} values were compared");
}

#[test]
fn files_of_the_reference_tools_are_read_back_equal_in_every_compression() {
    let Some(folder) = files() else { return };
    let folders = ["sqlite", "sqlite-file", "sqlite-message", "mcap", "mcap-file", "mcap-message"];
    let files = ["zstd.mcap", "lz4.mcap", "plain.mcap", "plain.bag", "lz4.bag", "bz2.bag"];
    for name in files.into_iter().chain(folders) {
        let reading = read_path(&folder.join(name), None).unwrap();
        assert_equal(&reading, folder, &[]);
        let report = &reading.report;
        assert!(report.repairs.is_empty(), "{name}: {:?}", report.repairs);
        assert_eq!(report.power_form, Some(PowerForm::Sides));
        assert_eq!(report.alignment.as_ref().unwrap().base, "/status");
        assert_eq!(report.streams.len(), 6, "{report}");
        let imu = report.streams.iter().find(|stream| stream.topic == "/imu/data").unwrap();
        assert_eq!((imu.messages, imu.rate_hz.unwrap().round()), (1000, 50.0));
        assert_eq!(reading.recording.runs[0].start_unix_s, Some(1.7e9));
    }
}

#[test]
fn custom_messages_are_read_by_field_path_and_unit() {
    let Some(folder) = files() else { return };
    let map = r#"{"name": "own", "wheel_radius_m": 0.2, "surface": "ice", "base": "/joint_states", "sources": [
        {"channel": "v_left_mps", "topic": "/joint_states", "fields": ["velocity[2]"], "unit": "rad/s"},
        {"channel": "v_right_mps", "topic": "/joint_states", "fields": ["velocity[name=rear_right_wheel]"], "unit": "rad/s"},
        {"channel": "current_a", "topic": "/battery_state", "fields": ["current"], "scale": -1},
        {"channel": "voltage_v", "topic": "/battery_state", "fields": ["voltage"]},
        {"channel": "ambient_temp_c", "topic": "/battery_state", "fields": ["temperature"], "unit": "degC"},
        {"aside": "cell_v", "topic": "/battery_state", "fields": ["cell_voltage[0]"]},
        {"aside": "absent", "topic": "/battery_state", "fields": ["cell_voltage[7]"]},
        {"aside": "charge_percent", "topic": "/status", "fields": ["charge_estimate"]}]}"#;
    let map = Map::from_json(map).unwrap();
    for name in ["zstd.mcap", "bz2.bag", "sqlite", "sqlite-message"] {
        let Reading { recording, report } = read_path(&folder.join(name), Some(&map)).unwrap();
        assert_eq!(recording.rows(), 200);
        let left = recording.channel(Channel::LeftSpeed).unwrap();
        assert!((left[17] - 0.2 * (2.0 + 1.7f64.sin())).abs() < 1e-9);
        // Power comes at 5 Hz: half-way rows lie half-way, and the last row, after power's last, has none.
        let current = recording.channel(Channel::Current).unwrap();
        assert!((current[3] - (4.0 + 0.3 / 8.0)).abs() < 1e-6, "{}", current[3]);
        assert!(current[199].is_nan());
        assert_eq!(recording.aside["cell_v"][0], 3.5);
        assert_eq!(recording.surface.as_ref().unwrap().get(0), Some("ice"));
        assert!(
            report
                .ignored
                .iter()
                .any(|i| i.name.contains("cell_voltage[7]") && i.reason.contains("no number"))
        );
        assert!(report.ignored.iter().any(|i| i.name == "/imu/data"), "{report}");
    }
}

#[test]
fn a_wrong_field_is_refused_with_those_that_are_there() {
    let Some(folder) = files() else { return };
    let map = r#"{"name": "own", "sources": [{"channel": "power_w", "topic": "/status", "fields": ["battery_power"]}]}"#;
    let map = Map::from_json(map).unwrap();
    let message = read_path(&folder.join("zstd.mcap"), Some(&map)).unwrap_err().to_string();
    assert!(message.contains("zstd.mcap: topic /status, field `battery_power`"), "{message}");
    assert!(message.contains("battery_voltage"), "{message}");
    let map = Map::from_json(r#"{"name": "own", "sources": []}"#).unwrap();
    let message = read_path(&folder.join("zstd.mcap"), Some(&map)).unwrap_err().to_string();
    assert!(message.contains("/joint_states"), "{message}");
}

fn bytes(folder: &Path, name: &str) -> (Vec<u8>, Format) {
    (std::fs::read(folder.join(name)).unwrap(), Format::of(Path::new(name)).unwrap())
}

#[test]
fn a_file_that_was_cut_off_is_read_as_far_as_it_goes_and_says_so() {
    let Some(folder) = files() else { return };
    for name in ["zstd.mcap", "plain.mcap", "plain.bag", "lz4.bag"] {
        let (mut bytes, format) = bytes(folder, name);
        bytes.truncate(bytes.len() * 6 / 10);
        let Reading { recording, report } = read(bytes, format, "cut", None).unwrap();
        assert!((30..100).contains(&recording.rows()), "{name}: {} rows", recording.rows());
        assert!(report.repairs.iter().any(|repair| repair.what.contains("breaks off")), "{name}: {report}");
        assert!((recording.channel(Channel::LeftPower).unwrap()[20] - 25.0 * 4.0).abs() < 1e-9);
    }
}

#[test]
fn a_chunk_with_a_wrong_checksum_is_left_out_and_told_by_byte() {
    let Some(folder) = files() else { return };
    let (mut bytes, format) = bytes(folder, "plain.mcap");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 0x10;
    let Reading { recording, report } = read(bytes, format, "flipped", None).unwrap();
    assert!(report.repairs.iter().any(|repair| repair.what.contains("checksum")), "{report}");
    assert!(recording.rows() < 100);
}

#[test]
fn a_file_under_a_wrong_name_is_refused() {
    let Some(folder) = files() else { return };
    let (bytes, _) = bytes(folder, "plain.bag");
    let message = read(bytes, Format::Mcap, "bag", None).unwrap_err().to_string();
    assert!(message.contains("no MCAP file"), "{message}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn damaged_files_never_panic(
        which in 0usize..7,
        flips in proptest::collection::vec((0.0..1.0f64, 0u8..8), 1..20),
        length in 0.3..1.0f64,
    ) {
        let names = ["zstd.mcap", "lz4.mcap", "plain.mcap", "plain.bag", "lz4.bag", "bz2.bag", "sqlite/sqlite.db3"];
        if let Some(folder) = files() {
            let (mut bytes, format) = bytes(folder, names[which]);
            bytes.truncate((bytes.len() as f64 * length) as usize);
            for (place, bit) in flips {
                let at = (bytes.len() as f64 * place) as usize;
                if let Some(byte) = bytes.get_mut(at) {
                    *byte ^= 1 << bit;
                }
            }
            let _ = read(bytes, format, "damaged", None);
        }
    }
}
