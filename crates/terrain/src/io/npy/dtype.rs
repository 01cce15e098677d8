//! Element types of arrays.

use half::f16;

use super::NpyError;

/// A type of real numbers, with the order of its bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Dtype {
    number: Number,
    is_big_endian: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Number {
    F16,
    F32,
    F64,
    I8,
    I16,
    I32,
    I64,
    U8,
    U16,
    U32,
    U64,
}

/// Elements of an array and the order in which they stand.
#[derive(Clone, Copy)]
pub(super) struct Elements<'a> {
    pub(super) bytes: &'a [u8],
    /// Number of rows, where elements stand column by column.
    pub(super) fortran_rows: Option<usize>,
}

impl Dtype {
    /// A dtype by numpy's array protocol: byte order, kind and bytes, as `<f4`.
    ///
    /// # Errors
    /// A type of elements that are no elevations.
    pub(super) fn parse(text: &str) -> Result<Self, NpyError> {
        let (order, name) = text.split_at_checked(1).unwrap_or(("", text));
        let number = match name {
            "f2" => Number::F16,
            "f4" => Number::F32,
            "f8" => Number::F64,
            "i1" => Number::I8,
            "i2" => Number::I16,
            "i4" => Number::I32,
            "i8" => Number::I64,
            "u1" => Number::U8,
            "u2" => Number::U16,
            "u4" => Number::U32,
            "u8" => Number::U64,
            _ => return Err(refused(text, name)),
        };
        // `|` says that one byte has no order.
        match order {
            "<" | ">" => Ok(Dtype { number, is_big_endian: order == ">" }),
            "|" if number.bytes() == 1 => Ok(Dtype { number, is_big_endian: false }),
            _ => Err(refused(text, "")),
        }
    }

    /// The refusal of elements with fields.
    pub(super) fn structured() -> NpyError {
        let mend = "save one field of it, as z[\"elevation\"]";
        NpyError::Dtype { found: "structured (fields in each element)".into(), mend }
    }

    /// Bytes of an element.
    pub(super) fn bytes(self) -> usize {
        self.number.bytes()
    }

    /// Whether single precision holds every value exactly.
    pub(super) fn is_exact_in_single(self) -> bool {
        self.bytes() <= size_of::<u16>() || self.number == Number::F32
    }

    /// Elements row by row, of a type that single precision holds.
    pub(super) fn singles(self, elements: Elements<'_>) -> Vec<f32> {
        match self.number {
            Number::F16 => self.decoded(elements, |bytes| f16::from_le_bytes(bytes).to_f32()),
            Number::I8 => self.decoded(elements, |bytes| f32::from(i8::from_le_bytes(bytes))),
            Number::U8 => self.decoded(elements, |bytes| f32::from(u8::from_le_bytes(bytes))),
            Number::I16 => self.decoded(elements, |bytes| f32::from(i16::from_le_bytes(bytes))),
            Number::U16 => self.decoded(elements, |bytes| f32::from(u16::from_le_bytes(bytes))),
            Number::F32 => self.decoded(elements, f32::from_le_bytes),
            _ => self.doubles(elements).into_iter().map(|z| z as f32).collect(),
        }
    }

    /// Elements row by row. Whole numbers beyond 2⁵³, which are no elevations, are rounded.
    pub(super) fn doubles(self, elements: Elements<'_>) -> Vec<f64> {
        match self.number {
            Number::F64 => self.decoded(elements, f64::from_le_bytes),
            Number::I32 => self.decoded(elements, |bytes| f64::from(i32::from_le_bytes(bytes))),
            Number::U32 => self.decoded(elements, |bytes| f64::from(u32::from_le_bytes(bytes))),
            Number::I64 => self.decoded(elements, |bytes| i64::from_le_bytes(bytes) as f64),
            Number::U64 => self.decoded(elements, |bytes| u64::from_le_bytes(bytes) as f64),
            _ => self.singles(elements).into_iter().map(f64::from).collect(),
        }
    }

    /// Numbers out of elements of N bytes, of which a function gives the number by their little-endian bytes.
    fn decoded<const N: usize, T>(self, elements: Elements<'_>, number: impl Fn([u8; N]) -> T) -> Vec<T> {
        let (all, _) = elements.bytes.as_chunks::<N>();
        let number = |mut bytes: [u8; N]| {
            if self.is_big_endian {
                bytes.reverse();
            }
            number(bytes)
        };
        match elements.fortran_rows {
            None => all.iter().copied().map(number).collect(),
            Some(rows) => {
                let row = |row: usize| all.iter().copied().skip(row).step_by(rows);
                let mut numbers = Vec::with_capacity(all.len());
                (0..rows).for_each(|at| numbers.extend(row(at).map(&number)));
                numbers
            }
        }
    }
}

impl Number {
    fn bytes(self) -> usize {
        match self {
            Number::I8 | Number::U8 => 1,
            Number::F16 | Number::I16 | Number::U16 => 2,
            Number::F32 | Number::I32 | Number::U32 => 4,
            Number::F64 | Number::I64 | Number::U64 => 8,
        }
    }
}

/// The refusal of a dtype, in the words of its kind.
fn refused(text: &str, name: &str) -> NpyError {
    let shown: String = text.chars().take(40).collect();
    let (kind, mend) = match name.chars().next() {
        Some('O') => {
            ("Python objects, which are not unpickled", "save z.astype(\"float32\"), with allow_pickle=False")
        }
        Some('b') => ("true or false", "save elevations; obstacles go into a JSON grid or a map in bytes"),
        Some('c') => ("complex numbers", "save z.real"),
        Some('S' | 'U' | 'a') => ("text", "save z.astype(\"float32\")"),
        Some('M' | 'm') => ("times", "save elevations"),
        Some('V') => ("raw bytes", "save the field that holds elevations"),
        _ => ("no type that is read", "save z.astype(\"<f4\")"),
    };
    NpyError::Dtype { found: format!("`{shown}` ({kind})"), mend }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_real_number_is_refused_with_the_expression_that_mends() {
        for (dtype, said) in [
            ("|O", "not unpickled"),
            ("|b1", "true or false"),
            ("<c8", "save z.real"),
            (">c16", "complex"),
            ("<U7", "text"),
            ("|S3", "text"),
            ("<M8[s]", "times"),
            ("|V12", "raw bytes"),
            ("<f16", "z.astype"),
            ("<f3", "z.astype"),
            ("f8", "z.astype"),
            ("|f8", "z.astype"),
            ("=f8", "z.astype"),
            ("", "z.astype"),
            ("é", "z.astype"),
        ] {
            let message = Dtype::parse(dtype).unwrap_err().to_string();
            assert!(message.contains(said) && message.contains(&format!("`{dtype}`")), "{message}");
        }
    }

    #[test]
    fn columns_are_turned_into_rows() {
        let dtype = Dtype::parse("|u1").unwrap();
        let elements = Elements { bytes: &[1, 4, 2, 5, 3, 6], fortran_rows: Some(2) };
        assert_eq!(dtype.singles(elements), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
        assert_eq!(dtype.doubles(Elements { fortran_rows: None, ..elements })[..2], [1.0, 4.0]);
    }
}
