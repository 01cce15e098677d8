//! The summary behind the data of an MCAP file, which repeats the schemas and channels of all chunks (<https://mcap.dev/spec#summary-section>).
//!
//! Recorders write a schema and a channel once, into the chunk that first needs them. Where that chunk is damaged, the summary says what
//! the messages of all others are.

use std::io::{Read, Seek, SeekFrom};

use crate::{cursor::Cursor, mcap, reading::read_up_to};

/// Longest summary that is read \[bytes\]: that of a day of one-second chunks and a hundred definitions.
const LONGEST_BYTES: u64 = 1 << 24;

/// A frame, two offsets and a checksum, and the magic behind them.
const FOOTER_BYTES: u64 = mcap::FRAME_BYTES + 20;
const CHECKSUM_BYTES: usize = 4;

/// A frame and a checksum: the record that ends the data.
const DATA_END_BYTES: u64 = mcap::FRAME_BYTES + 4;

/// Records of schemas and channels as (opcode, body); none where a file has no summary that holds together.
#[derive(Clone, Debug, Default)]
pub(crate) struct Summary(Vec<(u8, Vec<u8>)>);

impl Summary {
    /// The summary of a file, which is then at its beginning again.
    pub(crate) fn of(file: &mut (impl Read + Seek)) -> Summary {
        let found = read(file).unwrap_or_default();
        // What cannot be sought has not moved.
        let _ = file.seek(SeekFrom::Start(0));
        found
    }

    /// Its records.
    pub(crate) fn records(&self) -> &[(u8, Vec<u8>)] {
        &self.0
    }
}

fn read(file: &mut (impl Read + Seek)) -> Option<Summary> {
    let end = file.seek(SeekFrom::End(0)).ok()?;
    let footer_at = end.checked_sub(FOOTER_BYTES + mcap::MAGIC.len() as u64)?;
    let mut bytes = Vec::new();
    file.seek(SeekFrom::Start(footer_at)).ok()?;
    read_up_to(file, FOOTER_BYTES, &mut bytes).ok()?.then_some(())?;
    let mut cursor = Cursor::packed(&bytes);
    let (opcode, _) = mcap::frame_of(&mut cursor).ok()?;
    let start = cursor.u64().ok()?;
    let length = footer_at.checked_sub(start)?;
    if opcode != mcap::FOOTER || start < DATA_END_BYTES || length > LONGEST_BYTES {
        return None;
    }
    // Files that were put behind one another have offsets of their own, which lead elsewhere.
    file.seek(SeekFrom::Start(start - DATA_END_BYTES)).ok()?;
    let mut whole = Vec::new();
    read_up_to(file, DATA_END_BYTES + length + FOOTER_BYTES, &mut whole).ok()?.then_some(())?;
    let summary = whole.split_off(DATA_END_BYTES as usize);
    if whole.first() != Some(&mcap::DATA_END) {
        return None;
    }
    let (covered, checksum) = summary.split_at_checked(summary.len() - CHECKSUM_BYTES)?;
    let checksum = u32::from_le_bytes(checksum.try_into().ok()?);
    if checksum != 0 && crc32fast::hash(covered) != checksum {
        return None;
    }
    let mut cursor = Cursor::packed(&summary);
    let mut records = Vec::new();
    while let Ok((opcode, length)) = mcap::frame_of(&mut cursor) {
        let Ok(body) = cursor.take(usize::try_from(length).unwrap_or(usize::MAX)) else { break };
        if matches!(opcode, mcap::SCHEMA | mcap::CHANNEL) {
            records.push((opcode, body.to_vec()));
        }
    }
    // A channel may stand before its schema.
    records.sort_by_key(|record| record.0);
    Some(Summary(records))
}
