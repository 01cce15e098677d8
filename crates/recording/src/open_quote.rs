//! Quotation marks that open a cell and are not closed where the cell ends.
//!
//! A quoted cell may hold line breaks, so that one mark too many takes in the rows behind it without a word. Such a cell is told from a
//! note of several lines by what it takes in: a whole row of numbers, text behind its closing mark, or the end of the file.

use std::{error::Error as StdError, fmt, ops::ControlFlow};

use crate::cell::is_missing;

const QUOTE: u8 = b'"';

/// Longest part of a line within quotation marks that is looked at for a row \[bytes\]: rows of a thousand columns are shorter.
const LONGEST_ROW_BYTES: usize = 1 << 15;

/// A quotation mark that is not closed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct OpenQuote {
    /// Its line, from 1.
    pub(crate) line: u64,
    /// Its column, from 1.
    pub(crate) column: usize,
}

impl fmt::Display for OpenQuote {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let column = self.column;
        write!(
            f,
            "a quotation mark opens in column {column} and takes in the rows below; close it behind its cell, or remove it"
        )
    }
}

impl StdError for OpenQuote {}

/// Where in a cell the text stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// Before its first character.
    Start,
    /// In a cell without quotation marks, or behind its marks.
    Bare,
    /// Between quotation marks.
    Quoted,
    /// Behind a mark that closes the cell unless another follows.
    Closing,
}

/// Follows the quotation marks of a text as the CSV parser does.
#[derive(Debug)]
pub(crate) struct OpenQuotes {
    separator: u8,
    place: Place,
    /// Line at hand, from 1, and separators of it so far.
    line: u64,
    separators: usize,
    /// Separators of the header, once it ended.
    header: Option<usize>,
    opened: OpenQuote,
    /// Text of the line at hand between quotation marks, from a line break on; `None` on the line where the mark opened.
    taken_in: Option<Vec<u8>>,
}

impl OpenQuotes {
    pub(crate) fn new(separator: u8) -> OpenQuotes {
        OpenQuotes {
            separator,
            place: Place::Start,
            line: 1,
            separators: 0,
            header: None,
            opened: OpenQuote { line: 1, column: 1 },
            taken_in: None,
        }
    }

    /// Line of the text at hand, from 1.
    pub(crate) fn line(&self) -> u64 {
        self.line
    }

    /// Returns the mark that the text at hand stands behind, if it is open.
    pub(crate) fn open(&self) -> Option<OpenQuote> {
        (self.place == Place::Quoted).then_some(self.opened)
    }

    /// Follows the next block of the text, which is empty at its end.
    ///
    /// # Errors
    /// A mark that took in a row.
    pub(crate) fn follow(&mut self, block: &[u8]) -> Result<(), OpenQuote> {
        if block.is_empty() {
            let has_taken_in = self.taken_in.as_ref().is_some_and(|text| !text.trim_ascii().is_empty())
                || self.line > self.opened.line + 1;
            return if self.place == Place::Quoted && has_taken_in { Err(self.opened) } else { Ok(()) };
        }
        let is_plain = self.header.is_some()
            && matches!(self.place, Place::Start | Place::Bare)
            && !block.contains(&QUOTE);
        if is_plain {
            self.skip(block);
            return Ok(());
        }
        match block.iter().try_for_each(|byte| self.step(*byte)) {
            ControlFlow::Break(open) => Err(open),
            ControlFlow::Continue(()) => Ok(()),
        }
    }

    /// Follows a block without a quotation mark.
    fn skip(&mut self, block: &[u8]) {
        let breaks = block.iter().filter(|byte| **byte == b'\n').count() as u64;
        self.line += breaks;
        let tail = match block.iter().rposition(|byte| *byte == b'\n') {
            Some(at) => {
                self.separators = 0;
                &block[at + 1..]
            }
            None => block,
        };
        self.separators += tail.iter().filter(|byte| **byte == self.separator).count();
        let ends_cell = block.last().is_some_and(|byte| *byte == self.separator || *byte == b'\n');
        self.place = if ends_cell { Place::Start } else { Place::Bare };
    }

