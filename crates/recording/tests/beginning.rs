//! What a log begins with, as columns from which a map can be made.

#![allow(clippy::unwrap_used)]

mod written;

use std::{fs, path::Path};

use recording::{BeginningColumn, Channel, Format, MOST_ROWS, Map, beginning, read_path, unwatched};
use serde_json::json;

fn of_file(path: &Path, format: Format) -> Vec<BeginningColumn> {
    beginning(fs::File::open(path).unwrap(), format, &unwatched()).unwrap()
}

#[test]
fn fields_of_unknown_topics_are_shown_and_the_map_made_of_them_reads_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let messages = written::drive(1000, (0..700).map(|row| 50 + row % 9));
    let mcap = folder.path().join("drive.mcap");
    fs::write(&mcap, written::mcap(written::DRIVE, &messages)).unwrap();
    let db3 = folder.path().join("drive.db3");
    written::db3(&db3, written::DRIVE, &messages);
    for (path, format) in [(mcap, Format::Mcap), (db3, Format::Db3)] {
        assert!(read_path(&path, None).is_err(), "no built-in map knows its topic");
        let columns = of_file(&path, format);
        let names: Vec<_> = columns.iter().map(|one| (one.topic.as_deref(), one.name.as_str())).collect();
        let topic = Some("/drive");
        assert_eq!(names, [(topic, "left"), (topic, "right"), (topic, "watts")], "texts are no numbers");
        assert_eq!(columns[2].cells.len(), MOST_ROWS);
        assert_eq!(&columns[2].cells[..3], ["50", "51", "52"]);
        let channels = ["v_left_mps", "v_right_mps", "power_w"];
        let sources = columns.iter().zip(channels).map(
            |(column, channel)| json!({"channel": channel, "topic": column.topic, "fields": [column.name]}),
        );
        let sources: Vec<_> = sources.collect();
        let map = Map::from_value(&json!({"name": "picked", "sources": sources})).unwrap();
        let read = read_path(&path, Some(&map)).unwrap().recording;
        assert_eq!(read.channel(Channel::Power).unwrap()[..3], [50.0, 51.0, 52.0]);
    }
}

#[test]
fn a_bag_that_is_cut_off_shows_what_is_before_and_seeds_of_all_readers_show_their_numbers() {
    let seeds = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/seeds");
    for (file, format) in [
        ("bag/plain.bag", Format::Bag),
        ("bag/lz4.bag", Format::Bag),
        ("mcap/zstd.mcap", Format::Mcap),
        ("db3/message.db3", Format::Db3),
    ] {
        let columns = of_file(&seeds.join(file), format);
        assert!(!columns.is_empty(), "{file}");
        let is_number = |cell: &String| cell.is_empty() || cell.parse::<f64>().is_ok();
        assert!(columns.iter().all(|one| one.topic.is_some() && one.cells.iter().all(is_number)), "{file}");
        assert!(columns.iter().all(|one| !one.name.contains("covariance")), "{file}");
    }
    let folder = tempfile::tempdir().unwrap();
    let cut = folder.path().join("cut.mcap");
    let whole = written::mcap(written::DRIVE, &written::drive(1000, 0..100));
    fs::write(&cut, &whole[..whole.len() / 2]).unwrap();
    let cells = of_file(&cut, Format::Mcap)[0].cells.len();
    assert!((40..60).contains(&cells), "{cells}");
}

#[test]
fn columns_of_parquet_are_shown_as_they_stand_in_the_file() {
    let files = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/files");
    for file in ["drive-pandas.parquet", "drive-polars.parquet"] {
        let columns = of_file(&files.join(file), Format::Parquet);
        let speeds = columns.iter().find(|one| one.name == "v_left_mps").unwrap();
        assert!(speeds.topic.is_none() && speeds.cells[0].parse::<f64>().is_ok(), "{file}: {speeds:?}");
        let rows = columns.iter().map(|one| one.cells.len());
        assert!(rows.clone().max() == rows.min(), "{file}: a cell for every row");
    }
}

#[test]
fn columns_of_text_are_shown_whatever_they_are_called() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("drive.csv");
    fs::write(&path, "Zeit;Leistung (mW);leer\n0,1;12003;\n0,2;;\n").unwrap();
    let columns = of_file(&path, Format::Csv);
    let told: Vec<_> = columns.iter().map(|one| (one.name.as_str(), one.cells.join("|"))).collect();
    assert_eq!(told, [("Zeit", "0,1|0,2".to_owned()), ("Leistung (mW)", "12003|".to_owned())]);
}

#[test]
fn damaged_files_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    fs::write(&path, b"PAR1 and nothing else PAR1").unwrap();
    for format in [Format::Parquet, Format::Mcap, Format::Bag, Format::Db3, Format::Ulog] {
        let file = fs::File::open(&path).unwrap();
        assert!(beginning(file, format, &unwatched()).is_err(), "{format:?}");
    }
}
