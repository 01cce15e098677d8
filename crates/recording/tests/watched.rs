//! Readings that are stopped from outside: the watch is asked however few bytes the rows take.

#![allow(clippy::unwrap_used)]

use std::{
    fmt::Write as _,
    fs::File,
    io::{Seek, Write},
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicUsize, Ordering},
    },
};

use parquet::{
    data_type::DoubleType, file::writer::SerializedFileWriter, schema::parser::parse_message_type,
};
use recording::{Error, Format, Recording, Room, Watch, read, read_file};

const ROWS: usize = 200_000;
/// Rows that may be worked on between two looks.
const ROWS_A_LOOK: usize = 8192;

/// A watch that breaks at the question of a number, and the number of questions so far.
fn breaking_at(last: usize) -> (Watch, Arc<AtomicUsize>) {
    let asked = Arc::new(AtomicUsize::new(0));
    let count = Arc::clone(&asked);
    let watch: Watch = Arc::new(move |_| {
        let before = count.fetch_add(1, Ordering::Relaxed);
        if before + 1 >= last { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    (watch, asked)
}

/// Rows whose speeds and power never change, which Parquet stores in hardly any bytes.
fn constant_parquet() -> File {
    let names = ["t_s", "v_left_mps", "v_right_mps", "power_w"];
    let fields: String = names.iter().map(|name| format!("required double {name};")).collect();
    let schema = Arc::new(parse_message_type(&format!("message drive {{ {fields} }}")).unwrap());
    let mut file = tempfile::tempfile().unwrap();
    let mut writer = SerializedFileWriter::new(&mut file, schema, Arc::default()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    for channel in 0..names.len() {
        let value = |row: usize| if channel == 0 { row as f64 * 0.01 } else { 0.5 };
        let values: Vec<f64> = (0..ROWS).map(value).collect();
        let mut column = group.next_column().unwrap().unwrap();
        column.typed::<DoubleType>().write_batch(&values, None, None).unwrap();
        column.close().unwrap();
    }
    group.close().unwrap();
    writer.close().unwrap();
    file
}

fn csv() -> File {
    let mut text = String::from("t_s,v_left_mps,v_right_mps,power_w\n");
    (0..ROWS).for_each(|row| writeln!(text, "{:.2},.5,.5,9", row as f64 * 0.01).unwrap());
    let mut file = tempfile::tempfile().unwrap();
    file.write_all(text.as_bytes()).unwrap();
    file
}

#[test]
fn a_reading_asks_its_watch_every_few_thousand_rows_and_stops_wherever_it_breaks() {
    for (mut file, format) in [(constant_parquet(), Format::Parquet), (csv(), Format::Csv)] {
        let mut reading = |watch: &Watch| {
            file.rewind().unwrap();
            read_file(file.try_clone().unwrap(), format, "long", None, watch, Room::default())
        };
        let (never, asked) = breaking_at(usize::MAX);
        assert_eq!(reading(&never).unwrap().recording.rows(), ROWS);
        let all = asked.load(Ordering::Relaxed);
        // While rows are read, and column by column afterwards.
        assert!(all >= ROWS / ROWS_A_LOOK + 8, "{format:?}: {all} looks");
        for last in [1, 2, all / 4, all / 2, all - 1, all] {
            let (watch, asked) = breaking_at(last);
            assert!(matches!(reading(&watch), Err(Error::Stopped)), "{format:?}: at {last} of {all}");
            assert!(asked.load(Ordering::Relaxed) <= last + 2, "{format:?}: asked on after {last} of {all}");
        }
    }
}

#[test]
fn means_of_a_fast_recording_are_stopped_too() {
    let mut text = String::from("t_s,v_left_mps,v_right_mps,power_w\n");
    (0..30_000).for_each(|row| writeln!(text, "{:.2},.5,.5,{}", f64::from(row) * 0.01, row % 9).unwrap());
    let fast: Recording = read(text.into_bytes(), Format::Csv, "fast", None).unwrap().recording;
    let (never, asked) = breaking_at(usize::MAX);
    assert_eq!(*fast.thinned_watched(&never).unwrap(), *fast.thinned());
    for last in 1..=asked.load(Ordering::Relaxed) {
        assert!(matches!(fast.thinned_watched(&breaking_at(last).0), Err(Error::Stopped)), "at {last}");
    }
}
