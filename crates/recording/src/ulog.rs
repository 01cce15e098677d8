//! Flight logs of PX4 (ULog), by the format's description (<https://docs.px4.io/main/en/dev_log/ulog_file_format.html>).
//!
//! Messages are packed structures of numbers, as those of ROS 1 are, so that their formats become definitions. Axes are north-east-down and
//! forward-right-down; the built-in map `px4` turns them.

use std::{collections::BTreeMap, io::Read};

use crate::{
    Error, Map,
    container::{BREAKS_OFF, opened},
    cursor::{Cursor, Encoding},
    reading::{Reading, read_up_to},
    schema::{Schema, Text},
    topic::Topics,
    watch::Budget,
};

/// The first bytes of every file; a byte with the version follows.
pub(crate) const MAGIC: &[u8] = b"ULog\x01\x12\x35";
/// Version and time behind the magic.
const HEADER_BYTES: u64 = 9;
/// Size and type of a record.
const FRAME_BYTES: u64 = 3;

/// The format's name in reports.
pub(crate) const FORMAT: &str = "PX4 ULog";

/// Reads a log. Without a map, topics are those of a PX4 rover.
pub(crate) fn read(
    source: impl Read,
    name: &str,
    map: Option<&Map>,
    budget: &Budget,
) -> Result<Reading, Error> {
    let px4 = Map::built_in("px4");
    let map = map.or(px4.as_ref()).ok_or(Error::Empty { found: "no map".into() })?;
    let mut topics = Topics::new(map, budget.clone());
    read_into(source, &mut topics)?;
    topics.finish(name, FORMAT)
}

/// Reads a log front to back, one that was cut off as far as it goes.
pub(crate) fn read_into(source: impl Read, topics: &mut Topics<'_>) -> Result<(), Error> {
    let mut source = opened(source, MAGIC, FORMAT, "it does not begin with the ULog magic")?;
    let mut bytes = Vec::new();
    if !read_up_to(&mut source, HEADER_BYTES, &mut bytes)? {
        topics.tell(MAGIC.len() as u64, BREAKS_OFF);
        return Ok(());
    }
    let mut formats = Formats::default();
    let mut at = MAGIC.len() as u64 + HEADER_BYTES;
    loop {
        let framed = read_up_to(&mut source, FRAME_BYTES, &mut bytes)?;
        let (true, &[low, high, kind]) = (framed, bytes.as_slice()) else {
            if !bytes.is_empty() {
                topics.tell(at, BREAKS_OFF);
            }
            return Ok(());
        };
        let length = u64::from(u16::from_le_bytes([low, high]));
        if !read_up_to(&mut source, length, &mut bytes)? {
            topics.tell(at, BREAKS_OFF);
            return Ok(());
        }
        formats.record(kind, &bytes, at, topics)?;
        at = at.saturating_add(FRAME_BYTES + length);
    }
}

/// Formats that a log has told so far, by name, as definitions.
#[derive(Default)]
struct Formats(BTreeMap<String, String>);

impl Formats {
    fn record(&mut self, kind: u8, body: &[u8], at: u64, topics: &mut Topics<'_>) -> Result<(), Error> {
        topics.looks().worked(1)?;
        match kind {
            b'F' => {
                if let Some((name, fields)) = String::from_utf8_lossy(body).split_once(':') {
                    self.0.insert(name.to_owned(), definition(fields));
                }
                Ok(())
            }
            b'A' => self.subscribe(body, topics),
            b'D' => {
                let mut cursor = Cursor::packed(body);
                if let Ok(id) = cursor.u16() {
                    let message = cursor.rest();
                    if let Ok(since_start_us) = Cursor::packed(message).u64() {
                        let log_ns = i64::try_from(since_start_us.saturating_mul(1000)).unwrap_or(i64::MAX);
                        return topics.message(u32::from(id), log_ns, message);
                    }
                }
                topics.tell(at, "a message is shorter than its time; it was left out");
                Ok(())
            }
            b'O' => {
                let lost_ms = body.first_chunk::<2>().map_or(0, |bytes| u16::from_le_bytes(*bytes));
                topics
                    .tell(at, &format!("the logger could not keep up: {lost_ms} ms of all topics are lost"));
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// Connects a topic: its instance, its number in the log and its name.
    fn subscribe(&self, body: &[u8], topics: &mut Topics<'_>) -> Result<(), Error> {
        let [instance, low, high, name @ ..] = body else { return Ok(()) };
        let name = String::from_utf8_lossy(name);
        let topic = match instance {
            0 => format!("/{name}"),
            _ => format!("/{name}_{instance}"),
        };
        let mut text = self.0.get(name.as_ref()).cloned().unwrap_or_default();
        for (other, fields) in &self.0 {
            text += &format!("====\nMSG: px4/{other}\n{fields}");
        }
        text += "====\nMSG: px4/Quaternion\nfloat32 w\nfloat32 x\nfloat32 y\nfloat32 z\n";
        let type_name = format!("px4/{name}");
        let definition = Ok(Text::Msg(text.into()));
        let schema = Schema { type_name: &type_name, definition, encoding: Encoding::Ros1 };
        topics.connect(u32::from(u16::from_le_bytes([*low, *high])), &topic, &schema)
    }
}

/// Fields of a format, as `float[4] q;uint8_t[4] _padding0;`, as lines of a definition. Padding at the end is not written.
fn definition(fields: &str) -> String {
    let mut lines: Vec<String> = Vec::new();
    for field in fields.split(';') {
        let Some((kind, name)) = field.trim().split_once(' ') else { continue };
        let (base, count) = match kind.split_once('[') {
            Some((base, count)) => (base, format!("[{count}")),
            None => (kind, String::new()),
        };
        let base = match base {
            "float" => "float32",
            "double" => "float64",
            "char" => "uint8",
            other => other.strip_suffix("_t").unwrap_or(other),
        };
        // Attitudes are the quaternions among fields of four.
        let (base, count) = match (base, count.as_str(), name) {
            ("float32", "[4]", "q") => ("px4/Quaternion", String::new()),
            _ => (base, count),
        };
        // Names of ROS do not begin with a line below.
        lines.push(format!("{base}{count} {}\n", name.replace("_padding", "padding")));
    }
    while lines.last().is_some_and(|line| line.contains(" padding")) {
        lines.pop();
    }
    lines.concat()
}
