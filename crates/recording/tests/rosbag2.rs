//! What `ros2 bag record` leaves is read as it lies: folders, splits, SQLite, compression of files and messages.

#![allow(clippy::unwrap_used, clippy::expect_used)]

mod written;

use std::{fs, path::Path};

use recording::{Channel, Format, Map, Reading, read, read_path, read_paths};
use tempfile::TempDir;
use written::{DRIVE, MAP, Type, db3, drive, mcap, mcap_of_topics, metadata};

fn map() -> Map {
    Map::from_json(MAP).unwrap()
}

fn power(path: &Path) -> Vec<f64> {
    read_path(path, Some(&map())).unwrap().recording.channel(Channel::Power).unwrap().to_vec()
}

fn refused(path: &Path) -> String {
    read_path(path, Some(&map())).unwrap_err().to_string()
}

fn folder() -> TempDir {
    tempfile::tempdir().unwrap()
}

fn write(folder: &TempDir, name: &str, bytes: &[u8]) -> std::path::PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    path
}

fn up_to(last: u32) -> Vec<f64> {
    (1..=last).map(f64::from).collect()
}

#[test]
fn one_storage_file_and_its_folder_are_the_same_recording_in_every_storage() {
    let messages = drive(100, 1..=20);
    let packed: Vec<(u64, Vec<u8>)> =
        messages.iter().map(|(at, bytes)| (*at, zstd::encode_all(&bytes[..], 1).unwrap())).collect();
    for name in ["x.mcap", "x.db3", "x.mcap.zstd", "x.db3.zstd", "message.mcap", "message.db3"] {
        let folder = folder();
        let messages = if name.starts_with("message") { &packed } else { &messages };
        let path = folder.path().join(name);
        if name.contains("db3") {
            db3(&path, DRIVE, messages);
        } else {
            fs::write(&path, mcap(DRIVE, messages)).unwrap();
        }
        if name.ends_with("zstd") {
            fs::write(&path, zstd::encode_all(&fs::read(&path).unwrap()[..], 1).unwrap()).unwrap();
        }
        assert_eq!(power(&path), up_to(20), "{name}");
        metadata(folder.path(), &[name]);
        assert_eq!(power(folder.path()), up_to(20), "{name}");
        let run = &read_path(&path, Some(&map())).unwrap().recording.runs[0].name;
        assert_eq!(*run, name.split('.').next().unwrap(), "a run is named after its file");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2, "{name}: nothing was left beside it");
    }
}

#[test]
fn splits_are_one_drive_in_the_order_of_time_whatever_order_they_are_named_in() {
    for ending in ["db3", "mcap", "mcap.zstd"] {
        let folder = folder();
        for (at, name) in ["s_2", "s_10", "s_1"].iter().enumerate() {
            let (first, path) = (10 * at as u32 + 1, folder.path().join(format!("{name}.{ending}")));
            let messages = drive(100 + at as u64, first..first + 10);
            match ending {
                "db3" => db3(&path, DRIVE, &messages),
                "mcap" => fs::write(path, mcap(DRIVE, &messages)).unwrap(),
                _ => fs::write(path, zstd::encode_all(&mcap(DRIVE, &messages)[..], 1).unwrap()).unwrap(),
            }
        }
        let Reading { recording, report } = read_path(folder.path(), Some(&map())).unwrap();
        assert_eq!(recording.channel(Channel::Power).unwrap(), up_to(30), "{ending}");
        assert_eq!((recording.runs.len(), report.repairs.len()), (1, 0), "{ending}: {report}");
        metadata(folder.path(), &[&format!("s_10.{ending}"), &format!("bag/s_2.{ending}")]);
        let Reading { recording, report } = read_path(folder.path(), Some(&map())).unwrap();
        assert_eq!(recording.channel(Channel::Power).unwrap(), up_to(20), "{ending}");
        let told = &report.repairs[0];
        assert!(
            told.place.starts_with("s_1.") && told.what.contains("metadata.yaml does not name it"),
            "{told:?}"
        );
        assert_eq!(power(&folder.path().join(format!("s_10.{ending}"))).len(), 10, "one split for itself");
    }
}

#[test]
fn files_that_nothing_says_to_be_splits_are_not_taken_for_one_drive() {
    let folder = folder();
    write(&folder, "monday.mcap", &mcap(DRIVE, &drive(1, 1..=20)));
    write(&folder, "tuesday.mcap", &mcap(DRIVE, &drive(100, 1..=20)));
    let message = refused(folder.path());
    assert!(
        message.contains("no metadata.yaml") && message.contains("monday.mcap, tuesday.mcap"),
        "{message}"
    );
}

