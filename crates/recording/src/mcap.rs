//! ROS 2 MCAP files, by the format's specification (<https://mcap.dev/spec>).
//!
//! The records are framed here rather than by the `mcap` crate: its readers give up a chunk that is cut off, and subtract
//! lengths unchecked in chunks that are not compressed.

use std::{collections::BTreeMap, io::Read};

use crate::{
    Error, Map,
    compression::{LONGEST_BYTES, decompress},
    container::{BREAKS_OFF, ENDS_EARLY, UNPACKABLE, opened, topics},
    cursor::{Cursor, Short},
    mcap_summary::Summary,
    reading::{Reading, read_up_to},
    schema::{Described, Schema},
    topic::Topics,
    watch::Budget,
};

/// The first bytes of a file.
pub(crate) const MAGIC: &[u8] = b"\x89MCAP0\r\n";

/// The format's name in reports.
pub(crate) const FORMAT: &str = "MCAP";

/// Opcodes of the records that matter here.
pub(crate) const FOOTER: u8 = 0x02;
pub(crate) const SCHEMA: u8 = 0x03;
pub(crate) const CHANNEL: u8 = 0x04;
const MESSAGE: u8 = 0x05;
const CHUNK: u8 = 0x06;
pub(crate) const DATA_END: u8 = 0x0F;

/// A record's opcode and length.
pub(crate) const FRAME_BYTES: u64 = 9;

/// Name, encoding and text of a schema.
struct StoredSchema {
    name: String,
    encoding: String,
    text: Vec<u8>,
}

struct Reader<'t, 'm> {
    schemas: BTreeMap<u16, StoredSchema>,
    topics: &'t mut Topics<'m>,
    plain: Vec<u8>,
    /// What the summary says of schemas and channels, until a chunk is left out.
    summary: Summary,
}

/// Reads an MCAP file.
pub(crate) fn read(
    source: impl Read,
    summary: Summary,
    name: &str,
    map: Option<&Map>,
    budget: &Budget,
) -> Result<Reading, Error> {
    let mut topics = topics(map, budget)?;
    read_into(source, summary, &mut topics)?;
    topics.finish(name, FORMAT)
}

/// Reads an MCAP file, and those that were put behind it with `cat`.
pub(crate) fn read_into(source: impl Read, summary: Summary, topics: &mut Topics<'_>) -> Result<(), Error> {
    let mut source = opened(source, MAGIC, FORMAT, "it does not begin with the MCAP magic")?;
    let mut bytes = Vec::new();
    let mut at = MAGIC.len() as u64;
    // Only that of a single file was found, which is the first.
    let mut of_first = Some(summary);
    loop {
        let summary = of_first.take().unwrap_or_default();
        let mut reader = Reader { schemas: BTreeMap::new(), topics, plain: Vec::new(), summary };
        if !reader.file(&mut source, &mut bytes, &mut at)? || !behind_end(&mut source, &mut at)? {
            return Ok(());
        }
        if !read_up_to(&mut source, MAGIC.len() as u64, &mut bytes)? && bytes.is_empty() {
            return Ok(());
        }
        if bytes != MAGIC {
            let rest = bytes.len() as u64 + std::io::copy(&mut source, &mut std::io::sink())?;
            topics.tell(
                at,
                &format!("{rest} bytes follow the end of the file, and begin no other; they were left out"),
            );
            return Ok(());
        }
        at = at.saturating_add(MAGIC.len() as u64);
        topics.next_file();
    }
}

/// Steps over the index, which is not needed, up to behind the magic that ends a file. False: the file was cut off in there.
fn behind_end(source: &mut impl Read, at: &mut u64) -> Result<bool, Error> {
    let mut bytes = Vec::new();
    loop {
        let framed = read_up_to(source, FRAME_BYTES, &mut bytes)?;
        let Some((opcode, length)) =
            framed.then(|| frame_of(&mut Cursor::packed(&bytes))).and_then(Result::ok)
        else {
            return Ok(false);
        };
        let ends = opcode == FOOTER;
        let rest = length.saturating_add(if ends { MAGIC.len() as u64 } else { 0 });
        *at = at.saturating_add(FRAME_BYTES).saturating_add(rest);
        if std::io::copy(&mut source.by_ref().take(rest), &mut std::io::sink())? < rest {
            return Ok(false);
        }
        if ends {
            return Ok(true);
        }
    }
}

