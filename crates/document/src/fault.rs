//! One mistake as the parser or a type reports it, before its place is known.

use std::{cell::RefCell, fmt};

use serde::de::{self, Expected, Unexpected};

/// Similarity of names (Jaro, 0 to 1) from which one is suggested for the other; clap asks for the same.
const SIMILAR: f64 = 0.7;

/// A mistake with its line and column.
#[derive(Clone, Debug)]
pub(crate) struct Fault(Box<Inner>);

#[derive(Clone, Debug)]
struct Inner {
    kind: Kind,
    /// The object that lacks a field, as counted while reading.
    object: Option<usize>,
    hint: Option<String>,
    line: usize,
    column: usize,
}

/// What kind of mistake.
#[derive(Clone, Debug)]
pub(crate) enum Kind {
    /// The text is no JSON.
    Syntax(String),
    /// A field that the type needs.
    Missing(&'static str),
    /// Any other; in words.
    Other(String),
    /// A value of another JSON type.
    Type { expected: String, found: String, is_text: bool },
}

impl Fault {
    pub(crate) fn new(kind: Kind) -> Self {
        Fault(Box::new(Inner { kind, object: None, hint: None, line: 0, column: 0 }))
    }

    fn other(message: String) -> Self {
        Fault::new(Kind::Other(message))
    }

    pub(crate) fn kind(&self) -> &Kind {
        &self.0.kind
    }

    /// Whether the text is no JSON, so that its line and column say more than any path.
    pub(crate) fn is_syntax(&self) -> bool {
        matches!(self.0.kind, Kind::Syntax(_))
    }

    /// Line and column from 1; 0 where they are not known.
    pub(crate) fn line_and_column(&self) -> (usize, usize) {
        (self.0.line, self.0.column)
    }

    /// The missing field, and the object that lacks it.
    pub(crate) fn missing(&self) -> Option<(usize, &'static str)> {
        match self.0.kind {
            Kind::Missing(field) => self.0.object.map(|object| (object, field)),
            _ => None,
        }
    }

    /// Notes which object lacks a field, unless an inner one does.
    pub(crate) fn within(mut self, object: usize) -> Self {
        self.0.object.get_or_insert(object);
        self
    }

    /// Adds how to mend it.
    pub(crate) fn hinted(mut self, hint: String) -> Self {
        self.0.hint.get_or_insert(hint);
        self
    }

    fn at(mut self, line: usize, column: usize) -> Self {
        if self.0.line == 0 {
            (self.0.line, self.0.column) = (line, column);
        }
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0.kind {
            Kind::Syntax(message) => write!(f, "this is no valid JSON: {message}")?,
            Kind::Missing(field) => write!(f, "missing field `{field}`")?,
            Kind::Other(message) => f.write_str(message)?,
            Kind::Type { expected, found, .. } => write!(f, "expected {expected}, but found {found}")?,
        }
        if let Some(hint) = &self.0.hint {
            write!(f, "; {hint}")?;
        }
        if self.0.line > 0 {
            write!(f, " (line {}, column {})", self.0.line, self.0.column)?;
        }
        Ok(())
    }
}

impl std::error::Error for Fault {}

impl de::Error for Fault {
    fn custom<T: fmt::Display>(message: T) -> Self {
        Fault::other(message.to_string())
    }

    fn invalid_type(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Fault::new(Kind::Type {
            expected: in_json(&expected.to_string()),
            found: named(found),
            is_text: matches!(found, Unexpected::Str(_)),
        })
    }

    fn invalid_value(found: Unexpected<'_>, expected: &dyn Expected) -> Self {
        Fault::invalid_type(found, expected)
    }

    fn invalid_length(length: usize, expected: &dyn Expected) -> Self {
        Fault::other(format!("expected {}, but found {length} elements", in_json(&expected.to_string())))
    }

    fn missing_field(field: &'static str) -> Self {
        Fault::new(Kind::Missing(field))
    }

    fn unknown_field(field: &str, expected: &'static [&'static str]) -> Self {
        unknown("field", field, expected)
    }

