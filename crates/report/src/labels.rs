//! Labels of mechanisms and of their parameters.

use diagnosis::UNKNOWN;

/// The label of an effect outside the list.
const UNLISTED: &str = "something outside the list";

/// The label of a mechanism.
pub(crate) fn mechanism_label(name: &str) -> String {
    match name {
        UNKNOWN => UNLISTED.to_owned(),
        "speed_dependent_friction" => "speed-dependent friction".to_owned(),
        "grade_dependent_friction" => "grade-dependent friction".to_owned(),
        other => other.replace('_', " "),
    }
}

/// The label of a set of mechanisms that act together.
pub(crate) fn explanation_label<T: AsRef<str>>(mechanisms: &[T]) -> String {
    match mechanisms {
        [] => "nothing missing".to_owned(),
        some => some.iter().map(|name| mechanism_label(name.as_ref())).collect::<Vec<_>>().join(" + "),
    }
}

/// Labels of mechanisms in a row: `a, b or c`.
pub(crate) fn either<T: AsRef<str>>(mechanisms: &[T]) -> String {
    let labels: Vec<String> = mechanisms.iter().map(|name| mechanism_label(name.as_ref())).collect();
    match &labels[..] {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} or {last}", first.join(", ")),
    }
}

/// The label of a parameter, without the unit that stands beside its value.
pub(crate) fn parameter_label(name: &str) -> String {
    const UNITS: [&str; 12] = [
        "_kg",
        "_n",
        "_w",
        "_s",
        "_m",
        "_m2",
        "_rad",
        "_mps",
        "_k_per_w",
        "_per_mps",
        "_kg_per_m",
        "_per_rad",
    ];
    match name {
        "from_s" => "acts from".to_owned(),
        "until_s" => "acts until".to_owned(),
        "per_mps" => "growth with speed".to_owned(),
        "per_slope" => "growth with slope".to_owned(),
        "kg_per_side" => "mass per side".to_owned(),
        other => {
            let unit = UNITS.iter().filter(|unit| other.ends_with(**unit)).max_by_key(|unit| unit.len());
            other.strip_suffix(unit.copied().unwrap_or("")).unwrap_or(other).replace('_', " ")
        }
    }
}

/// Text whose first letter is a capital.
pub(crate) fn capitalized(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map_or(String::new(), |first| first.to_uppercase().collect::<String>() + letters.as_str())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_stand_beside_values() {
        let labels = ["drag_area_m2", "east_mps", "from_s", "roll_change", "per_mps"].map(parameter_label);
        assert_eq!(labels, ["drag area", "east", "acts from", "roll change", "growth with speed"]);
    }

    #[test]
    fn sets_are_added_up_and_alternatives_are_listed() {
        assert_eq!(explanation_label::<&str>(&[]), "nothing missing");
        assert_eq!(explanation_label(&["pitch_bias", "unknown"]), "pitch bias + something outside the list");
        assert_eq!(either(&["wind", "payload", "wheel_slip"]), "wind, payload or wheel slip");
    }
}
