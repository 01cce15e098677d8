//! The text of a package that breaks off, up to its last whole line: a line that is cut may end within a number.

use std::{
    cell::Cell,
    io::{Cursor, ErrorKind, Read, Result as IoResult},
    rc::Rc,
};

/// Bytes unpacked at a time.
const BLOCK_BYTES: u64 = 1 << 16;

/// Longest line that is held back until it is whole \[bytes\]: longer ones are refused as records.
const LONGEST_LINE_BYTES: usize = 1 << 26;

/// What is unpacked, line by line.
pub(crate) struct WholeLines<R> {
    packed: R,
    /// Bytes behind the last line break.
    held: Vec<u8>,
    ready: Cursor<Vec<u8>>,
    /// Whether the package broke off.
    is_cut_off: Rc<Cell<bool>>,
}

impl<R: Read> WholeLines<R> {
    /// What a decoder unpacks; `is_cut_off` is set where the package ends before its text does.
    pub(crate) fn new(packed: R, is_cut_off: Rc<Cell<bool>>) -> WholeLines<R> {
        WholeLines { packed, held: Vec::new(), ready: Cursor::default(), is_cut_off }
    }

    fn refill(&mut self) -> IoResult<()> {
        let before = self.held.len();
        let read = self.packed.by_ref().take(BLOCK_BYTES).read_to_end(&mut self.held);
        match read {
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => {
                self.is_cut_off.set(true);
                let whole = self.held.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
                self.held.truncate(whole);
                self.ready = Cursor::new(std::mem::take(&mut self.held));
            }
            Err(error) => return Err(error),
            Ok(0) => self.ready = Cursor::new(std::mem::take(&mut self.held)),
            Ok(_) => {
                let new = self.held.get(before..).unwrap_or_default();
                let end = new.iter().rposition(|byte| *byte == b'\n').map(|at| before + at + 1);
                let end = end.or_else(|| (self.held.len() > LONGEST_LINE_BYTES).then_some(self.held.len()));
                if let Some(end) = end {
                    let rest = self.held.split_off(end);
                    self.ready = Cursor::new(std::mem::replace(&mut self.held, rest));
                } else {
                    return self.refill();
                }
            }
        }
        Ok(())
    }
}

impl<R: Read> Read for WholeLines<R> {
    fn read(&mut self, buffer: &mut [u8]) -> IoResult<usize> {
        let bytes = self.ready.read(buffer)?;
        if bytes > 0 || buffer.is_empty() || self.is_cut_off.get() {
            return Ok(bytes);
        }
        self.refill()?;
        self.ready.read(buffer)
    }
}
