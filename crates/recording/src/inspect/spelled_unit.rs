//! Units in the names of columns.

use super::name::Name;
use crate::{Conversion, Quantity};

/// Spellings of units, by quantity.
const SPELLED: [(Quantity, &str, &[&str]); 22] = [
    (Quantity::Speed, "rpm", &["rpm"]),
    (Quantity::Speed, "rad/s", &["rad/s", "radps", "rad_s", "rads", "rad_per_s", "radpersec"]),
    (Quantity::Speed, "deg/s", &["deg/s", "degps", "deg_s", "dps"]),
    (Quantity::Speed, "km/h", &["km/h", "kmh", "kph"]),
    (Quantity::Speed, "mph", &["mph"]),
    (Quantity::Speed, "mm/s", &["mm/s", "mmps", "mm_s"]),
    (Quantity::Speed, "cm/s", &["cm/s", "cmps", "cm_s"]),
    (Quantity::Speed, "m/s", &["m/s", "mps", "m_s"]),
    (Quantity::AngularRate, "deg/s", &["deg/s", "degps", "deg_s", "dps", "deg"]),
    (Quantity::AngularRate, "rad/s", &["rad/s", "radps", "rad_s", "rads"]),
    (Quantity::Angle, "deg", &["deg", "°", "degrees"]),
    (Quantity::Angle, "mrad", &["mrad"]),
    (Quantity::Angle, "rad", &["rad", "radians"]),
    (Quantity::Power, "kW", &["kw", "kilowatt", "kilowatts"]),
    (Quantity::Power, "mW", &["mw", "milliwatt", "milliwatts"]),
    (Quantity::Power, "W", &["w", "watt", "watts"]),
    (Quantity::Current, "mA", &["ma", "milliamp", "milliamps"]),
    (Quantity::Current, "A", &["a", "amp", "amps", "ampere", "amperes"]),
    (Quantity::Voltage, "mV", &["mv", "millivolt", "millivolts"]),
    (Quantity::Voltage, "V", &["volt", "volts"]),
    (Quantity::Temperature, "K", &["k", "kelvin"]),
    (Quantity::Temperature, "degF", &["f", "degf", "fahrenheit"]),
];

/// Spellings of units that are sought last: one letter is also an abbreviation of much else.
const SPELLED_LAST: [(Quantity, &str, &[&str]); 2] =
    [(Quantity::Temperature, "degC", &["c", "degc", "celsius"]), (Quantity::Length, "m", &["m"])];

/// Words of names that say a unit of which no quantity here is measured: energies, charges, counts, and units that maps do not know.
const UNKNOWN: [&str; 29] = [
    "wh", "kwh", "mwh", "j", "kj", "joule", "joules", "energy", "ah", "mah", "coulomb", "va", "dbm", "kn",
    "kt", "kts", "knot", "knots", "fps", "ftps", "ips", "percent", "pct", "adc", "count", "counts", "tick",
    "ticks", "pwm",
];
/// More of them, which say other things beside other quantities.
const UNKNOWN_OF: [(Quantity, &[&str]); 2] =
    [(Quantity::Power, &["hp", "bhp", "ps", "cv", "duty"]), (Quantity::Speed, &["hp", "duty", "nm"])];

/// Prefixes of units (SI brochure, 9th edition, table 7), those of micro in three spellings.
const PREFIXES: [&str; 26] = [
    "da", "h", "k", "M", "G", "T", "P", "E", "Z", "Y", "R", "Q", "d", "c", "m", "µ", "μ", "u", "n", "p", "f",
    "a", "z", "y", "r", "q",
];

/// Symbols of units that come with prefixes.
const PREFIXED: [(&str, Quantity); 3] =
    [("A", Quantity::Current), ("V", Quantity::Voltage), ("W", Quantity::Power)];

/// Symbols at the end of a name that say a quantity of their own, whatever stands before them.
const SYMBOLS: [(&str, Quantity); 10] = [
    ("rad", Quantity::Angle),
    ("mrad", Quantity::Angle),
    ("deg", Quantity::Angle),
    ("degrees", Quantity::Angle),
    ("°", Quantity::Angle),
    ("A", Quantity::Current),
    ("V", Quantity::Voltage),
    ("W", Quantity::Power),
    ("m/s2", Quantity::Acceleration),
    ("m/s^2", Quantity::Acceleration),
];

