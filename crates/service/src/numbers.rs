//! Numbers in messages.

/// Most digits of a number that are written one by one: whole numbers of 64 bits have no more.
const MOST_DIGITS: usize = 20;
/// What numbers below 10⁻⁵ begin with.
const SMALL: &str = "0.00000";

/// A message whose very long and very small numbers have an exponent: `1e300`, and not 1 with three hundred zeros.
///
/// Numbers are those that stand alone: digits that are part of a word, a name or a path stay as they are.
///
/// ```
/// use service::with_exponents;
/// assert_eq!(with_exponents("x_m is 0.000000000001 m".into()), "x_m is 1e-12 m");
/// assert_eq!(with_exponents(format!("{} J", 1e300)), "1e300 J");
/// assert_eq!(with_exponents("map 7 has 16000 rows".into()), "map 7 has 16000 rows");
/// ```
pub fn with_exponents(text: String) -> String {
    if !text.contains(SMALL) && !has_long_number(&text) {
        return text;
    }
    let mut changed = String::with_capacity(text.len());
    let mut rest = &text[..];
    while let Some(start) = rest.find(|c: char| c.is_ascii_digit()) {
        let (before, from) = rest.split_at(start);
        changed.push_str(before);
        let end = from.find(|c: char| !c.is_ascii_digit() && c != '.').unwrap_or(from.len());
        let number = from[..end].trim_end_matches('.');
        let after = &from[number.len()..];
        changed.push_str(&match short(number) {
            Some(short) if begins_alone(&changed) && ends_alone(after) => short,
            _ => number.to_owned(),
        });
        rest = after;
        // What follows at once belongs to the same word.
        let word = rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len());
        changed.push_str(&rest[..word]);
        rest = &rest[word..];
    }
    changed + rest
}

fn has_long_number(text: &str) -> bool {
    text.split(|c: char| !c.is_ascii_digit() && c != '.').any(|run| run.len() > MOST_DIGITS)
}

/// A number with an exponent, where that is shorter to read.
fn short(number: &str) -> Option<String> {
    let digits = number.bytes().filter(u8::is_ascii_digit).count();
    let is_long = digits > MOST_DIGITS || number.starts_with(SMALL);
    let value = number.parse::<f64>().ok().filter(|value| is_long && value.is_finite())?;
    // What was rounded to nothing is nothing.
    Some(if value == 0.0 { number.to_owned() } else { format!("{value:e}") })
}

/// Whether a number may begin after a text.
fn begins_alone(before: &str) -> bool {
    let before = before.strip_suffix('-').unwrap_or(before);
    before.chars().next_back().is_none_or(|c| c.is_whitespace() || "([{`\"=±,".contains(c))
}

/// Whether a number may end before a text.
fn ends_alone(after: &str) -> bool {
    let after = after.strip_prefix('.').unwrap_or(after);
    after.chars().next().is_none_or(|c| c.is_whitespace() || ")]}`\",;:%°".contains(c))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn numbers_of_any_size_are_short_in_a_message() {
        for (value, shown) in [
            (1e300, "1e300"),
            (-1e300, "-1e300"),
            (f64::MAX, "1.7976931348623157e308"),
            (1e-12, "1e-12"),
            (f64::MIN_POSITIVE, "2.2250738585072014e-308"),
            (1e10, "10000000000"),
            (0.25, "0.25"),
            (0.30000000000000004, "0.30000000000000004"),
            (0.0, "0"),
        ] {
            assert_eq!(with_exponents(format!("charge is {value}, but")), format!("charge is {shown}, but"));
            assert_eq!(with_exponents(format!("the start ({value}, 2)")), format!("the start ({shown}, 2)"));
            assert_eq!(with_exponents(value.to_string()), shown);
        }
        assert_eq!(with_exponents(format!("at {:.2} m.", 1e300)), "at 1e300 m.");
    }

    #[test]
    fn names_stay_as_they_are() {
        for name in [
            "logs/000000000000000000000000123.csv: no such file",
            "map `a100000000000000000000000000000b` is not stored",
            "scan-100000000000000000000000000.asc",
            "1.000000000000000000000000000000.7",
            "2026-11-27T19:40:00.000000000000000000000001Z",
        ] {
            assert_eq!(with_exponents(name.to_owned()), name);
        }
    }

    proptest! {
        #[test]
        fn a_number_is_the_same_when_it_is_read_back(value in any::<f64>().prop_filter("finite", |v| v.is_finite())) {
            let shown = with_exponents(value.to_string());
            prop_assert!(shown.len() <= 26, "{shown}");
            prop_assert_eq!(shown.parse::<f64>().unwrap(), value);
        }

        #[test]
        fn what_has_no_long_number_is_not_touched(text in "[a-z0-9 .,:()-]{0,20}") {
            prop_assume!(!text.contains("0.00000"));
            prop_assert_eq!(with_exponents(text.clone()), text);
        }
    }
}
