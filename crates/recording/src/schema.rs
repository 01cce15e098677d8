//! How a container says that the messages of a topic are written.

use std::borrow::Cow;

use crate::cursor::Encoding;

/// Type, definition and encoding of a topic's messages.
pub(crate) struct Schema<'s> {
    pub(crate) type_name: &'s str,
    /// The definition, or why there is none that can be read.
    pub(crate) definition: Result<Cow<'s, str>, String>,
    pub(crate) encoding: Encoding,
}

/// What a ROS 2 container says of a topic.
pub(crate) struct Described<'s> {
    pub(crate) type_name: &'s str,
    pub(crate) message_encoding: &'s str,
    /// Of the definition.
    pub(crate) schema_encoding: &'s str,
    pub(crate) definition: &'s [u8],
}

impl<'s> Schema<'s> {
    /// What can be read of what a container describes.
    pub(crate) fn of(described: &Described<'s>) -> Schema<'s> {
        let Described { type_name, message_encoding, schema_encoding, definition } = *described;
        // Comments are in whatever encoding their author had.
        let text = String::from_utf8_lossy(definition);
        let (encoding, definition) = match (message_encoding, schema_encoding) {
            ("cdr", "ros2msg") => (Encoding::Cdr, Ok(text)),
            ("ros1", "ros1msg") => (Encoding::Ros1, Ok(text)),
            (message, schema) => {
                let reason = format!(
                    "its messages are `{message}` by a `{schema}` schema; cdr by ros2msg can be read"
                );
                (Encoding::Cdr, Err(reason))
            }
        };
        Schema { type_name, definition, encoding }
    }
}
