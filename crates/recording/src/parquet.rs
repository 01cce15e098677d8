//! Parquet with the columns of the CSV format.

use std::{
    cell::Cell,
    collections::HashMap,
    panic::{AssertUnwindSafe, catch_unwind},
};

use ::parquet::{
    column::reader::{ColumnReader, ColumnReaderImpl, get_column_reader},
    data_type::{ByteArray, DataType},
    file::reader::{ChunkReader, FileReader, SerializedFileReader},
    schema::types::ColumnDescriptor,
};

use crate::{
    Conversion, Error, Map, Quantity, arrow_schema,
    column::{Column, Kind, Plan},
    error::Position,
    label_column::{LabelColumn, MOST_NAMES},
    pages::Pages,
    parquet_type::{decimal_factor, is_unsigned, refuse_type, time_unit},
    reading::Part,
    table::Table,
    watch::Budget,
};

/// Rows read at a time: small enough to stay in the cache while they are widened.
const BATCH_ROWS: usize = 8192;

/// Most rows that a file may claim: constant columns take hardly any bytes, so that a damaged one may claim without end. At
/// 1 kHz it is four years.
const MOST_ROWS: u64 = 1 << 37;

/// Reads every row group, all columns side by side.
pub(crate) fn read(
    source: impl ChunkReader + 'static,
    name: &str,
    map: Option<&Map>,
    budget: &Budget,
) -> Result<Part, Error> {
    // The library asserts some of what a damaged file may say (negative offsets among it). Nothing of it outlives the
    // closure, so that stopping in the middle leaves nothing half done.
    let read = AssertUnwindSafe(|| read_file(source, name, map, budget));
    catch_unwind(read).unwrap_or_else(|_| Err(damaged()))
}

fn damaged() -> Error {
    let reason = "its contents contradict one another; it is damaged".into();
    Error::NotTheFormat { format: "Parquet", reason }
}

fn read_file(
    source: impl ChunkReader + 'static,
    name: &str,
    map: Option<&Map>,
    budget: &Budget,
) -> Result<Part, Error> {
    let file_bytes = source.len();
    let file = SerializedFileReader::new(source)?;
    refuse_contradictions(&file, file_bytes)?;
    let schema = file.metadata().file_metadata().schema_descr_ptr();
    let headers: Vec<String> = schema.columns().iter().map(|column| column.path().string()).collect();
    let mut plan = Plan::new(headers.clone(), map)?;
    let mut table = Table::new(&plan, budget.clone());
    let mut sources = Vec::with_capacity(headers.len());
    let durations = durations_of(&file);
    for index in 0..headers.len() {
        let descriptor = schema.column(index);
        let unit = time_unit(&descriptor, &durations);
        if let Some(own) = unit {
            plan.typed_time(index, own)?;
        }
        sources.push(Source::new(&descriptor, plan.kinds[index], unit, &mut table.columns[index])?);
    }
    let mut before = 0;
    for group in 0..file.num_row_groups() {
        let group = file.get_row_group(group)?;
        let readers = (0..sources.len()).map(|index| {
            let pages = Pages { source: group.get_column_page_reader(index)?, name: headers[index].clone() };
            Ok::<_, Error>(get_column_reader(schema.column(index), Box::new(pages)))
        });
        let mut readers = readers.collect::<Result<Vec<ColumnReader>, Error>>()?;
        loop {
            let mut rows = None;
            for ((reader, source), column) in readers.iter_mut().zip(&sources).zip(&mut table.columns) {
                if matches!(column, Column::Unusable(_)) {
                    continue;
                }
                let read = source.read(reader, column, before)?;
                if *rows.get_or_insert(read) != read && !matches!(column, Column::Unusable(_)) {
                    return Err(damaged());
                }
            }
            let Some(rows @ 1..) = rows else { break };
            before += rows as u64;
            table.end_rows(rows)?;
        }
    }
    let (recording, report) = plan.assemble(table, name, |row| Position::Row(row as u64 + 1))?;
    Ok(Part { recording, report, found: headers, format: "Parquet" })
}

/// The duration columns of a file that Arrow wrote, with their units.
fn durations_of<R: ChunkReader + 'static>(file: &SerializedFileReader<R>) -> HashMap<String, &'static str> {
    let pairs = file.metadata().file_metadata().key_value_metadata();
    let schema = pairs.and_then(|pairs| pairs.iter().find(|pair| pair.key == arrow_schema::KEY));
    schema.and_then(|pair| pair.value.as_deref()).map(arrow_schema::durations).unwrap_or_default()
}

