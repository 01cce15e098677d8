//! Reading numbers out of bytes, in the encodings that ROS messages and their containers come in.

/// The bytes end before what they should hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Short;

/// How the numbers of a message lie in its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Encoding {
    /// ROS 1: little-endian, packed.
    Ros1,
    /// ROS 2: OMG CDR, whose first four bytes say which order and alignment it has.
    Cdr,
}

/// How many bytes a character of a wide text has: no standard says so, and writers differ.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Wide {
    /// Four, as in Fast CDR 1 and Cyclone.
    Four,
    /// Two, as in Fast CDR 2.
    Two,
    /// The count is one of bytes, as in DDS-XTypes 1.3.
    Counted,
}

/// What the header of a message leaves open of how it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Dialect {
    pub(crate) wide: Wide,
    /// Whether collections of anything but numbers have their length before them, where the encoding is CDR's second version.
    pub(crate) collection_lengths: bool,
}

/// A place in bytes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    big_endian: bool,
    /// Numbers are aligned to their size up to so many bytes; 1 is packed.
    alignment: usize,
    /// Where alignment counts from.
    origin: usize,
    /// Bytes that end every text: CDR closes it with a zero that its length counts.
    pub(crate) text_terminator: usize,
    /// Whether it is CDR's second version.
    pub(crate) is_second: bool,
    /// Whether every struct has its length before it.
    struct_lengths: bool,
    pub(crate) dialect: Dialect,
}

impl<'a> Cursor<'a> {
    /// Packed little-endian bytes.
    pub(crate) fn packed(bytes: &'a [u8]) -> Self {
        Cursor {
            bytes,
            at: 0,
            big_endian: false,
            alignment: 1,
            origin: 0,
            text_terminator: 0,
            is_second: false,
            struct_lengths: false,
            dialect: Dialect { wide: Wide::Four, collection_lengths: true },
        }
    }

    /// The bytes of a message. The encapsulation of CDR is that of OMG DDSI-RTPS 2.5, section 10.5, and DDS-XTypes 1.3,
    /// table 60: classic CDR aligns to 8 bytes, its second version to 4.
    pub(crate) fn message(bytes: &'a [u8], encoding: Encoding) -> Result<Self, String> {
        if encoding == Encoding::Ros1 {
            return Ok(Cursor::packed(bytes));
        }
        const HEADER: usize = 4;
        let Some(&[kind_high, kind_low, ..]) = bytes.first_chunk::<HEADER>() else {
            return Err(format!("{} bytes are too few for the header of CDR", bytes.len()));
        };
        // The numbers of the second version were 0x10 to 0x15 before DDS-XTypes 1.3.
        let (is_second, struct_lengths) = match (kind_high, kind_low) {
            (0, 0 | 1) => (false, false),
            (0, 0x06 | 0x07 | 0x10 | 0x11) => (true, false),
            (0, 0x08 | 0x09 | 0x14 | 0x15) => (true, true),
            _ => {
                return Err(format!(
                    "CDR encapsulation 0x{kind_high:02x}{kind_low:02x} is none of plain CDR"
                ));
            }
        };
        Ok(Cursor {
            at: HEADER,
            big_endian: kind_low & 1 == 0,
            alignment: if is_second { 4 } else { 8 },
            origin: HEADER,
            text_terminator: 1,
            is_second,
            struct_lengths,
            ..Cursor::packed(bytes)
        })
    }

    /// Moves over the length that stands before a collection of anything but numbers.
    pub(crate) fn collection_length(&mut self) -> Result<(), Short> {
        if self.is_second && self.dialect.collection_lengths { self.u32().map(|_| ()) } else { Ok(()) }
    }

    /// Moves over the length that stands before a struct.
    pub(crate) fn struct_length(&mut self) -> Result<(), Short> {
        if self.struct_lengths { self.u32().map(|_| ()) } else { Ok(()) }
    }

    /// Moves over a wide text; returns whether it holds anything.
    pub(crate) fn wide_text(&mut self) -> Result<bool, Short> {
        let count = self.u32()? as usize;
        let character_bytes = match self.dialect.wide {
            Wide::Four => 4,
            Wide::Two => 2,
            Wide::Counted => 1,
        };
        self.skip(count.checked_mul(character_bytes).ok_or(Short)?)?;
        Ok(count > 0)
    }

    /// Bytes left.
    pub(crate) fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    /// Moves to where a number of that size may begin.
    pub(crate) fn align(&mut self, size: usize) -> Result<(), Short> {
        let step = size.min(self.alignment).max(1);
        let past = (self.at - self.origin) % step;
        if past == 0 { Ok(()) } else { self.skip(step - past) }
    }

    /// Moves on.
    pub(crate) fn skip(&mut self, bytes: usize) -> Result<(), Short> {
        self.take(bytes).map(|_| ())
    }

    /// The next bytes.
    pub(crate) fn take(&mut self, bytes: usize) -> Result<&'a [u8], Short> {
        let end = self.at.checked_add(bytes).ok_or(Short)?;
        let taken = self.bytes.get(self.at..end).ok_or(Short)?;
        self.at = end;
        Ok(taken)
    }

    /// What is left.
    pub(crate) fn rest(&self) -> &'a [u8] {
        self.bytes.get(self.at..).unwrap_or_default()
    }

    /// The next bytes as they lie in memory, aligned, turned to little-endian.
    pub(crate) fn number<const N: usize>(&mut self) -> Result<[u8; N], Short> {
        self.align(N)?;
        let mut bytes = *self.take(N)?.first_chunk::<N>().ok_or(Short)?;
        if self.big_endian {
            bytes.reverse();
        }
        Ok(bytes)
    }

    pub(crate) fn u16(&mut self) -> Result<u16, Short> {
        self.number().map(u16::from_le_bytes)
    }

    pub(crate) fn u32(&mut self) -> Result<u32, Short> {
        self.number().map(u32::from_le_bytes)
    }

    pub(crate) fn u64(&mut self) -> Result<u64, Short> {
        self.number().map(u64::from_le_bytes)
    }

    /// Bytes behind a count of them.
    pub(crate) fn counted(&mut self) -> Result<&'a [u8], Short> {
        let count = self.u32()? as usize;
        self.take(count)
    }

    /// A text, as bytes.
    pub(crate) fn text(&mut self) -> Result<&'a [u8], Short> {
        let bytes = self.counted()?;
        Ok(bytes.get(..bytes.len().saturating_sub(self.text_terminator)).unwrap_or_default())
    }
}
