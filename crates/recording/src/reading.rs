//! Reading a file, whatever its format.

use std::{
    fs::{self, File},
    io::{Cursor, Read},
    ops::ControlFlow,
    path::Path,
    sync::{Arc, atomic::Ordering},
};

use crate::{
    Channel, Error, Format, Ignored, Map, PowerForm, ReadingReport, Recording, Room, Watch, bag, csv,
    format::{self, ZSTD_MAGIC, ending_of, run_name},
    joined::{join_in_time, tables_of},
    mcap,
    mcap_summary::Summary,
    parquet,
    rosbag2::{db3, folder, storage},
    same_drive::join_drives,
    suspicion::suspicions_watched,
    ulog,
    unused_runs::tell_unused_runs,
    watch::{Budget, Looks, Watched},
};

/// A recording and what reading it found.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// The table.
    pub recording: Recording,
    /// What reading it found.
    pub report: ReadingReport,
}

/// Reads a file, or the folder that `ros2 bag record` leaves. Its first bytes say which format it is in, and its ending where
/// they say nothing, as in CSV. Without a map, a table's columns are what their names say and a bag's topics are taken for a
/// Husky's.
///
/// The file is read once, front to back, and of it only the numbers of the channels are held, in the [`Room`] that there is: where they
/// fill it, neighbouring rows become means, as the report then says.
///
/// # Errors
/// What is wrong, with file and line, row or topic.
pub fn read_path(path: &Path, map: Option<&Map>) -> Result<Reading, Error> {
    read_path_watched(path, map, &unwatched())
}

/// Reads a file as [`read_path`] does, followed by a watch.
///
/// # Errors
/// As [`read_path`], and [`Error::Stopped`] when the watch breaks.
pub fn read_path_watched(path: &Path, map: Option<&Map>, watch: &Watch) -> Result<Reading, Error> {
    read_path_within(path, map, watch, Room::default())
}

fn read_path_within(path: &Path, map: Option<&Map>, watch: &Watch, room: Room) -> Result<Reading, Error> {
    let read = || {
        let budget = Budget { room, looks: Looks::new(watch) };
        let name = &run_name(path);
        if path.is_dir() {
            return folder::read(path, name, map, watch, &budget);
        }
        let mut file = File::open(path)?;
        let head = format::head(&mut file)?;
        match Format::of_content(&head) {
            Some(Format::Db3) => storage::read(path, name, map, watch, &budget),
            // Text may be packed too, and is then unpacked as text.
            None if head.starts_with(&ZSTD_MAGIC) && Format::of(path).ok() != Some(Format::Csv) => {
                storage::read(path, name, map, watch, &budget)
            }
            Some(format) => read_file(file, format, name, map, watch, room),
            None => read_file(file, Format::of(path)?, name, map, watch, room),
        }
    };
    let mut reading = read().map_err(|error: Error| error.in_file(path))?;
    reading.report.source = path.display().to_string();
    Ok(reading)
}

/// Reads an open file of a known format, followed by a watch. The name becomes that of the run where the recording has
/// none of its own.
///
/// # Errors
/// What is wrong, with line, row or topic; [`Error::Stopped`] when the watch breaks.
pub fn read_file(
    mut file: File,
    format: Format,
    name: &str,
    map: Option<&Map>,
    watch: &Watch,
    room: Room,
) -> Result<Reading, Error> {
    let summary = if format == Format::Mcap { Summary::of(&mut file) } else { Summary::default() };
    let file = Watched::new(file, Arc::clone(watch));
    let stopped = file.stopped();
    let budget = Budget { room, looks: Looks::new(watch) };
    let finish = |part| Reading::finish(part, name, map, &budget.looks);
    let reading = match format {
        Format::Csv => csv::read(file, name, of_columns(map), &budget).and_then(finish),
        Format::Parquet => parquet::read(file, name, of_columns(map), &budget).and_then(finish),
        Format::Mcap => mcap::read(file, summary, name, map, &budget),
        Format::Bag => bag::read(file, name, map, &budget),
        Format::Db3 => db3::read_copy(file, name, map, &budget),
        Format::Ulog => ulog::read(file, name, map, &budget),
    };
    if stopped.load(Ordering::Relaxed) { Err(Error::Stopped) } else { reading }
}

