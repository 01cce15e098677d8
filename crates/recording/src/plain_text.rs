//! The bytes of a text file as UTF-8: unpacked by their content, and decoded where they are UTF-16.

use std::{
    cell::Cell,
    io::{BufReader, Chain, Cursor, Read, Result as IoResult},
    rc::Rc,
};

use flate2::read::MultiGzDecoder;
use zstd::stream::read::Decoder as ZstdDecoder;

use crate::{Error, cut_off::WholeLines};

/// Bytes that are looked at before anything is read: a header of any file.
pub(crate) const BEGINNING_BYTES: usize = 1 << 20;

/// Bytes decoded at a time.
const BLOCK_BYTES: usize = 1 << 16;

/// Beginnings of files that are no text, and what they are.
const OTHER_FORMATS: [(&[u8], &str); 9] = [
    (b"PAR1", "a Parquet file: name it .parquet"),
    (b"\x89MCAP", "an MCAP file: name it .mcap"),
    (b"#ROSBAG", "a ROS 1 bag: name it .bag"),
    (b"PK\x03\x04", "a ZIP archive or an Excel workbook: unpack it, or save the sheet as CSV"),
    (b"\xd0\xcf\x11\xe0", "an Excel workbook: save the sheet as CSV"),
    (b"\x89HDF", "an HDF5 file: write its table as CSV or Parquet"),
    (b"SQLite format 3", "a database, as of ROS 2: convert it to MCAP"),
    (b"ULog", "a PX4 log: convert it to CSV"),
    (b"BZh", "packed with bzip2: unpack it, or pack it with gzip or zstd"),
];

/// A text file of which the beginning is known.
pub(crate) struct PlainText {
    /// Its first bytes, [`BEGINNING_BYTES`] at most.
    pub(crate) beginning: Vec<u8>,
    rest: Box<dyn Read>,
    /// Whether what it is packed in was found to break off.
    pub(crate) is_cut_off: Rc<Cell<bool>>,
}

impl PlainText {
    /// Opens a text file, whatever it is packed and encoded with.
    pub(crate) fn open<R: Read + 'static>(source: R) -> Result<PlainText, Error> {
        let text = PlainText::begin(Box::new(source))?;
        let is_cut_off = Rc::clone(&text.is_cut_off);
        let unpacked: Box<dyn Read> = if text.beginning.starts_with(&[0x1f, 0x8b]) {
            Box::new(WholeLines::new(MultiGzDecoder::new(text.whole()), Rc::clone(&is_cut_off)))
        } else if text.beginning.starts_with(&[0x28, 0xb5, 0x2f, 0xfd]) {
            Box::new(WholeLines::new(ZstdDecoder::new(text.whole())?, Rc::clone(&is_cut_off)))
        } else {
            return text.decode();
        };
        let text = PlainText { is_cut_off, ..PlainText::begin(unpacked).map_err(unpacking)? };
        if text.beginning.is_empty() && text.is_cut_off.get() {
            let reason = "it breaks off before its first line ends; pack it again".into();
            return Err(Error::NotTheFormat { format: "packed CSV", reason });
        }
        text.decode()
    }

    /// All of its bytes.
    pub(crate) fn whole(self) -> Chain<Cursor<Vec<u8>>, Box<dyn Read>> {
        Cursor::new(self.beginning).chain(self.rest)
    }

    fn begin(mut source: Box<dyn Read>) -> Result<PlainText, Error> {
        let mut beginning = Vec::new();
        source.by_ref().take(BEGINNING_BYTES as u64).read_to_end(&mut beginning)?;
        Ok(PlainText { beginning, rest: source, is_cut_off: Rc::default() })
    }

    fn decode(mut self) -> Result<PlainText, Error> {
        if let Some((_, what)) = OTHER_FORMATS.iter().find(|(magic, _)| self.beginning.starts_with(magic)) {
            return Err(Error::NotTheFormat { format: "CSV", reason: format!("it is {what}") });
        }
        let Some(order) = Order::of(&self.beginning) else {
            if self.beginning.starts_with(b"\xef\xbb\xbf") {
                self.beginning.drain(..3);
            }
            if first_line(&self.beginning).contains(&0) {
                let reason = "its first line is not text but binary data".into();
                return Err(Error::NotTheFormat { format: "CSV", reason });
            }
            return Ok(self);
        };
        let is_cut_off = Rc::clone(&self.is_cut_off);
        let source = BufReader::with_capacity(BLOCK_BYTES, self.whole());
        let decoded = Utf16 { source, order, held: Vec::new(), ready: Cursor::default() };
        Ok(PlainText { is_cut_off, ..PlainText::begin(Box::new(decoded))? })
    }
}

/// The bytes before the first line break.
pub(crate) fn first_line(text: &[u8]) -> &[u8] {
    text.split(|byte| *byte == b'\n').next().unwrap_or_default()
}

