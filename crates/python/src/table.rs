//! Columns of tables that other libraries hold: numpy's, and those of the C stream interface of Arrow.

use std::borrow::Cow;

use arrow_array::{
    Array, ArrayRef, RecordBatch, RecordBatchReader,
    cast::AsArray,
    ffi_stream::{FFI_ArrowArrayStream, RecordBatchStreamReader},
    types::{
        ArrowPrimitiveType, Float32Type, Float64Type, Int8Type, Int16Type, Int32Type, Int64Type, UInt8Type,
        UInt16Type, UInt32Type, UInt64Type,
    },
};
use arrow_schema::{DataType, TimeUnit};
use numpy::PyReadonlyArray1;
use pyo3::{
    exceptions::{PyTypeError, PyValueError},
    prelude::*,
    types::{PyCapsule, PyTuple},
};
use recording::{ColumnValues, NamedColumn};
/// A column whose values Python holds.
pub(crate) struct HeldColumn<'py> {
    name: String,
    values: HeldValues<'py>,
}

enum HeldValues<'py> {
    Numbers(PyReadonlyArray1<'py, f64>),
    Times(PyReadonlyArray1<'py, f64>, &'static str),
    Texts(Vec<String>, PyReadonlyArray1<'py, u32>),
    Unusable(String, usize),
}

impl<'py> HeldColumn<'py> {
    /// A column from a tuple of its name, of what its values are, and of the values.
    pub(crate) fn of(column: &Bound<'py, PyTuple>) -> PyResult<Self> {
        let (name, kind): (String, String) = (column.get_item(0)?.extract()?, column.get_item(1)?.extract()?);
        let values = match kind.as_str() {
            "numbers" => HeldValues::Numbers(column.get_item(2)?.extract()?),
            "texts" => HeldValues::Texts(column.get_item(2)?.extract()?, column.get_item(3)?.extract()?),
            "unusable" => {
                HeldValues::Unusable(column.get_item(2)?.extract()?, column.get_item(3)?.extract()?)
            }
            unit => {
                let unit = ["s", "ms", "us", "ns"].into_iter().find(|known| *known == unit);
                let unit = unit.ok_or_else(|| PyValueError::new_err(format!("no kind of column: {kind}")))?;
                HeldValues::Times(column.get_item(2)?.extract()?, unit)
            }
        };
        Ok(HeldColumn { name, values })
    }

    /// The column as the recording crate takes it.
    pub(crate) fn named(&self) -> PyResult<NamedColumn<'_>> {
        let values = match &self.values {
            HeldValues::Numbers(values) => ColumnValues::Numbers(values.as_slice()?.into()),
            HeldValues::Times(values, unit) => {
                ColumnValues::Times { values: values.as_slice()?.into(), unit }
            }
            HeldValues::Texts(names, index) => {
                ColumnValues::Texts { names: names.clone(), index: index.as_slice()?.into() }
            }
            HeldValues::Unusable(reason, rows) => {
                ColumnValues::Unusable { reason: reason.clone(), rows: *rows }
            }
        };
        Ok(NamedColumn { name: self.name.clone(), values })
    }
}

/// A table of Arrow, in the pieces that it came in.
pub(crate) struct ArrowTable {
    names: Vec<String>,
    types: Vec<DataType>,
    batches: Vec<RecordBatch>,
}

impl ArrowTable {
    /// The table of an object that has `__arrow_c_stream__`, as those of pyarrow, polars and pandas have.
    pub(crate) fn of(table: &Bound<'_, PyAny>) -> PyResult<Self> {
        let exported = table.call_method0("__arrow_c_stream__")?;
        let capsule = exported.cast::<PyCapsule>().map_err(|_| {
            PyTypeError::new_err("__arrow_c_stream__ of the table gives no capsule of Arrow's C interface")
        })?;
        let stream = capsule.pointer_checked(Some(c"arrow_array_stream"))?.cast::<FFI_ArrowArrayStream>();
        // SAFETY: a capsule of this name points to a valid stream by the C interface of Arrow; what is taken out of it is marked as
        // released there, so that the capsule does not release it again.
        #[allow(unsafe_code)]
        let reader = unsafe { RecordBatchStreamReader::from_raw(stream.as_ptr()) };
        let invalid = |error: arrow_schema::ArrowError| PyValueError::new_err(error.to_string());
        let reader = reader.map_err(invalid)?;
        let schema = reader.schema();
        let names = schema.fields().iter().map(|field| field.name().clone()).collect();
        let types = schema.fields().iter().map(|field| field.data_type().clone()).collect();
        Ok(ArrowTable { names, types, batches: reader.collect::<Result<_, _>>().map_err(invalid)? })
    }

    /// The columns as the recording crate takes them; doubles without a null in one piece are not copied.
    pub(crate) fn named(&self) -> Vec<NamedColumn<'_>> {
        let column = |(index, name): (usize, &String)| {
            let pieces: Vec<&ArrayRef> = self.batches.iter().map(|batch| batch.column(index)).collect();
            NamedColumn { name: name.clone(), values: values_of(&pieces, &self.types[index]) }
        };
        self.names.iter().enumerate().map(column).collect()
    }
}