/// When the first message was written \[ns\], if its record or chunk comes whole.
pub(crate) fn first_ns(source: impl Read) -> Option<i64> {
    let mut source = opened(source, MAGIC, FORMAT, "").ok()?;
    let mut bytes = Vec::new();
    loop {
        let framed = read_up_to(&mut source, FRAME_BYTES, &mut bytes).ok()?;
        let (opcode, length) = framed.then(|| frame_of(&mut Cursor::packed(&bytes)))?.ok()?;
        // Of a chunk the time of its first message comes first, which is 0 where it has none.
        let skipped = match opcode {
            MESSAGE => 6,
            CHUNK => 0,
            DATA_END => return None,
            _ => length,
        };
        let mut body = source.by_ref().take(length);
        std::io::copy(&mut body.by_ref().take(skipped), &mut std::io::sink()).ok()?;
        if skipped < length && read_up_to(&mut body, 8, &mut bytes).ok()? {
            let first_ns = Cursor::packed(&bytes).u64().ok()?;
            if first_ns > 0 {
                return i64::try_from(first_ns).ok();
            }
        }
        std::io::copy(&mut body, &mut std::io::sink()).ok()?;
    }
}

/// What a chunk that is left out costs, by the times of its first and last message.
fn cost([first_ns, last_ns]: [u64; 2]) -> String {
    let [first_s, last_s] = [first_ns, last_ns].map(|ns| ns as f64 / 1e9);
    if last_s < first_s {
        return String::new();
    }
    format!(
        ", which cost all messages of {:.3} s, from {first_s:.3} s of the log's clock on",
        last_s - first_s
    )
}

pub(crate) fn frame_of(cursor: &mut Cursor<'_>) -> Result<(u8, u64), Short> {
    let [opcode] = cursor.number::<1>()?;
    Ok((opcode, cursor.u64()?))
}

impl Reader<'_, '_> {
    fn tell(&mut self, at: u64, what: &str) {
        self.topics.tell(at, what);
    }

    /// Reads the records of a file front to back up to the end of its data; an index is not needed, so one that was cut off
    /// is read as far as it goes. False: it was cut off.
    fn file(&mut self, source: &mut impl Read, bytes: &mut Vec<u8>, at: &mut u64) -> Result<bool, Error> {
        loop {
            let framed = read_up_to(source, FRAME_BYTES, bytes)?;
            let frame = framed.then(|| frame_of(&mut Cursor::packed(bytes))).and_then(Result::ok);
            let Some((opcode, length)) = frame else {
                self.tell(*at, ENDS_EARLY);
                return Ok(false);
            };
            let wanted = matches!(opcode, SCHEMA | CHANNEL | MESSAGE | CHUNK);
            let whole = if wanted && length <= LONGEST_BYTES {
                read_up_to(source, length, bytes)?
            } else {
                if wanted {
                    self.tell(*at, &format!("a record claims {length} bytes; it was stepped over"));
                }
                bytes.clear();
                std::io::copy(&mut source.by_ref().take(length), &mut std::io::sink())? == length
            };
            if wanted && !bytes.is_empty() {
                self.record(opcode, bytes, *at, whole)?;
            }
            if !whole {
                self.tell(*at, BREAKS_OFF);
                return Ok(false);
            }
            *at = at.saturating_add(FRAME_BYTES).saturating_add(length);
            if opcode == DATA_END {
                return Ok(true);
            }
        }
    }

    /// Reads a record. What a broken one says is told, not trusted.
    fn record(&mut self, opcode: u8, body: &[u8], at: u64, whole: bool) -> Result<(), Error> {
        self.topics.looks().worked(1)?;
        if opcode == CHUNK {
            return self.chunk(body, at, whole);
        }
        let read = match opcode {
            _ if !whole => return Ok(()),
            SCHEMA => self.schema(body),
            CHANNEL => return self.channel(body, at),
            MESSAGE => match self.message(body) {
                Ok(read) => return read,
                Err(short) => Err(short),
            },
            _ => return Ok(()),
        };
        if read.is_err() {
            self.tell(at, "a record is shorter than its kind; it was left out");
        }
        Ok(())
    }

