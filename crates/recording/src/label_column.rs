//! A text column while it is read.

use std::collections::HashMap;

use crate::Labels;

/// Most different names of runs or surfaces in one file: a year of driving has fewer drives.
pub(crate) const MOST_NAMES: usize = 10_000;

/// Labels that find a name by its hash.
#[derive(Debug, Default)]
pub(crate) struct LabelColumn {
    labels: Labels,
    known: HashMap<String, u32>,
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
        } else if names.len() >= MOST_NAMES {
            return false;
        } else {
            let new = u32::try_from(names.len()).unwrap_or(Labels::NONE);
            names.push(name.to_owned());
            self.known.insert(name.to_owned(), new);
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
    fn names_are_numbered_as_they_appear_and_one_too_many_is_refused() {
        let mut column = LabelColumn::default();
        assert!(["ice", "ice", "", "mud", "ice"].iter().all(|name| column.push(name)));
        assert!((2..MOST_NAMES).all(|number| column.push(&number.to_string())));
        assert!(!column.push("one more") && column.push("mud"));
        let labels = column.into_labels();
        assert_eq!(labels.index[..5], [0, 0, Labels::NONE, 1, 0]);
    }
}