fn values_of<'a>(pieces: &[&'a ArrayRef], of_type: &DataType) -> ColumnValues<'a> {
    let integers = || widened::<Int64Type>(pieces, |value| value as f64);
    match of_type {
        DataType::Float64 => match pieces {
            [piece] if piece.null_count() == 0 => {
                ColumnValues::Numbers(Cow::Borrowed(piece.as_primitive::<Float64Type>().values()))
            }
            _ => ColumnValues::Numbers(widened::<Float64Type>(pieces, |value| value).into()),
        },
        DataType::Float32 => ColumnValues::Numbers(widened::<Float32Type>(pieces, f64::from).into()),
        DataType::Int8 => ColumnValues::Numbers(widened::<Int8Type>(pieces, f64::from).into()),
        DataType::Int16 => ColumnValues::Numbers(widened::<Int16Type>(pieces, f64::from).into()),
        DataType::Int32 => ColumnValues::Numbers(widened::<Int32Type>(pieces, f64::from).into()),
        DataType::Int64 => ColumnValues::Numbers(integers().into()),
        DataType::UInt8 => ColumnValues::Numbers(widened::<UInt8Type>(pieces, f64::from).into()),
        DataType::UInt16 => ColumnValues::Numbers(widened::<UInt16Type>(pieces, f64::from).into()),
        DataType::UInt32 => ColumnValues::Numbers(widened::<UInt32Type>(pieces, f64::from).into()),
        DataType::UInt64 => ColumnValues::Numbers(widened::<UInt64Type>(pieces, |value| value as f64).into()),
        DataType::Boolean => {
            let cells = pieces.iter().flat_map(|piece| piece.as_boolean().iter());
            let number = |cell: Option<bool>| cell.map_or(f64::NAN, |cell| f64::from(u8::from(cell)));
            ColumnValues::Numbers(cells.map(number).collect::<Vec<_>>().into())
        }
        DataType::Timestamp(unit, _) | DataType::Duration(unit) => times_of(pieces, of_type, *unit),
        DataType::Utf8 => texts_of(pieces.iter().flat_map(|piece| piece.as_string::<i32>().iter())),
        DataType::LargeUtf8 => texts_of(pieces.iter().flat_map(|piece| piece.as_string::<i64>().iter())),
        DataType::Utf8View => texts_of(pieces.iter().flat_map(|piece| piece.as_string_view().iter())),
        DataType::Dictionary(_, _) => dictionary_of(pieces, of_type),
        other => unusable(pieces, other),
    }
}

fn rows_of(pieces: &[&ArrayRef]) -> usize {
    pieces.iter().map(|piece| piece.len()).sum()
}

fn unusable<'a>(pieces: &[&'a ArrayRef], of_type: &DataType) -> ColumnValues<'a> {
    ColumnValues::Unusable { reason: format!("it holds {of_type}"), rows: rows_of(pieces) }
}

/// Numbers as doubles, NaN for nulls.
fn widened<T: ArrowPrimitiveType>(pieces: &[&ArrayRef], widen: impl Fn(T::Native) -> f64) -> Vec<f64> {
    let cells = pieces.iter().flat_map(|piece| piece.as_primitive::<T>().iter());
    cells.map(|cell| cell.map_or(f64::NAN, &widen)).collect()
}

fn times_of<'a>(pieces: &[&'a ArrayRef], of_type: &DataType, unit: TimeUnit) -> ColumnValues<'a> {
    let counts = pieces.iter().map(|piece| piece.to_data().into_builder().data_type(DataType::Int64).build());
    let Ok(counts) = counts.collect::<Result<Vec<_>, _>>() else { return unusable(pieces, of_type) };
    let counts: Vec<ArrayRef> = counts.into_iter().map(arrow_array::make_array).collect();
    let counts: Vec<&ArrayRef> = counts.iter().collect();
    let unit = match unit {
        TimeUnit::Second => "s",
        TimeUnit::Millisecond => "ms",
        TimeUnit::Microsecond => "us",
        TimeUnit::Nanosecond => "ns",
    };
    ColumnValues::Times { values: widened::<Int64Type>(&counts, |value| value as f64).into(), unit }
}

fn texts_of<'a, 't>(cells: impl Iterator<Item = Option<&'t str>>) -> ColumnValues<'a> {
    let mut known = std::collections::HashMap::<&str, u32>::new();
    let mut names = Vec::new();
    let index = cells.map(|cell| {
        let Some(text) = cell else { return u32::MAX };
        *known.entry(text).or_insert_with(|| {
            names.push(text.to_owned());
            u32::try_from(names.len() - 1).unwrap_or(u32::MAX)
        })
    });
    let index: Vec<u32> = index.collect();
    ColumnValues::Texts { names, index: index.into() }
}

/// Texts of a dictionary, as categories of a data frame are.
fn dictionary_of<'a>(pieces: &[&'a ArrayRef], of_type: &DataType) -> ColumnValues<'a> {
    let mut cells: Vec<Option<&'a str>> = Vec::with_capacity(rows_of(pieces));
    for piece in pieces {
        let dictionary = piece.as_any_dictionary();
        let values: Vec<Option<&str>> = match dictionary.values().data_type() {
            DataType::Utf8 => dictionary.values().as_string::<i32>().iter().collect(),
            DataType::LargeUtf8 => dictionary.values().as_string::<i64>().iter().collect(),
            DataType::Utf8View => dictionary.values().as_string_view().iter().collect(),
            _ => return unusable(pieces, of_type),
        };
        // Without values there are no keys to normalise.
        let keys = if values.is_empty() { vec![0; piece.len()] } else { dictionary.normalized_keys() };
        let cell = |(row, key): (usize, &usize)| {
            if piece.is_null(row) { None } else { values.get(*key).copied().flatten() }
        };
        cells.extend(keys.iter().enumerate().map(cell));
    }
    texts_of(cells.into_iter())
}
