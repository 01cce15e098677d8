//! ROS 1 bags of version 2.0, by the format's description (<http://wiki.ros.org/Bags/Format/2.0>).
//!
//! The `rosbag` crate needs the index at the end of the file, which a bag that was cut off lacks, and allocates what a chunk
//! claims; so the records are read here.

use std::io::Read;

use crate::{
    Error, Map,
    bag_loss::LastChunk,
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
const BAG: u8 = 0x03;
const INDEX: u8 = 0x04;
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

/// What is said of a bag whose recorder did not close it.
const NOT_CLOSED: &str = "the bag was never closed, as one that is named `.bag.active`: it was read up to where it was written, and what the recorder had \
     not written is lost; `rosbag reindex` makes a whole bag of it";

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
    let mut last = LastChunk::default();
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
        let (fields, operation) = (Header(&header), Header(&header).operation());
        if operation != Some(INDEX) {
            std::mem::take(&mut last).settle(topics);
        }
        match operation {
            Some(BAG) if fields.number("index_pos") == Some([0; 8]) => topics.tell(at, NOT_CLOSED),
            Some(INDEX) => last.index(&body),
            // Until it is closed a chunk says that it is empty, and all that follows is in it.
            Some(CHUNK) if body.is_empty() => {
                if !matches!(fields.get("compression"), Some(b"none")) {
                    read_up_to(&mut source, LONGEST_BYTES, &mut body)?;
                    open_chunk(&fields, &body, at, &mut plain, topics)?;
                    break;
                }
            }
            Some(CHUNK) => last = chunk(&fields, &body, at, true, &mut plain, topics)?,
            Some(_) => {
                record(&fields, &body, at, topics)?;
            }
            None => topics.tell(at, "a record does not say what it is; it was left out"),
        }
        at = at.saturating_add(8).saturating_add(header_bytes).saturating_add(body_bytes);
    }
    last.settle(topics);
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

/// Reads a record; tells whether it was a message.
fn record(header: &Header<'_>, body: &[u8], at: u64, topics: &mut Topics<'_>) -> Result<bool, Error> {
    topics.looks().worked(1)?;
    let connection = header.number("conn").map(u32::from_le_bytes);
    match (header.operation(), connection) {
        (Some(MESSAGE), Some(connection)) => {
            let Some(time) = header.number::<8>("time") else {
                topics.tell(at, "a message has no time; it was left out");
                return Ok(false);
            };
            let packed = u64::from_le_bytes(time);
            let (seconds, nanoseconds) = (packed & u64::from(u32::MAX), packed >> 32);
            let log_ns = i64::try_from(seconds * 1_000_000_000 + nanoseconds).unwrap_or(i64::MAX);
            topics.message(connection, log_ns, body)?;
            Ok(true)
        }
        (Some(CONNECTION), Some(connection)) => {
            let about = Header(body);
            let text = |bytes: Option<&[u8]>| String::from_utf8_lossy(bytes.unwrap_or_default()).into_owned();
            let (topic, type_name) = (text(header.get("topic")), text(about.get("type")));
            let definition = text(about.get("message_definition"));
            let (definition, encoding) = (Ok(Text::Msg(definition.into())), Encoding::Ros1);
            topics.connect(connection, &topic, &Schema { type_name: &type_name, definition, encoding })?;
            Ok(false)
        }
        _ => Ok(false),
    }
}

/// Reads a chunk; what is wrong with it is told once its index says what that cost.
fn chunk(
    header: &Header<'_>,
    body: &[u8],
    at: u64,
    whole: bool,
    plain: &mut Vec<u8>,
    topics: &mut Topics<'_>,
) -> Result<LastChunk, Error> {
    let failed = |fault: &str| LastChunk::new(at, 0, Some(fault.to_owned()));
    let (Some(compression), Some(size)) = (header.get("compression"), header.number("size")) else {
        return Ok(failed("a chunk does not say how it is compressed; it was left out"));
    };
    Ok(match decompress(compression, body, u64::from(u32::from_le_bytes(size)), plain, topics.looks())? {
        Err(reason) => failed(&format!("{reason}; the chunk was left out")),
        Ok(false) if whole => failed(UNPACKABLE),
        Ok(_) => LastChunk::new(at, records(plain, at, topics)?, None),
    })
}

/// Reads what is whole of the last chunk of a bag that was not closed.
fn open_chunk(
    header: &Header<'_>,
    body: &[u8],
    at: u64,
    plain: &mut Vec<u8>,
    topics: &mut Topics<'_>,
) -> Result<(), Error> {
    let compression = header.get("compression").unwrap_or_default();
    match decompress(compression, body, LONGEST_BYTES, plain, topics.looks())? {
        Err(reason) => topics.tell(at, &format!("{reason}; the chunk was left out")),
        Ok(_) => {
            records(plain, at, topics)?;
        }
    }
    Ok(())
}

/// Reads the records of a chunk; tells how many messages it had.
fn records(plain: &[u8], at: u64, topics: &mut Topics<'_>) -> Result<u64, Error> {
    let (mut cursor, mut messages) = (Cursor::packed(plain), 0);
    let mut next = || Ok::<_, Short>((cursor.counted()?, cursor.counted()?));
    while let Ok((header, body)) = next() {
        messages += u64::from(record(&Header(header), body, at, topics)?);
    }
    Ok(messages)
}
