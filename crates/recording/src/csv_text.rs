//! The records of a CSV file one after another, each with its line.

use std::{
    cell::{Cell, RefCell},
    io::{Chain, Cursor, Error as IoError, ErrorKind as IoErrorKind, Read, Result as IoResult},
    rc::Rc,
};

use ::csv::{ByteRecord, ErrorKind, Reader, ReaderBuilder};

use crate::{
    Error,
    dialect::{Dialect, Separator},
    open_quote::{OpenQuote, OpenQuotes},
    plain_text::{PlainText, first_line},
};

/// Bytes read at a time: large enough that calls to the system do not matter, small against any file that takes long.
const BUFFER_BYTES: usize = 1 << 20;

/// Longest record \[bytes\]: a small packed file can hold one that fills the memory.
const LONGEST_RECORD_BYTES: usize = 1 << 26;

/// A CSV file from its header on.
pub(crate) struct CsvText {
    dialect: Dialect,
    reader: Reader<Bounded>,
    /// Bytes read since the last record ended.
    unread: Rc<Cell<usize>>,
    /// Quotation marks of what was read.
    quotes: Rc<RefCell<OpenQuotes>>,
    /// Whether the package of the file was found to break off.
    is_cut_off: Rc<Cell<bool>>,
    record: ByteRecord,
    /// Cells of a record that spaces separate.
    compact: ByteRecord,
    /// Whether lines end with a carriage return: the parser ends them there and counts the newline with the next line.
    returns: bool,
}

impl CsvText {
    /// Opens a file before its header.
    pub(crate) fn open(source: impl Read + 'static) -> Result<CsvText, Error> {
        let mut text = PlainText::open(source)?;
        let dialect = Dialect::of(&text.beginning);
        text.beginning.drain(..dialect.header_at);
        let returns = first_line(&text.beginning).ends_with(b"\r");
        let unread = Rc::new(Cell::new(0));
        let quotes = Rc::new(RefCell::new(OpenQuotes::new(dialect.separator.byte())));
        let is_cut_off = Rc::clone(&text.is_cut_off);
        let bounded =
            Bounded { source: text.whole(), unread: Rc::clone(&unread), quotes: Rc::clone(&quotes) };
        let reader = ReaderBuilder::new()
            .delimiter(dialect.separator.byte())
            .has_headers(false)
            .flexible(true)
            .buffer_capacity(BUFFER_BYTES)
            .from_reader(bounded);
        Ok(CsvText {
            dialect,
            reader,
            unread,
            quotes,
            is_cut_off,
            record: ByteRecord::new(),
            compact: ByteRecord::new(),
            returns,
        })
    }

    /// Whether the package of the file was found to break off.
    pub(crate) fn is_cut_off(&self) -> bool {
        self.is_cut_off.get()
    }

    /// How the file is written.
    pub(crate) fn dialect(&self) -> &Dialect {
        &self.dialect
    }

    /// The record at hand.
    pub(crate) fn record(&self) -> &ByteRecord {
        if self.dialect.separator == Separator::Spaces { &self.compact } else { &self.record }
    }

    /// Goes on to the next record and tells its line; `None` behind the last.
    pub(crate) fn advance(&mut self) -> Result<Option<u64>, Error> {
        let read = self.reader.read_byte_record(&mut self.record);
        if !read.map_err(|error| self.error(&error))? {
            return Ok(None);
        }
        self.unread.set(0);
        if self.dialect.separator == Separator::Spaces {
            self.compact.clear();
            let cells = self.record.iter().filter(|cell| !cell.is_empty());
            cells.for_each(|cell| self.compact.push_field(cell));
        }
        let line = line_of(&self.record, self.reader.position().line());
        Ok(Some(self.dialect.lines_before + line + u64::from(self.returns)))
    }

    /// The names in the record at hand. What is not UTF-8 is Latin-1, of which every byte is a letter.
    pub(crate) fn headers(&self) -> Vec<String> {
        let text = |cell: &[u8]| match std::str::from_utf8(cell) {
            Ok(text) => text.trim().to_owned(),
            Err(_) => cell.iter().map(|byte| char::from(*byte)).collect::<String>().trim().to_owned(),
        };
        self.record().iter().map(text).collect()
    }

    /// Refuses a first line that is a row of numbers, or something else above the header.
    pub(crate) fn refuse_what_is_no_header(&self, headers: &[String]) -> Result<(), Error> {
        let line = self.dialect.lines_before + 1;
        let is_number = |cell: &String| cell.is_empty() || cell.replace(',', ".").parse::<f64>().is_ok();
        if headers.iter().all(is_number) && headers.iter().any(|cell| !cell.is_empty()) {
            let message = "there is no header; write the names of the columns above, as `t_s,v_left_mps,v_right_mps,power_w`";
            return Err(Error::Csv { line, message: message.into() });
        }
        match self.dialect.later_header {
            Some(later) => {
                let message = format!(
                    "the header seems to be line {later}; remove what is above it, or begin those lines with `#`"
                );
                Err(Error::Csv { line, message })
            }
            None => Ok(()),
        }
    }

    fn error(&self, error: &::csv::Error) -> Error {
        let line = self.dialect.lines_before + error.position().map_or(1, ::csv::Position::line);
        match error.kind() {
            ErrorKind::Io(io) if io.kind() == IoErrorKind::FileTooLarge => {
                let line = self.dialect.lines_before + self.quotes.borrow().line();
                Error::Csv { line, message: io.to_string() }
            }
            ErrorKind::Io(io)
                if let Some(open) = io.get_ref().and_then(|inner| inner.downcast_ref::<OpenQuote>()) =>
            {
                Error::Csv { line: self.dialect.lines_before + open.line, message: open.to_string() }
            }
            ErrorKind::Io(io) if io.kind() == IoErrorKind::UnexpectedEof => {
                let message = "the packed file breaks off behind this line; pack it again, or unpack what is left of it";
                Error::Csv {
                    line: self.dialect.lines_before + self.reader.position().line(),
                    message: message.into(),
                }
            }
            ErrorKind::Io(io) => Error::Io(IoError::new(io.kind(), io.to_string())),
            _ => Error::Csv { line, message: error.to_string() },
        }
    }
}

/// A source of which a record may take no more than so much.
struct Bounded {
    source: Chain<Cursor<Vec<u8>>, Box<dyn Read>>,
    unread: Rc<Cell<usize>>,
    quotes: Rc<RefCell<OpenQuotes>>,
}

impl Read for Bounded {
    fn read(&mut self, buffer: &mut [u8]) -> IoResult<usize> {
        if self.unread.get() > LONGEST_RECORD_BYTES {
            return Err(match self.quotes.borrow().open() {
                Some(open) => IoError::other(open),
                None => IoError::new(
                    IoErrorKind::FileTooLarge,
                    "this line does not end within 64 MiB; is it a table?",
                ),
            });
        }
        let bytes = self.source.read(buffer)?;
        self.quotes.borrow_mut().follow(&buffer[..bytes]).map_err(IoError::other)?;
        self.unread.set(self.unread.get() + bytes);
        Ok(bytes)
    }
}

/// The line that a record begins in. Where the parser began to look for it comes before blank lines; the line that it
/// stopped at comes behind breaks within quotes.
fn line_of(record: &ByteRecord, next_line: u64) -> u64 {
    let began = record.position().map_or(0, ::csv::Position::line);
    let breaks = record.as_slice().iter().filter(|byte| **byte == b'\n').count() as u64;
    began.max(next_line.saturating_sub(1 + breaks))
}
