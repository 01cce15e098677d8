//! Every type that a writer may choose for a column of a drive: its numbers come out as they went in, or it is refused.

#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use ::parquet::{
    data_type::{
        ByteArray, ByteArrayType, DataType, DoubleType, FixedLenByteArray, FixedLenByteArrayType, FloatType,
        Int32Type, Int64Type,
    },
    file::writer::SerializedFileWriter,
    schema::parser::parse_message_type,
};
use recording::{Channel, Error, Format, Map, Reading, read};

const ROWS: usize = 8;

/// A drive of which one column is of another type: its declaration, and its values.
fn table<T: DataType>(column: &str, values: &[T::T], levels: Option<&[i16]>) -> Vec<u8> {
    let name = column.split_whitespace().nth(2).unwrap();
    let others = ["t_s", "v_left_mps", "v_right_mps", "power_w"].into_iter().filter(|other| *other != name);
    let others: Vec<&str> = others.collect();
    let declared: String = others.iter().map(|other| format!("required double {other}; ")).collect();
    let schema = Arc::new(parse_message_type(&format!("message drive {{ {column}; {declared} }}")).unwrap());
    let mut bytes = Vec::new();
    let mut writer = SerializedFileWriter::new(&mut bytes, schema, Arc::default()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    let mut special = group.next_column().unwrap().unwrap();
    special.typed::<T>().write_batch(values, levels, None).unwrap();
    special.close().unwrap();
    for other in others {
        let value = |row: usize| if other == "t_s" { 0.25 * row as f64 } else { 1.0 };
        let values: Vec<f64> = (0..ROWS).map(value).collect();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(&values, None, None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
    bytes
}

fn parquet(bytes: Vec<u8>, map: Option<&Map>) -> Result<Reading, Error> {
    read(bytes, Format::Parquet, "drive", map)
}

fn quarters<I>(per_second: i64, of: fn(i64) -> I) -> Vec<I> {
    (0..ROWS as i64).map(|row| of(row * per_second / 4)).collect()
}

#[test]
fn times_of_every_type_are_seconds_and_their_unit_is_applied_once() {
    let map = |unit: &str| {
        let source = format!(r#"{{"channel": "t_s", "column": "t_s", "unit": "{unit}"}}"#);
        Map::from_json(&format!(r#"{{"name": "lab", "sources": [{source}]}}"#)).unwrap()
    };
    let whole = |per_second: i64| quarters(per_second, |t| t);
    let short = |per_second: i64| quarters(per_second, |t| i32::try_from(t).unwrap());
    for (declared, unit, bytes) in [
        ("int32 t_s (TIME(MILLIS, true))", "ms", short(1000)),
        ("int32 t_s (TIME_MILLIS)", "ms", short(1000)),
    ]
    .map(|(declared, unit, values)| {
        (declared, unit, table::<Int32Type>(&format!("required {declared}"), &values, None))
    })
    .into_iter()
    .chain(
        [
            ("int64 t_s (TIME(MICROS, true))", "us", whole(1_000_000)),
            ("int64 t_s (TIME_MICROS)", "us", whole(1_000_000)),
            ("int64 t_s (TIME(NANOS, false))", "ns", whole(1_000_000_000)),
            ("int64 t_s (TIMESTAMP(MILLIS, true))", "ms", whole(1000)),
            ("int64 t_s (TIMESTAMP(MICROS, false))", "us", whole(1_000_000)),
            ("int64 t_s (TIMESTAMP(NANOS, true))", "ns", whole(1_000_000_000)),
            ("int64 t_s (TIMESTAMP_MILLIS)", "ms", whole(1000)),
            ("int64 t_s (TIMESTAMP_MICROS)", "us", whole(1_000_000)),
        ]
        .map(|(declared, unit, values)| {
            (declared, unit, table::<Int64Type>(&format!("required {declared}"), &values, None))
        }),
    ) {
        for map in [None, Some(map(unit)), Some(map("s"))] {
            let t_s = parquet(bytes.clone(), map.as_ref()).unwrap().recording.t_s;
            let expected = (0..ROWS).map(|row| 0.25 * row as f64);
            assert!(t_s.iter().zip(expected).all(|(t, e)| (t - e).abs() < 1e-9), "{declared}: {t_s:?}");
        }
        let wrong = parquet(bytes, Some(&map("min"))).unwrap_err().to_string();
        assert!(
            wrong.contains("given as `min`") && wrong.contains(&format!("`{unit}`")),
            "{declared}: {wrong}"
        );
    }
}

#[test]
fn decimals_have_their_point_and_unsigned_integers_no_sign() {
    let power_w = |bytes| parquet(bytes, None).unwrap().recording.channel(Channel::Power).unwrap()[1];
    for declared in ["DECIMAL(9,2)", "DECIMAL(5,2)"] {
        let column = format!("required int32 power_w ({declared})");
        assert!(
            (power_w(table::<Int32Type>(&column, &[4_025; ROWS], None)) - 40.25).abs() < 1e-9,
            "{declared}"
        );
    }
    let column = "required int64 power_w (DECIMAL(18,3))";
    assert!((power_w(table::<Int64Type>(column, &[40_250; ROWS], None)) - 40.25).abs() < 1e-9);
    // Decimals of Python and Arrow come in bytes.
    for (declared, hundredths) in [("DECIMAL(7,2)", 4_025i64), ("DECIMAL(7,2)", -4_025)] {
        let bytes = hundredths.to_be_bytes()[4..].to_vec();
        let column = format!("required fixed_len_byte_array(4) power_w ({declared})");
        let fixed = vec![FixedLenByteArray::from(bytes.clone()); ROWS];
        let read_w = power_w(table::<FixedLenByteArrayType>(&column, &fixed, None));
        assert!((read_w - hundredths as f64 / 100.0).abs() < 1e-9, "{read_w}");
        let column = format!("required binary power_w ({declared})");
        let read_w = power_w(table::<ByteArrayType>(&column, &vec![ByteArray::from(bytes); ROWS], None));
        assert!((read_w - hundredths as f64 / 100.0).abs() < 1e-9, "{read_w}");
    }
    // Microseconds of a controller's clock of 32 bits pass 2³¹ after 36 minutes.
    let past: Vec<i32> = (0..ROWS as u32).map(|row| (0x7fff_ff00 + 250_000 * row).cast_signed()).collect();
    let source = r#"{"channel": "t_s", "column": "t_s", "unit": "us"}"#;
    let map = Map::from_json(&format!(r#"{{"name": "lab", "sources": [{source}]}}"#)).unwrap();
    for declared in ["UINT_32", "INTEGER(32,false)"] {
        let bytes = table::<Int32Type>(&format!("required int32 t_s ({declared})"), &past, None);
        let t_s = parquet(bytes, Some(&map)).unwrap().recording.t_s;
        assert!((t_s[ROWS - 1] - t_s[0] - 0.25 * (ROWS - 1) as f64).abs() < 1e-9, "{declared}: {t_s:?}");
    }
    let dates = table::<Int32Type>("required int32 t_s (DATE)", &[19_000; ROWS], None);
    assert!(parquet(dates, None).unwrap_err().to_string().contains("it holds dates; write it as a double"));
}

#[test]
fn runs_in_doubles_are_named_by_their_whole_numbers() {
    let runs = [1.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0, 2.0];
    let names = |bytes| -> Vec<String> {
        parquet(bytes, None).unwrap().recording.runs.into_iter().map(|run| run.name).collect()
    };
    assert_eq!(names(table::<DoubleType>("required double run", &runs, None)), ["1", "2"]);
    assert_eq!(
        names(table::<FloatType>("required float run", &runs.map(|run| run as f32), None)),
        ["1", "2"]
    );
    let mut gaps = runs;
    gaps[..4].fill(f64::NAN);
    assert_eq!(
        names(table::<DoubleType>("required double run", &gaps, None)),
        ["2"],
        "blank rows take the run beside them"
    );
    let levels = [1, 1, 1, 1, 0, 0, 0, 0];
    assert_eq!(names(table::<DoubleType>("optional double run", &runs[..4], Some(&levels))), ["1"]);
    let broken = table::<DoubleType>("required double run", &[1.5; ROWS], None);
    let message = parquet(broken, None).unwrap_err().to_string();
    assert!(
        message.contains("field `run`: it holds 1.5, no whole number; write it as text or an integer"),
        "{message}"
    );
}
