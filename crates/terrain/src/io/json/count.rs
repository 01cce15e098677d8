//! Numbers of a grid's frame: whole ones, as programs without integers write them too (`3.0`), and pairs.

use std::fmt;

use serde::{
    Deserializer,
    de::{Error, IgnoredAny, SeqAccess, Unexpected, Visitor},
};

/// Reads a whole number of zero or more, with or without decimal places.
///
/// # Errors
/// Any other value.
pub(super) fn whole_number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u64, D::Error> {
    deserializer.deserialize_u64(Whole)
}

struct Whole;

impl Visitor<'_> for Whole {
    type Value = u64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("u64")
    }

    fn visit_u64<E: Error>(self, value: u64) -> Result<u64, E> {
        Ok(value)
    }

    fn visit_i64<E: Error>(self, value: i64) -> Result<u64, E> {
        u64::try_from(value).map_err(|_| E::invalid_value(Unexpected::Signed(value), &self))
    }

    fn visit_f64<E: Error>(self, value: f64) -> Result<u64, E> {
        /// Above it not all whole numbers are doubles.
        const EXACT: f64 = (1u64 << f64::MANTISSA_DIGITS) as f64;
        let is_whole = value.fract() == 0.0 && (0.0..EXACT).contains(&value);
        if is_whole { Ok(value as u64) } else { Err(E::invalid_type(Unexpected::Float(value), &self)) }
    }
}

/// Reads two numbers, x and y.
///
/// # Errors
/// Any other value, by how many numbers there are.
pub(super) fn pair<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 2], D::Error> {
    deserializer.deserialize_seq(Pair)
}

struct Pair;

impl<'de> Visitor<'de> for Pair {
    type Value = [f64; 2];

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("two numbers, x and y")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut numbers: A) -> Result<[f64; 2], A::Error> {
        let x_m = numbers.next_element()?.ok_or_else(|| A::Error::invalid_length(0, &self))?;
        let y_m = numbers.next_element()?.ok_or_else(|| A::Error::invalid_length(1, &self))?;
        let mut length = 2;
        while numbers.next_element::<IgnoredAny>()?.is_some() {
            length += 1;
        }
        if length == 2 { Ok([x_m, y_m]) } else { Err(A::Error::invalid_length(length, &self)) }
    }
}
