//! How a container says that the messages of a topic are written.

use std::borrow::Cow;

use crate::{
    cursor::Encoding,
    definition::{Definition, idl},
};

/// Type, definition and encoding of a topic's messages.
pub(crate) struct Schema<'s> {
    pub(crate) type_name: &'s str,
    /// The definition, or why the messages cannot be read.
    pub(crate) definition: Result<Text<'s>, String>,
    pub(crate) encoding: Encoding,
}

/// The text of a definition.
pub(crate) enum Text<'s> {
    /// `.msg`, with its dependencies.
    Msg(Cow<'s, str>),
    /// OMG IDL.
    Idl(Cow<'s, str>),
    /// None, or one in a language that is not read.
    None,
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
            ("cdr", "ros2msg") => (Encoding::Cdr, Ok(Text::Msg(text))),
            ("cdr", "ros2idl" | "omgidl") => (Encoding::Cdr, Ok(Text::Idl(text))),
            ("cdr", _) => (Encoding::Cdr, Ok(Text::None)),
            ("ros1", "ros1msg") => (Encoding::Ros1, Ok(Text::Msg(text))),
            (message, schema) => {
                let reason = format!(
                    "its messages are `{message}` by a `{schema}` schema; `cdr` by `ros2msg` or `ros2idl` can be read"
                );
                (Encoding::Cdr, Err(reason))
            }
        };
        Schema { type_name, definition, encoding }
    }

    /// The definition: that of a standard package where the text does not define the type.
    pub(crate) fn parse(&self) -> Result<Definition, String> {
        let own = match self.definition.as_ref().map_err(Clone::clone)? {
            Text::Msg(text) => Definition::parse(self.type_name, text),
            Text::Idl(text) => idl::parse(self.type_name, text),
            Text::None => return Definition::standard(self.type_name),
        };
        match own {
            Ok(own) if self.encoding == Encoding::Ros1 || !own.root().is_empty() => Ok(own),
            Ok(_) => Definition::standard(self.type_name),
            Err(reason) => Definition::standard(self.type_name).map_err(|_| reason),
        }
    }
}
