//! ROS 1 bags that were not closed or are damaged are read as far as they can be, and what was lost is said.

#![allow(clippy::unwrap_used)]

use recording::{Map, Reading, read_path};

#[path = "written/ros1.rs"]
mod ros1;
use ros1::{Chunk, Topic, header};

const DEFINITION: &str = "float64 left\nfloat64 right\nfloat64 power\n";

fn map() -> Map {
    let source = |channel: &str, field: &str| {
        format!(r#"{{"channel": "{channel}", "topic": "/drive", "fields": ["{field}"]}}"#)
    };
    let sources = [source("v_left_mps", "left"), source("v_right_mps", "right"), source("power_w", "power")];
    Map::from_json(&format!(r#"{{"name": "own", "sources": [{}]}}"#, sources.join(", "))).unwrap()
}

/// Messages every tenth of a second.
fn chunk(rows: std::ops::Range<u64>) -> Chunk {
    let message = |row: u64| {
        let numbers = [0.5, 0.5 + 0.01 * (row % 7) as f64, 60.0 + row as f64];
        (
            1_700_000_000_000_000_000 + 100_000_000 * row,
            numbers.iter().flat_map(|x| x.to_le_bytes()).collect(),
        )
    };
    let messages: Vec<(u64, Vec<u8>)> = rows.map(message).collect();
    let topic = Topic { connection: 0, name: "/drive", type_name: "test/Drive", definition: DEFINITION };
    Chunk::new(&topic, &messages)
}

fn read(name: &str, bytes: &[u8]) -> Reading {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    read_path(&path, Some(&map())).unwrap()
}

#[test]
fn a_bag_that_was_never_closed_is_read_into_its_open_chunk_and_said() {
    let bytes = [header(0), chunk(0..30).closed(), chunk(30..50).open()].concat();
    let reading = read("drive.bag.active", &bytes[..bytes.len() - 5]);
    assert_eq!(reading.recording.rows(), 49);
    let said: Vec<&str> = reading.report.repairs.iter().map(|repair| repair.what.as_str()).collect();
    assert!(
        said.iter().any(|what| what.contains("never closed") && what.contains("rosbag reindex")),
        "{said:?}"
    );
    assert!(said.iter().any(|what| what.contains("breaks off")), "{said:?}");
}

#[test]
fn a_whole_bag_has_nothing_to_say() {
    let bytes = [header(4117), chunk(0..30).closed(), chunk(30..50).closed()].concat();
    let reading = read("drive.bag", &bytes);
    assert!(reading.recording.rows() == 50 && reading.report.repairs.is_empty(), "{}", reading.report);
}

#[test]
fn a_block_of_zeros_in_a_chunk_is_said_with_the_messages_that_it_cost() {
    let (first, second) = (chunk(0..30).closed(), chunk(30..50).closed());
    let start = header(4117).len() + first.len();
    let mut bytes = [header(4117), first, second].concat();
    let within = start + 600..start + 1200;
    bytes[within].fill(0);
    let reading = read("drive.bag", &bytes);
    let rows = reading.recording.rows();
    assert!((31..50).contains(&rows), "{rows}");
    let said = &reading.report.repairs[0].what;
    let lost = format!("cost {} of its 20 messages", 50 - rows);
    assert!(said.contains(&lost) && said.contains("between 1700000003.000 and 1700000004.900 s"), "{said}");
}
