//! The header of an array: its version, and a dictionary of dtype, order and shape (NEP 1; numpy's `lib/format.py`).

use super::{Dtype, NpyError, literal::Literal};
use crate::io::named_by_magic;

const MAGIC: &[u8] = b"\x93NUMPY";
/// Offset of the header's length, behind magic and version.
const LENGTH_AT: usize = MAGIC.len() + 2;

/// What an array's header says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) dtype: Dtype,
    /// Whether elements stand column by column.
    pub(super) is_fortran_order: bool,
    pub(super) rows: u64,
    pub(super) columns: u64,
    /// Offset of the first element.
    pub(super) elements_at: usize,
}

/// Whether bytes begin as an array does, whatever its version.
pub fn is_npy(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

impl Header {
    /// Reads the header of versions 1.0 to 3.0.
    ///
    /// # Errors
    /// Another file, a damaged header, or an array that is no table of numbers.
    pub(super) fn read(bytes: &[u8]) -> Result<Self, NpyError> {
        if !is_npy(bytes) {
            return Err(NpyError::Magic { found: named_by_magic(bytes) });
        }
        let truncated =
            |expected: usize| NpyError::Truncated { expected: expected as u64, found: bytes.len() };
        let version = bytes.get(MAGIC.len()..LENGTH_AT).ok_or_else(|| truncated(LENGTH_AT))?;
        let length_bytes = match *version {
            [1, 0] => size_of::<u16>(),
            [2 | 3, 0] => size_of::<u32>(),
            [major, minor] => return Err(NpyError::Version { major, minor }),
            _ => return Err(truncated(LENGTH_AT)),
        };
        let text_at = LENGTH_AT + length_bytes;
        let length = bytes.get(LENGTH_AT..text_at).ok_or_else(|| truncated(text_at))?;
        let length = length.iter().rev().fold(0, |sum, byte| sum << u8::BITS | usize::from(*byte));
        let elements_at = text_at.saturating_add(length);
        let text = bytes.get(text_at..elements_at).ok_or_else(|| truncated(elements_at))?;
        let mut literal = Literal::new(text, elements_at);
        let (dtype, is_fortran_order, [rows, columns]) = dictionary(&mut literal)?;
        Ok(Header { dtype, is_fortran_order, rows, columns, elements_at })
    }

    /// Number of elements.
    pub(super) fn elements(&self) -> u64 {
        self.rows.saturating_mul(self.columns)
    }

    /// The elements' bytes.
    ///
    /// # Errors
    /// Fewer or more of them than the header says.
    pub(super) fn elements_of<'a>(&self, bytes: &'a [u8]) -> Result<&'a [u8], NpyError> {
        let expected = self.elements().saturating_mul(self.dtype.bytes() as u64);
        let elements = bytes.get(self.elements_at..).unwrap_or_default();
        let found = elements.len() as u64;
        if found < expected {
            let expected = expected.saturating_add(self.elements_at as u64);
            return Err(NpyError::Truncated { expected, found: bytes.len() });
        }
        match found - expected {
            0 => Ok(elements),
            more => Err(NpyError::Trailing { bytes: more as usize }),
        }
    }
}

/// The dictionary of a header, whose keys come in any order.
fn dictionary(literal: &mut Literal<'_>) -> Result<(Dtype, bool, [u64; 2]), NpyError> {
    let (mut dtype, mut is_fortran_order, mut shape) = (None, None, None);
    literal.pass(b'{', "a dictionary")?;
    while !literal.passes(b'}') {
        let unknown = literal.missing("one of the keys `descr`, `fortran_order` and `shape`");
        let key = literal.text("a key in quotes")?;
        literal.pass(b':', "a colon")?;
        match key {
            "descr" => dtype = Some(described(literal)?),
            "fortran_order" => is_fortran_order = Some(literal.truth()?),
            "shape" => shape = Some(table(literal)?),
            _ => return Err(unknown),
        }
        if !literal.passes(b',') && literal.peek() != Some(b'}') {
            return Err(literal.missing("a comma or closing brace"));
        }
    }
    if !literal.is_at_end() {
        return Err(literal.missing("the end of the header"));
    }
    Ok((
        dtype.ok_or_else(|| literal.missing("the key `descr`"))?,
        is_fortran_order.ok_or_else(|| literal.missing("the key `fortran_order`"))?,
        shape.ok_or_else(|| literal.missing("the key `shape`"))?,
    ))
}

