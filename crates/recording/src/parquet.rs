//! Parquet with the columns of the CSV format.

use std::{
    collections::HashMap,
    panic::{AssertUnwindSafe, catch_unwind},
};

use ::parquet::{
    basic::{ConvertedType, LogicalType, TimeUnit, Type as Physical},
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
    reading::{Part, Reading},
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
) -> Result<Reading, Error> {
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
) -> Result<Reading, Error> {
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
    let part = Part { recording, report, found: headers, format: "Parquet" };
    Reading::finish(part, name, map, &budget.looks)
}

/// The duration columns of a file that Arrow wrote, with their units.
fn durations_of<R: ChunkReader + 'static>(file: &SerializedFileReader<R>) -> HashMap<String, &'static str> {
    let pairs = file.metadata().file_metadata().key_value_metadata();
    let schema = pairs.and_then(|pairs| pairs.iter().find(|pair| pair.key == arrow_schema::KEY));
    schema.and_then(|pair| pair.value.as_deref()).map(arrow_schema::durations).unwrap_or_default()
}

/// The unit that a column of integers stores times in by its type, whatever the writer says it by; `None` for plain numbers.
fn time_unit(
    descriptor: &ColumnDescriptor,
    durations: &HashMap<String, &'static str>,
) -> Option<&'static str> {
    if descriptor.physical_type() == Physical::INT96 {
        return Some("ns");
    }
    if !matches!(descriptor.physical_type(), Physical::INT32 | Physical::INT64) {
        return None;
    }
    let symbol = |unit: &TimeUnit| match unit {
        TimeUnit::MILLIS => "ms",
        TimeUnit::MICROS => "us",
        TimeUnit::NANOS => "ns",
    };
    match (descriptor.logical_type_ref(), descriptor.converted_type()) {
        (Some(LogicalType::Timestamp(stamp)), _) => Some(symbol(&stamp.unit)),
        (Some(LogicalType::Time(time)), _) => Some(symbol(&time.unit)),
        (None, ConvertedType::TIMESTAMP_MILLIS | ConvertedType::TIME_MILLIS) => Some("ms"),
        (None, ConvertedType::TIMESTAMP_MICROS | ConvertedType::TIME_MICROS) => Some("us"),
        _ => {
            let [name] = descriptor.path().parts() else { return None };
            durations.get(name).copied()
        }
    }
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
        let scale = match refuse_type(descriptor, kind) {
            Ok(()) => in_seconds.map_or(1.0, |unit| unit.factor),
            Err(found) if kind == Kind::Perhaps => {
                *column = Column::Unusable(found);
                1.0
            }
            Err(found) => {
                let topic = "of the table".into();
                return Err(Error::Field {
                    topic,
                    field: name,
                    reason: format!("{found}; write it as a double"),
                });
            }
        };
        Ok(Source { name, kind, full, scale })
    }

    /// Reads the next rows into the column and says how many; so many were read before.
    fn read(&self, reader: &mut ColumnReader, column: &mut Column, before: u64) -> Result<usize, Error> {
        let rows = match (reader, &mut *column) {
            (ColumnReader::DoubleColumnReader(r), Column::Numbers(v)) => self.numbers(r, v, |x| *x)?,
            (ColumnReader::FloatColumnReader(r), Column::Numbers(v)) => {
                self.numbers(r, v, |x| f64::from(*x))?
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

/// Refuses, in words, what a column holds instead of what is wanted.
fn refuse_type(descriptor: &ColumnDescriptor, kind: Kind) -> Result<(), String> {
    if descriptor.max_rep_level() > 0 {
        return Err("it holds lists".into());
    }
    let physical = descriptor.physical_type();
    let text = matches!(physical, Physical::BYTE_ARRAY);
    if kind == Kind::Label {
        let whole = matches!(physical, Physical::INT32 | Physical::INT64);
        return if text || whole { Ok(()) } else { Err(format!("it holds {physical}, not text")) };
    }
    match (physical, descriptor.logical_type_ref()) {
        (_, Some(LogicalType::Decimal(_))) => Err("it holds decimals".into()),
        (_, Some(LogicalType::Date)) => Err("it holds dates".into()),
        (
            Physical::DOUBLE
            | Physical::FLOAT
            | Physical::INT32
            | Physical::INT64
            | Physical::INT96
            | Physical::BOOLEAN,
            _,
        ) => Ok(()),
        _ if text => Err("it holds text".into()),
        _ => Err(format!("it holds {physical}")),
    }
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
