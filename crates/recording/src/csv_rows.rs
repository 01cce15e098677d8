//! What each record of a CSV file is: a row, a remark, a row of units, nothing, or a mistake.

use ::csv::ByteRecord;

use crate::{
    Error, Repair,
    cell::{Spelling, is_missing, is_spreadsheets},
    column::{Kind, Plan},
    dialect::{Dialect, Separator, remark},
    units_row::is_units_row,
};

/// What a record is.
pub(crate) enum Role {
    /// A row of the table.
    Row,
    /// Nothing to read.
    Passed,
    /// A row of so many cells, which are too few, and what is wrong with it unless it is the last.
    Short(usize, Error),
}

/// The records so far.
pub(crate) struct Rows {
    /// How numbers and times are spelled.
    pub(crate) spelling: Spelling,
    headers: Vec<String>,
    separator: Separator,
    /// Columns up to the last that has a name.
    named: usize,
    rows: usize,
    remarks: usize,
    repairs: Vec<Repair>,
}

impl Rows {
    pub(crate) fn new(dialect: &Dialect, headers: &[String]) -> Rows {
        Rows {
            spelling: Spelling::new(dialect.separator.byte()),
            separator: dialect.separator,
            named: headers.iter().rposition(|header| !header.is_empty()).map_or(0, |last| last + 1),
            headers: headers.to_vec(),
            rows: 0,
            remarks: dialect.remarks,
            repairs: Vec::new(),
        }
    }

    /// What a record is.
    ///
    /// # Errors
    /// A count of cells that is not the header's, a second header, or a row of other units.
    pub(crate) fn role(&mut self, plan: &Plan, record: &ByteRecord, line: u64) -> Result<Role, Error> {
        let is_empty = |cell: &[u8]| cell.iter().all(u8::is_ascii_whitespace);
        let first = record.get(0).unwrap_or_default();
        // A name may begin like a remark, a number may not.
        let is_whole = record.len() == self.headers.len();
        let is_name = is_whole && (plan.kinds.first() != Some(&Kind::Number) || is_spreadsheets(first));
        if remark(first).is_some() && !is_name {
            self.remarks += 1;
            return Ok(Role::Passed);
        }
        if record.iter().all(is_empty) {
            // Spreadsheets write rows of separators alone below their last.
            return Ok(if record.len() < self.named { self.short(record, line) } else { Role::Passed });
        }
        if record.len() < self.named {
            return Ok(self.short(record, line));
        }
        if !record.iter().skip(self.headers.len()).all(is_empty) {
            return Err(self.wrong_count(record, line));
        }
        if self.rows == 0 && is_units_row(plan, |column| record.get(column).unwrap_or_default(), line)? {
            self.repair(line, "it is a row of units, which agree with the names");
            self.rows += 1;
            return Ok(Role::Passed);
        }
        if self.rows > 0 && first == self.headers[0].as_bytes() && self.is_header(record) {
            let message = "the header stands here again; give files that were put together one by one, or number them in a column `run`";
            return Err(Error::Csv { line, message: message.into() });
        }
        self.rows += 1;
        Ok(Role::Row)
    }

    /// Whether most cells that have to hold numbers hold words: a header that is not the first, as of files put together.
    pub(crate) fn is_another_header(&self, plan: &Plan, record: &ByteRecord) -> bool {
        let is_word = |column: usize| {
            let text = String::from_utf8_lossy(record.get(column).unwrap_or_default()).into_owned();
            text.trim().starts_with(char::is_alphabetic) && !is_missing(text.trim())
        };
        let needed: Vec<usize> = plan.needed().collect();
        let words = needed.iter().filter(|column| is_word(**column)).count();
        words >= 2 && 2 * words >= needed.len()
    }

    /// Takes note of a last line that breaks off.
    pub(crate) fn breaks_off(&mut self, found: usize, line: u64) {
        self.repairs.push(Repair {
            place: format!("line {line}, the last"),
            what: format!("it breaks off after {found} of {} cells; it was left out", self.headers.len()),
        });
    }

    /// What was passed over, and how numbers were read.
    pub(crate) fn repairs(mut self) -> Vec<Repair> {
        if self.remarks > 0 {
            let what = format!("{} are remarks and were passed over", self.remarks);
            self.repairs.push(Repair { place: "lines".into(), what });
        }
        if let Some(line) = self.spelling.decimal_comma() {
            self.repair(line, "numbers here and below were read with a decimal comma");
        }
        if let Some(line) = self.spelling.calendar() {
            self.repair(line, "times here and below were read as dates or times of the clock, by UTC where no offset is given and whatever unit a map gives");
        }
        self.repairs
    }

    fn repair(&mut self, line: u64, what: &str) {
        self.repairs.push(Repair { place: format!("line {line}"), what: what.into() });
    }

    fn is_header(&self, record: &ByteRecord) -> bool {
        record.iter().zip(&self.headers).all(|(cell, header)| cell.trim_ascii() == header.as_bytes())
    }

    fn short(&self, record: &ByteRecord, line: u64) -> Role {
        Role::Short(record.len(), self.wrong_count(record, line))
    }

    fn wrong_count(&self, record: &ByteRecord, line: u64) -> Error {
        let (found, expected) = (record.len(), self.headers.len());
        let is_whole =
            |cell: &[u8]| !cell.is_empty() && cell.iter().all(|byte| byte.is_ascii_digit() || *byte == b'-');
        let halves = found > expected && record.iter().filter(|cell| is_whole(cell)).count() > found / 2;
        // R numbers rows from 1, without a name above.
        let has_row_names = self.rows == 0 && found == expected + 1 && record.get(0) == Some(b"1");
        let remedy = match self.separator {
            _ if has_row_names => {
                "the header is one name short, as R writes it beside row names: write with `row.names = FALSE`, or name the first column"
            }
            Separator::Byte(b',') if halves => {
                "if decimals stand behind a comma, write a decimal point, or separate cells by semicolons"
            }
            Separator::Spaces => {
                "where spaces separate cells, write `nan` for a gap and no space within a cell"
            }
            Separator::Byte(_) => "mend or remove the line",
        };
        Error::Csv { line, message: format!("{found} cells, but the header has {expected}; {remedy}") }
    }
}