#[test]
fn what_is_missing_or_empty_in_a_folder_is_told_or_refused() {
    let folder = folder();
    assert!(refused(folder.path()).contains("holds no .mcap or .db3 file: it is empty"));
    metadata(folder.path(), &["x_0.mcap", "x_1.mcap"]);
    assert!(refused(folder.path()).contains("metadata.yaml names x_0.mcap, x_1.mcap"));
    write(&folder, "x_0.mcap", &mcap(DRIVE, &drive(1, 1..=20)));
    let report = read_path(folder.path(), Some(&map())).unwrap().report;
    assert!(report.repairs[0].what.contains("x_1.mcap, which is not in the folder"), "{report}");
    write(&folder, "x_1.mcap", b"");
    let report = read_path(folder.path(), Some(&map())).unwrap().report;
    assert!(report.repairs[0].place == "x_1.mcap" && report.repairs[0].what.contains("empty"), "{report}");
    write(&folder, "x_1.mcap", b"some text that is no storage");
    let message = refused(folder.path());
    assert!(message.contains("x_1.mcap: this is no recording"), "{message}");
}

#[test]
fn the_content_of_a_file_says_what_it_is_not_its_name() {
    let folder = folder();
    let path = write(&folder, "named.csv", &mcap(DRIVE, &drive(1, 1..=20)));
    assert_eq!(power(&path), up_to(20));
    let path = folder.path().join("named.mcap");
    db3(&path, DRIVE, &drive(1, 1..=20));
    assert_eq!(power(&path), up_to(20));
    let copied = read(fs::read(&path).unwrap(), Format::Db3, "body", Some(&map())).unwrap();
    assert_eq!(copied.recording.channel(Channel::Power).unwrap(), up_to(20));
    assert_eq!(copied.report.format, "ROS 2 SQLite bag");
    let path = write(&folder, "table.csv.zst", &zstd::encode_all(&b"t_s,v_left_mps\n0,1\n"[..], 1).unwrap());
    assert!(refused(&path).contains("v_right_mps"), "packed text is read as text");
    let path = write(&folder, "table.parquet.zst", &zstd::encode_all(&b"PAR1"[..], 1).unwrap());
    assert!(refused(&path).contains("zstd -d"), "{}", refused(&path));
}

#[test]
fn files_that_were_cut_off_are_read_or_refused_with_their_place() {
    let folder = folder();
    let whole = mcap(DRIVE, &drive(1, 1..=20_000));
    let packed = zstd::encode_all(&whole[..], 1).unwrap();
    let path = write(&folder, "cut.mcap.zstd", &packed[..packed.len() - 20]);
    let report = read_path(&path, Some(&map())).unwrap().report;
    assert!(report.rows > 1000 && report.repairs[0].what.contains("breaks off"), "{report}");

    let path = folder.path().join("cut.db3");
    db3(&path, DRIVE, &drive(1, 1..=2000));
    let whole = fs::read(&path).unwrap();
    fs::write(&path, &whole[..whole.len() / 2]).unwrap();
    let message = refused(&path);
    assert!(message.contains(&format!("cut.db3: byte {}: the file ends here", whole.len() / 2)), "{message}");
    let mut zeroed = whole.clone();
    zeroed[whole.len() / 2..].fill(0);
    fs::write(&path, zeroed).unwrap();
    let message = refused(&path);
    assert!(message.contains("cut.db3: table messages, behind row "), "{message}");
    assert!(message.contains("malformed") && message.contains(".recover"), "{message}");
    for length in [16, 100, 3000, 4096] {
        fs::write(&path, &whole[..length]).unwrap();
        let message = refused(&path);
        assert!(message.contains("cut.db3: ") && message.len() > 40, "{message}");
    }
}

#[test]
fn a_database_that_is_no_recording_or_hostile_is_refused() {
    let folder = folder();
    let path = folder.path().join("other.db3");
    rusqlite::Connection::open(&path).unwrap().execute_batch("CREATE TABLE notes(x)").unwrap();
    assert!(refused(&path).contains("no table `topics`"));
    let path = folder.path().join("view.db3");
    db3(&path, DRIVE, &drive(1, 1..=5));
    let hostile = "DROP TABLE messages; CREATE VIEW messages AS WITH RECURSIVE n(x) AS
        (SELECT 1 UNION ALL SELECT x + 1 FROM n) SELECT x AS id, 7 AS topic_id, x AS timestamp, x'' AS data FROM n";
    rusqlite::Connection::open(&path).unwrap().execute_batch(hostile).unwrap();
    assert!(refused(&path).contains("no table `messages`"));
    let path = folder.path().join("number.db3");
    db3(&path, DRIVE, &drive(1, 1..=5));
    let odd = "UPDATE messages SET data = 7 WHERE id = 3";
    rusqlite::Connection::open(&path).unwrap().execute_batch(odd).unwrap();
    let message = refused(&path);
    assert!(message.contains("table messages, behind row 1"), "{message}");
}

