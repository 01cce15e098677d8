//! Units of durations in a Parquet file that Arrow wrote.
//!
//! Parquet has no type for durations: pandas' `timedelta64` and polars' `Duration` are stored as bare integers, and only the Arrow
//! schema in the file's metadata says in which unit. It is a FlatBuffer in Base64 (<https://arrow.apache.org/docs/format/Columnar.html>,
//! `Message.fbs` and `Schema.fbs`). One number of it is wanted, for which the Arrow crates would bring in their arrays and readers, and
//! generated FlatBuffers code is unsafe; so the few tables on the way are walked here, every offset checked.

use std::collections::HashMap;

use base64::{Engine, engine::general_purpose::STANDARD};

/// Key of the schema in the file's metadata.
pub(crate) const KEY: &str = "ARROW:schema";

/// Longest schema that is decoded \[bytes of Base64\]: that of 100 000 columns.
const LONGEST_BYTES: usize = 16 << 20;

/// Marks the beginning of a message since Arrow 0.15; older ones begin with their length.
const CONTINUATION: u32 = u32::MAX;

/// Places of fields in their tables, by `Message.fbs` and `Schema.fbs`.
const MESSAGE_HEADER: usize = 2;
const SCHEMA_FIELDS: usize = 1;
const FIELD_NAME: usize = 0;
const FIELD_TYPE_KIND: usize = 2;
const FIELD_TYPE: usize = 3;
const DURATION_UNIT: usize = 0;

/// The number of `Duration` in the union `Type`.
const DURATION: u8 = 18;

/// Symbols of the enumeration `TimeUnit`.
const TIME_UNITS: [&str; 4] = ["s", "ms", "us", "ns"];

/// `TimeUnit` of a duration that does not say: milliseconds.
const DEFAULT_UNIT: u16 = 1;

/// The top-level duration columns of an encoded schema, with the symbols of their units. What cannot be read has none.
pub(crate) fn durations(encoded: &str) -> HashMap<String, &'static str> {
    if encoded.len() > LONGEST_BYTES {
        return HashMap::new();
    }
    let bytes = STANDARD.decode(encoded.trim_end_matches('\0')).unwrap_or_default();
    Buffer(&bytes).durations().unwrap_or_default()
}

/// A FlatBuffer; offsets that lead out of it have no value.
#[derive(Clone, Copy)]
struct Buffer<'b>(&'b [u8]);

/// Place of a table in its buffer.
#[derive(Clone, Copy)]
struct Table(usize);

