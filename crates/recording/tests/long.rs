//! Files that are longer than the room that there is are read as means, in every format.

#![allow(clippy::unwrap_used)]

use std::{fs::File, path::Path, sync::Arc};

use parquet::{
    data_type::DoubleType, file::writer::SerializedFileWriter, schema::parser::parse_message_type,
};
use recording::{Channel, Format, Map, Reading, Room, read_file, unwatched};

const ROWS: usize = 40_000;
const NAMES: [&str; 4] = ["t_s", "v_left_mps", "v_right_mps", "power_w"];

/// A drive at 100 Hz whose numbers are linear in time, so that their means lie on the same lines.
fn row(index: usize) -> [f64; 4] {
    let t_s = index as f64 * 0.01;
    [t_s, 0.2 + 1e-3 * t_s, 0.4 - 1e-3 * t_s, 50.0 + t_s]
}

fn write_parquet(path: &Path) {
    let fields: String = NAMES.iter().map(|name| format!("required double {name};")).collect();
    let schema = Arc::new(parse_message_type(&format!("message drive {{ {fields} }}")).unwrap());
    let mut writer = SerializedFileWriter::new(File::create(path).unwrap(), schema, Arc::default()).unwrap();
    for rows in [0..ROWS / 3, ROWS / 3..ROWS] {
        let mut group = writer.next_row_group().unwrap();
        for channel in 0..NAMES.len() {
            let values: Vec<f64> = rows.clone().map(|index| row(index)[channel]).collect();
            let mut column = group.next_column().unwrap().unwrap();
            column.typed::<DoubleType>().write_batch(&values, None, None).unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
    }
    writer.close().unwrap();
}

/// The same as messages of one topic, by the MCAP specification (<https://mcap.dev/spec>), without chunks.
fn write_mcap(path: &Path) {
    let text = |text: &str| [&(text.len() as u32).to_le_bytes()[..], text.as_bytes()].concat();
    let record = |opcode: u8, body: &[u8]| [&[opcode][..], &(body.len() as u64).to_le_bytes(), body].concat();
    let fields: String = NAMES[1..].iter().map(|name| format!("float64 {name}\n")).collect();
    let schema =
        [&1u16.to_le_bytes()[..], &text("lab_msgs/msg/Drive"), &text("ros2msg"), &text(&fields)].concat();
    let channel =
        [&1u16.to_le_bytes()[..], &1u16.to_le_bytes(), &text("/drive"), &text("cdr"), &text("")].concat();
    let mut bytes = b"\x89MCAP0\r\n".to_vec();
    bytes.extend([record(3, &schema), record(4, &channel)].concat());
    for index in 0..ROWS {
        let ns = 1_700_000_000_000_000_000 + index as u64 * 10_000_000;
        let mut message =
            [&1u16.to_le_bytes()[..], &0u32.to_le_bytes(), &ns.to_le_bytes(), &ns.to_le_bytes()].concat();
        message.extend([0, 1, 0, 0]);
        row(index)[1..].iter().for_each(|value| message.extend(value.to_le_bytes()));
        bytes.extend(record(5, &message));
    }
    bytes.extend(record(0x0F, &0u32.to_le_bytes()));
    std::fs::write(path, bytes).unwrap();
}

fn map() -> Map {
    let sources: Vec<String> = NAMES[1..]
        .iter()
        .map(|name| format!(r#"{{"channel": "{name}", "topic": "/drive", "fields": ["{name}"]}}"#))
        .collect();
    Map::from_json(&format!(r#"{{"name": "lab", "sources": [{}]}}"#, sources.join(","))).unwrap()
}

#[test]
fn parquet_and_mcap_beyond_their_room_become_means_on_the_same_lines() {
    let folder = tempfile::tempdir().unwrap();
    let map = map();
    for (name, format, map) in
        [("long.parquet", Format::Parquet, None), ("long.mcap", Format::Mcap, Some(&map))]
    {
        let path = folder.path().join(name);
        if format == Format::Parquet {
            write_parquet(&path);
        } else {
            write_mcap(&path);
        }
        let read = |room| read_file(File::open(&path).unwrap(), format, "long", map, &unwatched(), room);
        assert_eq!(read(Room::default()).unwrap().recording.rows(), ROWS, "{name}");
        // A few thousandths of the room of a file: some thousand rows.
        let Reading { recording, report } = read(Room::default().share(1, 400)).unwrap();
        assert!((500..=10_000).contains(&recording.rows()), "{name}: {}", recording.rows());
        assert!(report.repairs[0].what.starts_with("40000 are more than are held"), "{name}: {report}");
        let power_w = recording.channel(Channel::Power).unwrap();
        let first_s = recording.t_s[0];
        let begins_w = power_w[0];
        for (t_s, power_w) in recording.t_s.iter().zip(power_w) {
            assert!((power_w - begins_w - (t_s - first_s)).abs() < 1e-6, "{name} at {t_s} s: {power_w}");
        }
        let mean_w = power_w.iter().sum::<f64>() / power_w.len() as f64;
        assert!((mean_w - 250.0).abs() < 1.0, "{name}: the whole drive is there, {mean_w}");
    }
}