fn unpacking(error: Error) -> Error {
    match error {
        Error::Io(error) => {
            let reason = format!("it cannot be unpacked ({error}); pack it again");
            Error::NotTheFormat { format: "packed CSV", reason }
        }
        other => other,
    }
}

/// Order of the two bytes of a UTF-16 unit.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Order {
    Little,
    Big,
}

impl Order {
    /// The order that a beginning shows, by its mark or, without one, by the zeros of two ASCII letters.
    fn of(beginning: &[u8]) -> Option<Order> {
        match beginning {
            [0xff, 0xfe, ..] => Some(Order::Little),
            [0xfe, 0xff, ..] => Some(Order::Big),
            [1..=0x7f, 0, 1..=0x7f, 0, ..] => Some(Order::Little),
            [0, 1..=0x7f, 0, 1..=0x7f, ..] => Some(Order::Big),
            _ => None,
        }
    }

    fn unit(self, bytes: [u8; 2]) -> u16 {
        match self {
            Order::Little => u16::from_le_bytes(bytes),
            Order::Big => u16::from_be_bytes(bytes),
        }
    }
}

/// UTF-16 read as UTF-8; what is no character becomes U+FFFD.
struct Utf16<R> {
    source: R,
    order: Order,
    /// Bytes read that do not make a whole character yet.
    held: Vec<u8>,
    ready: Cursor<Vec<u8>>,
}

impl<R: Read> Read for Utf16<R> {
    fn read(&mut self, buffer: &mut [u8]) -> IoResult<usize> {
        loop {
            let bytes = self.ready.read(buffer)?;
            if bytes > 0 || buffer.is_empty() {
                return Ok(bytes);
            }
            let more = self.source.by_ref().take(BLOCK_BYTES as u64).read_to_end(&mut self.held)?;
            if more == 0 {
                return Ok(0);
            }
            self.decode();
        }
    }
}

impl<R> Utf16<R> {
    fn decode(&mut self) {
        let order = self.order;
        let pairs = self.held.chunks_exact(2).map(|pair| order.unit([pair[0], pair[1]]));
        let mut units: Vec<u16> = pairs.collect();
        // The first half of a character waits for the other.
        if units.last().is_some_and(|unit| (0xd800..0xdc00).contains(unit)) {
            units.pop();
        }
        let rest = self.held.split_off(2 * units.len());
        self.held = rest;
        let characters = char::decode_utf16(units).map(|unit| unit.unwrap_or(char::REPLACEMENT_CHARACTER));
        let text: String = characters.filter(|character| *character != '\u{feff}').collect();
        self.ready = Cursor::new(text.into_bytes());
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    const TEXT: &str = "t_s,ö,𝄞\n0.1,2,3\n";

    fn read(bytes: Vec<u8>) -> Result<String, Error> {
        let mut text = String::new();
        PlainText::open(Cursor::new(bytes))?.whole().read_to_string(&mut text)?;
        Ok(text)
    }

    fn utf16(text: &str, bytes: fn(u16) -> [u8; 2]) -> Vec<u8> {
        text.encode_utf16().flat_map(bytes).collect()
    }

    fn gzip(bytes: &[u8]) -> Vec<u8> {
        let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        encoder.write_all(bytes).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn whatever_a_text_is_packed_and_encoded_with_it_is_the_same() {
        let marked = format!("\u{feff}{TEXT}");
        for bytes in [
            TEXT.as_bytes().to_vec(),
            marked.as_bytes().to_vec(),
            utf16(&marked, u16::to_le_bytes),
            utf16(&marked, u16::to_be_bytes),
            utf16(TEXT, u16::to_le_bytes),
            utf16(TEXT, u16::to_be_bytes),
            gzip(TEXT.as_bytes()),
            [gzip(&TEXT.as_bytes()[..9]), gzip(&TEXT.as_bytes()[9..])].concat(),
            gzip(&utf16(&marked, u16::to_le_bytes)),
            zstd::encode_all(marked.as_bytes(), 1).unwrap(),
        ] {
            assert_eq!(read(bytes).unwrap(), TEXT);
        }
    }

    #[test]
    fn characters_are_whole_across_blocks() {
        let long: String = "x𝄞".repeat(BLOCK_BYTES);
        assert_eq!(read(utf16(&format!("\u{feff}{long}"), u16::to_le_bytes)).unwrap(), long);
    }

    #[test]
    fn files_of_other_formats_and_broken_packages_are_named() {
        for (bytes, said) in [
            (b"PAR1xxxx".to_vec(), "Parquet"),
            (b"PK\x03\x04xx".to_vec(), "Excel"),
            (b"a\x00\x01\x02\n".to_vec(), "binary data"),
            (gzip(TEXT.as_bytes())[..14].to_vec(), "pack it again"),
        ] {
            let message = read(bytes).unwrap_err().to_string();
            assert!(message.contains(said), "{said}: {message}");
        }
    }
}
