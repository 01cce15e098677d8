//! The few Python literals of an array's header: a dictionary of texts, truths and whole numbers.
//!
//! Nothing nests, so that nothing recurs, and nothing is built: a hostile header costs one pass over its bytes.

use super::NpyError;

/// A place in the text of a header.
pub(super) struct Literal<'a> {
    rest: &'a [u8],
    /// Offset of the text's end in the file.
    end: usize,
}

impl<'a> Literal<'a> {
    /// The text of a header, which ends at an offset of the file.
    pub(super) fn new(text: &'a [u8], end: usize) -> Self {
        Literal { rest: text, end }
    }

    /// Whether all has been read.
    pub(super) fn is_at_end(&mut self) -> bool {
        self.peek().is_none()
    }

    /// The next byte that is no blank.
    pub(super) fn peek(&mut self) -> Option<u8> {
        self.rest = self.rest.trim_ascii_start();
        self.rest.first().copied()
    }

    /// Whether a byte comes next, which is passed then.
    pub(super) fn passes(&mut self, byte: u8) -> bool {
        let comes = self.peek() == Some(byte);
        if comes {
            self.rest = self.rest.get(1..).unwrap_or_default();
        }
        comes
    }

    /// Passes a byte.
    ///
    /// # Errors
    /// Another one.
    pub(super) fn pass(&mut self, byte: u8, name: &'static str) -> Result<(), NpyError> {
        if self.passes(byte) { Ok(()) } else { Err(self.missing(name)) }
    }

    /// A text in quotes of either kind, without escapes.
    ///
    /// # Errors
    /// Anything else.
    pub(super) fn text(&mut self, name: &'static str) -> Result<&'a str, NpyError> {
        let quote = self.peek().filter(|byte| matches!(byte, b'\'' | b'"'));
        let inner = self.rest.get(1..).unwrap_or_default();
        let length = quote.and_then(|quote| inner.iter().position(|byte| *byte == quote));
        let text = length.and_then(|length| std::str::from_utf8(inner.get(..length)?).ok());
        let text = text.filter(|text| !text.contains('\\')).ok_or_else(|| self.missing(name))?;
        self.rest = inner.get(text.len() + 1..).unwrap_or_default();
        Ok(text)
    }

    /// `True` or `False`.
    ///
    /// # Errors
    /// Anything else.
    pub(super) fn truth(&mut self) -> Result<bool, NpyError> {
        self.peek();
        for (word, value) in [(&b"True"[..], true), (b"False", false)] {
            if let Some(rest) = self.rest.strip_prefix(word) {
                self.rest = rest;
                return Ok(value);
            }
        }
        Err(self.missing("`True` or `False`"))
    }

    /// A whole number from nought on, with the `L` that Python 2 wrote behind it or without.
    ///
    /// # Errors
    /// Anything else, or a number of more than 64 bits.
    pub(super) fn count(&mut self) -> Result<u64, NpyError> {
        self.peek();
        let digits = self.rest.iter().take_while(|byte| byte.is_ascii_digit()).count();
        let number = self.rest.get(..digits).and_then(|digits| std::str::from_utf8(digits).ok());
        let number = number.and_then(|digits| digits.parse().ok());
        let number = number.ok_or_else(|| self.missing("a whole number"))?;
        self.rest = self.rest.get(digits..).unwrap_or_default();
        self.rest = self.rest.strip_prefix(b"L").unwrap_or(self.rest);
        Ok(number)
    }

    /// The refusal of what comes next.
    pub(super) fn missing(&self, expected: &'static str) -> NpyError {
        NpyError::Header { at: self.end - self.rest.len(), expected }
    }
}