    fn step(&mut self, byte: u8) -> ControlFlow<OpenQuote> {
        match (self.place, byte) {
            (Place::Start, QUOTE) => {
                self.place = Place::Quoted;
                self.opened = OpenQuote { line: self.line, column: self.separators + 1 };
                self.taken_in = None;
            }
            (Place::Quoted, QUOTE) => self.place = Place::Closing,
            (Place::Closing, QUOTE) => {
                self.place = Place::Quoted;
                self.take_in(byte);
            }
            (Place::Quoted, b'\n') => {
                self.line += 1;
                if self.took_in_a_row() {
                    return ControlFlow::Break(self.opened);
                }
                self.taken_in = Some(Vec::new());
            }
            (Place::Quoted, _) => self.take_in(byte),
            (_, b'\n') => self.end_line(),
            (_, _) if byte == self.separator => {
                self.place = Place::Start;
                self.separators += 1;
            }
            (Place::Closing, b'\r' | b' ' | b'\t') => {}
            // The mark that seems to close a cell of several lines opens one in a row below.
            (Place::Closing, _) if self.taken_in.is_some() => return ControlFlow::Break(self.opened),
            _ => self.place = Place::Bare,
        }
        ControlFlow::Continue(())
    }

    fn end_line(&mut self) {
        if self.separators > 0 {
            self.header.get_or_insert(self.separators);
        }
        self.line += 1;
        self.separators = 0;
        self.place = Place::Start;
        self.taken_in = None;
    }

    fn take_in(&mut self, byte: u8) {
        if let Some(text) = self.taken_in.as_mut().filter(|text| text.len() < LONGEST_ROW_BYTES) {
            text.push(byte);
        }
    }

    /// Whether the line that ends is a row of the table: as many cells as the header has, most of them numbers.
    fn took_in_a_row(&self) -> bool {
        let (Some(text), Some(separators)) = (&self.taken_in, self.header) else { return false };
        let cells: Vec<&[u8]> = text.split(|byte| *byte == self.separator).collect();
        let is_number = |cell: &&&[u8]| {
            let text = std::str::from_utf8(cell).unwrap_or("-").trim();
            is_missing(text) || text.replace(',', ".").parse::<f64>().is_ok()
        };
        cells.len() == separators + 1 && 2 * cells.iter().filter(is_number).count() > cells.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "t_s,left,right,power,note\n";

    fn found(text: &str, block: usize) -> Option<OpenQuote> {
        let mut quotes = OpenQuotes::new(b',');
        let blocks = text.as_bytes().chunks(block).chain([&b""[..]]);
        blocks.map(|block| quotes.follow(block)).find_map(Result::err)
    }

    #[test]
    fn a_mark_that_takes_in_rows_is_named_wherever_it_ends() {
        let rows = "2,0,0,1,ok\n".repeat(5);
        for (text, line, column) in [
            (format!("1,0,0,1,\"slip\n{rows}"), 2, 5),
            (format!("{rows}1,0,\"0,1,ok\n{rows}"), 7, 3),
            // Closed by the mark that opens the cell of the row below.
            ("1,0,0,1,\"slip\n2,0,0,1,\"ok\"\n".into(), 2, 5),
            (format!("\"1\",\"0\",0,1,\"a \"\"b\"\" c\"\n1,0,0,1,\"slip\n{rows}3,0,0,1,\"ok\"\n"), 3, 5),
            // Closed by a mark for inches.
            (format!("1,0,0,1,\"slip\n{rows}3,0,0,1,5\"\n"), 2, 5),
            ("1,0,0,1,\"slip\n2,0,0,1".into(), 2, 5),
        ] {
            for block in [1, 7, 1 << 20] {
                let expected = Some(OpenQuote { line, column });
                assert_eq!(found(&format!("{HEADER}{text}"), block), expected, "{text}");
            }
        }
    }

    #[test]
    fn notes_of_several_lines_are_cells() {
        for text in [
            "1,0,0,1,\"a\nb, c\n\nd\"\n2,0,0,1,ok\n",
            "1,0,0,1,\"he said \"\"go\"\"\nand went\" \r\n2,0,0,1,ok\n",
            "1,0,0,1,\"one, two, three, four, five\n, , , and, so\"\n",
            "1,0,0,1,5\" tyre\n2,0,0,1,6\" tyre\n",
            "1,0,0,1,\"the file ends here\n",
            "1,0,0,1,\"\"\n2,0,0,1,\"\"\n",
        ] {
            for block in [1, 7, 1 << 20] {
                assert_eq!(found(&format!("{HEADER}{text}"), block), None, "{text}");
            }
        }
    }
}