#[test]
fn messages_that_the_recorder_had_not_yet_written_are_told_of() {
    let folder = folder();
    let path = folder.path().join("killed.db3");
    db3(&path, DRIVE, &drive(1, 1..=20));
    write(&folder, "killed.db3-wal", b"frames");
    let report = read_path(&path, Some(&map())).unwrap().report;
    assert!(report.repairs[0].place == "killed.db3-wal", "{report}");
}

#[test]
fn a_folder_and_a_file_are_read_behind_one_another() {
    let folder = folder();
    let bag = folder.path().join("bag");
    fs::create_dir(&bag).unwrap();
    db3(&bag.join("bag_0.db3"), Type { definition: DRIVE.definition, ..DRIVE }, &drive(1, 1..=20));
    let file = write(&folder, "other.mcap", &mcap(DRIVE, &drive(1, 1..=30)));
    let (recording, _) = read_paths(&[bag, file], Some(&map())).unwrap();
    let names: Vec<&str> = recording.runs.iter().map(|run| run.name.as_str()).collect();
    assert_eq!((recording.rows(), names), (50, vec!["bag", "other"]));
}

#[test]
fn what_lies_behind_the_end_of_an_mcap_file_is_read_or_told() {
    let first = mcap(DRIVE, &drive(100, 1..=10));
    let second = mcap(Type { name: "my_msgs/msg/Other", ..DRIVE }, &drive(101, 11..=20));
    let read = |bytes: &[u8]| read(bytes.to_vec(), Format::Mcap, "both", Some(&map())).unwrap();
    let same = [first.clone(), mcap(DRIVE, &drive(101, 11..=20))].concat();
    let Reading { recording, report } = read(&same);
    assert_eq!(recording.channel(Channel::Power).unwrap(), up_to(20), "{report}");
    assert!(report.repairs.is_empty(), "{report}");
    // The numbers of channels begin anew, so that what they stood for before does not count.
    let other = read(&[first.clone(), second].concat()).report;
    let messages: Vec<usize> = other.streams.iter().map(|stream| stream.messages).collect();
    assert_eq!(messages, [10, 10], "{other}");
    let Reading { recording, report } = read(&[first.clone(), b"more bytes".to_vec()].concat());
    assert_eq!(recording.rows(), 10);
    let told = &report.repairs[0];
    assert_eq!(told.place, format!("byte {}", first.len()));
    assert!(told.what.contains("10 bytes follow the end") && told.what.contains("left out"), "{told:?}");
    let cut = [&same[..same.len() - 60]].concat();
    assert!(read(&cut).recording.rows() > 15);
}

#[test]
fn a_summary_that_was_cut_off_loses_nothing_and_is_not_told() {
    let whole = mcap(DRIVE, &drive(100, 1..=10));
    for length in (whole.len() - 30)..whole.len() {
        let Reading { recording, report } =
            read(whole[..length].to_vec(), Format::Mcap, "cut", Some(&map())).unwrap();
        assert_eq!((recording.rows(), report.repairs.len()), (10, 0), "{length}: {report}");
    }
}

#[test]
fn power_that_begins_late_and_ends_early_leaves_the_seconds_of_the_wheels() {
    let text = MAP.replace(r#""power_w", "topic": "/drive""#, r#""power_w", "topic": "/battery""#);
    let map = Map::from_json(&text).unwrap();
    let folder = folder();
    let read_of = |battery: &[(u64, Vec<u8>)]| {
        let bytes = mcap_of_topics(&[("/drive", DRIVE, &drive(100, 1..=200)), ("/battery", DRIVE, battery)]);
        read_path(&write(&folder, "x.mcap", &bytes), Some(&map)).unwrap()
    };
    // Every second stamp of the wheels, from 4 s on and up to 13.8 s.
    let battery: Vec<(u64, Vec<u8>)> = drive(104, 1..=99).into_iter().step_by(2).collect();
    let Reading { recording, report } = read_of(&battery);
    assert_eq!((recording.t_s[0], recording.t_s.last().copied()), (0.0, Some(19.8)), "{report}");
    let power = recording.channel(Channel::Power).unwrap();
    let known: Vec<usize> = (0..power.len()).filter(|row| !power[*row].is_nan()).collect();
    assert_eq!((power.len(), known.len(), known[0]), (100, 50, 20), "{report}");
    assert!(recording.channel(Channel::LeftSpeed).unwrap().iter().all(|v_mps| *v_mps == 1.0), "{report}");
    let told = report.repairs.iter().find(|repair| repair.place == "topic /battery").unwrap();
    let says = "it begins 4.0 s after /drive and ends 6.0 s before /drive";
    assert!(told.what.starts_with(says), "{}", told.what);

    // Within a gap of its own rhythm any two topics begin and end.
    let Reading { recording, report } = read_of(&drive(100, 1..=198));
    assert_eq!((recording.rows(), report.repairs.len()), (198, 0), "{report}");
}
