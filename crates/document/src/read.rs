//! Reading a document.

use serde::{Deserializer, de::DeserializeOwned};
use serde_json::Value;
use serde_path_to_error::Path;

use crate::{
    error::{Error, Mistake},
    fault::Fault,
    place::{beneath, pointer, shown, tracked_pointer},
    strict::{Reading, Strict},
};

/// Most missing fields that are reported together; each takes another reading of the document.
const MOST_MISSING: usize = 32;
/// Most bytes that are read again to find further missing fields: some 40 ms at the 100 MB/s of a strict reading. Of larger
/// documents fewer missing fields are told at once.
const MOST_READ_AGAIN: usize = 4 << 20;

/// Reads a document.
///
/// # Errors
/// The place of whatever is no JSON, mistyped, unknown or given twice, or all missing fields.
pub fn from_json<T: DeserializeOwned>(text: &[u8]) -> Result<T, Error> {
    /// Byte order mark of UTF-8, which a reader may ignore (RFC 8259, section 8.1).
    const BYTE_ORDER_MARK: &[u8] = b"\xef\xbb\xbf";
    let text = text.strip_prefix(BYTE_ORDER_MARK).unwrap_or(text);
    if text.trim_ascii().is_empty() {
        return Err(Error::of(whole("the document is empty".to_owned())));
    }
    read(text.len(), |filled| {
        let mut parser = serde_json::Deserializer::from_slice(text);
        let value = attempt(&mut parser, filled).map_err(|failed| failed.worded(text))?;
        parser.end().map_err(|error| {
            let fault = Reading::default().carrier.take(&error);
            let (path, pointer) = (String::new(), String::new());
            Failed { fault: fault.to_string(), missing: None, path, pointer, not_json: None }
        })?;
        Ok(value)
    })
}

/// Reads a part of a document that was parsed before.
///
/// # Errors
/// As [`from_json`], without lines and columns.
pub fn from_value<T: DeserializeOwned>(value: &Value) -> Result<T, Error> {
    read(size_of(value), |filled| attempt(value, filled))
}

/// A reading that failed, with the place in the document.
struct Failed {
    fault: String,
    missing: Option<(usize, &'static str)>,
    path: String,
    pointer: String,
    /// Where the text is no JSON.
    not_json: Option<Box<NotJson>>,
}

/// The place at which a text is no JSON.
struct NotJson {
    line: usize,
    column: usize,
    path: String,
    pointer: String,
}

impl Failed {
    /// The same, where other programs' words stand for a number, with that word, its place and what JSON has for it.
    fn worded(self, text: &[u8]) -> Self {
        let Some(not_json) = &self.not_json else { return self };
        let word = word_at(text, not_json.line, not_json.column);
        let Some(word) = WORDS_OF_OTHERS.iter().find(|other| other.as_bytes() == word) else { return self };
        let (line, column) = (not_json.line, not_json.column);
        let fault = format!(
            "{word} is no JSON: write null where there is no number (line {line}, column {column}); json.dumps of Python writes NaN and Infinity unless it is given allow_nan=False"
        );
        Failed { fault, path: not_json.path.clone(), pointer: not_json.pointer.clone(), ..self }
    }
}

/// Words by which programs write numbers that are none, or nothing, into what they take for JSON.
const WORDS_OF_OTHERS: [&str; 12] = [
    "NaN",
    "-NaN",
    "nan",
    "-nan",
    "Infinity",
    "-Infinity",
    "inf",
    "-inf",
    "Inf",
    "-Inf",
    "None",
    "undefined",
];

/// The letters, with a sign, about a column of a line, both from 1.
fn word_at(text: &[u8], line: usize, column: usize) -> &[u8] {
    let Some(line) = text.split(|byte| *byte == b'\n').nth(line.saturating_sub(1)) else { return &[] };
    let is_part = |byte: &u8| byte.is_ascii_alphabetic() || *byte == b'-';
    // The parser has read one letter of the word, or none after a sign.
    let at = column.saturating_sub(1).min(line.len());
    let (before, after) = line.split_at(at);
    let start = at - before.iter().rev().take_while(|byte| is_part(byte)).count();
    let end = at + after.iter().take_while(|byte| is_part(byte)).count();
    line.get(start..end).unwrap_or_default()
}

fn attempt<'de, T, D>(inner: D, filled: &[(usize, &'static str)]) -> Result<T, Failed>
where
    T: DeserializeOwned,
    D: Deserializer<'de>,
{
    let reading = Reading::new(filled);
    serde_path_to_error::deserialize(Strict { inner, reading: &reading }).map_err(|error| {
        let (fault, path): (&Fault, _) = (error.inner(), error.path());
        let place = |of: fn(&Path) -> String| if fault.is_syntax() { String::new() } else { of(path) };
        let not_json = fault.is_syntax().then(|| {
            let (line, column) = fault.line_and_column();
            Box::new(NotJson { line, column, path: shown(path), pointer: tracked_pointer(path) })
        });
        Failed {
            fault: fault.to_string(),
            missing: fault.missing(),
            path: place(shown),
            pointer: place(tracked_pointer),
            not_json,
        }
    })
}

/// Reads; where a field is missing, reads again as though it were there, until no other is missing.
fn read<T>(
    bytes: usize,
    attempt: impl Fn(&[(usize, &'static str)]) -> Result<T, Failed>,
) -> Result<T, Error> {
    let most_missing = MOST_MISSING.min(1 + MOST_READ_AGAIN / bytes.max(1));
    let mut filled = Vec::new();
    let mut mistakes = Vec::new();
    loop {
        let failed = match attempt(&filled) {
            Ok(value) if mistakes.is_empty() => return Ok(value),
            Ok(_) => return Err(Error { mistakes }),
            Err(failed) => failed,
        };
        match failed.missing {
            Some((object, field)) if mistakes.len() < most_missing => {
                filled.push((object, field));
                mistakes.push(Mistake {
                    path: beneath(&failed.path, field),
                    pointer: failed.pointer + &pointer(field),
                    message: format!("missing field `{field}`"),
                    is_missing: true,
                });
                if mistakes.len() == most_missing {
                    return Err(Error { mistakes });
                }
            }
            // What follows may be a mistake of the filling alone.
            _ if !mistakes.is_empty() => return Err(Error { mistakes }),
            _ => {
                return Err(Error::of(Mistake {
                    path: failed.path,
                    pointer: failed.pointer,
                    message: failed.fault,
                    is_missing: false,
                }));
            }
        }
    }
}

/// Bytes of a parsed document as text, about: what each value takes at least, and all texts.
fn size_of(value: &Value) -> usize {
    const LEAST: usize = 4;
    match value {
        Value::Array(items) => LEAST + items.iter().map(size_of).sum::<usize>(),
        Value::Object(fields) => {
            LEAST + fields.iter().map(|(name, value)| name.len() + size_of(value)).sum::<usize>()
        }
        Value::String(text) => LEAST + text.len(),
        _ => LEAST,
    }
}

/// A mistake of the document as a whole.
fn whole(message: String) -> Mistake {
    Mistake { path: String::new(), pointer: String::new(), message, is_missing: false }
}