/// A map as far as it is of tables: one that names topics only leaves columns to their names.
pub(crate) fn of_columns(map: Option<&Map>) -> Option<&Map> {
    map.filter(|map| map.names_columns())
}

/// Reads a table that may lack what a recording needs, since others hold it.
fn read_table(path: &Path, map: Option<&Map>, watch: &Watch, room: Room) -> Result<Part, Error> {
    let budget = Budget { room, looks: Looks::new(watch) };
    let name = &run_name(path);
    let read = || {
        let format = Format::of(path)?;
        let file = Watched::new(File::open(path)?, Arc::clone(watch));
        let stopped = file.stopped();
        let part = match format {
            Format::Csv => csv::read(file, name, of_columns(map), &budget),
            Format::Parquet => parquet::read(file, name, of_columns(map), &budget),
            Format::Mcap | Format::Bag | Format::Db3 | Format::Ulog => {
                Err(Error::NoTable { ending: ending_of(path) })
            }
        };
        if stopped.load(Ordering::Relaxed) { Err(Error::Stopped) } else { part }
    };
    read().map_err(|error: Error| error.in_file(path))
}

/// The columns of a table by a map, whatever they lack of a recording.
pub(crate) fn read_part(path: &Path, map: &Map) -> Result<Recording, Error> {
    Ok(read_table(path, Some(map), &unwatched(), Room::default())?.recording)
}

/// A watch that lets everything pass.
pub fn unwatched() -> Watch {
    Arc::new(|_| ControlFlow::Continue(()))
}

/// Reads several files and puts their runs behind one another. Tables of one drive that are joined by `+`, as
/// `wheels.csv+power.csv`, become one recording on one clock.
///
/// # Errors
/// The first file's that cannot be read; [`Error::SameDrive`] where two runs hold the same seconds of a drive.
pub fn read_paths<P: AsRef<Path>>(
    paths: &[P],
    map: Option<&Map>,
) -> Result<(Recording, Vec<ReadingReport>), Error> {
    read_paths_watched(paths, map, &unwatched())
}

/// Reads several files as [`read_paths`] does, followed by a watch.
///
/// # Errors
/// As [`read_paths`], and [`Error::Stopped`] when the watch breaks.
pub fn read_paths_watched<P: AsRef<Path>>(
    paths: &[P],
    map: Option<&Map>,
    watch: &Watch,
) -> Result<(Recording, Vec<ReadingReport>), Error> {
    let all_bytes = paths
        .iter()
        .map(|path| tables_of(path.as_ref()).iter().map(|path| bytes_on_disk(path)).sum::<u64>())
        .sum();
    let room = |path: &Path| Room::default().share(bytes_on_disk(path), all_bytes);
    let (mut recordings, mut reports) = (Vec::new(), Vec::new());
    for path in paths {
        let reading = match tables_of(path.as_ref()).as_slice() {
            [path] => read_path_within(path, map, watch, room(path))?,
            tables => {
                let parts =
                    tables.iter().map(|path| Ok((path.clone(), read_table(path, map, watch, room(path))?)));
                join_in_time(parts.collect::<Result<_, Error>>()?, map, &Looks::new(watch))?
            }
        };
        recordings.push(reading.recording);
        reports.push(reading.report);
    }
    let sources = reports.iter().map(|report: &ReadingReport| report.source.clone());
    let joined = join_drives(sources.zip(recordings).collect(), watch)?;
    tell_unused_runs(&joined, &mut reports);
    Ok((joined, reports))
}

/// The length of a file, or of all files of a folder \[bytes\]; 0 for what cannot be looked at.
pub fn bytes_on_disk(path: &Path) -> u64 {
    let bytes = |path: &Path| fs::metadata(path).map_or(0, |data| data.len());
    match fs::read_dir(path) {
        Ok(entries) => entries.flatten().map(|entry| bytes(&entry.path())).sum(),
        Err(_) => bytes(path),
    }
}

