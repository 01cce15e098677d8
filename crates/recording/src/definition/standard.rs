//! Definitions of standard packages, for recordings that hold none: SQLite files before Iron, and MCAP files of some bridges.

use std::{collections::BTreeMap, sync::LazyLock};

use super::{Definition, Field};

/// Name of a message that the text does not define; its other messages are the library.
const NONE: &str = "none/None";

static LIBRARY: LazyLock<BTreeMap<String, Vec<Field>>> = LazyLock::new(|| {
    let text = include_str!("../../definitions/ros2.msg");
    Definition::parse(NONE, text).map(|definition| definition.messages).unwrap_or_default()
});

/// Fields of a message of a standard package.
pub(super) fn fields(message: &str) -> Option<&'static [Field]> {
    LIBRARY.get(message).map(Vec::as_slice)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::definition::Base;

    #[test]
    fn the_library_is_whole() {
        assert!(LIBRARY.len() > 50, "{}", LIBRARY.len());
        for (name, message) in LIBRARY.iter().filter(|(name, _)| *name != NONE) {
            assert!(!message.is_empty(), "{name}");
            for field in message {
                if let Base::Message(inner) = &field.base {
                    assert!(fields(inner).is_some(), "{name} has {inner}");
                }
            }
        }
    }
}
