//! Recordings from columns that are in memory already, as those of a data frame.

use std::borrow::Cow;

use crate::{
    Conversion, Error, Map, Quantity, Reading, Recording, Room, Watch,
    column::{Column, Kind, Plan},
    error::Position,
    label_column::{LabelColumn, MOST_NAMES},
    reading::{Part, of_columns},
    table::Table,
    watch::{Budget, Looks, ROWS_A_LOOK},
};

/// A column of a table in memory.
#[derive(Clone, Debug, PartialEq)]
pub struct NamedColumn<'a> {
    /// Its name, as the header of a file has it.
    pub name: String,
    /// What it holds.
    pub values: ColumnValues<'a>,
}

/// The values of a column by row.
#[derive(Clone, Debug, PartialEq)]
pub enum ColumnValues<'a> {
    /// Numbers; NaN is a gap.
    Numbers(Cow<'a, [f64]>),
    /// Times in a unit that the column's type states, as nanoseconds since 1970; NaN is a gap.
    Times {
        /// The times in that unit.
        values: Cow<'a, [f64]>,
        /// `"s"`, `"ms"`, `"us"` or `"ns"`.
        unit: &'static str,
    },
    /// Texts: the distinct ones, and by row the index of its own; indices beyond them are rows without a text.
    Texts {
        /// The distinct texts.
        names: Vec<String>,
        /// By row, the index of its text.
        index: Cow<'a, [u32]>,
    },
    /// Values of no use, and what they are, as "it holds lists".
    Unusable {
        /// What it holds.
        reason: String,
        /// Number of rows.
        rows: usize,
    },
}

impl ColumnValues<'_> {
    /// Number of rows.
    pub fn rows(&self) -> usize {
        match self {
            ColumnValues::Numbers(values) | ColumnValues::Times { values, .. } => values.len(),
            ColumnValues::Texts { index, .. } => index.len(),
            ColumnValues::Unusable { rows, .. } => *rows,
        }
    }
}