/// Refuses columns that lie outside the file before anything of their size is allocated.
fn refuse_contradictions<R: ChunkReader + 'static>(
    file: &SerializedFileReader<R>,
    file_bytes: u64,
) -> Result<(), Error> {
    let groups = file.metadata().row_groups().iter();
    let rows = groups.map(|group| u64::try_from(group.num_rows()).unwrap_or(u64::MAX));
    let rows = rows.fold(0u64, u64::saturating_add);
    if rows > MOST_ROWS {
        return Err(Error::Claims { rows });
    }
    for group in file.metadata().row_groups() {
        for column in group.columns() {
            let start = column.dictionary_page_offset().unwrap_or(column.data_page_offset());
            let end = start.checked_add(column.compressed_size());
            let inside = |at: i64| u64::try_from(at).is_ok_and(|at| at <= file_bytes);
            if !inside(start) || column.compressed_size() < 0 || !end.is_some_and(inside) {
                let reason = format!("column `{}` lies outside the file", column.column_path().string());
                return Err(Error::NotTheFormat { format: "Parquet", reason });
            }
        }
    }
    Ok(())
}

/// What is to be read of a column.
struct Source {
    name: String,
    kind: Kind,
    /// Definition level of a value that is there.
    full: i16,
    /// What a stored number is multiplied with.
    scale: f64,
    is_unsigned: bool,
}

impl Source {
    fn new(
        descriptor: &ColumnDescriptor,
        kind: Kind,
        unit: Option<&str>,
        column: &mut Column,
    ) -> Result<Source, Error> {
        let (name, full) = (descriptor.path().string(), descriptor.max_def_level());
        let in_seconds = unit.and_then(|unit| Conversion::from_unit(Quantity::Time, unit, None));
        if let Err(found) = refuse_type(descriptor, kind) {
            if kind != Kind::Perhaps {
                let remedy = if kind == Kind::Label { "text or an integer" } else { "a double" };
                let (topic, reason) = ("of the table".into(), format!("{found}; write it as {remedy}"));
                return Err(Error::Field { topic, field: name, reason });
            }
            *column = Column::Unusable(found);
        }
        let scale = in_seconds.map_or_else(|| decimal_factor(descriptor), |unit| unit.factor);
        Ok(Source { name, kind, full, scale, is_unsigned: is_unsigned(descriptor) })
    }

    /// Reads the next rows into the column and says how many; so many were read before.
    fn read(&self, reader: &mut ColumnReader, column: &mut Column, before: u64) -> Result<usize, Error> {
        let rows = match (reader, &mut *column) {
            (ColumnReader::DoubleColumnReader(r), Column::Numbers(v)) => self.numbers(r, v, |x| *x)?,
            (ColumnReader::FloatColumnReader(r), Column::Numbers(v)) => {
                self.numbers(r, v, |x| f64::from(*x))?
            }
            (ColumnReader::Int32ColumnReader(r), Column::Numbers(v)) if self.is_unsigned => {
                self.numbers(r, v, |x| f64::from(x.cast_unsigned()))?
            }
            (ColumnReader::Int64ColumnReader(r), Column::Numbers(v)) if self.is_unsigned => {
                self.numbers(r, v, |x| x.cast_unsigned() as f64)?
            }
            (ColumnReader::Int32ColumnReader(r), Column::Numbers(v)) => {
                self.numbers(r, v, |x| f64::from(*x))?
            }
            (ColumnReader::Int64ColumnReader(r), Column::Numbers(v)) => self.numbers(r, v, |x| *x as f64)?,
            // Timestamps of older Spark and Impala, in nanoseconds.
            (ColumnReader::Int96ColumnReader(r), Column::Numbers(v)) => {
                self.numbers(r, v, |x| x.to_nanos() as f64)?
            }
            (ColumnReader::BoolColumnReader(r), Column::Numbers(v)) => {
                self.numbers(r, v, |x| f64::from(u8::from(*x)))?
            }
            (ColumnReader::ByteArrayColumnReader(r), Column::Numbers(v)) => {
                self.numbers(r, v, |x| big_endian(x.data()))?
            }
            (ColumnReader::FixedLenByteArrayColumnReader(r), Column::Numbers(v)) => {
                self.numbers(r, v, |x| big_endian(x.data()))?
            }
            (ColumnReader::ByteArrayColumnReader(r), Column::Labels(labels)) => {
                self.labels(r, labels, before, |text: &ByteArray| {
                    text.as_utf8().unwrap_or_default().to_owned()
                })?
            }
            (ColumnReader::Int32ColumnReader(r), Column::Labels(labels)) => {
                self.labels(r, labels, before, i32::to_string)?
            }
            (ColumnReader::Int64ColumnReader(r), Column::Labels(labels)) => {
                self.labels(r, labels, before, i64::to_string)?
            }
            (ColumnReader::DoubleColumnReader(r), Column::Labels(labels)) => {
                self.whole_labels(r, labels, before, |x| *x)?
            }
            (ColumnReader::FloatColumnReader(r), Column::Labels(labels)) => {
                self.whole_labels(r, labels, before, |x| f64::from(*x))?
            }
            _ => {
                *column = Column::Unusable("its type changes within the file".into());
                return Ok(0);
            }
        };
        if let (Kind::Number, Column::Numbers(values)) = (self.kind, &*column) {
            let new = &values[values.len() - rows..];
            if let Some(row) = new.iter().position(|value| value.is_infinite()) {
                let (position, column) = (Position::Row(before + row as u64 + 1), self.name.clone());
                let (found, remedy) = (format!("{}", new[row]), "write null for a gap".into());
                return Err(Error::Number { position, column, found, remedy });
            }
        }
        Ok(rows)
    }

