//! Parquet with the columns of the CSV format.

use std::panic::{AssertUnwindSafe, catch_unwind};

use ::parquet::{
    basic::{LogicalType, TimeUnit, Type as Physical},
    column::reader::{ColumnReader, ColumnReaderImpl},
    data_type::{ByteArray, DataType},
    file::reader::{ChunkReader, FileReader, SerializedFileReader},
    schema::types::ColumnDescriptor,
};

use crate::{
    Error, Map,
    column::{Column, Kind, Plan},
    error::Position,
    label_column::{LabelColumn, MOST_NAMES},
    limit::refuse_too_many,
    reading::{Part, Reading},
};

/// Rows read at a time: small enough to stay in the cache while they are widened.
const BATCH_ROWS: usize = 8192;

/// Reads every row group, a column at a time.
pub(crate) fn read(
    source: impl ChunkReader + 'static,
    name: &str,
    map: Option<&Map>,
) -> Result<Reading, Error> {
    // The library asserts some of what a damaged file may say (negative offsets among it). Nothing of it outlives the
    // closure, so that stopping in the middle leaves nothing half done.
    let read = AssertUnwindSafe(|| read_file(source, name, map));
    catch_unwind(read).unwrap_or_else(|_| {
        let reason = "its contents contradict one another; it is damaged".into();
        Err(Error::NotTheFormat { format: "Parquet", reason })
    })
}

fn read_file(source: impl ChunkReader + 'static, name: &str, map: Option<&Map>) -> Result<Reading, Error> {
    let file_bytes = source.len();
    let file = SerializedFileReader::new(source)?;
    refuse_contradictions(&file, file_bytes)?;
    let schema = file.metadata().file_metadata().schema_descr_ptr();
    let headers: Vec<String> = schema.columns().iter().map(|column| column.path().string()).collect();
    let plan = Plan::new(headers.clone(), map)?;
    let mut columns = Vec::with_capacity(headers.len());
    for (index, kind) in plan.kinds.iter().enumerate() {
        columns.push(read_column(&file, index, *kind, &schema.column(index))?);
    }
    let (recording, report) = plan.assemble(columns, name, |row| Position::Row(row as u64 + 1))?;
    Reading::finish(Part { recording, report, found: headers, format: "Parquet" }, name, map)
}

/// Refuses columns that lie outside the file before anything of their size is allocated.
fn refuse_contradictions<R: ChunkReader + 'static>(
    file: &SerializedFileReader<R>,
    file_bytes: u64,
) -> Result<(), Error> {
    let rows = file
        .metadata()
        .row_groups()
        .iter()
        .map(|group| usize::try_from(group.num_rows()).unwrap_or(usize::MAX));
    let rows = rows.fold(0usize, usize::saturating_add);
    refuse_too_many(rows, file.metadata().file_metadata().schema_descr().num_columns())?;
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

fn read_column<R: ChunkReader + 'static>(
    file: &SerializedFileReader<R>,
    index: usize,
    kind: Kind,
    descriptor: &ColumnDescriptor,
) -> Result<Column, Error> {
    let scale = match meaning(descriptor, kind) {
        Ok(scale) => scale,
        Err(found) if kind == Kind::Perhaps => return Ok(Column::Unusable(found)),
        Err(found) => {
            let (field, topic) = (descriptor.path().string(), "of the table".into());
            return Err(Error::Field { topic, field, reason: format!("{found}; write it as a double") });
        }
    };
    let mut column = match kind {
        Kind::Label => Column::Labels(LabelColumn::default()),
        Kind::Number | Kind::Perhaps => Column::Numbers(Vec::new()),
    };
    let mut rows = 0;
    let mut too_many = None;
    let mut add = |labels: &mut LabelColumn, name: &str| {
        rows += 1;
        if !labels.push(name) {
            too_many.get_or_insert(rows);
        }
    };
    for group in 0..file.num_row_groups() {
        let reader = file.get_row_group(group)?.get_column_reader(index)?;
        let full = descriptor.max_def_level();
        match (reader, &mut column) {
            (ColumnReader::DoubleColumnReader(r), Column::Numbers(v)) => numbers(r, full, v, |x| x * scale)?,
            (ColumnReader::FloatColumnReader(r), Column::Numbers(v)) => {
                numbers(r, full, v, |x| f64::from(*x) * scale)?;
            }
            (ColumnReader::Int32ColumnReader(r), Column::Numbers(v)) => {
                numbers(r, full, v, |x| f64::from(*x) * scale)?;
            }
            (ColumnReader::Int64ColumnReader(r), Column::Numbers(v)) => {
                numbers(r, full, v, |x| *x as f64 * scale)?;
            }
            (ColumnReader::BoolColumnReader(r), Column::Numbers(v)) => {
                numbers(r, full, v, |x| f64::from(u8::from(*x)))?;
            }
            (ColumnReader::ByteArrayColumnReader(r), Column::Labels(labels)) => {
                for_each(r, full, |text: Option<&ByteArray>| {
                    add(labels, text.and_then(|text| text.as_utf8().ok()).unwrap_or_default());
                })?;
            }
            (ColumnReader::Int32ColumnReader(r), Column::Labels(labels)) => {
                for_each(r, full, |x: Option<&i32>| add(labels, &x.map_or(String::new(), i32::to_string)))?;
            }
            (ColumnReader::Int64ColumnReader(r), Column::Labels(labels)) => {
                for_each(r, full, |x: Option<&i64>| add(labels, &x.map_or(String::new(), i64::to_string)))?;
            }
            _ => return Ok(Column::Unusable("its type changes within the file".into())),
        }
    }
    if let Some(row) = too_many {
        let (position, column) = (Position::Row(row), descriptor.path().string());
        return Err(Error::TooManyNames { position, column, most: MOST_NAMES });
    }
    if let (Kind::Number, Column::Numbers(values)) = (kind, &column)
        && let Some(row) = values.iter().position(|value| value.is_infinite())
    {
        return Err(Error::Number {
            position: Position::Row(row as u64 + 1),
            column: descriptor.path().string(),
            found: format!("{}", values[row]),
        });
    }
    Ok(column)
}

