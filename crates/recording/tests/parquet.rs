//! Parquet: the types that writers use, and damage of every kind, refused before it costs memory.

#![allow(clippy::unwrap_used)]

use std::sync::Arc;

use ::parquet::{
    data_type::{ByteArray, ByteArrayType, DoubleType, FloatType, Int64Type},
    file::{properties::WriterProperties, writer::SerializedFileWriter},
    schema::parser::parse_message_type,
};
use proptest::prelude::*;
use recording::{Channel, Format, Reading, read};

/// Parquet of three rows in two row groups, of the types that writers use.
fn parquet_file() -> Vec<u8> {
    let schema = "message drive { required int64 t_s (TIMESTAMP(MICROS, true)); required double v_left_mps;
        optional float v_right_mps; optional int64 power_w; optional binary surface (UTF8); optional binary note (UTF8); }";
    let schema = Arc::new(parse_message_type(schema).unwrap());
    let mut bytes = Vec::new();
    let mut writer =
        SerializedFileWriter::new(&mut bytes, schema, Arc::new(WriterProperties::default())).unwrap();
    for (t, left, right, power, surface) in [
        (
            vec![0, 500_000],
            vec![0.5, 0.25],
            (vec![0.5f32], vec![1, 0]),
            (vec![40, 50], vec![1, 1]),
            ("ice", vec![1, 1]),
        ),
        (vec![1_000_000], vec![0.125], (vec![0.25f32], vec![1]), (vec![], vec![0]), ("mud", vec![0])),
    ] {
        let mut group = writer.next_row_group().unwrap();
        let texts: Vec<ByteArray> =
            surface.1.iter().filter(|l| **l == 1).map(|_| ByteArray::from(surface.0)).collect();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<Int64Type>().write_batch(&t, None, None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(&left, None, None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<FloatType>().write_batch(&right.0, Some(&right.1), None).unwrap();
        column.close().unwrap();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<Int64Type>().write_batch(&power.0, Some(&power.1), None).unwrap();
        column.close().unwrap();
        for _ in 0..2 {
            let mut column = group.next_column().unwrap().unwrap();
            column.typed::<ByteArrayType>().write_batch(&texts, Some(&surface.1), None).unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
    }
    writer.close().unwrap();
    bytes
}

#[test]
fn parquet_of_several_types_and_row_groups_is_read_with_its_nulls_as_gaps() {
    let Reading { recording, report } = read(parquet_file(), Format::Parquet, "drive", None).unwrap();
    assert_eq!(recording.t_s, [0.0, 0.5, 1.0]);
    assert_eq!(recording.channel(Channel::LeftSpeed).unwrap(), [0.5, 0.25, 0.125]);
    let right = recording.channel(Channel::RightSpeed).unwrap();
    assert!(right[0] == 0.5 && right[1].is_nan() && right[2] == 0.25, "{right:?}");
    let power_w = recording.channel(Channel::Power).unwrap();
    assert!(power_w[..2] == [40.0, 50.0] && power_w[2].is_nan());
    let surface = recording.surface.unwrap();
    assert_eq!([surface.get(0), surface.get(2)], [Some("ice"), None]);
    assert!(report.ignored.iter().any(|i| i.name == "note" && i.reason.contains("text")), "{report}");
}

#[test]
fn parquet_with_text_for_numbers_or_cut_off_is_refused() {
    let schema = "message drive { required binary t_s (UTF8); required double v_left_mps; }";
    let mut bytes = Vec::new();
    let schema = Arc::new(parse_message_type(schema).unwrap());
    SerializedFileWriter::new(&mut bytes, schema, Arc::default()).unwrap().close().unwrap();
    let message = read(bytes, Format::Parquet, "drive", None).unwrap_err().to_string();
    assert!(message.contains("field `t_s`: it holds text; write it as a double"), "{message}");
    let whole = parquet_file();
    let cut = whole[..whole.len() / 2].to_vec();
    let message = read(cut, Format::Parquet, "drive", None).unwrap_err().to_string();
    assert!(message.contains("not a readable Parquet file"), "{message}");
}

/// The first dictionary says in its header to hold 671 million values, which would take 5 GB before the first was read.
#[test]
fn a_dictionary_that_claims_more_values_than_it_has_bytes_is_refused() {
    let mut bytes = parquet_file();
    // A header: dictionary page of 16 bytes, packed into 16, of two values; integers are doubled, as Thrift writes them.
    let header = [21, 4, 21, 32, 21, 32, 76, 21, 4, 21, 0, 18, 0, 0];
    let at = bytes.windows(header.len()).position(|window| window == header).unwrap();
    // The number is four bytes longer, of which the page's values, zeros here, are relieved: nothing else moves.
    bytes.splice(at + 8..at + 9, [254, 255, 255, 255, 4]);
    bytes.drain(at + header.len() + 4..at + header.len() + 8);
    let message = read(bytes, Format::Parquet, "drive", None).unwrap_err().to_string();
    assert!(message.contains("`t_s` says to hold 671088639 values in 16 bytes"), "{message}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn damaged_parquet_never_panics(
        flips in proptest::collection::vec((0.0..1.0f64, 0u8..8), 1..6),
        length in 0.5..1.5f64,
    ) {
        let mut bytes = parquet_file();
        bytes.truncate((bytes.len() as f64 * length) as usize);
        for (place, bit) in flips {
            let at = (bytes.len() as f64 * place) as usize;
            if let Some(byte) = bytes.get_mut(at) {
                *byte ^= 1 << bit;
            }
        }
        let _ = read(bytes, Format::Parquet, "damaged", None);
    }
}

#[test]
fn a_page_that_fails_its_checksum_is_refused_with_its_column() {
    // As pyarrow 26 writes them with `write_page_checksum`.
    let whole = include_bytes!("files/checksummed.parquet").to_vec();
    assert_eq!(read(whole.clone(), Format::Parquet, "drive", None).unwrap().recording.rows(), 20);
    let watts = [85.0f64, 86.0].map(f64::to_le_bytes).concat();
    let at = whole.windows(watts.len()).position(|bytes| bytes == watts).unwrap();
    let mut damaged = whole;
    damaged[at + 7] = 0x41;
    let message = read(damaged, Format::Parquet, "drive", None).unwrap_err().to_string();
    assert!(
        message.contains("column `power_w` fails its checksum") && message.contains("copy the file"),
        "{message}"
    );
}

#[test]
fn a_compression_that_is_not_read_is_named_with_those_that_are() {
    let brotli = include_bytes!("files/brotli.parquet").to_vec();
    let message = read(brotli, Format::Parquet, "drive", None).unwrap_err().to_string();
    assert!(
        message.contains("compressed with brotli") && message.contains("write it with zstd"),
        "{message}"
    );
    assert!(!message.contains("closed by its writer"), "{message}");
}