impl Recording {
    /// A recording from columns, by the rules and with the checks of a table's file: a map first, then the contract's names; what is
    /// no channel is kept aside. `name` becomes that of the run where there is no column `run`.
    ///
    /// ```
    /// use recording::{Channel, ColumnValues, NamedColumn, Recording, unwatched};
    /// let column = |name: &str, values: &[f64]| NamedColumn {
    ///     name: name.to_owned(),
    ///     values: ColumnValues::Numbers(values.to_vec().into()),
    /// };
    /// let table = [
    ///     column("t_s", &[0.0, 0.1, 0.2]),
    ///     column("v_left_mps", &[0.5; 3]),
    ///     column("v_right_mps", &[0.5; 3]),
    ///     column("power_w", &[80.0, f64::NAN, 82.0]),
    /// ];
    /// let reading = Recording::from_columns(&table, "drive", None, &unwatched())?;
    /// assert_eq!(reading.recording.rows(), 3);
    /// assert!(reading.recording.channel(Channel::Power).is_some_and(|power_w| power_w[1].is_nan()));
    /// # Ok::<(), recording::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of a file, with rows for places; [`Error::Ragged`] where columns differ in length; [`Error::Stopped`] when the watch breaks.
    pub fn from_columns(
        columns: &[NamedColumn<'_>],
        name: &str,
        map: Option<&Map>,
        watch: &Watch,
    ) -> Result<Reading, Error> {
        let looks = Looks::new(watch);
        let part = part_of(columns, name, of_columns(map), &looks)?;
        Reading::finish(part, name, map, &looks)
    }
}

fn part_of(columns: &[NamedColumn<'_>], name: &str, map: Option<&Map>, looks: &Looks) -> Result<Part, Error> {
    let rows = columns.first().map_or(0, |column| column.values.rows());
    refuse_ragged(columns, rows)?;
    let headers: Vec<String> = columns.iter().map(|column| column.name.clone()).collect();
    let mut plan = Plan::new(headers.clone(), map)?;
    let mut table = Table::new(&plan, Budget { room: Room::default(), looks: looks.clone() });
    let mut sources = Vec::with_capacity(columns.len());
    for (index, column) in columns.iter().enumerate() {
        if let ColumnValues::Times { unit, .. } = column.values {
            plan.typed_time(index, unit)?;
        }
        sources.push(Source::new(column, plan.kinds[index], &mut table.columns[index])?);
    }
    for from in (0..rows).step_by(ROWS_A_LOOK) {
        let until = rows.min(from + ROWS_A_LOOK);
        for (source, column) in sources.iter().zip(&mut table.columns) {
            source.read(from, until, column)?;
        }
        table.end_rows(until - from)?;
    }
    let (recording, report) = plan.assemble(table, name, |row| Position::Row(row as u64 + 1))?;
    Ok(Part { recording, report, found: headers, format: "columns" })
}

fn refuse_ragged(columns: &[NamedColumn<'_>], expected: usize) -> Result<(), Error> {
    let Some(other) = columns.iter().find(|column| column.values.rows() != expected) else { return Ok(()) };
    let first = columns.first().map_or(String::new(), |column| column.name.clone());
    Err(Error::Ragged { column: other.name.clone(), rows: other.values.rows(), first, expected })
}

/// A column and how it is read.
struct Source<'a> {
    column: &'a NamedColumn<'a>,
    kind: Kind,
    /// What a number is multiplied with.
    scale: f64,
}

impl<'a> Source<'a> {
    fn new(column: &'a NamedColumn<'a>, kind: Kind, into: &mut Column) -> Result<Source<'a>, Error> {
        let wrong = match (&column.values, kind) {
            (ColumnValues::Unusable { reason, .. }, _) => Some(reason.clone()),
            (ColumnValues::Texts { .. }, Kind::Number | Kind::Perhaps) => Some("it holds text".to_owned()),
            _ => None,
        };
        if let Some(found) = wrong {
            if kind != Kind::Perhaps {
                let remedy = if kind == Kind::Label { "text or whole numbers" } else { "numbers" };
                let (topic, reason) = ("of the table".into(), format!("{found}; give {remedy}"));
                return Err(Error::Field { topic, field: column.name.clone(), reason });
            }
            *into = Column::Unusable(found);
        }
        let unit = match column.values {
            ColumnValues::Times { unit, .. } => Conversion::from_unit(Quantity::Time, unit, None),
            _ => None,
        };
        Ok(Source { column, kind, scale: unit.map_or(1.0, |unit| unit.factor) })
    }

    /// Adds the rows from one to before another.
    fn read(&self, from: usize, until: usize, into: &mut Column) -> Result<(), Error> {
        match (&self.column.values, into) {
            (ColumnValues::Numbers(values) | ColumnValues::Times { values, .. }, Column::Numbers(into)) => {
                self.refuse_infinite(values, from, until)?;
                match self.scale {
                    1.0 => into.extend_from_slice(&values[from..until]),
                    scale => into.extend(values[from..until].iter().map(|value| value * scale)),
                }
            }
            (ColumnValues::Numbers(values) | ColumnValues::Times { values, .. }, Column::Labels(into)) => {
                for (row, value) in values[from..until].iter().enumerate() {
                    self.push(&self.whole(*value, from + row)?, from + row, into)?;
                }
            }
            (ColumnValues::Texts { names, index }, Column::Labels(into)) => {
                for (row, place) in index[from..until].iter().enumerate() {
                    let name = names.get(*place as usize).map_or("", String::as_str);
                    self.push(name.trim(), from + row, into)?;
                }
            }
            _ => {}
        }
        Ok(())
    }

    fn push(&self, name: &str, row: usize, into: &mut LabelColumn) -> Result<(), Error> {
        if into.push(name) {
            return Ok(());
        }
        let (position, column) = (Position::Row(row as u64 + 1), self.column.name.clone());
        Err(Error::TooManyNames { position, column, most: MOST_NAMES })
    }

    /// A whole number as a name: data frames turn integers into doubles where one is missing, which is NaN then.
    fn whole(&self, value: f64, row: usize) -> Result<String, Error> {
        if value.is_nan() {
            return Ok(String::new());
        }
        if value.fract() == 0.0 {
            return Ok(format!("{value}"));
        }
        Err(self.refused(value, row, "give text or whole numbers"))
    }

    fn refuse_infinite(&self, values: &[f64], from: usize, until: usize) -> Result<(), Error> {
        if self.kind != Kind::Number {
            return Ok(());
        }
        match values[from..until].iter().position(|value| value.is_infinite()) {
            Some(row) => Err(self.refused(values[from + row], from + row, "give NaN for a gap")),
            None => Ok(()),
        }
    }

    fn refused(&self, value: f64, row: usize, remedy: &str) -> Error {
        Error::Number {
            position: Position::Row(row as u64 + 1),
            column: self.column.name.clone(),
            found: format!("{value}"),
            remedy: remedy.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Channel, Format, TimeError, read, unwatched};

    fn numbers<'a>(name: &str, values: impl Into<Cow<'a, [f64]>>) -> NamedColumn<'a> {
        NamedColumn { name: name.into(), values: ColumnValues::Numbers(values.into()) }
    }

    fn texts<'a>(name: &str, names: &[&str], index: Vec<u32>) -> NamedColumn<'a> {
        let names = names.iter().map(|name| (*name).to_owned()).collect();
        NamedColumn { name: name.into(), values: ColumnValues::Texts { names, index: index.into() } }
    }