/// Reads what is already in memory, as the body of a request. The name becomes that of the run where the recording has
/// none of its own.
///
/// # Errors
/// What is wrong, with line, row or topic.
pub fn read(bytes: Vec<u8>, format: Format, name: &str, map: Option<&Map>) -> Result<Reading, Error> {
    read_within(bytes, format, name, map, Room::default())
}

/// Reads what is in memory into the room that there is.
pub(crate) fn read_within(
    bytes: Vec<u8>,
    format: Format,
    name: &str,
    map: Option<&Map>,
    room: Room,
) -> Result<Reading, Error> {
    let budget = Budget { room, looks: Looks::new(&unwatched()) };
    let finish = |part| Reading::finish(part, name, map, &budget.looks);
    match format {
        Format::Parquet => {
            parquet::read(bytes::Bytes::from(bytes), name, of_columns(map), &budget).and_then(finish)
        }
        Format::Csv => csv::read(Cursor::new(bytes), name, of_columns(map), &budget).and_then(finish),
        Format::Mcap => {
            let mut source = Cursor::new(bytes);
            let summary = Summary::of(&mut source);
            mcap::read(source, summary, name, map, &budget)
        }
        Format::Bag => bag::read(Cursor::new(bytes), name, map, &budget),
        Format::Db3 => db3::read_copy(Cursor::new(bytes), name, map, &budget),
        Format::Ulog => ulog::read(Cursor::new(bytes), name, map, &budget),
    }
}

/// What a format's reader hands over.
pub(crate) struct Part {
    pub(crate) recording: Recording,
    pub(crate) report: ReadingReport,
    /// Names of the columns or topics in the file.
    pub(crate) found: Vec<String>,
    pub(crate) format: &'static str,
}

impl Reading {
    /// Takes out what holds nothing, checks that the rest is a recording, and completes the report.
    pub(crate) fn finish(part: Part, name: &str, map: Option<&Map>, looks: &Looks) -> Result<Reading, Error> {
        let Part { mut recording, mut report, mut found, format } = part;
        let mut empty = Vec::new();
        recording.channels.retain(|channel, values| {
            let holds = values.iter().any(|value| !value.is_nan());
            if !holds {
                empty.push(*channel);
            }
            holds
        });
        for channel in empty {
            report.channels.retain(|used| used.channel != channel);
            found.iter_mut().filter(|f| *f == channel.name()).for_each(|f| f.push_str(" (without a number)"));
            report.ignored.push(Ignored { name: channel.name().into(), reason: "it holds no number".into() });
        }
        let lacks = |channel: &Channel| !recording.channels.contains_key(channel);
        let wheels = [Channel::LeftSpeed, Channel::RightSpeed];
        let missing: Vec<Channel> = wheels.into_iter().filter(lacks).collect();
        let power = recording.power_form().is_none();
        if power || !missing.is_empty() {
            // One side alone is the likelier slip: name the other side rather than every form of power. A voltage is
            // recorded for itself.
            let has = |channel: &&Channel| !lacks(channel) && **channel != Channel::Voltage;
            let half = PowerForm::ALL.iter().find(|(_, needs)| needs.iter().filter(has).count() == 1);
            return Err(match half {
                Some((_, needs)) if power => {
                    let other = needs.iter().filter(|channel| lacks(channel));
                    Error::missing(
                        &missing.into_iter().chain(other.copied()).collect::<Vec<_>>(),
                        false,
                        &found,
                    )
                }
                _ => Error::missing(&missing, power, &found),
            });
        }
        report.source = name.to_owned();
        report.format = format.to_owned();
        report.map = map.map(|map| map.name.clone());
        report.channels.sort_by_key(|used| used.channel);
        map.iter().try_for_each(|map| map.derive_columns(&mut recording))?;
        report.repairs.extend(map.and_then(|map| map.settle_drawn_column(&mut recording, &report)));
        recording.wheel_radius_m =
            map.and_then(|map| map.wheel_radius_m).filter(|_| report.has_wheel_rates());
        report.describe(&recording, looks)?;
        report.suspicions = suspicions_watched(&recording, looks)?;
        Ok(Reading { recording, report })
    }
}

/// Fills a buffer with exactly so many bytes, or with what there is before the end; never holds more than was there.
pub(crate) fn read_up_to(source: &mut impl Read, bytes: u64, buffer: &mut Vec<u8>) -> Result<bool, Error> {
    buffer.clear();
    let got = source.take(bytes).read_to_end(buffer)?;
    Ok(got as u64 == bytes)
}

