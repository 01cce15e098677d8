//! Numbers as text.

/// Three significant figures, with a true minus sign.
pub(crate) fn three_figures(value: f64) -> String {
    if value == 0.0 {
        return "0".to_owned();
    }
    let digits = (2.0 - value.abs().max(1e-6).log10().floor()).clamp(0.0, 6.0) as usize;
    format!("{value:.digits$}").replace('-', "−")
}

/// A value with its unit; a unit of `1` is none.
pub(crate) fn quantity(value: f64, unit: &str) -> String {
    let number = three_figures(value);
    if unit == "1" { number } else { format!("{number}\u{a0}{unit}") }
}

/// A power with one decimal.
pub(crate) fn watts(value_w: f64) -> String {
    format!("{value_w:.1}\u{a0}W").replace('-', "−")
}

/// A share as a whole percentage; a dash where there is none.
pub(crate) fn percent(share: Option<f64>) -> String {
    share.map_or_else(|| "–".into(), |share| format!("{:.0}\u{a0}%", 100.0 * share))
}

/// A number with so many decimals; a dash where there is none.
pub(crate) fn decimals(value: Option<f64>, digits: usize) -> String {
    value.map_or_else(|| "–".into(), |value| format!("{value:.digits$}"))
}

/// A probability as a percentage with one decimal, bounded where that would read 0 or 100.
pub(crate) fn probability(p: f64) -> String {
    match p {
        p if p < 5e-4 => "<\u{a0}0.1\u{a0}%".to_owned(),
        p if p > 1.0 - 5e-4 => ">\u{a0}99.9\u{a0}%".to_owned(),
        p => format!("{:.1}\u{a0}%", 100.0 * p),
    }
}

/// Odds of one probability against another, as `12 : 1` or `1 : 3.5`.
pub(crate) fn odds(of: f64, against: f64) -> String {
    /// Ratio beyond which the exact figure says nothing.
    const LARGEST: f64 = 1e6;
    let side = |ratio: f64| match ratio {
        ratio if ratio.is_nan() || ratio > LARGEST => None,
        ratio if ratio < 10.0 => Some(format!("{ratio:.1}")),
        ratio => Some(grouped(ratio)),
    };
    if of >= against {
        side(of / against).map_or_else(
            || ">\u{a0}1\u{202f}000\u{202f}000\u{a0}:\u{a0}1".to_owned(),
            |n| format!("{n}\u{a0}:\u{a0}1"),
        )
    } else {
        side(against / of).map_or_else(
            || "<\u{a0}1\u{a0}:\u{a0}1\u{202f}000\u{202f}000".to_owned(),
            |n| format!("1\u{a0}:\u{a0}{n}"),
        )
    }
}

/// A whole number with its thousands apart.
fn grouped(value: f64) -> String {
    let digits = format!("{value:.0}");
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push('\u{202f}');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn three_figures_count_and_zero_is_zero() {
        assert_eq!([0.0, 0.1224, -3.937, 1520.0].map(three_figures), ["0", "0.122", "−3.94", "1520"]);
        assert_eq!(quantity(0.25, "1"), "0.250");
        assert_eq!(quantity(25.3, "kg"), "25.3\u{a0}kg");
    }

    #[test]
    fn probabilities_never_read_as_certain() {
        let shown = [0.0, 0.0065, 0.9881, 1.0 + 1e-13].map(|p| probability(p).replace('\u{a0}', " "));
        assert_eq!(shown, ["< 0.1 %", "0.7 %", "98.8 %", "> 99.9 %"]);
    }

    #[test]
    fn odds_stand_for_the_likelier_side_and_end_at_a_million() {
        let shown = [(0.9, 0.1), (0.9851, 0.0065), (0.2, 0.7), (1.0, 0.0), (0.0, 1.0), (0.99999, 1e-5)]
            .map(|(of, against)| odds(of, against).replace(['\u{a0}', '\u{202f}'], " "));
        assert_eq!(
            shown,
            ["9.0 : 1", "152 : 1", "1 : 3.5", "> 1 000 000 : 1", "< 1 : 1 000 000", "99 999 : 1"]
        );
    }
}
