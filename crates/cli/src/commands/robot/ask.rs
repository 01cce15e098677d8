//! Questions on a terminal, for what no flag told.

use std::{
    io::{self, BufRead, IsTerminal, Write},
    str::FromStr,
};

use crate::failure::BadInput;

/// Whether somebody is there to answer.
pub(super) fn is_there_somebody() -> bool {
    io::stdin().is_terminal() && io::stderr().is_terminal()
}

/// An answer, asked for until it can be read; `None` for an empty one.
pub(super) fn optional<T: FromStr>(question: &str) -> anyhow::Result<Option<T>>
where
    T::Err: std::fmt::Display,
{
    loop {
        let mut out = io::stderr().lock();
        write!(out, "{question}: ")?;
        out.flush()?;
        let mut line = String::new();
        if io::stdin().lock().read_line(&mut line)? == 0 {
            return Ok(None);
        }
        match line.trim() {
            "" => return Ok(None),
            text => match text.parse() {
                Ok(value) => return Ok(Some(value)),
                Err(error) => writeln!(out, "`{text}` cannot be read: {error}")?,
            },
        }
    }
}

/// An answer that cannot be done without.
pub(super) fn required<T: FromStr>(flag: &str, question: &str) -> anyhow::Result<T>
where
    T::Err: std::fmt::Display,
{
    optional(question)?.ok_or_else(|| BadInput(format!("{flag} is needed: {question}")).into())
}
