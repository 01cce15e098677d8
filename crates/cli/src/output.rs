//! Everything the command prints: the one place that writes to standard output and standard error.

use std::{
    fmt,
    io::{self, BufWriter, ErrorKind, Write},
};

use anyhow::Context;
use serde::Serialize;

/// A reader of standard output that has left, as `head` does: the command ends without a word.
#[derive(Debug)]
pub(crate) struct ReaderLeft;

impl fmt::Display for ReaderLeft {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("nobody reads the output")
    }
}

impl std::error::Error for ReaderLeft {}

/// Prints a text and ends its line.
///
/// # Errors
/// [`ReaderLeft`], or an output that cannot be written to.
pub(crate) fn line(text: impl fmt::Display) -> anyhow::Result<()> {
    print(|out| writeln!(out, "{text}"))
}

/// Prints a text that ends its own lines.
///
/// # Errors
/// As [`line`].
pub(crate) fn text(text: impl fmt::Display) -> anyhow::Result<()> {
    print(|out| write!(out, "{text}"))
}

/// Prints a document as one line of JSON.
///
/// # Errors
/// As [`line`].
pub(crate) fn json(document: &impl Serialize) -> anyhow::Result<()> {
    print(|out| {
        serde_json::to_writer(&mut *out, document)?;
        writeln!(out)
    })
}

/// Prints a remark to standard error. Where that is closed nobody is left to be told.
pub(crate) fn note(text: impl fmt::Display) {
    let _ = writeln!(io::stderr().lock(), "{text}");
}

fn print(write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> anyhow::Result<()> {
    written(write, io::stdout().lock())
}

/// Writes all of an output and tells a reader that left from one that cannot take it.
fn written(write: impl FnOnce(&mut dyn Write) -> io::Result<()>, out: impl Write) -> anyhow::Result<()> {
    let mut out = BufWriter::new(out);
    match write(&mut out).and_then(|()| out.flush()) {
        Ok(()) => Ok(()),
        Err(error) if error.kind() == ErrorKind::BrokenPipe => {
            // What is buffered has nowhere to go.
            let _ = out.into_parts();
            Err(ReaderLeft.into())
        }
        Err(error) => {
            let _ = out.into_parts();
            Err(error).context("cannot write to standard output")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An output that takes so many bytes and then fails.
    struct Failing(usize, ErrorKind);

    impl Write for Failing {
        fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
            if self.0 == 0 {
                return Err(self.1.into());
            }
            let taken = bytes.len().min(self.0);
            self.0 -= taken;
            Ok(taken)
        }

        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }

    #[test]
    fn a_reader_that_leaves_at_any_byte_is_told_from_a_full_disk() {
        let document: Vec<u32> = (0..10_000).collect();
        let json = |out: &mut dyn Write| -> io::Result<()> { Ok(serde_json::to_writer(out, &document)?) };
        for taken in [0, 1, 100, 20_000] {
            let left = written(json, Failing(taken, ErrorKind::BrokenPipe)).unwrap_err();
            assert!(left.is::<ReaderLeft>(), "{left:?}");
            let full = written(json, Failing(taken, ErrorKind::StorageFull)).unwrap_err();
            assert!(!full.is::<ReaderLeft>() && format!("{full:#}").contains("standard output"), "{full:#}");
        }
        assert!(written(json, Failing(1 << 20, ErrorKind::BrokenPipe)).is_ok());
    }
}