impl<'b> Buffer<'b> {
    fn durations(self) -> Option<HashMap<String, &'static str>> {
        let start = if self.u32(0)? == CONTINUATION { 8 } else { 4 };
        let message = Table(self.follow(start)?);
        let schema = self.table(message, MESSAGE_HEADER)?;
        let fields = self.follow(self.field(schema, SCHEMA_FIELDS)?)?;
        let count = self.u32(fields)? as usize;
        let mut found = HashMap::new();
        // Columns have names of their own, so that all names fit into the buffer, unless many entries lead to one field.
        let mut bytes_left = self.0.len();
        // A count that lies ends where the buffer does.
        for index in 0..count {
            let field = Table(self.follow(fields.checked_add(4 * (index + 1))?)?);
            if let Some((name, unit)) = self.duration(field) {
                bytes_left = bytes_left.checked_sub(name.len().max(1))?;
                if let Ok(name) = std::str::from_utf8(name) {
                    found.entry(name.to_owned()).or_insert(unit);
                }
            }
        }
        Some(found)
    }

    /// Name and unit of a field, if it is a duration.
    fn duration(self, field: Table) -> Option<(&'b [u8], &'static str)> {
        let kind = *self.0.get(self.field(field, FIELD_TYPE_KIND)?)?;
        if kind != DURATION {
            return None;
        }
        let unit = match self.field(self.table(field, FIELD_TYPE)?, DURATION_UNIT) {
            Some(at) => self.u16(at)?,
            None => DEFAULT_UNIT,
        };
        let name = self.text(self.follow(self.field(field, FIELD_NAME)?)?)?;
        Some((name, TIME_UNITS.get(usize::from(unit))?))
    }

    fn u16(self, at: usize) -> Option<u16> {
        let bytes = self.0.get(at..at.checked_add(2)?)?;
        Some(u16::from_le_bytes(bytes.try_into().ok()?))
    }

    fn u32(self, at: usize) -> Option<u32> {
        let bytes = self.0.get(at..at.checked_add(4)?)?;
        Some(u32::from_le_bytes(bytes.try_into().ok()?))
    }

    /// Where the offset that stands at a place leads.
    fn follow(self, at: usize) -> Option<usize> {
        at.checked_add(self.u32(at)? as usize)
    }

    /// Where a field of a table stands; `None` where the table leaves it out.
    fn field(self, table: Table, number: usize) -> Option<usize> {
        // A table begins with the signed distance back to its list of fields.
        let back = i64::from(self.u32(table.0)? as i32);
        let list = usize::try_from(i64::try_from(table.0).ok()?.checked_sub(back)?).ok()?;
        let entry = 4 + 2 * number;
        if entry + 2 > usize::from(self.u16(list)?) {
            return None;
        }
        match self.u16(list.checked_add(entry)?)? {
            0 => None,
            offset => table.0.checked_add(usize::from(offset)),
        }
    }

    fn table(self, table: Table, number: usize) -> Option<Table> {
        self.follow(self.field(table, number)?).map(Table)
    }

    fn text(self, at: usize) -> Option<&'b [u8]> {
        let start = at.checked_add(4)?;
        self.0.get(start..start.checked_add(self.u32(at)? as usize)?)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The schema that pyarrow 26 writes for the columns s, ms, us, ns and x: durations in those units, and a double.
    const WRITTEN: &str = include_str!("../tests/files/durations.schema");

    #[test]
    fn units_are_those_that_arrow_wrote() {
        let expected = ["s", "ms", "us", "ns"].map(|unit| (unit.to_owned(), unit));
        assert_eq!(durations(WRITTEN.trim()), HashMap::from(expected));
        assert!(durations("").is_empty());
        assert!(durations("no Base64").is_empty());
    }

    /// A schema of which so many entries lead to one and the same field, a duration in milliseconds with a name of so many bytes.
    fn repeated(entries: usize, name_bytes: usize) -> String {
        let mut bytes = Vec::new();
        let mut u32s = |numbers: &[u32]| numbers.iter().for_each(|n| bytes.extend(n.to_le_bytes()));
        // Pairs of 16 bits, the first in the low half: length of a list of fields and its table, then where each field stands.
        let pair = |low: u32, high: u32| low | high << 16;
        // From the root to the message at 24, its header at 40, and the vector of fields at 48.
        u32s(&[CONTINUATION, 0, 16, pair(10, 8), 0, 4]);
        u32s(&[12, 12, pair(8, 8), pair(0, 4), 8, 4]);
        u32s(&[entries as u32]);
        // The field begins 12 bytes behind the vector.
        (0..entries).for_each(|entry| u32s(&[(4 * (entries - entry) + 12) as u32]));
        u32s(&[pair(12, 16), pair(4, 0), pair(8, 12), 12, 20, u32::from(DURATION), 8]);
        u32s(&[pair(4, 4), 4, name_bytes as u32]);
        bytes.extend(std::iter::repeat_n(b'a', name_bytes));
        STANDARD.encode(bytes)
    }

    #[test]
    fn entries_that_share_a_field_take_no_more_memory_than_the_schema() {
        assert_eq!(durations(&repeated(1, 5)), HashMap::from([("aaaaa".to_owned(), "ms")]));
        assert_eq!(durations(&repeated(1000, 100_000)), HashMap::new(), "100 MB of names in 0.1 MB");
        assert_eq!(durations(&repeated(3_000, 0)).len(), 1);
    }

    proptest! {
        #[test]
        fn a_damaged_schema_never_panics(
            flips in proptest::collection::vec((0.0..1.0f64, any::<u8>()), 1..8), length in 0.0..1.0f64
        ) {
            let mut bytes = STANDARD.decode(WRITTEN.trim()).unwrap();
            for (place, byte) in flips {
                let at = (bytes.len() as f64 * place) as usize;
                bytes[at] = byte;
            }
            durations(&STANDARD.encode(&bytes));
            bytes.truncate((bytes.len() as f64 * length) as usize);
            durations(&STANDARD.encode(bytes));
        }
    }
}
