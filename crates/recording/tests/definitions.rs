//! Messages whose definitions are missing, in IDL, in another encoding, or such that their bytes may lie in several ways.

#![allow(clippy::unwrap_used, clippy::expect_used)]

mod written;

use recording::{Channel, Error, Format, Map, Reading, read};
use written::{DRIVE, MAP, Type, db3, drive, mcap, message};

fn read_drive(of: Type<'_>, messages: &[Vec<u8>]) -> Result<Reading, Error> {
    let timed: Vec<(u64, Vec<u8>)> =
        (0u64..).map(|row| (1 + row) * 100_000_000).zip(messages.to_vec()).collect();
    read(mcap(of, &timed), Format::Mcap, "drive", Some(&Map::from_json(MAP).unwrap()))
}

fn power_w(reading: &Reading) -> &[f64] {
    reading.recording.channel(Channel::Power).unwrap()
}

/// A map of a battery's state; the wheels' speeds are taken from whatever the message has twice.
fn battery_map(power: &str) -> Map {
    let source = |channel: &str, field: &str| {
        format!(r#"{{"channel": "{channel}", "topic": "*/drive", "fields": ["{field}"]}}"#)
    };
    let sources =
        [source("v_left_mps", "current"), source("v_right_mps", "current"), source("power_w", power)];
    Map::from_json(&format!(r#"{{"name": "own", "sources": [{}]}}"#, sources.join(","))).unwrap()
}

/// A BatteryState in CDR of the class that its header names, with a serial number of so many bytes a character behind.
fn battery(current: f32, serial: &[u8]) -> Vec<u8> {
    let mut bytes = vec![0, 1, 0, 0];
    bytes.extend([0u32, 0, 1].map(u32::to_le_bytes).concat());
    bytes.extend([0, 0, 0, 0]);
    bytes.extend([24.0, 30.0, current, 1.0, 2.0, 3.0, 0.5f32].map(f32::to_le_bytes).concat());
    bytes.extend([1, 2, 3, 1]);
    bytes.extend([0u32, 0, 1].map(u32::to_le_bytes).concat());
    bytes.extend([0, 0, 0, 0]);
    bytes.extend(serial);
    bytes
}

/// A text of plain CDR.
const SERIAL: [u8; 8] = [4, 0, 0, 0, b'a', b'b', b'c', 0];

#[test]
fn types_of_standard_packages_are_read_without_a_definition_and_the_report_says_so() {
    let messages: Vec<(u64, Vec<u8>)> =
        (1u64..=20).map(|row| (row * 100_000_000, battery(row as f32, &SERIAL))).collect();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("humble.db3");
    let of = Type { name: "sensor_msgs/msg/BatteryState", definition: b"", ..DRIVE };
    db3(&path, of, &messages);
    let map = battery_map("voltage");
    let humble = std::fs::read(&path).unwrap();
    let unsaid = Type { schema_encoding: "", ..of };
    let module = Type { schema_encoding: "ros2idl", definition: b"module m {};", ..of };
    for (bytes, format) in [
        (humble, Format::Db3),
        (mcap(of, &messages), Format::Mcap),
        (mcap(unsaid, &messages), Format::Mcap),
        (mcap(module, &messages), Format::Mcap),
    ] {
        let reading = read(bytes, format, "drive", Some(&map)).unwrap();
        assert_eq!(reading.recording.channel(Channel::LeftSpeed).unwrap()[2], 3.0);
        assert_eq!(power_w(&reading)[2], 24.0);
        let told = &reading.report.repairs[0];
        assert!(told.place == "topic /drive" && told.what.contains("sensor_msgs/BatteryState"), "{told:?}");
    }
}

#[test]
fn a_message_that_is_not_of_the_standard_definition_is_refused_rather_than_misread() {
    // Before Foxy a BatteryState had no temperature: what lies there is the current, and the message is shorter.
    let older = |current| {
        let whole = battery(current, &SERIAL);
        [&whole[..24], &whole[28..]].concat()
    };
    let of = Type { name: "sensor_msgs/msg/BatteryState", definition: b"", ..DRIVE };
    let messages = [(100_000_000, older(1.0)), (200_000_000, older(2.0))];
    let error = read(mcap(of, &messages), Format::Mcap, "drive", Some(&battery_map("voltage"))).unwrap_err();
    let message = error.to_string();
    assert!(message.contains("sensor_msgs/msg/BatteryState") && message.contains("standard"), "{message}");
}

#[test]
fn the_error_says_of_every_topic_that_the_map_names_why_it_is_not_read() {
    let star = MAP.replace("\"/drive\"", "\"*/drive\"");
    let map = Map::from_json(&star).unwrap();
    let messages = drive(1, 1..=5);
    for (of, reason) in [
        (Type { message_encoding: "json", schema_encoding: "jsonschema", ..DRIVE }, "`json`"),
        (Type { message_encoding: "protobuf", schema_encoding: "protobuf", ..DRIVE }, "`protobuf`"),
        (Type { definition: b"", ..DRIVE }, "no definition of my_msgs/Drive"),
        (Type { definition: b"float64[x] left", ..DRIVE }, "`float64[x]` is no array"),
        (Type { schema_encoding: "ros2idl", definition: b"module my_msgs { union", ..DRIVE }, "IDL"),
    ] {
        let message = read(mcap(of, &messages), Format::Mcap, "drive", Some(&map)).unwrap_err().to_string();
        assert!(message.contains("/drive") && message.contains(reason), "{message}");
    }
}

#[test]
fn comments_of_a_definition_may_be_in_latin_1() {
    let definition = [b"# motor in \xb0C\n", DRIVE.definition].concat();
    let reading =
        read_drive(Type { definition: &definition, ..DRIVE }, &[message(40.0), message(50.0)]).unwrap();
    assert_eq!(power_w(&reading), [40.0, 50.0]);
}

const IDL: &[u8] = b"================================================================================
IDL: my_msgs/msg/Drive
// generated from rosidl_adapter
#include \"std_msgs/msg/Header.idl\"
module my_msgs {
  module msg {
    typedef double double__2[2];
    module Drive_Constants {
      const uint8 FULL = 3; /* of a battery */
    };
    @verbatim (language=\"comment\", text=\"a drive; with { braces }\" \"and a second line\")
    struct Drive {
      @unit (value=\"m/s\") double left, right;
      sequence<my_msgs::msg::Cell, 4> cells;
      double__2 pair;
      @key wstring<9> note;
      unsigned long long count;
      double watts;
    };
  };
};
================================================================================
IDL: my_msgs/msg/Cell
module my_msgs { module msg {
    enum State { IDLE, BUSY };
    struct Cell { State state; string name; @optional_not_used octet raw[3]; };
}; };
";

#[test]
fn definitions_in_idl_are_read() {
    let mut message = vec![0, 1, 0, 0];
    message.extend([1.0f64, 2.0].map(f64::to_le_bytes).concat());
    // Two cells: state, name "n", three octets; then a double aligned.
    message.extend([2u32, 1, 2].map(u32::to_le_bytes).concat());
    message.extend([b'n', 0, 7, 8, 9, 0, 0, 0]);
    message.extend([0u32, 2].map(u32::to_le_bytes).concat());
    message.extend([b'n', 0, 7, 8, 9, 0, 0, 0]);
    message.extend([0, 0, 0, 0]);
    message.extend([5.0f64, 6.0].map(f64::to_le_bytes).concat());
    message.extend(0u32.to_le_bytes());
    message.extend([0; 4]);
    message.extend(9u64.to_le_bytes());
    message.extend(40.0f64.to_le_bytes());
    let of = Type { schema_encoding: "ros2idl", definition: IDL, ..DRIVE };
    let reading = read_drive(of, &[message.clone(), message]).unwrap();
    assert_eq!(power_w(&reading), [40.0, 40.0]);
    assert_eq!(reading.recording.channel(Channel::RightSpeed).unwrap(), [2.0, 2.0]);
}

/// A wide text before what is wanted, as Fast CDR 1 (four bytes a character), Fast CDR 2 (two, counted in characters) and
/// DDS-XTypes 1.3 (two, counted in bytes) write it.
#[test]
fn wide_texts_are_stepped_over_in_each_width_that_is_written() {
    let definition = b"wstring name\nfloat64 left\nfloat64 right\nfloat64 watts\n";
    let four: Vec<u8> = "abc".chars().flat_map(|c| u32::from(c).to_le_bytes()).collect();
    let two: Vec<u8> = "abc".encode_utf16().flat_map(u16::to_le_bytes).collect();
    for (count, text) in [(3u32, &four), (3, &two), (6, &two), (0, &Vec::new())] {
        let mut body = [&count.to_le_bytes()[..], text].concat();
        body.resize(body.len().next_multiple_of(8), 0);
        let numbers = [1.0f64, 2.0, 40.0].map(f64::to_le_bytes).concat();
        let message = [&[0, 1, 0, 0][..], &body, &numbers].concat();
        let reading = read_drive(Type { definition, ..DRIVE }, &[message.clone(), message]).unwrap();
        assert_eq!(power_w(&reading), [40.0, 40.0], "{} bytes", text.len());
    }
}

/// DDS-XTypes 1.3, section 7.4.3.5: the second version of CDR writes the length of a collection of texts before it, and that
/// of an appendable type; some writers leave it out.
#[test]
fn the_second_version_of_cdr_is_read_with_and_without_its_lengths() {
    let definition = b"string[] names\nfloat64 left\nfloat64 right\nfloat64 watts\n";
    let names = [1u32.to_le_bytes().to_vec(), 2u32.to_le_bytes().to_vec(), b"a\0".to_vec()].concat();
    let numbers = [1.0f64, 2.0, 40.0].map(f64::to_le_bytes).concat();
    let padded = |bytes: Vec<u8>| [bytes, vec![0, 0]].concat();
    let length = |bytes: usize| (bytes as u32).to_le_bytes().to_vec();
    let with = padded([length(names.len()), names.clone()].concat());
    let without = padded(names);
    let body = [with.clone(), numbers.clone()].concat();
    for message in [
        [vec![0, 7, 0, 0], body.clone()].concat(),
        [vec![0, 7, 0, 0], without, numbers].concat(),
        [vec![0, 9, 0, 0], length(body.len()), body].concat(),
    ] {
        let reading = read_drive(Type { definition, ..DRIVE }, &[message.clone(), message]).unwrap();
        assert_eq!(power_w(&reading), [40.0, 40.0]);
    }
}
