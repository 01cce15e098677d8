//! Text with a header line and cells separated by commas, semicolons, tabs, bars or spaces.

use std::io::Read;

use crate::{
    Error, Map, Repair,
    cell::shown,
    column::{Column, Kind, NOT_A_NUMBER, Plan},
    csv_rows::{Role, Rows},
    csv_text::CsvText,
    error::Position,
    label_column::MOST_NAMES,
    reading::Part,
    table::Table,
    watch::Budget,
};

/// Remedy for words where a row of numbers should stand.
const ANOTHER_HEADER: &str =
    "the line looks like another header: give files that were put together one by one";

/// What is said of a package that breaks off.
const BROKEN_PACKAGE: &str = "the package of the file breaks off behind this line; what is whole was read, and the rest of the drive is missing";

/// Reads a text table in one pass, whatever it is packed with, encoded in and separated by.
pub(crate) fn read(
    source: impl Read + 'static,
    name: &str,
    map: Option<&Map>,
    budget: &Budget,
) -> Result<Part, Error> {
    let mut text = CsvText::open(source)?;
    if text.advance()?.is_none() {
        return Err(Error::Empty { found: "an empty file".into() });
    }
    let headers = text.headers();
    text.refuse_what_is_no_header(&headers)?;
    let mut plan = Plan::new(headers.clone(), map)?;
    let mut table = Table::new(&plan, budget.clone());
    let mut rows = Rows::new(text.dialect(), &headers);
    let mut lines = Lines::default();
    let is_time: Vec<bool> = (0..headers.len()).map(|column| plan.is_time(column)).collect();
    while let Some(line) = text.advance()? {
        match rows.role(&plan, text.record(), line)? {
            Role::Row => {}
            Role::Passed => continue,
            Role::Short(found, error) => {
                // A line that breaks off at the end of the file is what a full disk or a lost battery leaves behind.
                if text.advance().is_ok_and(|next| next.is_some()) {
                    return Err(error);
                }
                rows.breaks_off(found, line);
                break;
            }
        }
        lines.push(line);
        for (index, column) in table.columns.iter_mut().enumerate() {
            let cell = text.record().get(index).unwrap_or_default();
            let kind = plan.kinds[index];
            match column {
                Column::Numbers(values) if kind == Kind::Perhaps => match rows.spelling.perhaps(cell) {
                    Some(value) => values.push(value),
                    None => {
                        *column = Column::Unusable(format!("{NOT_A_NUMBER} in line {line}"));
                    }
                },
                Column::Numbers(values) => {
                    let read = if is_time[index] {
                        rows.spelling.time(cell, line)
                    } else {
                        rows.spelling.number(cell, line)
                    };
                    values.push(read.map_err(|remedy| {
                        let is_header = rows.is_another_header(&plan, text.record());
                        let remedy = if is_header { ANOTHER_HEADER.to_owned() } else { remedy };
                        number_error(&headers[index], cell, line, remedy)
                    })?);
                }
                Column::Labels(labels) => {
                    let is_room = labels.push(String::from_utf8_lossy(cell).trim());
                    if !is_room {
                        let (position, column) = (Position::Line(line), headers[index].clone());
                        return Err(Error::TooManyNames { position, column, most: MOST_NAMES });
                    }
                }
                Column::Unusable(_) => {}
            }
        }
        table.end_rows(1)?;
    }
    if let (Some(time), Some(_)) = (plan.time(), rows.spelling.calendar()) {
        plan.calendar_time(time);
    }
    let (recording, mut report) = plan.assemble(table, name, |row| Position::Line(lines.of(row)))?;
    report.repairs.extend(rows.repairs());
    if text.is_cut_off() {
        let place = format!("line {}", lines.last());
        report.repairs.push(Repair { place, what: BROKEN_PACKAGE.into() });
    }
    Ok(Part { recording, report, found: headers, format: "CSV" })
}

fn number_error(column: &str, cell: &[u8], line: u64, remedy: String) -> Error {
    Error::Number { position: Position::Line(line), column: column.to_owned(), found: shown(cell), remedy }
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

    /// The line of the last row.
    fn last(&self) -> u64 {
        self.of(self.rows.saturating_sub(1))
    }

    fn of(&self, row: usize) -> u64 {
        let after = self.shifts.partition_point(|shift| shift.0 <= row);
        let shift = after.checked_sub(1).and_then(|at| self.shifts.get(at)).map_or(0, |shift| shift.1);
        row as u64 + shift
    }
}