    fn schema(&mut self, body: &[u8]) -> Result<(), Short> {
        let mut cursor = Cursor::packed(body);
        let id = cursor.u16()?;
        let [name, encoding] =
            [cursor.text()?, cursor.text()?].map(|t| String::from_utf8_lossy(t).into_owned());
        let text = cursor.counted()?.to_vec();
        self.schemas.entry(id).or_insert(StoredSchema { name, encoding, text });
        Ok(())
    }

    fn channel(&mut self, body: &[u8], at: u64) -> Result<(), Error> {
        let mut cursor = Cursor::packed(body);
        let mut parts = || Ok::<_, Short>((cursor.u16()?, cursor.u16()?, cursor.text()?, cursor.text()?));
        let Ok((id, schema_id, topic, encoding)) = parts() else {
            self.tell(at, "a channel record is too short; it was left out");
            return Ok(());
        };
        let (topic, encoding) = (String::from_utf8_lossy(topic), String::from_utf8_lossy(encoding));
        let schema = self.schemas.get(&schema_id);
        let described = Described {
            type_name: schema.map_or("", |schema| schema.name.as_str()),
            message_encoding: &encoding,
            schema_encoding: schema.map_or("", |schema| schema.encoding.as_str()),
            definition: schema.map_or(&[], |schema| schema.text.as_slice()),
        };
        self.topics.connect(u32::from(id), &topic, &Schema::of(&described))
    }

    fn message(&mut self, body: &[u8]) -> Result<Result<(), Error>, Short> {
        let mut cursor = Cursor::packed(body);
        let (channel, _sequence, log_ns, _publish_ns) =
            (cursor.u16()?, cursor.u32()?, cursor.u64()?, cursor.u64()?);
        let log_ns = i64::try_from(log_ns).unwrap_or(i64::MAX);
        Ok(self.topics.message(u32::from(channel), log_ns, cursor.rest()))
    }

    /// Reads the records of a chunk: all of them when its checksum holds, those before the break when it is the one that
    /// the file ends in, else none.
    fn chunk(&mut self, body: &[u8], at: u64, whole: bool) -> Result<(), Error> {
        let mut cursor = Cursor::packed(body);
        let mut header = || {
            let times_ns = [cursor.u64()?, cursor.u64()?];
            let (claimed_bytes, checksum) = (cursor.u64()?, cursor.number::<4>().map(u32::from_le_bytes)?);
            let compression = cursor.text()?;
            let packed_bytes = cursor.u64()?;
            Ok::<_, Short>((times_ns, claimed_bytes, checksum, compression, packed_bytes))
        };
        let Ok((times_ns, claimed_bytes, checksum, compression, packed_bytes)) = header() else {
            self.tell(at, "a chunk is shorter than its header; it was left out");
            return Ok(());
        };
        let packed_bytes = usize::try_from(packed_bytes).unwrap_or(usize::MAX);
        let packed = cursor.rest();
        let packed = packed.get(..packed_bytes).unwrap_or(packed);
        let mut plain = std::mem::take(&mut self.plain);
        let left_out = match decompress(compression, packed, claimed_bytes, &mut plain, self.topics.looks())?
        {
            Err(reason) => Some(format!("{reason}; the chunk was left out")),
            Ok(true) if checksum != 0 && crc32fast::hash(&plain) != checksum => {
                Some("a chunk fails its checksum; it was left out".to_owned())
            }
            Ok(false) if whole => Some(UNPACKABLE.to_owned()),
            Ok(_) => None,
        };
        match left_out {
            Some(why) => {
                self.tell(at, &format!("{why}{}", cost(times_ns)));
                self.recall_summary(at)?;
            }
            None => self.records(&plain, at)?,
        }
        self.plain = plain;
        Ok(())
    }

    /// Takes schemas and channels from the summary, since those of a chunk are lost.
    fn recall_summary(&mut self, at: u64) -> Result<(), Error> {
        for (opcode, body) in std::mem::take(&mut self.summary).records() {
            self.record(*opcode, body, at, true)?;
        }
        Ok(())
    }

    fn records(&mut self, plain: &[u8], at: u64) -> Result<(), Error> {
        let mut cursor = Cursor::packed(plain);
        while let Ok((opcode, length)) = frame_of(&mut cursor) {
            let Ok(body) = cursor.take(usize::try_from(length).unwrap_or(usize::MAX)) else { break };
            if opcode != CHUNK {
                self.record(opcode, body, at, true)?;
            }
        }
        Ok(())
    }
}
