//! Several sources of one channel in a bag, and several robots.

#![allow(clippy::unwrap_used)]

mod written;

use recording::{Channel, Error, Format, Map, Reading, read};
use serde_json::{Value, json};
use written::{DRIVE, Type, mcap_of_topics};

/// Rows of 0.1 s.
const ROWS: usize = 600;
const WHEELS: Type<'static> =
    Type { name: "own/msg/Wheels", definition: b"float64 left\nfloat64 right\n", ..DRIVE };
const WATTS: Type<'static> = Type { name: "own/msg/Watts", definition: b"float64 watts\n", ..DRIVE };

type Messages = Vec<(u64, Vec<u8>)>;

fn messages(rows: std::ops::Range<usize>, of: impl Fn(usize) -> Vec<f64>) -> Messages {
    let bytes = |row: usize| -> Vec<u8> {
        let numbers = of(row).into_iter().flat_map(f64::to_le_bytes);
        [0u8, 1, 0, 0].into_iter().chain(numbers).collect()
    };
    rows.map(|row| (1_000_000_000_000 + 100_000_000 * row as u64, bytes(row))).collect()
}

fn wheels() -> Messages {
    messages(0..ROWS, |row| vec![0.4 + 0.1 * (0.05 * row as f64).sin(), 0.5])
}

fn watts(rows: std::ops::Range<usize>, by: f64) -> Messages {
    messages(rows, |row| vec![by * (80.0 + 20.0 * (0.05 * row as f64).sin())])
}

fn bag(topics: &[(&str, &Messages)]) -> Vec<u8> {
    let of = |name: &str| if name.ends_with("wheels") { WHEELS } else { WATTS };
    let topics: Vec<_> =
        topics.iter().map(|(name, messages)| (*name, of(name), messages.as_slice())).collect();
    mcap_of_topics(&topics)
}

fn read_by(sources: &[Value], bytes: Vec<u8>) -> Result<Reading, Error> {
    let wheel =
        |channel: &str, field: &str| json!({"channel": channel, "topic": "*/wheels", "fields": [field]});
    let wheels = [wheel("v_left_mps", "left"), wheel("v_right_mps", "right")];
    let all: Vec<&Value> = wheels.iter().chain(sources).collect();
    let map = Map::from_value(&json!({"name": "own", "sources": all})).unwrap();
    read(bytes, Format::Mcap, "drive", Some(&map))
}

fn power(topic: &str) -> Value {
    json!({"channel": "power_w", "topic": topic, "fields": ["watts"]})
}

fn mean_power_w(reading: &Reading) -> f64 {
    let values: Vec<f64> =
        reading.recording.channel(Channel::Power).unwrap().iter().copied().filter(|w| !w.is_nan()).collect();
    values.iter().sum::<f64>() / values.len() as f64
}

#[test]
fn a_source_with_a_few_messages_gives_way_to_one_that_covers_the_drive() {
    let (few, all) = (watts(0..3, 1.0), watts(0..ROWS, 1.0));
    let bytes = bag(&[("/wheels", &wheels()), ("/bms/state", &few), ("/battery", &all)]);
    let reading = read_by(&[power("/bms/state"), power("/battery")], bytes).unwrap();
    let known = reading.recording.channel(Channel::Power).unwrap().iter().filter(|w| !w.is_nan()).count();
    assert!(known > ROWS - 3, "{known}");
    let told = reading.report.repairs.iter().find(|repair| repair.place.contains("/bms/state")).unwrap();
    assert!(told.what.contains("0.2 s of a drive of 59.9 s") && told.what.contains("/battery"), "{told:?}");
    // One that ends halfway stays, and what it lacks is counted elsewhere.
    let most = watts(0..400, 1.0);
    let bytes = bag(&[("/wheels", &wheels()), ("/bms/state", &most), ("/battery", &all)]);
    let reading = read_by(&[power("/bms/state"), power("/battery")], bytes).unwrap();
    assert!(
        reading.report.channels.iter().any(|channel| channel.from == "/bms/state watts"),
        "{}",
        reading.report
    );
}

#[test]
fn two_sources_of_a_users_map_that_both_hold_numbers_are_said_with_the_cure() {
    let half = watts(0..ROWS, 0.5);
    let bytes = || bag(&[("/wheels", &wheels()), ("/p1", &half), ("/p2", &half)]);
    let reading = read_by(&[power("/p1"), power("/p2")], bytes()).unwrap();
    let told = reading.report.repairs.iter().find(|repair| repair.place == "power_w").unwrap();
    assert!(["/p1", "/p2", "\"sum\"", "topics"].iter().all(|word| told.what.contains(word)), "{told:?}");
    let both = json!({"channel": "power_w", "topics": ["/p1", "/p2"], "fields": ["watts"], "combine": "sum"});
    let added = read_by(&[both], bytes()).unwrap();
    assert!((mean_power_w(&added) - 2.0 * mean_power_w(&reading)).abs() < 0.5, "{}", added.report);
    assert!(
        added.report.repairs.is_empty()
            && added.report.channels.iter().any(|c| c.from == "/p1 watts, /p2 watts")
    );
    let mean = json!({"channel": "power_w", "topics": ["/p1", "/p2"], "fields": ["watts"]});
    assert!((mean_power_w(&read_by(&[mean], bytes()).unwrap()) - mean_power_w(&reading)).abs() < 0.5);
    // A whole without one of its parts is none.
    let lacks =
        json!({"channel": "power_w", "topics": ["/p1", "/p3"], "fields": ["watts"], "combine": "sum"});
    assert!(read_by(&[lacks], bytes()).unwrap_err().to_string().contains("power"));
    for wrong in [json!({"topic": "/p1"}), json!({"combine": "product"})] {
        let mut source = json!({"channel": "power_w", "topics": ["/p1", "/p2"], "fields": ["watts"]});
        wrong.as_object().unwrap().iter().for_each(|(key, value)| source[key] = value.clone());
        let refused = Map::from_value(&json!({"name": "own", "sources": [source]})).unwrap_err().to_string();
        assert!(refused.contains("sources[0].topics"), "{refused}");
    }
}