    fn unknown_variant(variant: &str, expected: &'static [&'static str]) -> Self {
        unknown("name", variant, expected)
    }

    fn duplicate_field(field: &'static str) -> Self {
        twice(field)
    }
}

/// A name that stands twice in one object.
pub(crate) fn twice(field: &str) -> Fault {
    Fault::other(format!("field `{field}` is given twice"))
}

fn unknown(what: &str, name: &str, known: &[&str]) -> Fault {
    // A long name is no misspelling, and not worth repeating in full.
    let short: String = name.chars().take(80).collect();
    let listed: Vec<String> = known.iter().map(|known| format!("`{known}`")).collect();
    let nearest = known
        .iter()
        .map(|known| (strsim::jaro(&short, known), known))
        .filter(|(similarity, _)| *similarity > SIMILAR)
        .max_by(|(one, _), (other, _)| one.total_cmp(other));
    let suggested = nearest.map_or(String::new(), |(_, known)| format!(": did you mean `{known}`?"));
    Fault::other(match known {
        [] => format!("unknown {what} `{short}`, where none is expected"),
        _ => format!("unknown {what} `{short}`{suggested}; known: {}", listed.join(", ")),
    })
}

/// What serde expects, in terms of JSON.
fn in_json(expected: &str) -> String {
    match expected {
        "f64" | "f32" => "a number".into(),
        "u8" | "u16" | "u32" | "u64" | "usize" => "a whole number of at least 0".into(),
        "i8" | "i16" | "i32" | "i64" | "isize" => "a whole number".into(),
        "a sequence" => "an array".into(),
        "a map" => "an object".into(),
        "a boolean" => "true or false".into(),
        "unit" => "null".into(),
        _ => match expected.strip_prefix("struct ") {
            Some(_) => "an object".into(),
            None => expected.to_owned(),
        },
    }
}

/// What was found, in terms of JSON.
fn named(found: Unexpected<'_>) -> String {
    match found {
        Unexpected::Bool(value) => value.to_string(),
        Unexpected::Unsigned(value) => value.to_string(),
        Unexpected::Signed(value) => value.to_string(),
        Unexpected::Float(value) => value.to_string(),
        Unexpected::Str(text) => {
            let short: String = text.chars().take(80).collect();
            let rest = if short.len() < text.len() { "…" } else { "" };
            format!("the string \"{short}{rest}\"")
        }
        Unexpected::Unit | Unexpected::Option => "null".into(),
        Unexpected::Seq => "an array".into(),
        Unexpected::Map => "an object".into(),
        other => other.to_string(),
    }
}

/// Carries a fault through code whose error type is another.
#[derive(Default)]
pub(crate) struct Carrier(RefCell<Option<Fault>>);

impl Carrier {
    /// Keeps a fault; what is returned stands for it.
    pub(crate) fn keep<E: de::Error>(&self, fault: Fault) -> E {
        self.0.replace(Some(fault));
        E::custom("")
    }

    /// The fault that was kept, or the parser's own, with its line and column.
    pub(crate) fn take(&self, error: &impl fmt::Display) -> Fault {
        let kept = self.0.borrow_mut().take();
        let said = error.to_string();
        let (message, place) = split_place(&said);
        let fault = kept.unwrap_or_else(|| {
            Fault::new(match message {
                // A mistake of one value, whose path says the most.
                "number out of range" => Kind::Other("the number is too large to be represented".into()),
                _ => Kind::Syntax(message.to_owned()),
            })
        });
        match place {
            Some((line, column)) => fault.at(line, column),
            None => fault,
        }
    }
}

/// Splits the parser's message into its words and its line and column.
pub(crate) fn split_place(said: &str) -> (&str, Option<(usize, usize)>) {
    let split = || {
        let (message, place) = said.rsplit_once(" at line ")?;
        let (line, column) = place.split_once(" column ")?;
        Some((message, (line.parse().ok()?, column.parse().ok()?)))
    };
    split().map_or((said, None), |(message, place)| (message, Some(place)))
}
