//! Numbers of an ESRI ASCII grid: with decimal points or commas, and words for unknown ground.

use super::AsciiError;

/// How the numbers of a file are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Notation {
    Points,
    /// Decimal commas, as some locales have them.
    Commas,
}

/// Words for cells without a value: of C and Python, of C on Windows, of SQL and Python, of GRASS.
const UNKNOWN: [&str; 10] =
    ["nan", "-nan", "nan(ind)", "-nan(ind)", "1.#qnan", "-1.#ind", "null", "none", "nodata", "*"];

impl Notation {
    /// The notation of a file. A comma is a decimal comma where no number has a point, no word has two commas, and some comma
    /// is followed by another count of digits than the three of separated thousands.
    pub(super) fn of(text: &str) -> Result<Self, AsciiError> {
        if !text.contains(',') {
            return Ok(Notation::Points);
        }
        let mut first = None;
        let (mut has_decimals, mut has_points) = (false, false);
        for (index, line) in text.lines().enumerate() {
            for word in line.split_ascii_whitespace() {
                has_points |= word.contains('.') && !is_unknown(word);
                let Some((_, digits)) = word.split_once(',') else { continue };
                let found = || AsciiError::Comma { line: index + 1, found: super::excerpt(word) };
                if digits.contains(',') {
                    return Err(found());
                }
                has_decimals |= digits.len() != 3;
                first.get_or_insert_with(found);
            }
        }
        match first {
            Some(error) if has_points || !has_decimals => Err(error),
            _ => Ok(Notation::Commas),
        }
    }

    /// A word as a number; words for unknown ground are NaN.
    pub(super) fn number(self, word: &str) -> Option<f64> {
        let parsed = match self {
            Notation::Points => word.parse(),
            Notation::Commas => word.replace(',', ".").parse(),
        };
        match parsed {
            Ok(value) if f64::is_infinite(value) => None,
            Ok(value) => Some(value),
            Err(_) => is_unknown(word).then_some(f64::NAN),
        }
    }
}

fn is_unknown(word: &str) -> bool {
    UNKNOWN.iter().any(|unknown| word.eq_ignore_ascii_case(unknown))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_commas_are_read_where_they_can_be_nothing_else() {
        assert_eq!(Notation::of("1 2.5").unwrap(), Notation::Points);
        assert_eq!(Notation::of("300,123 300,15").unwrap(), Notation::Commas);
        assert_eq!(Notation::Commas.number("-300,15"), Some(-300.15));
        for doubtful in ["1,234 5,678", "1,234.5", "1,5 2.5", "1,2,3"] {
            assert!(Notation::of(doubtful).is_err(), "{doubtful}");
        }
    }

    #[test]
    fn words_for_unknown_ground_are_no_number_and_infinity_is_refused() {
        for word in ["nan", "NaN", "-nan", "null", "NULL", "1.#QNAN", "*"] {
            assert!(Notation::Points.number(word).is_some_and(f64::is_nan), "{word}");
        }
        for word in ["inf", "-Infinity", "1e999", "x", ""] {
            assert_eq!(Notation::Points.number(word), None, "{word}");
        }
    }
}
