//! A row of units below the header, as data loggers and MATLAB write it.

use crate::{
    Conversion, Error, Quantity, calendar, cell::is_missing, column::Plan, error::excerpt, unit_names,
};

/// Other spellings of units, and their names in maps.
const SPELLINGS: [(&str, &str); 53] = [
    ("sec", "s"),
    ("secs", "s"),
    ("second", "s"),
    ("seconds", "s"),
    ("msec", "ms"),
    ("milliseconds", "ms"),
    ("µs", "us"),
    ("usec", "us"),
    ("microseconds", "us"),
    ("nsec", "ns"),
    ("nanoseconds", "ns"),
    ("minutes", "min"),
    ("hours", "h"),
    ("hr", "h"),
    ("hrs", "h"),
    ("days", "d"),
    ("day", "d"),
    ("mps", "m/s"),
    ("m/sec", "m/s"),
    ("m s-1", "m/s"),
    ("m s^-1", "m/s"),
    ("m·s⁻¹", "m/s"),
    ("kmh", "km/h"),
    ("kph", "km/h"),
    ("kmph", "km/h"),
    ("rad/sec", "rad/s"),
    ("radps", "rad/s"),
    ("rad s-1", "rad/s"),
    ("rad·s⁻¹", "rad/s"),
    ("deg/sec", "deg/s"),
    ("degps", "deg/s"),
    ("dps", "deg/s"),
    ("°/s", "deg/s"),
    ("RPM", "rpm"),
    ("1/min", "rpm"),
    ("radian", "rad"),
    ("radians", "rad"),
    ("°", "deg"),
    ("degree", "deg"),
    ("degrees", "deg"),
    ("watt", "W"),
    ("watts", "W"),
    ("Watt", "W"),
    ("Watts", "W"),
    ("ampere", "A"),
    ("Amps", "A"),
    ("volt", "V"),
    ("Volts", "V"),
    ("°C", "degC"),
    ("celsius", "degC"),
    ("m/s^2", "m/s2"),
    ("m/s²", "m/s2"),
    ("metres", "m"),
];

/// Whether the first row behind the header holds no number where numbers are needed, time among them. It is a row of units then, and
/// has to agree with what the columns are taken to be in.
///
/// # Errors
/// The column whose unit is another, or that says what is no unit.
pub(crate) fn is_units_row<'c>(
    plan: &Plan,
    cell: impl Fn(usize) -> &'c [u8],
    line: u64,
) -> Result<bool, Error> {
    let needed: Vec<(usize, String)> = plan
        .needed()
        .map(|column| (column, String::from_utf8_lossy(cell(column)).trim().to_owned()))
        .collect();
    let tells_nothing = |text: &str| is_missing(text) || text == "-";
    let digits = |text: &str| text.bytes().filter(u8::is_ascii_digit).count();
    let has_letter =
        |text: &str| text.contains(|character: char| character.is_alphabetic() || character == '°');
    let is_word = |text: &str| tells_nothing(text) || (has_letter(text) && digits(text) <= 2);
    let first = plan.time().and_then(|time| needed.iter().find(|(column, _)| *column == time));
    let is_time_word =
        first.is_some_and(|(_, text)| !tells_nothing(text) && calendar::duration_s(text).is_none());
    let has_number = needed.iter().any(|(_, text)| !tells_nothing(text) && text.parse::<f64>().is_ok());
    if !is_time_word || has_number || !needed.iter().all(|(_, text)| is_word(text)) {
        return Ok(false);
    }
    for (column, text) in needed.iter().filter(|(_, text)| !tells_nothing(text)) {
        let Some((quantity, taken)) = plan.unit_of(*column) else { continue };
        let own = text.trim_matches(['[', ']', '(', ')', '<', '>']).trim();
        if !is_same(quantity, own, taken) {
            let is_known = unit_names(quantity).contains(&symbol(own));
            return Err(Error::UnitsRow {
                line,
                column: plan.header(*column).to_owned(),
                found: excerpt(own),
                taken: taken.to_owned(),
                is_known,
            });
        }
    }
    Ok(true)
}

/// The unit of maps that is spelled otherwise.
pub(crate) fn symbol(spelled: &str) -> &str {
    SPELLINGS.iter().find(|(spelling, _)| *spelling == spelled).map_or(spelled, |(_, symbol)| symbol)
}

/// Whether two units of a quantity are one.
fn is_same(quantity: Quantity, spelled: &str, taken: &str) -> bool {
    let conversion = |unit: &str| Conversion::from_unit(quantity, unit, None);
    let own = symbol(spelled);
    own == taken || (conversion(own).is_some() && conversion(own) == conversion(taken))
}
