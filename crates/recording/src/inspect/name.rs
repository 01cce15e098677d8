//! The name of a column taken apart: its words, the side, and the unit that it ends in.

use super::vocabulary::{LEFT, RIGHT};

/// A side of the robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Left,
    Right,
}

impl Side {
    /// The side that a name says; `None` where it says none or both.
    pub(crate) fn of_name(name: &str) -> Option<Side> {
        let name = Name::new(name);
        match (name.has(LEFT), name.has(RIGHT)) {
            (true, false) => Some(Side::Left),
            (false, true) => Some(Side::Right),
            _ => None,
        }
    }
}

/// The name of a column.
pub(super) struct Name {
    /// Lower-case words.
    pub(super) words: Vec<String>,
    /// Its last word as it is written, or what stands in brackets.
    pub(super) ending: String,
    /// Whether it names a rail by its voltage, as `12v`.
    pub(super) is_of_rail: bool,
}

impl Name {
    pub(super) fn new(name: &str) -> Name {
        let (plain, bracketed) = without_brackets(name);
        let last =
            plain.rsplit(|c: char| !(c.is_alphanumeric() || "°µμ".contains(c))).find(|word| !word.is_empty());
        let last = last.unwrap_or_default();
        let is_of_rail = |word: &str| {
            let digits = word.trim_end_matches(['v', 'V']);
            digits.len() + 1 == word.len()
                && !digits.is_empty()
                && digits.bytes().all(|byte| byte.is_ascii_digit())
        };
        Name {
            is_of_rail: plain.split(|c: char| !c.is_alphanumeric()).any(is_of_rail),
            ending: bracketed.unwrap_or_else(|| last.to_owned()),
            words: joined(words_of(name)),
        }
    }

    /// Whether any of some words is one of its own.
    pub(super) fn has(&self, any: &[&str]) -> bool {
        self.last(any).is_some()
    }

    /// Where the last of its words stands that is one of some.
    pub(super) fn last(&self, any: &[&str]) -> Option<usize> {
        self.words.iter().rposition(|word| any.contains(&word.as_str()))
    }
}

/// Words of which the first alone would mean another thing.
const COMPOUNDS: [[&str; 2]; 4] =
    [["power", "supply"], ["power", "board"], ["power", "unit"], ["power", "module"]];

/// Words with compounds as one.
fn joined(words: Vec<String>) -> Vec<String> {
    let mut joined: Vec<String> = Vec::with_capacity(words.len());
    for word in words {
        match joined.last_mut() {
            Some(before) if COMPOUNDS.contains(&[before.as_str(), word.as_str()]) => {
                *before = format!("{before} {word}");
            }
            _ => joined.push(word),
        }
    }
    joined
}

/// A name without what stands in brackets at its end, and that.
fn without_brackets(name: &str) -> (String, Option<String>) {
    let trimmed = name.trim_end();
    let inner = [('(', ')'), ('[', ']'), ('<', '>')].into_iter().find_map(|(open, close)| {
        let (before, inner) = trimmed.strip_suffix(close)?.rsplit_once(open)?;
        inner.chars().any(char::is_alphabetic).then(|| (before.to_owned(), inner.trim().to_owned()))
    });
    inner.map_or_else(|| (name.to_owned(), None), |(before, inner)| (before, Some(inner)))
}

/// Lower-case words of a text, cut at signs, digits and changes of case.
fn words_of(text: &str) -> Vec<String> {
    let mut words = vec![String::new()];
    let mut before_lower = false;
    let mut characters = text.chars().peekable();
    while let Some(character) = characters.next() {
        // A hump of `wheelSpeed`, and no `kW`.
        let is_hump = character.is_uppercase()
            && before_lower
            && characters.peek().is_some_and(|next| next.is_lowercase());
        if !character.is_alphabetic() || is_hump {
            words.push(String::new());
        }
        if let (true, Some(word)) = (character.is_alphabetic(), words.last_mut()) {
            word.extend(character.to_lowercase());
        }
        before_lower = character.is_lowercase();
    }
    words.retain(|word| !word.is_empty());
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_has_words_and_an_ending() {
        let of = |name: &str| {
            let Name { words, ending, .. } = Name::new(name);
            (words.join(" "), ending)
        };
        let own = |words: &str, ending: &str| (words.to_owned(), ending.to_owned());
        assert_eq!(of("Left wheel [rad/s]"), own("left wheel rad s", "rad/s"));
        assert_eq!(of("wheelSpeedLeft"), own("wheel speed left", "wheelSpeedLeft"));
        assert_eq!(of("battery_cA"), own("battery ca", "cA"));
        assert_eq!(of("/battery_state/current"), own("battery state current", "current"));
        assert_eq!(of("field.power_supply_health"), own("field power supply health", "health"));
        assert!(Name::new("current_12v").is_of_rail && !Name::new("v12_current").is_of_rail);
    }
}
