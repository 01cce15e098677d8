//! Comma-separated text.

use std::io::{BufRead, BufReader, Read};

use ::csv::{ByteRecord, ErrorKind, ReaderBuilder};

use crate::{
    Error, Map, Repair,
    column::{Column, Kind, Plan},
    error::{Position, excerpt},
    label_column::MOST_NAMES,
    reading::{Part, Reading},
    table::Table,
    watch::Budget,
};

/// Bytes read at a time: large enough that calls to the system do not matter, small against any file that takes long.
const BUFFER_BYTES: usize = 1 << 20;

/// Reads comma-, semicolon- or tab-separated text with a header line, in one pass.
pub(crate) fn read(
    source: impl Read,
    name: &str,
    map: Option<&Map>,
    budget: &Budget,
) -> Result<Reading, Error> {
    let mut source = BufReader::with_capacity(BUFFER_BYTES, source);
    let beginning = source.fill_buf()?;
    let delimiter = delimiter(beginning);
    // The parser ends a line at the carriage return and counts the newline with the next line.
    let returns = first_line(beginning).ends_with(b"\r");
    let mut reader =
        ReaderBuilder::new().delimiter(delimiter).has_headers(false).flexible(true).from_reader(source);
    let mut record = ByteRecord::new();
    let headers = match reader.read_byte_record(&mut record) {
        Ok(true) => headers(&record)?,
        Ok(false) => return Err(Error::Empty { found: "an empty file".into() }),
        Err(error) => return Err(csv_error(&error)),
    };
    let plan = Plan::new(headers.clone(), map)?;
    let mut table = Table::new(&plan, budget.clone());
    let mut lines = Lines::default();
    let mut repairs = Vec::new();
    while reader.read_byte_record(&mut record).map_err(|error| csv_error(&error))? {
        let line = line_of(&record, reader.position().line()) + u64::from(returns);
        if record.len() != headers.len() {
            let (found, expected) = (record.len(), headers.len());
            // A line that breaks off at the end of the file is what a full disk or a lost battery leaves behind.
            if found < expected && !reader.read_byte_record(&mut ByteRecord::new()).unwrap_or(true) {
                repairs.push(Repair {
                    place: format!("line {line}, the last"),
                    what: format!("it breaks off after {found} of {expected} cells; it was left out"),
                });
                break;
            }
            let message = format!("{found} cells, but the header has {expected}; mend or remove the line");
            return Err(Error::Csv { line, message });
        }
        lines.push(line);
        for (index, cell) in record.iter().enumerate() {
            push(&mut table.columns[index], plan.kinds[index], cell, &headers[index], line)?;
        }
        table.end_rows(1)?;
    }
    let (recording, mut report) = plan.assemble(table, name, |row| Position::Line(lines.of(row)))?;
    report.repairs.extend(repairs);
    let found = headers;
    Reading::finish(Part { recording, report, found, format: "CSV" }, name, map, &budget.looks)
}

/// The delimiter that the header line has most of; the comma when it has none.
fn delimiter(beginning: &[u8]) -> u8 {
    let header = first_line(beginning);
    let count = |delimiter: u8| header.iter().filter(|byte| **byte == delimiter).count();
    let most = [b'\t', b';', b','].into_iter().max_by_key(|delimiter| count(*delimiter));
    most.filter(|delimiter| count(*delimiter) > 0).unwrap_or(b',')
}

fn first_line(beginning: &[u8]) -> &[u8] {
    beginning.split(|byte| *byte == b'\n').next().unwrap_or_default()
}

/// The line that a record begins in. Where the parser began to look for it comes before blank lines; the line that it
/// stopped at comes behind breaks within quotes.
fn line_of(record: &ByteRecord, next_line: u64) -> u64 {
    let began = record.position().map_or(0, ::csv::Position::line);
    let breaks = record.as_slice().iter().filter(|byte| **byte == b'\n').count() as u64;
    began.max(next_line.saturating_sub(1 + breaks))
}

fn headers(record: &ByteRecord) -> Result<Vec<String>, Error> {
    let text = |cell: &[u8]| {
        let text = std::str::from_utf8(cell).map_err(|_| Error::NotTheFormat {
            format: "CSV",
            reason: "its first line is not UTF-8 text".into(),
        })?;
        Ok(text.trim_start_matches('\u{feff}').trim().to_owned())
    };
    record.iter().map(text).collect()
}

fn push(column: &mut Column, kind: Kind, cell: &[u8], name: &str, line: u64) -> Result<(), Error> {
    match column {
        Column::Numbers(values) => match number(cell) {
            Some(value) => values.push(value),
            None if kind == Kind::Perhaps => {
                *column = Column::Unusable(format!("no channel, and not a number in line {line}"));
            }
            None => {
                return Err(Error::Number {
                    position: Position::Line(line),
                    column: name.to_owned(),
                    found: excerpt(&String::from_utf8_lossy(cell)),
                });
            }
        },
        Column::Labels(labels) => {
            if !labels.push(String::from_utf8_lossy(cell).trim()) {
                let (position, column) = (Position::Line(line), name.to_owned());
                return Err(Error::TooManyNames { position, column, most: MOST_NAMES });
            }
        }
        Column::Unusable(_) => {}
    }
    Ok(())
}

/// A finite number, or NaN for an empty cell and for `nan`.
fn number(cell: &[u8]) -> Option<f64> {
    let cell = cell.trim_ascii();
    if cell.is_empty() {
        return Some(f64::NAN);
    }
    let value: f64 = std::str::from_utf8(cell).ok()?.parse().ok()?;
    (!value.is_infinite()).then_some(value)
}

fn csv_error(error: &::csv::Error) -> Error {
    let line = error.position().map_or(1, ::csv::Position::line);
    match error.kind() {
        ErrorKind::Io(io) => Error::Io(std::io::Error::new(io.kind(), io.to_string())),
        _ => Error::Csv { line, message: error.to_string() },
    }
}

/// The line of each row, kept only where blank lines or breaks within quotes shift it.
#[derive(Default)]
struct Lines {
    rows: usize,
    shifts: Vec<(usize, u64)>,
}

impl Lines {
    fn push(&mut self, line: u64) {
        let shift = line.saturating_sub(self.rows as u64);
        if self.shifts.last().is_none_or(|last| last.1 != shift) {
            self.shifts.push((self.rows, shift));
        }
        self.rows += 1;
    }

    fn of(&self, row: usize) -> u64 {
        let after = self.shifts.partition_point(|shift| shift.0 <= row);
        let shift = after.checked_sub(1).and_then(|at| self.shifts.get(at)).map_or(0, |shift| shift.1);
        row as u64 + shift
    }
}
