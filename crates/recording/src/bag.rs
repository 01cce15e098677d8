//! ROS 1 bags of version 2.0, by the format's description (<http://wiki.ros.org/Bags/Format/2.0>).
//!
//! The `rosbag` crate needs the index at the end of the file, which a bag that was cut off lacks, and allocates what a chunk
//! claims; so the records are read here.

use std::io::Read;

use crate::{
    Error, Map,
    compression::{LONGEST_BYTES, decompress},
    container::{BREAKS_OFF, ENDS_EARLY, UNPACKABLE, opened, topics},
    cursor::{Cursor, Encoding, Short},
    reading::{Reading, read_up_to},
    schema::{Schema, Text},
    topic::Topics,
    watch::Budget,
};

const MAGIC: &[u8] = b"#ROSBAG V2.0\n";

/// Operations of the records that matter here.
const MESSAGE: u8 = 0x02;
const CHUNK: u8 = 0x05;
const CONNECTION: u8 = 0x07;

/// A record header's fields.
struct Header<'b>(&'b [u8]);

impl<'b> Header<'b> {
    /// The value of a field.
    fn get(&self, name: &str) -> Option<&'b [u8]> {
        let mut cursor = Cursor::packed(self.0);
        while let Ok(field) = cursor.counted() {
            let split = field.iter().position(|byte| *byte == b'=')?;
            if field.get(..split)? == name.as_bytes() {
                return field.get(split + 1..);
            }
        }
        None
    }

    fn number<const N: usize>(&self, name: &str) -> Option<[u8; N]> {
        self.get(name)?.try_into().ok()
    }

    fn operation(&self) -> Option<u8> {
        self.number::<1>("op").map(|[op]| op)
    }
}

/// The format's name in reports.
pub(crate) const FORMAT: &str = "ROS 1 bag";

/// Reads a bag.
pub(crate) fn read(
    source: impl Read,
    name: &str,
    map: Option<&Map>,
    budget: &Budget,
) -> Result<Reading, Error> {
    let mut topics = topics(map, budget)?;
    read_into(source, &mut topics)?;
    topics.finish(name, FORMAT)
}

/// Reads a bag front to back; its index is not needed, so one that was cut off is read as far as it goes.
pub(crate) fn read_into(source: impl Read, topics: &mut Topics<'_>) -> Result<(), Error> {
    let older = "it does not begin with `#ROSBAG V2.0`; convert older bags with `rosbag fix`";
    let mut source = opened(source, MAGIC, FORMAT, older)?;
    let mut header = Vec::new();
    let (mut body, mut plain) = (Vec::new(), Vec::new());
    let mut at = MAGIC.len() as u64;
    loop {
        let header_bytes = match part(&mut source, &mut header)? {
            // A bag has no end mark: it ends where no record begins.
            Ended::Before => break,
            Ended::Within => {
                topics.tell(at, ENDS_EARLY);
                break;
            }
            Ended::Not(bytes) => bytes,
        };
        let Ended::Not(body_bytes) = part(&mut source, &mut body)? else {
            if Header(&header).operation() == Some(CHUNK) {
                chunk(&Header(&header), &body, at, false, &mut plain, topics)?;
            }
            topics.tell(at, BREAKS_OFF);
            break;
        };
        match Header(&header).operation() {
            Some(CHUNK) => chunk(&Header(&header), &body, at, true, &mut plain, topics)?,
            Some(_) => record(&Header(&header), &body, at, topics)?,
            None => topics.tell(at, "a record does not say what it is; it was left out"),
        }
        at = at.saturating_add(8).saturating_add(header_bytes).saturating_add(body_bytes);
    }
    Ok(())
}

/// Whether the file ended while a part of a record was read.
enum Ended {
    /// Before its first byte.
    Before,
    /// Within it, or it claims more than [`LONGEST_BYTES`].
    Within,
    /// No: the part has so many bytes.
    Not(u64),
}

/// Reads a part of a record behind its length into `bytes`.
fn part(source: &mut impl Read, bytes: &mut Vec<u8>) -> Result<Ended, Error> {
    if !read_up_to(source, 4, bytes)? {
        return Ok(if bytes.is_empty() { Ended::Before } else { Ended::Within });
    }
    let length = u64::from(Cursor::packed(bytes).u32().unwrap_or(0));
    let whole = read_up_to(source, length.min(LONGEST_BYTES), bytes)?;
    Ok(if whole && length <= LONGEST_BYTES { Ended::Not(length) } else { Ended::Within })
}

fn record(header: &Header<'_>, body: &[u8], at: u64, topics: &mut Topics<'_>) -> Result<(), Error> {
    topics.looks().worked(1)?;
    let connection = header.number("conn").map(u32::from_le_bytes);
    match (header.operation(), connection) {
        (Some(MESSAGE), Some(connection)) => {
            let Some(time) = header.number::<8>("time") else {
                topics.tell(at, "a message has no time; it was left out");
                return Ok(());
            };
            let packed = u64::from_le_bytes(time);
            let (seconds, nanoseconds) = (packed & u64::from(u32::MAX), packed >> 32);
            let log_ns = i64::try_from(seconds * 1_000_000_000 + nanoseconds).unwrap_or(i64::MAX);
            topics.message(connection, log_ns, body)?;
            Ok(())
        }
        (Some(CONNECTION), Some(connection)) => {
            let about = Header(body);
            let text = |bytes: Option<&[u8]>| String::from_utf8_lossy(bytes.unwrap_or_default()).into_owned();
            let (topic, type_name) = (text(header.get("topic")), text(about.get("type")));
            let definition = text(about.get("message_definition"));
            let (definition, encoding) = (Ok(Text::Msg(definition.into())), Encoding::Ros1);
            topics.connect(connection, &topic, &Schema { type_name: &type_name, definition, encoding })
        }
        _ => Ok(()),
    }
}

fn chunk(
    header: &Header<'_>,
    body: &[u8],
    at: u64,
    whole: bool,
    plain: &mut Vec<u8>,
    topics: &mut Topics<'_>,
) -> Result<(), Error> {
    let (Some(compression), Some(size)) = (header.get("compression"), header.number("size")) else {
        topics.tell(at, "a chunk does not say how it is compressed; it was left out");
        return Ok(());
    };
    match decompress(compression, body, u64::from(u32::from_le_bytes(size)), plain, topics.looks())? {
        Err(reason) => topics.tell(at, &format!("{reason}; the chunk was left out")),
        Ok(false) if whole => topics.tell(at, UNPACKABLE),
        Ok(_) => {
            let mut cursor = Cursor::packed(plain);
            let mut next = || Ok::<_, Short>((cursor.counted()?, cursor.counted()?));
            while let Ok((header, body)) = next() {
                record(&Header(header), body, at, topics)?;
            }
        }
    }
    Ok(())
}