#[test]
fn a_topic_that_a_users_map_names_and_the_file_lacks_is_said() {
    let all = watts(0..ROWS, 1.0);
    let pitch = json!({"channel": "pitch_rad", "topic": "/pich", "fields": ["data"]});
    let reading =
        read_by(&[power("/p1"), pitch, power("/p0")], bag(&[("/wheels", &wheels()), ("/p1", &all)])).unwrap();
    let said = |name: &str| {
        reading
            .report
            .ignored
            .iter()
            .any(|ignored| ignored.name == name && ignored.reason.contains("no such topic"))
    };
    assert!(said("/pich"), "{}", reading.report);
    assert!(!said("/p0"), "another source gave the channel");
}

#[test]
fn a_simulation_is_as_long_as_its_own_clock_says() {
    let clock = Type {
        name: "rosgraph_msgs/msg/Clock",
        definition:
            b"builtin_interfaces/Time clock\n===\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n",
        ..DRIVE
    };
    // The log's clock runs on while the simulation takes two seconds for one.
    let slowly = |messages: Messages| -> Messages {
        messages.into_iter().map(|(at_ns, bytes)| (2 * at_ns - 1_000_000_000_000, bytes)).collect()
    };
    let time = |row: usize| {
        [[0, 1, 0, 0], ((row / 10) as u32).to_le_bytes(), ((row % 10) as u32 * 100_000_000).to_le_bytes()]
            .concat()
    };
    let ticks: Messages = slowly(messages(0..ROWS, |_| Vec::new()))
        .into_iter()
        .enumerate()
        .map(|(row, (at_ns, _))| (at_ns, time(row)))
        .collect();
    let (wheels, watts) = (slowly(wheels()), slowly(watts(0..ROWS, 1.0)));
    let both = [("/wheels", WHEELS, wheels.as_slice()), ("/p1", WATTS, watts.as_slice())];
    let with_clock = [&both[..], &[("/clock", clock, ticks.as_slice())]].concat();
    let long = read_by(&[power("/p1")], mcap_of_topics(&both)).unwrap();
    let right = read_by(&[power("/p1")], mcap_of_topics(&with_clock)).unwrap();
    assert!((long.recording.duration_s() - 119.8).abs() < 1e-6);
    assert!((right.recording.duration_s() - 59.9).abs() < 1e-6, "{}", right.report);
    assert!(
        right.report.repairs.iter().any(|repair| repair.what.contains("0.500 of the speed")),
        "{}",
        right.report
    );
}

#[test]
fn what_is_used_is_not_said_to_be_unused() {
    let all = watts(0..ROWS, 1.0);
    let bytes = bag(&[("/a/wheels", &wheels()), ("/a/platform/bms/state", &all)]);
    let reading = read_by(&[power("*/platform/bms/state"), power("*/bms/state")], bytes).unwrap();
    assert!(reading.report.ignored.is_empty(), "{:?}", reading.report.ignored);
}

#[test]
fn wheels_of_one_robot_and_power_of_another_are_refused() {
    let all = watts(0..ROWS, 1.0);
    let of = |wheels_of: &str, power_of: &str| {
        let (wheels_topic, power_topic) = (format!("{wheels_of}/wheels"), format!("{power_of}/bms/state"));
        read_by(&[power("*/bms/state")], bag(&[(&wheels_topic, &wheels()), (&power_topic, &all)]))
    };
    let refused = of("/a200_0000", "/a200_0001").unwrap_err().to_string();
    assert!(refused.contains("several robots") && refused.contains("/a200_0001"), "{refused}");
    // Namespaces of parts of one robot, and topics without any.
    for [wheels_of, power_of] in
        [["/a200_0000", "/a200_0000"], ["/base", "/battery"], ["/a200_0000", ""], ["", "/a200_0000"]]
    {
        assert!(of(wheels_of, power_of).is_ok(), "{wheels_of} {power_of}");
    }
    // A map that names both outright means both.
    let named = bag(&[("/a200_0000/wheels", &wheels()), ("/a200_0001/bms/state", &all)]);
    assert!(read_by(&[power("/a200_0001/bms/state")], named).is_ok());
}
