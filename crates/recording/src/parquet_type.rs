//! What the types of Parquet columns say of their numbers: units of time, decimals, signs.

use std::collections::HashMap;

use ::parquet::{
    basic::{ConvertedType, LogicalType, TimeUnit, Type as Physical},
    schema::types::ColumnDescriptor,
};

use crate::column::{Kind, TEXT};

/// The unit that a column of integers stores times in by its type, whatever the writer says it by; `None` for plain numbers.
pub(crate) fn time_unit(
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

/// What the stored integers of a column are multiplied with where they are decimals; one for other types.
pub(crate) fn decimal_factor(descriptor: &ColumnDescriptor) -> f64 {
    if is_decimal(descriptor) { 10f64.powi(-descriptor.type_scale()) } else { 1.0 }
}

/// Whether a column holds integers without a sign.
pub(crate) fn is_unsigned(descriptor: &ColumnDescriptor) -> bool {
    use ConvertedType as C;
    match descriptor.logical_type_ref() {
        Some(LogicalType::Integer(integer)) => !integer.is_signed,
        Some(_) => false,
        None => matches!(descriptor.converted_type(), C::UINT_8 | C::UINT_16 | C::UINT_32 | C::UINT_64),
    }
}

/// Whether a column holds decimals.
pub(crate) fn is_decimal(descriptor: &ColumnDescriptor) -> bool {
    matches!(descriptor.logical_type_ref(), Some(LogicalType::Decimal(_)))
        || descriptor.converted_type() == ConvertedType::DECIMAL
}

/// Refuses, in words, what a column holds instead of what is wanted.
pub(crate) fn refuse_type(descriptor: &ColumnDescriptor, kind: Kind) -> Result<(), String> {
    if descriptor.max_rep_level() > 0 {
        return Err("it holds lists".into());
    }
    let physical = descriptor.physical_type();
    let text = matches!(physical, Physical::BYTE_ARRAY);
    if kind == Kind::Label {
        let whole =
            matches!(physical, Physical::INT32 | Physical::INT64 | Physical::DOUBLE | Physical::FLOAT);
        return if text || whole { Ok(()) } else { Err(format!("it holds {physical}, not text")) };
    }
    let is_integer = matches!(physical, Physical::INT32 | Physical::INT64);
    let (logical, converted) = (descriptor.logical_type_ref(), descriptor.converted_type());
    match physical {
        _ if is_decimal(descriptor) && !is_integer => Ok(()),
        _ if matches!(logical, Some(LogicalType::Date)) || converted == ConvertedType::DATE => {
            Err("it holds dates".into())
        }
        Physical::DOUBLE | Physical::FLOAT | Physical::INT96 | Physical::BOOLEAN => Ok(()),
        _ if is_integer => Ok(()),
        _ if text => Err(TEXT.into()),
        _ => Err(format!("it holds {physical}")),
    }
}