#[cfg(test)]
mod tests {
    use std::fmt::Write as _;

    use super::*;

    const ROWS: usize = 20_000;

    /// Two drives of 100 s at 100 Hz with a pause, in which the power is that of the time.
    fn long_table() -> Vec<u8> {
        let mut text = String::from("run,t_s,v_left_mps,v_right_mps,power_w,heading_deg,note,gear\n");
        for row in 0..ROWS {
            let t_s = (row % (ROWS / 2)) as f64 * 0.01 + if row % (ROWS / 2) < 5000 { 0.0 } else { 7.0 };
            let (drive, heading_deg) = (row * 2 / ROWS, 180.0 + 20.0 * t_s.sin());
            let heading_deg = (heading_deg + 180.0).rem_euclid(360.0) - 180.0;
            writeln!(text, "drive-{drive},{t_s:.2},0.5,0.6,{:.4},{heading_deg:.3},x,3", 50.0 + t_s).unwrap();
        }
        text.into_bytes()
    }

    fn map() -> Map {
        let source = r#"{"channel": "heading_rad", "column": "heading_deg", "unit": "deg"}"#;
        Map::from_json(&format!(r#"{{"name": "lab", "sources": [{source}]}}"#)).unwrap()
    }

    #[test]
    fn a_table_beyond_its_room_becomes_means_and_says_so() {
        let whole = read(long_table(), Format::Csv, "long", Some(&map())).unwrap();
        let room = Room::of_rows(1000);
        let Reading { recording, report } =
            read_within(long_table(), Format::Csv, "long", Some(&map()), room).unwrap();
        assert_eq!(whole.recording.rows(), ROWS);
        assert!((250..=500).contains(&recording.rows()), "{}", recording.rows());
        let told = &report.repairs[0].what;
        assert!(told.starts_with("20000 are more than are held") && told.contains("up to 64"), "{told}");
        assert!(report.ignored.iter().any(|i| i.name == "gear" && i.reason.contains("too long")), "{report}");
        assert_eq!(report.runs.iter().map(|run| run.gaps).collect::<Vec<_>>(), [1, 1], "the pause stays");
        let steps_s = recording.t_s.windows(2).map(|pair| pair[1] - pair[0]);
        let even = steps_s.filter(|step_s| (step_s - 0.64).abs() < 1e-6).count();
        assert!(10 * even > 9 * recording.rows(), "one rhythm throughout: {even} of {}", recording.rows());
        // Power is linear in time, so that means lie on the same line, and headings never point east.
        let power_w = recording.channel(Channel::Power).unwrap();
        for (row, t_s) in recording.t_s.iter().enumerate() {
            assert!((power_w[row] - (50.0 + t_s)).abs() < 1e-3, "row {row}");
            assert!(recording.channel(Channel::Heading).unwrap()[row].cos() < -0.9, "row {row}");
        }
        assert_eq!(recording.runs.len(), 2);
    }

    #[test]
    fn what_is_wrong_far_into_a_long_table_is_still_named_by_its_line() {
        let text = String::from_utf8(long_table()).unwrap();
        let back = text.replacen("drive-1,80.01,", "drive-1,3.5,", 1);
        let line = back.lines().position(|line| line.starts_with("drive-1,3.5,")).unwrap() + 1;
        let refused = read_within(back.into_bytes(), Format::Csv, "long", None, Room::of_rows(1000));
        let message = refused.unwrap_err().to_string();
        assert!(message.contains(&format!("line {line}")) && message.contains("goes back"), "{message}");
        let mut turns = String::from("run,t_s,v_left_mps,v_right_mps,power_w\n");
        (0..4000).for_each(|row| writeln!(turns, "{},{}.0,0.5,0.5,40", row % 2, row / 2).unwrap());
        let refused = read_within(turns.into_bytes(), Format::Csv, "turns", None, Room::of_rows(1000));
        let message = refused.unwrap_err().to_string();
        assert!(message.contains("runs take turns") && message.contains("sort it by run"), "{message}");
    }
}
