//! Messages that are not what their definition says: named by topic, left out where others are whole.

#![allow(clippy::unwrap_used)]

use recording::{Channel, Error, Format, Map, Reading, read};

const DEFINITION: &str = "float64 left\nfloat64 right\nfloat64 watts\n";

fn text(text: &str) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes(), text.as_bytes()].concat()
}

fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode], &(body.len() as u64).to_le_bytes()[..], body].concat()
}

/// An MCAP file of one topic, by its specification: magic, schema, channel, messages, end of data.
fn mcap(definition: &str, messages: &[Vec<u8>]) -> Vec<u8> {
    let id = 1u16.to_le_bytes();
    let schema = [&id[..], &text("my_msgs/Drive"), &text("ros2msg"), &text(definition)].concat();
    let channel = [&id[..], &id, &text("/drive"), &text("cdr"), &0u32.to_le_bytes()].concat();
    let mut file = [b"\x89MCAP0\r\n".to_vec(), record(3, &schema), record(4, &channel)].concat();
    for (row, message) in (0u64..).zip(messages) {
        let stamp_ns = (row * 100_000_000).to_le_bytes();
        let head = [&id[..], &(row as u32).to_le_bytes(), &stamp_ns, &stamp_ns].concat();
        file.extend(record(5, &[head, message.clone()].concat()));
    }
    [file, record(15, &[0; 4])].concat()
}

fn cdr(header: [u8; 4], numbers: [f64; 3]) -> Vec<u8> {
    let little = header[1] == 1;
    let bytes = numbers.map(|number| if little { number.to_le_bytes() } else { number.to_be_bytes() });
    [&header[..], &bytes.concat()].concat()
}

fn reading(messages: &[Vec<u8>]) -> Result<Reading, Error> {
    reading_by(DEFINITION, messages)
}

fn reading_by(definition: &str, messages: &[Vec<u8>]) -> Result<Reading, Error> {
    let source = |channel: &str, field: &str| {
        format!(r#"{{"channel": "{channel}", "topic": "/drive", "fields": ["{field}"]}}"#)
    };
    let sources = [source("v_left_mps", "left"), source("v_right_mps", "right"), source("power_w", "watts")];
    let map = Map::from_json(&format!(r#"{{"name": "own", "sources": [{}]}}"#, sources.join(","))).unwrap();
    read(mcap(definition, messages), Format::Mcap, "drive", Some(&map))
}

#[test]
fn both_byte_orders_are_read() {
    let found = reading(&[cdr([0, 1, 0, 0], [1.0, 2.0, 40.0]), cdr([0, 0, 0, 0], [1.5, 2.5, 50.0])]).unwrap();
    assert_eq!(found.recording.channel(Channel::Power).unwrap(), [40.0, 50.0]);
}

#[test]
fn a_topic_of_which_no_message_is_what_it_says_is_refused_by_name_and_reason() {
    let whole = cdr([0, 1, 0, 0], [1.0, 2.0, 40.0]);
    for (message, said) in [
        (whole[..20].to_vec(), "its 20 bytes end too soon"),
        (cdr([0, 3, 0, 0], [1.0, 2.0, 40.0]), "CDR encapsulation 0x0003 is none of plain CDR"),
        (vec![0, 1], "2 bytes are too few for the header of CDR"),
        (Vec::new(), "0 bytes are too few"),
    ] {
        let error = reading(&[message.clone(), message]).unwrap_err().to_string();
        let topic =
            "topic /drive: none of its 2 messages is a my_msgs/Drive as its definition says: message 1: ";
        assert!(error.contains(topic) && error.contains(said), "{error}");
    }
}

#[test]
fn messages_that_are_wrong_among_others_are_left_out_and_told() {
    let whole = |watts| cdr([0, 1, 0, 0], [1.0, 2.0, watts]);
    let found = reading(&[whole(40.0), whole(0.0)[..9].to_vec(), whole(60.0)]).unwrap();
    assert_eq!(found.recording.channel(Channel::Power).unwrap(), [40.0, 60.0]);
    let repair = &found.report.repairs[0];
    assert_eq!(repair.place, "topic /drive");
    assert!(
        repair.what.contains("1 messages are not what") && repair.what.contains("message 2"),
        "{repair:?}"
    );
}

#[test]
fn a_definition_that_names_a_field_twice_is_refused() {
    // Such a one could put any number into the stamp, and its seconds into nanoseconds overflow.
    let definition = format!(
        "my_msgs/Stamped header\nmy_msgs/Loose header\n{DEFINITION}{0}\nMSG: my_msgs/Stamped\ntime stamp\n{0}\n\
         MSG: my_msgs/Loose\nfloat64 stamp\n",
        "=".repeat(80)
    );
    let numbers = [1e300, 1.0, 2.0, 40.0].map(f64::to_le_bytes).concat();
    let message = [vec![0, 1, 0, 0], 7u64.to_le_bytes().to_vec(), numbers].concat();
    let error = reading_by(&definition, &[message.clone(), message]).unwrap_err().to_string();
    assert!(
        error.contains("topic /drive") && error.contains("two fields `header` in my_msgs/Drive"),
        "{error}"
    );
}
