//! Times of the calendar and of the clock as seconds.

use crate::{Conversion, Quantity, units_row::symbol};

/// Days from 1 March of year 0 to 1 January 1970.
const DAYS_TO_1970: i64 = 719_468;

const DAY_S: i64 = 86_400;

/// Seconds of a date and time of ISO 8601 since 1970, by UTC where no offset is given, or of a duration such as `1 days 02:03:04.5`.
///
/// Between date and time stands `T` or a space, and the date may have slashes where its year comes first. Dates that begin with a
/// day or a month are ambiguous and have no value.
pub(crate) fn seconds(text: &str) -> Option<f64> {
    let text = text.trim();
    if let Some((days, clock)) = text.split_once(" day") {
        let clock = clock.strip_prefix('s').unwrap_or(clock).trim_start_matches([',', ' ']);
        let days: i64 = days.parse().ok()?;
        return Some(days.checked_mul(DAY_S)? as f64 + of_clock(clock)?);
    }
    let Some((date, time)) = text.split_once(['T', 't', ' ']) else { return of_clock(text) };
    let (clock, offset_s) = without_offset(time.trim())?;
    let whole_s = days_since_1970(date)? * DAY_S - offset_s;
    Some(whole_s as f64 + of_clock(clock)?)
}

/// Seconds of a duration with its unit behind it, as MATLAB writes `0.1 sec`.
pub(crate) fn duration_s(text: &str) -> Option<f64> {
    let text = text.trim();
    let unit_at = text.find(|sign: char| sign.is_alphabetic() && !matches!(sign, 'e' | 'E'))?;
    let (number, unit) = text.split_at(unit_at);
    let unit = Conversion::from_unit(Quantity::Time, symbol(unit.trim()), None)?;
    let number: f64 = number.trim_end().parse().ok().filter(|number: &f64| number.is_finite())?;
    Some(unit.apply(number))
}

/// Whether a text looks like a date or a time of the clock, read or not.
pub(crate) fn is_like_time(text: &str) -> bool {
    let digits = text.bytes().filter(u8::is_ascii_digit).count();
    let marks = text.bytes().filter(|byte| matches!(byte, b':' | b'/' | b'-' | b'.')).count();
    digits >= 4 && marks >= 2 && text.bytes().all(|byte| byte.is_ascii() && byte != b',')
}

/// Days from 1970 to a date of the Gregorian calendar (Hinnant, `days_from_civil`).
fn days_since_1970(date: &str) -> Option<i64> {
    let mut parts = date.split(['-', '/']);
    let [year, month, day] = [parts.next()?, parts.next()?, parts.next()?];
    if year.len() != 4 || parts.next().is_some() {
        return None;
    }
    let [year, month, day] = [whole(year)?, whole(month)?, whole(day)?];
    let is_leap = year % 4 == 0 && (year % 100 != 0 || year % 400 == 0);
    let longest = match month {
        2 if is_leap => 29,
        2 => 28,
        4 | 6 | 9 | 11 => 30,
        1..=12 => 31,
        _ => return None,
    };
    if !(1..=longest).contains(&day) {
        return None;
    }
    // Years begin in March, so that the leap day is their last.
    let year = if month <= 2 { year - 1 } else { year };
    let (era, year_of_era) = (year.div_euclid(400), year.rem_euclid(400));
    let day_of_year = (153 * ((month + 9) % 12) + 2) / 5 + day - 1;
    let day_of_era = year_of_era * 365 + year_of_era / 4 - year_of_era / 100 + day_of_year;
    Some(era * 146_097 + day_of_era - DAYS_TO_1970)
}

/// A time of the clock and its offset from UTC \[s\].
fn without_offset(time: &str) -> Option<(&str, i64)> {
    if let Some(clock) = ["Z", "z", "UTC"].iter().find_map(|mark| time.strip_suffix(mark)) {
        return Some((clock.trim_end(), 0));
    }
    let Some(at) = time.rfind(['+', '-']) else { return Some((time, 0)) };
    let (clock, offset) = time.split_at(at);
    let (sign, digits) = (if offset.starts_with('-') { -1 } else { 1 }, offset[1..].replace(':', ""));
    let minutes = match digits.len() {
        2 => 60 * whole(&digits)?,
        4 => 60 * whole(digits.get(..2)?)? + whole(digits.get(2..)?)?,
        _ => return None,
    };
    Some((clock.trim_end(), sign * 60 * minutes))
}

/// Seconds since midnight of `22:13:20.5`.
fn of_clock(clock: &str) -> Option<f64> {
    let mut parts = clock.split(':');
    let [hours, minutes, seconds] = [parts.next()?, parts.next()?, parts.next()?];
    if parts.next().is_some() || hours.len() > 2 || minutes.len() != 2 {
        return None;
    }
    let seconds = seconds.replace(',', ".");
    if !seconds.bytes().all(|byte| byte.is_ascii_digit() || byte == b'.') {
        return None;
    }
    let (hours, minutes, seconds) = (whole(hours)?, whole(minutes)?, seconds.parse::<f64>().ok()?);
    let is_time = hours < 24 && minutes < 60 && seconds < 61.0;
    is_time.then(|| (3600 * hours + 60 * minutes) as f64 + seconds)
}

fn whole(digits: &str) -> Option<i64> {
    let is_whole = !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit());
    digits.parse().ok().filter(|_| is_whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_with_a_unit_of_time_is_a_duration() {
        for (text, expected_s) in [
            ("0.1 sec", 0.1),
            ("2.5 min", 150.0),
            ("1 hr", 3600.0),
            ("200 ms", 0.2),
            ("1e3 s", 1000.0),
            ("3s", 3.0),
        ] {
            assert_eq!(duration_s(text), Some(expected_s), "{text}");
        }
        for text in ["0.1", "sec", "0.1 volt", "", "nan s", "2023-11-14"] {
            assert_eq!(duration_s(text), None, "{text}");
        }
    }

    #[test]
    fn dates_and_clocks_are_seconds() {
        for (text, expected_s) in [
            ("2023-11-14T22:13:20.25", 1_700_000_000.25),
            ("2023-11-14 22:13:20,25", 1_700_000_000.25),
            ("2023/11/14 22:13:20.25Z", 1_700_000_000.25),
            ("2023-11-14T23:13:20.25+01:00", 1_700_000_000.25),
            ("2023-11-14T20:43:20.25-0130", 1_700_000_000.25),
            ("2023-11-14 22:13:20.25+00", 1_700_000_000.25),
            ("2023-11-14 22:13:20 UTC", 1_700_000_000.0),
            ("1970-01-01T00:00:00", 0.0),
            ("2000-03-01T00:00:00", 951_868_800.0),
            ("2024-02-29T00:00:00", 1_709_164_800.0),
            ("0 days 00:00:20.100000", 20.1),
            ("1 day, 0:00:01", 86_401.0),
            ("22:13:20.5", 80_000.5),
        ] {
            assert_eq!(seconds(text), Some(expected_s), "{text}");
        }
    }

    #[test]
    fn ambiguous_and_impossible_times_have_no_value() {
        for text in [
            "14.11.2023 22:13:20",
            "11/14/2023 22:13:20",
            "2023-13-14T22:13:20",
            "2023-02-29T22:13:20",
            "2023-11-14T24:13:20",
            "2023-11-14",
            "13:20.1",
            "20.1",
            "+",
            "T",
            "2023-11-14Té",
        ] {
            assert_eq!(seconds(text), None, "{text}");
        }
        assert!(is_like_time("14.11.2023 22:13:20") && is_like_time("2023-11-14") && !is_like_time("12.5"));
    }
}
