//! The number that a cell of a text file holds.

use crate::{calendar, error::excerpt};

/// Spellings of a value that is missing, in small letters: of pandas, R, MATLAB, Excel, SQL and C libraries.
const MISSING: [&str; 15] = [
    "",
    "nan",
    "-nan",
    "+nan",
    "na",
    "n/a",
    "<na>",
    "null",
    "none",
    "nil",
    "#n/a",
    "#na",
    "#n/a n/a",
    "nan(ind)",
    "-nan(ind)",
];

/// Errors that spreadsheets write into cells, which begin like a remark.
const SPREADSHEETS: [&str; 9] =
    ["#n/a", "#na", "#n/a n/a", "#div/0!", "#value!", "#ref!", "#name?", "#num!", "#null!"];

/// The minus of typography, which word processors and some tables write.
const MINUS: char = '\u{2212}';

/// Remedy for what is no number of any spelling.
const EMPTY: &str = "leave the cell empty for a gap";
const GROUPS: &str = "write it without separators of thousands, and its decimals behind a point";
const ZEROS: &str =
    "these are zero bytes, as a loss of power leaves them: remove the line, or what follows from it on";
const ALONE: &str = "write the number alone, without its unit";
const ISO_8601: &str =
    "write seconds, or date and time by ISO 8601, year first, as `2023-11-14T22:13:20.5Z` or `22:13:20.5`";

/// The marks of decimals and times that a file uses; it may not change them on the way.
#[derive(Debug)]
pub(crate) struct Spelling {
    /// Whether commas separate cells, so that they mark no decimals.
    is_comma_separated: bool,
    decimals: Option<Seen<Mark>>,
    times: Option<Seen<Times>>,
}

