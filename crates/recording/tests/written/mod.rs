//! Containers as their recorders write them, from messages of one topic.

#![allow(dead_code, clippy::unwrap_used)]

use std::path::Path;

/// The type of [`mcap`]'s and [`db3`]'s messages.
pub(crate) const DEFINITION: &str = "float64 left\nfloat64 right\nfloat64 watts\n";

/// A map of them.
pub(crate) const MAP: &str = r#"{"name": "own", "sources": [
    {"channel": "v_left_mps", "topic": "/drive", "fields": ["left"]},
    {"channel": "v_right_mps", "topic": "/drive", "fields": ["right"]},
    {"channel": "power_w", "topic": "/drive", "fields": ["watts"]}]}"#;

/// A message of [`DEFINITION`] in little-endian CDR.
pub(crate) fn message(watts: f64) -> Vec<u8> {
    [&[0, 1, 0, 0][..], &[1.0, 2.0, watts].map(f64::to_le_bytes).concat()].concat()
}

/// Time and bytes of messages every 0.1 s from a second on, of which each tells its own power.
pub(crate) fn drive(first_s: u64, watts: impl IntoIterator<Item = u32>) -> Vec<(u64, Vec<u8>)> {
    let at_ns = |row: u64| first_s * 1_000_000_000 + row * 100_000_000;
    (0u64..).zip(watts).map(|(row, watts)| (at_ns(row), message(f64::from(watts)))).collect()
}

fn text(text: &[u8]) -> Vec<u8> {
    [&(text.len() as u32).to_le_bytes(), text].concat()
}

fn record(opcode: u8, body: &[u8]) -> Vec<u8> {
    [&[opcode], &(body.len() as u64).to_le_bytes()[..], body].concat()
}

/// Name, encodings and definition of the messages of a container.
#[derive(Clone, Copy)]
pub(crate) struct Type<'t> {
    pub(crate) name: &'t str,
    pub(crate) message_encoding: &'t str,
    pub(crate) schema_encoding: &'t str,
    pub(crate) definition: &'t [u8],
}

/// The type of [`message`].
pub(crate) const DRIVE: Type<'static> = Type {
    name: "my_msgs/msg/Drive",
    message_encoding: "cdr",
    schema_encoding: "ros2msg",
    definition: DEFINITION.as_bytes(),
};

const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// Records of the schema and the channel of topic `/drive`, and of its messages.
fn mcap_records(of: Type<'_>, messages: &[(u64, Vec<u8>)]) -> (Vec<u8>, Vec<u8>) {
    let id = 1u16.to_le_bytes();
    let schema =
        [&id[..], &text(of.name.as_bytes()), &text(of.schema_encoding.as_bytes()), &text(of.definition)];
    let channel =
        [&id[..], &id, &text(b"/drive"), &text(of.message_encoding.as_bytes()), &0u32.to_le_bytes()];
    let mut records = Vec::new();
    for (row, (at_ns, message)) in (0u32..).zip(messages) {
        let head = [&id[..], &row.to_le_bytes(), &at_ns.to_le_bytes(), &at_ns.to_le_bytes()].concat();
        records.extend(record(5, &[&head[..], message].concat()));
    }
    ([record(3, &schema.concat()), record(4, &channel.concat())].concat(), records)
}

/// Time and bytes of messages.
pub(crate) type Messages = [(u64, Vec<u8>)];