    /// A drive of two runs, with text, a gap and a column that is no channel.
    fn drive() -> Vec<NamedColumn<'static>> {
        vec![
            numbers("t_s", vec![0.0, 0.1, 0.2, 0.0, 0.1]),
            numbers("v_left_mps", vec![0.5; 5]),
            numbers("v_right_mps", vec![0.5, 0.6, 0.5, 0.4, 0.5]),
            numbers("power_w", vec![80.0, 81.0, f64::NAN, 79.0, 80.5]),
            numbers("run", vec![1.0, 1.0, 1.0, 2.0, 2.0]),
            texts("surface", &["ice", "mud"], vec![0, 0, 1, u32::MAX, 1]),
            numbers("gear", vec![1.0, 2.0, 2.0, 1.0, 1.0]),
        ]
    }

    fn from(columns: &[NamedColumn<'_>]) -> Result<Reading, Error> {
        Recording::from_columns(columns, "drive", None, &unwatched())
    }

    #[test]
    fn columns_are_the_recording_that_their_file_is() {
        let text = "t_s,v_left_mps,v_right_mps,power_w,run,surface,gear\n0,0.5,0.5,80,1,ice,1\n0.1,0.5,0.6,81,1,ice,2\n\
                    0.2,0.5,0.5,,1,mud,2\n0,0.5,0.4,79,2,,1\n0.1,0.5,0.5,80.5,2,mud,1\n";
        let file = read(text.into(), Format::Csv, "drive", None).unwrap();
        let reading = from(&drive()).unwrap();
        // NaN is not NaN, so that what is printed is compared.
        assert_eq!(format!("{:?}", reading.recording), format!("{:?}", file.recording));
        assert_eq!(reading.report.aside, file.report.aside);
        assert_eq!(reading.report.format, "columns");
    }

    #[test]
    fn what_a_file_is_refused_for_columns_are_refused_for() {
        let without =
            |name: &str| drive().into_iter().filter(|column| column.name != name).collect::<Vec<_>>();
        let with = |column: NamedColumn<'static>| {
            let mut columns = without(&column.name);
            columns.push(column);
            columns
        };
        let refused = |columns: &[NamedColumn<'_>]| from(columns).unwrap_err().to_string();
        assert!(matches!(from(&without("power_w")), Err(Error::Missing { .. })));
        assert!(matches!(from(&without("t_s")), Err(Error::Missing { .. })));
        let back = with(numbers("t_s", vec![0.0, 0.2, 0.1, 0.0, 0.1]));
        assert!(matches!(from(&back), Err(Error::Time(TimeError::TimeOrder { .. }))));
        assert!(refused(&back).contains("row 3"), "{}", refused(&back));
        let infinite = with(numbers("power_w", vec![1.0, 2.0, f64::INFINITY, 3.0, 4.0]));
        assert!(refused(&infinite).contains("row 3, column `power_w`: `inf`"), "{}", refused(&infinite));
        let text = with(texts("power_w", &["80 W"], vec![0; 5]));
        assert!(refused(&text).contains("`power_w`: it holds text; give numbers"), "{}", refused(&text));
        let broken = with(numbers("run", vec![1.0, 1.0, 1.5, 2.0, 2.0]));
        assert!(refused(&broken).contains("row 3, column `run`: `1.5`"), "{}", refused(&broken));
        let mut twice = drive();
        twice.push(numbers("power_w", vec![0.0; 5]));
        assert!(matches!(from(&twice), Err(Error::Duplicate { .. })));
        let ragged = with(numbers("power_w", vec![80.0; 4]));
        assert!(refused(&ragged).contains("`power_w` has 4 rows, but `t_s` has 5"), "{}", refused(&ragged));
        assert!(matches!(from(&[]), Err(Error::Missing { .. })));
    }

    #[test]
    fn times_of_a_typed_column_are_seconds() {
        let mut columns = drive();
        let values = [0.0, 0.1, 0.2, 0.0, 0.1].map(|t_s| 1e9 * t_s + 1.7e18).to_vec();
        columns[0].values = ColumnValues::Times { values: values.into(), unit: "ns" };
        let t_s = from(&columns).unwrap().recording.t_s;
        assert!((t_s[2] - t_s[0] - 0.2).abs() < 1e-6, "{t_s:?}");
    }

    #[test]
    fn more_rows_than_there_is_room_for_become_means_as_those_of_a_file() {
        let rows = 1_200_000;
        let t_s: Vec<f64> = (0..rows).map(|row| f64::from(row) * 0.01).collect();
        let constant = vec![0.5; rows as usize];
        let columns = [
            numbers("t_s", &t_s[..]),
            numbers("v_left_mps", &constant[..]),
            numbers("v_right_mps", &constant[..]),
            numbers("power_w", &constant[..]),
        ];
        let reading = from(&columns).unwrap();
        assert!(reading.recording.rows() < 1_100_000 && reading.recording.rows() > 300_000);
        assert_eq!(reading.recording.channel(Channel::Power).unwrap()[7], 0.5);
        assert!(
            reading.report.repairs[0].what.contains("more than are held"),
            "{:?}",
            reading.report.repairs
        );
    }
}