/// What a stored number is multiplied with, or in words what the column holds instead of what is wanted.
fn meaning(descriptor: &ColumnDescriptor, kind: Kind) -> Result<f64, String> {
    if descriptor.max_rep_level() > 0 {
        return Err("it holds lists".into());
    }
    let physical = descriptor.physical_type();
    let text = matches!(physical, Physical::BYTE_ARRAY);
    if kind == Kind::Label {
        let whole = matches!(physical, Physical::INT32 | Physical::INT64);
        return if text || whole { Ok(1.0) } else { Err(format!("it holds {physical}, not text")) };
    }
    match (physical, descriptor.logical_type_ref()) {
        (_, Some(LogicalType::Decimal(_))) => Err("it holds decimals".into()),
        (Physical::INT32 | Physical::INT64, Some(LogicalType::Timestamp(stamp))) => Ok(seconds(&stamp.unit)),
        (Physical::INT32 | Physical::INT64, Some(LogicalType::Time(time))) => Ok(seconds(&time.unit)),
        (Physical::DOUBLE | Physical::FLOAT | Physical::INT32 | Physical::INT64 | Physical::BOOLEAN, _) => {
            Ok(1.0)
        }
        _ if text => Err("it holds text".into()),
        _ => Err(format!("it holds {physical}")),
    }
}

fn seconds(unit: &TimeUnit) -> f64 {
    match unit {
        TimeUnit::MILLIS => 1e-3,
        TimeUnit::MICROS => 1e-6,
        TimeUnit::NANOS => 1e-9,
    }
}

fn numbers<T: DataType>(
    reader: ColumnReaderImpl<T>,
    full: i16,
    values: &mut Vec<f64>,
    widen: impl Fn(&T::T) -> f64,
) -> Result<(), Error> {
    for_each(reader, full, |value| values.push(value.map_or(f64::NAN, &widen)))
}

/// Calls with every value of a column chunk, `None` for nulls: those whose definition level is not the full one.
fn for_each<T: DataType>(
    mut reader: ColumnReaderImpl<T>,
    full: i16,
    mut take: impl FnMut(Option<&T::T>),
) -> Result<(), Error> {
    let (mut batch, mut levels) = (Vec::with_capacity(BATCH_ROWS), Vec::new());
    loop {
        batch.clear();
        levels.clear();
        let levels_wanted = (full > 0).then_some(&mut levels);
        let (rows, found, _) = reader.read_records(BATCH_ROWS, levels_wanted, None, &mut batch)?;
        if rows == 0 && found == 0 {
            return Ok(());
        }
        if full == 0 {
            batch.iter().for_each(|value| take(Some(value)));
            continue;
        }
        let mut values = batch.iter();
        for level in &levels {
            take(if *level == full { values.next() } else { None });
        }
    }
}