/// The dtype of all elements; a list or tuple is that of elements with fields.
fn described(literal: &mut Literal<'_>) -> Result<Dtype, NpyError> {
    match literal.peek() {
        Some(b'[' | b'(' | b'{') => Err(Dtype::structured()),
        _ => Dtype::parse(literal.text("the dtype in quotes")?),
    }
}

/// The shape of an array of two axes.
fn table(literal: &mut Literal<'_>) -> Result<[u64; 2], NpyError> {
    let (mut shape, mut axes) = ([0; 2], 0);
    literal.pass(b'(', "the shape as a tuple")?;
    while !literal.passes(b')') {
        let length = literal.count()?;
        if let Some(known) = shape.get_mut(axes) {
            *known = length;
        }
        axes += 1;
        if !literal.passes(b',') && literal.peek() != Some(b')') {
            return Err(literal.missing("a comma or closing bracket"));
        }
    }
    if axes == shape.len() { Ok(shape) } else { Err(NpyError::Axes { axes }) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(version: u8, text: &str) -> Vec<u8> {
        let length = text.len().to_le_bytes();
        let length = if version == 1 { &length[..2] } else { &length[..4] };
        [MAGIC, &[version, 0], length, text.as_bytes()].concat()
    }

    fn read(text: &str) -> Result<Header, NpyError> {
        Header::read(&header(1, text))
    }

    #[test]
    fn all_versions_and_spellings_of_a_header_are_read() {
        let texts = [
            "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 40), }          \n",
            "{'descr': '<f4', 'fortran_order': False, 'shape': (3L, 40L), }\n",
            "{\"shape\":(3,40),\"fortran_order\":False,\"descr\":\"<f4\"}",
            " { 'shape' : ( 3 , 40 , ) , 'descr' : '<f4' ,\n'fortran_order' : False }\t",
        ];
        for (version, text) in [1, 2, 3].into_iter().flat_map(|v| texts.map(|text| (v, text))) {
            let bytes = header(version, text);
            let read = Header::read(&bytes).unwrap();
            assert_eq!((read.rows, read.columns, read.is_fortran_order), (3, 40, false), "{text}");
            assert_eq!(read.elements_at, bytes.len(), "version {version}");
        }
    }

    #[test]
    fn a_bad_header_is_refused_by_its_byte() {
        let good = "{'descr': '<f4', 'fortran_order': False, 'shape': (3, 40), }";
        for (bad, said) in [
            ("".to_owned(), "at byte 10, a dictionary"),
            (good.replace("(3, 40)", "3"), "at byte 60, the shape as a tuple"),
            (good.replace("(3, 40)", "(-3, 40)"), "at byte 61, a whole number"),
            (good.replace("40", "18446744073709551616"), "a whole number"),
            (good.replace("False", "0"), "`True` or `False`"),
            (good.replace("'shape'", "'form'"), "at byte 51, one of the keys"),
            (good.replace("'shape': (3, 40), ", ""), "the key `shape`"),
            (good.replace("'<f4', ", "'<f4' "), "a comma or closing brace"),
            (good.replace("'<f4'", "'<f4"), "no type that is read"),
            (good.replace("'<f4'", "'\\x3cf4'"), "the dtype in quotes"),
            (good.replace('}', ""), "a key in quotes"),
            (good.to_owned() + "{}", "the end of the header"),
            (good.replace("3, 40", "3"), "has 1 axis"),
            (good.replace("3, 40", ""), "has 0 axes"),
            (good.replace("3, 40", "1, 3, 40"), "has 3 axes"),
        ] {
            let message = read(&bad).unwrap_err().to_string();
            assert!(message.contains(said), "{bad}\n  said: {message}");
        }
    }

    #[test]
    fn a_header_longer_than_the_file_or_of_brackets_alone_is_refused() {
        let mut long = header(2, "");
        long[8..12].copy_from_slice(&u32::MAX.to_le_bytes());
        assert!(matches!(Header::read(&long), Err(NpyError::Truncated { found: 12, .. })));
        let brackets = "(".repeat(60_000);
        assert!(read(&brackets).is_err());
        assert!(read(&format!("{{'shape': {brackets}")).is_err());
    }

    #[test]
    fn another_file_is_named_and_another_version_refused() {
        let said = |bytes: &[u8]| Header::read(bytes).unwrap_err().to_string();
        assert!(said(b"PK\x03\x04").contains("it is a ZIP file"));
        assert!(said(b"").contains("numpy.save"));
        assert!(said(b"\x93NUMPY\x04\x00").contains("version 4.0"));
        assert!(said(b"\x93NUMPY\x01\x01").contains("version 1.1"));
    }
}
