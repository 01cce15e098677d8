//! A text column while it is read.

use std::collections::HashMap;

use crate::Labels;

/// Most different names of runs or surfaces in one file: a year of driving has fewer drives.
pub(crate) const MOST_NAMES: usize = 10_000;

/// Labels that find a name by its hash. Numbers are one name however they are spelled: `1` and `1.0`.
#[derive(Debug, Default)]
pub(crate) struct LabelColumn {
    labels: Labels,
    known: HashMap<String, u32>,
    /// Names that are numbers, by their bits.
    numbers: HashMap<u64, u32>,
}

/// Bits of the number that a name spells in digits; `None` of any other name.
fn number_of(name: &str) -> Option<u64> {
    let is_spelled = name.bytes().all(|byte| byte.is_ascii_digit() || b"+-.eE".contains(&byte));
    let number = name.parse::<f64>().ok().filter(|number| is_spelled && number.is_finite())?;
    // Both zeros are one number.
    Some((number + 0.0).to_bits())
}

impl LabelColumn {
    /// Adds a row; an empty name is none. False: it is one name too many.
    #[must_use]
    pub(crate) fn push(&mut self, name: &str) -> bool {
        let Labels { names, index } = &mut self.labels;
        let last = index.last().copied().unwrap_or(Labels::NONE);
        // Names come in long stretches, so the last one is looked at first.
        let found = if name.is_empty() {
            Labels::NONE
        } else if names.get(last as usize).is_some_and(|known| known == name) {
            last
        } else if let Some(&known) = self.known.get(name) {
            known
        } else if let Some(&same) = number_of(name).and_then(|number| self.numbers.get(&number)) {
            self.known.insert(name.to_owned(), same);
            same
        } else if names.len() >= MOST_NAMES {
            return false;
        } else {
            let new = u32::try_from(names.len()).unwrap_or(Labels::NONE);
            names.push(name.to_owned());
            self.known.insert(name.to_owned(), new);
            self.numbers.extend(number_of(name).map(|number| (number, new)));
            new
        };
        index.push(found);
        true
    }

    /// Which name each row has.
    pub(crate) fn index(&mut self) -> &mut Vec<u32> {
        &mut self.labels.index
    }

    pub(crate) fn into_labels(self) -> Labels {
        self.labels
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_number_is_one_name_however_it_is_spelled() {
        let mut column = LabelColumn::default();
        let names = ["1", "1.0", "01", "1e0", "2", "run-1", "2.00", "-0", "0", "nan", "1_0", "inf"];
        assert!(names.iter().all(|name| column.push(name)));
        assert_eq!(column.into_labels().index, [0, 0, 0, 0, 1, 2, 1, 3, 3, 4, 5, 6]);
    }

    #[test]
    fn names_are_numbered_as_they_appear_and_one_too_many_is_refused() {
        let mut column = LabelColumn::default();
        assert!(["ice", "ice", "", "mud", "ice"].iter().all(|name| column.push(name)));
        assert!((2..MOST_NAMES).all(|number| column.push(&number.to_string())));
        assert!(!column.push("one more") && column.push("mud"));
        let labels = column.into_labels();
        assert_eq!(labels.index[..5], [0, 0, Labels::NONE, 1, 0]);
    }
}
