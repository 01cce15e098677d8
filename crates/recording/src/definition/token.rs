//! The words of an IDL text.

use crate::error::excerpt;

/// Words in order; comments, directives and separators between files are left out.
#[derive(Default)]
pub(super) struct Tokens<'t> {
    words: Vec<&'t str>,
    at: usize,
}

/// Splits a text into words.
pub(super) fn tokens(text: &str) -> Result<Tokens<'_>, String> {
    let mut words = Vec::new();
    let mut rest = text;
    let mut begins_line = true;
    while let Some(first) = rest.chars().next() {
        let line = || rest.find('\n').unwrap_or(rest.len());
        let length = if first.is_whitespace() {
            begins_line |= first == '\n';
            rest = rest.get(first.len_utf8()..).unwrap_or_default();
            continue;
        } else if rest.starts_with("//") || begins_line && is_between(rest) {
            rest = rest.get(line()..).unwrap_or_default();
            continue;
        } else if rest.starts_with("/*") {
            let end = rest.find("*/").ok_or("a comment is not closed")?;
            rest = rest.get(end + 2..).unwrap_or_default();
            continue;
        } else if matches!(first, '"' | '\'') {
            quoted(rest, first)?
        } else if first.is_alphanumeric() || first == '_' {
            rest.find(|c: char| !c.is_alphanumeric() && c != '_').unwrap_or(rest.len())
        } else if rest.starts_with("::") {
            2
        } else {
            first.len_utf8()
        };
        let (word, behind) = rest.split_at(length);
        words.push(word);
        rest = behind;
        begins_line = false;
    }
    Ok(Tokens { words, at: 0 })
}

/// A directive, a line of `=` or the name of the file behind it.
fn is_between(line: &str) -> bool {
    line.starts_with('#') || line.starts_with("==") || line.starts_with("IDL:")
}

/// Length of a text in quotes.
fn quoted(text: &str, quote: char) -> Result<usize, String> {
    let mut escaped = false;
    for (at, character) in text.char_indices().skip(1) {
        match character {
            _ if escaped => escaped = false,
            '\\' => escaped = true,
            c if c == quote => return Ok(at + c.len_utf8()),
            _ => {}
        }
    }
    Err("a text is not closed".into())
}

impl<'t> Tokens<'t> {
    pub(super) fn is_empty(&self) -> bool {
        self.at >= self.words.len()
    }

    pub(super) fn next(&mut self) -> Result<&'t str, String> {
        let word = self.words.get(self.at).copied().ok_or("it ends too soon")?;
        self.at += 1;
        Ok(word)
    }

    /// Takes a word if it comes next.
    pub(super) fn take(&mut self, word: &str) -> bool {
        let comes = self.words.get(self.at) == Some(&word);
        self.at += usize::from(comes);
        comes
    }

    pub(super) fn expect(&mut self, word: &str) -> Result<(), String> {
        match self.next()? {
            found if found == word => Ok(()),
            found => Err(format!("`{}` stands where `{word}` should", excerpt(found))),
        }
    }

    pub(super) fn name(&mut self) -> Result<&'t str, String> {
        let word = self.next()?;
        let is_name = word.starts_with(|c: char| c.is_alphabetic() || c == '_');
        if is_name { Ok(word) } else { Err(format!("`{}` is no name", excerpt(word))) }
    }

    pub(super) fn number(&mut self) -> Result<usize, String> {
        let word = self.next()?;
        word.parse().map_err(|_| format!("`{}` is no number", excerpt(word)))
    }

    /// Moves behind the next such word.
    pub(super) fn skip_to(&mut self, word: &str) -> Result<(), String> {
        while self.next()? != word {}
        Ok(())
    }

    /// Moves behind the name and the arguments of an annotation.
    pub(super) fn skip_annotation(&mut self) -> Result<(), String> {
        self.name()?;
        while self.take("::") {
            self.name()?;
        }
        let mut open = usize::from(self.take("("));
        while open > 0 {
            match self.next()? {
                "(" => open += 1,
                ")" => open -= 1,
                _ => {}
            }
        }
        Ok(())
    }
}
