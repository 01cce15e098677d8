//! What is wrong with a document.

use std::fmt;

/// A document that cannot be read: one mistake, or several missing fields.
#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    pub(crate) mistakes: Vec<Mistake>,
}

/// One mistake and its place.
#[derive(Clone, Debug, PartialEq)]
pub struct Mistake {
    /// Path, as `surfaces.marble.mu_roll`; empty for the document itself.
    pub path: String,
    /// JSON pointer of the same place (RFC 6901).
    pub pointer: String,
    /// What is wrong there and, where it is known, how to mend it.
    pub message: String,
    pub(crate) is_missing: bool,
}

impl Error {
    pub(crate) fn of(mistake: Mistake) -> Self {
        Error { mistakes: vec![mistake] }
    }

    /// The mistakes, of which there is at least one.
    pub fn mistakes(&self) -> &[Mistake] {
        &self.mistakes
    }

    /// Path of the first mistake, where it lies in a field.
    pub fn field(&self) -> Option<&str> {
        self.mistakes.first().map(|mistake| mistake.path.as_str()).filter(|path| !path.is_empty())
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.mistakes.as_slice() {
            missing if missing.len() > 1 => {
                let paths: Vec<String> = missing.iter().map(|m| format!("`{}`", m.path)).collect();
                write!(f, "missing fields {}", paths.join(", "))
            }
            [mistake] => mistake.fmt(f),
            _ => Ok(()),
        }
    }
}

impl fmt::Display for Mistake {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.is_missing {
            return write!(f, "missing field `{}`", self.path);
        }
        if !self.path.is_empty() {
            write!(f, "{}: ", self.path)?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for Error {}