/// A whole MCAP file of these topics, each of one type: (topic, type, messages).
pub(crate) fn mcap_of_topics(topics: &[(&str, Type<'_>, &Messages)]) -> Vec<u8> {
    let mut records = Vec::new();
    for (id, (topic, of, messages)) in (1u16..).zip(topics) {
        let id = id.to_le_bytes();
        let schema =
            [&id[..], &text(of.name.as_bytes()), &text(of.schema_encoding.as_bytes()), &text(of.definition)];
        let channel = [
            &id[..],
            &id,
            &text(topic.as_bytes()),
            &text(of.message_encoding.as_bytes()),
            &0u32.to_le_bytes(),
        ];
        records.extend([record(3, &schema.concat()), record(4, &channel.concat())].concat());
        for (at_ns, message) in *messages {
            let head = [&id[..], &[0; 4], &at_ns.to_le_bytes(), &at_ns.to_le_bytes()].concat();
            records.extend(record(5, &[&head[..], message].concat()));
        }
    }
    [MAGIC, &records, &record(15, &[0; 4]), &record(2, &[0; 20]), MAGIC].concat()
}

/// A whole MCAP file of topic `/drive`, by its specification: magic, schema, channel, messages, end of data, footer, magic.
pub(crate) fn mcap(of: Type<'_>, messages: &[(u64, Vec<u8>)]) -> Vec<u8> {
    let (described, records) = mcap_records(of, messages);
    [MAGIC, &described, &records, &record(15, &[0; 4]), &record(2, &[0; 20]), MAGIC].concat()
}

/// The same in two chunks, of which the first alone describes the topic, with the summary that repeats it; where the first chunk stands.
pub(crate) fn mcap_of_two_chunks(messages: &[(u64, Vec<u8>)]) -> (Vec<u8>, std::ops::Range<usize>) {
    let chunk = |plain: &[u8], times_ns: [u64; 2]| {
        let sizes = (plain.len() as u64).to_le_bytes();
        let checksum = crc32fast::hash(plain).to_le_bytes();
        let times = times_ns.map(u64::to_le_bytes).concat();
        record(6, &[&times[..], &sizes, &checksum, &text(b""), &sizes, plain].concat())
    };
    let (first, second) = messages.split_at(messages.len() / 2);
    let times = |messages: &[(u64, Vec<u8>)]| [messages[0].0, messages[messages.len() - 1].0];
    let (described, first_records) = mcap_records(DRIVE, first);
    let (_, second_records) = mcap_records(DRIVE, second);
    let first_chunk = chunk(&[&described[..], &first_records].concat(), times(first));
    let ends = MAGIC.len() + first_chunk.len();
    let data = [MAGIC, &first_chunk, &chunk(&second_records, times(second)), &record(15, &[0; 4])].concat();
    let mut footer = [&(data.len() as u64).to_le_bytes()[..], &[0; 8]].concat();
    let begun = [&[2][..], &20u64.to_le_bytes(), &footer].concat();
    footer.extend(crc32fast::hash(&[&described[..], &begun].concat()).to_le_bytes());
    ([&data[..], &described, &record(2, &footer), MAGIC].concat(), MAGIC.len()..ends)
}

/// A SQLite file of topic `/drive` with the tables that rosbag2 makes since Iron; without a definition those of Humble.
pub(crate) fn db3(path: &Path, of: Type<'_>, messages: &[(u64, Vec<u8>)]) {
    let mut connection = rusqlite::Connection::open(path).unwrap();
    let tables = "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL,
          serialization_format TEXT NOT NULL, offered_qos_profiles TEXT NOT NULL);
        CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL,
          data BLOB NOT NULL);
        CREATE INDEX timestamp_idx ON messages (timestamp ASC);";
    connection.execute_batch(tables).unwrap();
    let topic = "INSERT INTO topics VALUES (?1, ?2, ?3, ?4, '')";
    connection.execute(topic, (7, "/drive", of.name, of.message_encoding)).unwrap();
    connection.execute(topic, (3, "/chatter", "std_msgs/msg/String", "cdr")).unwrap();
    if !of.definition.is_empty() {
        let table = "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL,
              encoding TEXT NOT NULL, encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL)";
        connection.execute_batch(table).unwrap();
        let definition = "INSERT INTO message_definitions VALUES (1, ?1, ?2, CAST(?3 AS TEXT), '')";
        connection.execute(definition, (of.name, of.schema_encoding, of.definition)).unwrap();
    }
    let transaction = connection.transaction().unwrap();
    for (at_ns, message) in messages {
        let insert = "INSERT INTO messages(topic_id, timestamp, data) VALUES (?1, ?2, ?3)";
        transaction.execute(insert, (7, *at_ns as i64, message)).unwrap();
        transaction.execute(insert, (3, *at_ns as i64, b"no CDR")).unwrap();
    }
    transaction.commit().unwrap();
}

/// The `metadata.yaml` that names these files.
pub(crate) fn metadata(folder: &Path, names: &[&str]) {
    let listed: String = names.iter().map(|name| format!("    - {name}\n")).collect();
    let text = format!(
        "rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n{listed}  message_count: 9\n"
    );
    std::fs::write(folder.join("metadata.yaml"), text).unwrap();
}