/// The unit that a name says.
#[derive(Debug, PartialEq)]
pub(super) enum SpelledUnit {
    /// One that maps know.
    Known(&'static str),
    /// A word that says none that they know.
    Unknown(String),
    /// A symbol of another quantity.
    Another(String),
    /// None.
    Unsaid,
}

/// The unit that a name says of a quantity.
pub(super) fn spelled_unit(text: &str, name: &Name, quantity: Quantity) -> SpelledUnit {
    let of_quantity = UNKNOWN_OF.iter().find(|(of, _)| *of == quantity).map_or(&[][..], |(_, words)| words);
    let is_unknown = |word: &&String| UNKNOWN.iter().chain(of_quantity).any(|unknown| unknown == word);
    if let Some(word) = name.words.iter().find(is_unknown) {
        return SpelledUnit::Unknown(word.clone());
    }
    if let Some((of, symbol)) = prefixed(&name.ending, quantity) {
        return match known(quantity, &symbol) {
            _ if of != quantity => SpelledUnit::Another(symbol),
            Some(unit) => SpelledUnit::Known(unit),
            None => SpelledUnit::Unknown(symbol),
        };
    }
    if let Some(unit) = spelled(text, name, quantity) {
        return SpelledUnit::Known(unit);
    }
    let is_another = |(symbol, of): &&(&str, Quantity)| *symbol == name.ending && !is_of(*of, quantity);
    match SYMBOLS.iter().find(is_another) {
        Some((symbol, _)) => SpelledUnit::Another((*symbol).to_owned()),
        None => SpelledUnit::Unsaid,
    }
}

/// Whether a symbol of one quantity may be written for another: rates of gyroscopes are, of radians and degrees.
fn is_of(symbol: Quantity, quantity: Quantity) -> bool {
    symbol == quantity || (symbol == Quantity::Angle && quantity == Quantity::AngularRate)
}

/// A unit with a prefix that a name ends in, and its quantity. Snake case writes units in lower case, so there the quantity's own are meant.
fn prefixed(ending: &str, quantity: Quantity) -> Option<(Quantity, String)> {
    /// Prefixes that electrical units of robots have, and no more, are looked for in lower case, in which they are words of other things too.
    const USUAL: [&str; 6] = ["m", "k", "c", "d", "u", "n"];
    let of = |(symbol, of): &(&str, Quantity)| {
        let exact = ending.strip_suffix(symbol).filter(|prefix| PREFIXES.contains(prefix));
        let lower = || ending.strip_suffix(&symbol.to_lowercase()).filter(|prefix| USUAL.contains(prefix));
        let prefix = exact.or_else(|| if *of == quantity { lower() } else { None })?;
        Some((*of, format!("{prefix}{symbol}")))
    };
    PREFIXED.iter().find_map(of)
}

/// The unit of maps that has a symbol.
fn known(quantity: Quantity, symbol: &str) -> Option<&'static str> {
    crate::unit_names(quantity).into_iter().find(|unit| *unit == symbol)
}

/// The longer spelling first: `mrad` holds `rad`, and a word of a name is no unit within another.
fn spelled(text: &str, name: &Name, quantity: Quantity) -> Option<&'static str> {
    let lower = text.to_lowercase();
    let is_said = |spelling: &str| {
        if spelling.len() == 1 {
            // An `f` before the end is as likely the front.
            name.words.last().is_some_and(|last| last == spelling)
        } else if spelling.chars().all(char::is_alphabetic) {
            name.words.iter().any(|word| word == spelling)
        } else {
            lower.contains(spelling)
        }
    };
    let all = SPELLED.iter().chain(&SPELLED_LAST);
    let mut of_quantity = all.filter(|(of, ..)| *of == quantity);
    let (_, unit, _) = of_quantity.find(|(.., spellings)| spellings.iter().any(|s| is_said(s)))?;
    Conversion::from_unit(quantity, unit, Some(1.0)).map(|_| *unit)
}