    fn numbers<T: DataType>(
        &self,
        reader: &mut ColumnReaderImpl<T>,
        values: &mut Vec<f64>,
        widen: impl Fn(&T::T) -> f64,
    ) -> Result<usize, Error> {
        for_each(reader, self.full, |value| values.push(value.map_or(f64::NAN, |x| widen(x) * self.scale)))
    }

    /// Reads whole numbers as names: pandas turns integers into doubles where one is missing, which is NaN then.
    fn whole_labels<T: DataType>(
        &self,
        reader: &mut ColumnReaderImpl<T>,
        labels: &mut LabelColumn,
        before: u64,
        widen: impl Fn(&T::T) -> f64,
    ) -> Result<usize, Error> {
        let broken = Cell::new(None);
        let text = |number: &T::T| {
            let number = widen(number);
            if number.is_nan() {
                return String::new();
            }
            if number.fract() != 0.0 {
                broken.set(broken.get().or(Some(number)));
            }
            format!("{number}")
        };
        let rows = self.labels(reader, labels, before, text)?;
        match broken.get() {
            None => Ok(rows),
            Some(number) => {
                let reason = format!("it holds {number}, no whole number; write it as text or an integer");
                Err(Error::Field { topic: "of the table".into(), field: self.name.clone(), reason })
            }
        }
    }

    fn labels<T: DataType>(
        &self,
        reader: &mut ColumnReaderImpl<T>,
        labels: &mut LabelColumn,
        before: u64,
        text: impl Fn(&T::T) -> String,
    ) -> Result<usize, Error> {
        let (mut row, mut too_many) = (before, None);
        let rows = for_each(reader, self.full, |name| {
            row += 1;
            if !labels.push(&name.map_or(String::new(), &text)) {
                too_many.get_or_insert(row);
            }
        })?;
        match too_many {
            Some(row) => {
                let (position, column) = (Position::Row(row), self.name.clone());
                Err(Error::TooManyNames { position, column, most: MOST_NAMES })
            }
            None => Ok(rows),
        }
    }
}

/// The whole number of a decimal in bytes: two's complement, the highest byte first (Parquet format, logical types, `DECIMAL`).
fn big_endian(bytes: &[u8]) -> f64 {
    let negative = bytes.first().is_some_and(|byte| byte & 0x80 != 0);
    let magnitude = |byte: &u8| if negative { !byte } else { *byte };
    let whole = bytes.iter().map(magnitude).fold(0.0, |whole, byte| 256.0 * whole + f64::from(byte));
    if negative { -whole - 1.0 } else { whole }
}

/// Calls with every value of the next rows of a column chunk, `None` for nulls: those whose definition level is not the full one.
/// Says how many rows there were.
fn for_each<T: DataType>(
    reader: &mut ColumnReaderImpl<T>,
    full: i16,
    mut take: impl FnMut(Option<&T::T>),
) -> Result<usize, Error> {
    let (mut batch, mut levels) = (Vec::with_capacity(BATCH_ROWS), Vec::new());
    let mut read = 0;
    while read < BATCH_ROWS {
        batch.clear();
        levels.clear();
        let levels_wanted = (full > 0).then_some(&mut levels);
        let (rows, found, _) = reader.read_records(BATCH_ROWS - read, levels_wanted, None, &mut batch)?;
        if rows == 0 && found == 0 {
            break;
        }
        if full == 0 {
            read += batch.len();
            batch.iter().for_each(|value| take(Some(value)));
            continue;
        }
        read += levels.len();
        let mut values = batch.iter();
        for level in &levels {
            take(if *level == full { values.next() } else { None });
        }
    }
    Ok(read)
}