/// What was seen first, and in which line.
#[derive(Clone, Copy, Debug)]
struct Seen<T> {
    what: T,
    line: u64,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Mark {
    Point,
    Comma,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Times {
    Numbers,
    Calendar,
}

impl Spelling {
    pub(crate) fn new(separator: u8) -> Spelling {
        Spelling { is_comma_separated: separator == b',', decimals: None, times: None }
    }

    /// The first line with a decimal comma, if the file uses them.
    pub(crate) fn decimal_comma(&self) -> Option<u64> {
        self.decimals.filter(|seen| seen.what == Mark::Comma).map(|seen| seen.line)
    }

    /// The first line with a time of the calendar or the clock, if the file uses them.
    pub(crate) fn calendar(&self) -> Option<u64> {
        self.times.filter(|seen| seen.what == Times::Calendar).map(|seen| seen.line)
    }

    /// The finite number of a cell, NaN where it is missing, or how to mend it.
    #[inline]
    pub(crate) fn number(&mut self, cell: &[u8], line: u64) -> Result<f64, String> {
        // Nearly all cells of nearly all files: of these the words below need not be asked.
        match short_decimal(cell) {
            Some((value, has_point)) if !has_point || self.is_point() => Ok(value),
            _ => self.any_number(cell, line),
        }
    }

    fn any_number(&mut self, cell: &[u8], line: u64) -> Result<f64, String> {
        let text = std::str::from_utf8(cell).unwrap_or("\u{fffd}").trim();
        let hyphened = text.contains(MINUS).then(|| text.replace(MINUS, "-"));
        let text = hyphened.as_deref().unwrap_or(text);
        let mark = if text.contains(',') { Mark::Comma } else { Mark::Point };
        let value = match mark {
            Mark::Point => plain(text),
            Mark::Comma if self.is_comma_separated => {
                let remedy =
                    "it has a decimal comma or groups thousands: write a decimal point, and no groups";
                return Err(remedy.into());
            }
            Mark::Comma => text.split_once(',').and_then(|(whole, decimals)| {
                let is_plain = |part: &str| !part.contains(['.', ',', ' ']);
                plain(&format!("{whole}.{decimals}")).filter(|_| is_plain(whole) && is_plain(decimals))
            }),
        };
        let Some(value) = value else { return Err(remedy(text)) };
        if mark == Mark::Point && (self.is_point() || !text.contains('.')) {
            return Ok(value);
        }
        match *self.decimals.get_or_insert(Seen { what: mark, line }) {
            Seen { what, .. } if what == mark => Ok(value),
            Seen { what, line } => {
                let other = if what == Mark::Comma { "comma" } else { "point" };
                Err(format!(
                    "decimals stand behind a {other} in line {line}: write all behind a point, without groups"
                ))
            }
        }
    }

    /// The time of a cell \[s, or the unit of the column\], NaN where it is missing, or how to mend it.
    pub(crate) fn time(&mut self, cell: &[u8], line: u64) -> Result<f64, String> {
        let are_numbers = matches!(self.times, Some(Seen { what: Times::Numbers, .. }));
        if let (true, Some((value, has_point))) = (are_numbers, short_decimal(cell))
            && (!has_point || self.is_point())
        {
            return Ok(value);
        }
        let text = String::from_utf8_lossy(cell);
        let calendar = match text.contains(':') {
            true => calendar::seconds(&text),
            false => calendar::duration_s(&text),
        };
        let (what, value) = match calendar {
            Some(value) => (Times::Calendar, value),
            None if calendar::is_like_time(&text) && plain(text.trim()).is_none() => {
                return Err(ISO_8601.into());
            }
            None => (Times::Numbers, self.number(cell, line)?),
        };
        if value.is_nan() {
            return Ok(value);
        }
        match *self.times.get_or_insert(Seen { what, line }) {
            Seen { what: first, .. } if first == what => Ok(value),
            Seen { what: first, line } => {
                let other = if first == Times::Numbers { "a number" } else { "a date or time of the clock" };
                Err(format!("line {line} has {other}: write all times in one way"))
            }
        }
    }

    /// The number of a cell that may hold anything.
    pub(crate) fn perhaps(&self, cell: &[u8]) -> Option<f64> {
        if let Some((value, _)) = short_decimal(cell) {
            return Some(value);
        }
        let text = std::str::from_utf8(cell).ok()?.trim();
        let text = text.replace(MINUS, "-");
        if self.decimal_comma().is_some() { plain(&text.replacen(',', ".", 1)) } else { plain(&text) }
    }

    fn is_point(&self) -> bool {
        matches!(self.decimals, Some(Seen { what: Mark::Point, .. }))
    }
}

/// Powers of ten that a double holds exactly, as many as digits of a short decimal need.
const TENS: [f64; 16] =
    [1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15];

/// A number of up to 15 digits with at most one decimal point and nothing else, and whether it has the point; `None` of any other cell.
///
/// Its digits as a whole number and the power of ten below are doubles without rounding, so that their ratio is rounded once, as the
/// standard library rounds: W. D. Clinger, *How to Read Floating Point Numbers Accurately*, PLDI 1990.
#[inline]
fn short_decimal(cell: &[u8]) -> Option<(f64, bool)> {
    let (is_negative, digits) = match cell {
        [b'-', rest @ ..] => (true, rest),
        _ => (false, cell),
    };
    // Fifteen digits and a point.
    if digits.len() > 16 {
        return None;
    }
    let (mut whole, mut point) = (0u64, None);
    for (place, byte) in digits.iter().enumerate() {
        match byte {
            b'0'..=b'9' => whole = 10 * whole + u64::from(byte - b'0'),
            b'.' if point.is_none() => point = Some(place),
            _ => return None,
        }
    }
    let count = digits.len() - usize::from(point.is_some());
    if count == 0 || count > 15 {
        return None;
    }
    let decimals = point.map_or(0, |place| digits.len() - 1 - place);
    let magnitude = whole as f64 / TENS[decimals];
    Some((if is_negative { -magnitude } else { magnitude }, point.is_some()))
}

/// Whether a cell holds what a spreadsheet writes in place of a value.
pub(crate) fn is_spreadsheets(cell: &[u8]) -> bool {
    SPREADSHEETS.iter().any(|error| cell.trim_ascii().eq_ignore_ascii_case(error.as_bytes()))
}

/// Whether a cell says that it has no value.
pub(crate) fn is_missing(text: &str) -> bool {
    MISSING.iter().any(|missing| text.eq_ignore_ascii_case(missing))
}

/// A finite number with a decimal point, or NaN for a missing one.
fn plain(text: &str) -> Option<f64> {
    match text.parse::<f64>() {
        Ok(value) => (!value.is_infinite()).then_some(value),
        Err(_) => is_missing(text).then_some(f64::NAN),
    }
}

fn remedy(text: &str) -> String {
    let digits = text.bytes().any(|byte| byte.is_ascii_digit());
    let has_groups = digits && text.bytes().all(|byte| byte.is_ascii_digit() || b",.' -+".contains(&byte));
    let number = text.trim_end_matches(|character: char| !character.is_ascii_digit()).trim();
    if text.contains('\0') {
        ZEROS.into()
    } else if has_groups {
        GROUPS.into()
    } else if digits && number.len() < text.len() && plain(&number.replacen(',', ".", 1)).is_some() {
        ALONE.into()
    } else {
        EMPTY.into()
    }
}

/// A cell for a message.
pub(crate) fn shown(cell: &[u8]) -> String {
    excerpt(&String::from_utf8_lossy(cell))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(separator: u8, cells: &[&str]) -> Result<Vec<f64>, String> {
        let mut spelling = Spelling::new(separator);
        cells.iter().zip(2..).map(|(cell, line)| spelling.number(cell.as_bytes(), line)).collect()
    }

    #[test]
    fn decimals_may_stand_behind_a_comma_where_it_separates_no_cells() {
        for separator in [b';', b'\t', b' '] {
            assert_eq!(all(separator, &["0,1", "-3", " 1,5e-3 ", ",5"]), Ok(vec![0.1, -3.0, 1.5e-3, 0.5]));
        }
        assert_eq!(all(b',', &["\u{2212}0.5", "1e\u{2212}3"]), Ok(vec![-0.5, 1e-3]));
        assert_eq!(all(b',', &["0.1", "1e3", "+.5", "5."]), Ok(vec![0.1, 1e3, 0.5, 5.0]));
        assert!(all(b',', &["0,1"]).unwrap_err().contains("decimal comma"));
    }

    #[test]
    fn short_decimals_are_rounded_as_the_standard_library_rounds() {
        let mut state = 7u64;
        for _ in 0..20_000 {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            let (digits, sign) = ((state >> 33) % 16, if state >> 63 == 0 { "" } else { "-" });
            let whole = (state >> 8) % 10u64.pow(digits as u32 + 1).min(1_000_000_000_000_000);
            let mut text = whole.to_string();
            let place = (state >> 20) as usize % (text.len() + 1);
            text.insert(place, '.');
            let text = format!("{sign}{text}");
            let (value, has_point) = short_decimal(text.as_bytes()).unwrap();
            assert_eq!(
                (value.to_bits(), has_point),
                (text.parse::<f64>().unwrap().to_bits(), true),
                "{text}"
            );
        }
        for other in ["", "-", ".", "1e3", "+1", " 1", "1,5", "1.2.3", "0x1", "nan", "1234567890123456"] {
            assert_eq!(short_decimal(other.as_bytes()), None, "{other}");
        }
        assert_eq!(short_decimal(b"-0").map(|(value, _)| value.to_bits()), Some((-0.0f64).to_bits()));
    }

    #[test]
    fn marks_that_change_and_groups_of_thousands_are_refused() {
        for (cells, said) in [
            (["0,1", "0.1"], "behind a comma in line 2"),
            (["0.1", "1,234"], "behind a point in line 2"),
            (["1", "1.234,5"], "thousands"),
            (["1", "1,234,567"], "thousands"),
            (["1", "1 234,5"], "thousands"),
            (["1", "1'234"], "thousands"),
            (["1", "12.5 W"], "without its unit"),
            (["1", "12,5V"], "without its unit"),
            (["1", "fast"], "empty for a gap"),
            (["1", "inf"], "empty for a gap"),
        ] {
            let refused = all(b';', &cells).unwrap_err();
            assert!(refused.contains(said), "{cells:?}: {refused}");
        }
    }

    #[test]
    fn missing_values_are_gaps_in_every_spelling() {
        for cell in ["", " ", "NA", "N/A", "nan", "NaN", "-nan(ind)", "NULL", "None", "<NA>", "#N/A"] {
            assert!(all(b',', &[cell]).unwrap()[0].is_nan(), "{cell}");
        }
    }

    #[test]
    fn times_are_numbers_or_dates_and_do_not_change() {
        let times = |cells: &[&str]| -> Result<Vec<f64>, String> {
            let mut spelling = Spelling::new(b',');
            cells.iter().zip(2..).map(|(cell, line)| spelling.time(cell.as_bytes(), line)).collect()
        };
        assert_eq!(times(&["1970-01-01T00:00:01", "1970-01-01 00:00:02"]), Ok(vec![1.0, 2.0]));
        assert_eq!(times(&["-1.5", "2e-3"]), Ok(vec![-1.5, 2e-3]));
        assert!(times(&["1.5", "1970-01-01T00:00:02"]).unwrap_err().contains("line 2 has a number"));
        assert!(times(&["14.11.2023 22:13:20"]).unwrap_err().contains("ISO 8601"));
        assert!(times(&["20231114"]).is_ok() && times(&["2023-11-14"]).unwrap_err().contains("ISO 8601"));
    }
}
