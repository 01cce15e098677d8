//! Reading a file, whatever its format.

use std::{
    fs::File,
    io::{Cursor, Read},
    ops::ControlFlow,
    path::Path,
    sync::{Arc, atomic::Ordering},
};

use serde::{Deserialize, Serialize};

use crate::{
    Channel, Error, Ignored, Map, PowerForm, ReadingReport, Recording, Watch, bag, csv, mcap, parquet,
    suspicion, watch::Watched,
};

/// A recording and what reading it found.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// The table.
    pub recording: Recording,
    /// What reading it found.
    pub report: ReadingReport,
}

/// A file format of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Format {
    /// Comma-, semicolon- or tab-separated text with a header line.
    Csv,
    /// Parquet with the same columns.
    Parquet,
    /// A ROS 2 MCAP file.
    Mcap,
    /// A ROS 1 bag, version 2.0.
    Bag,
}

impl Format {
    /// The format that a file name's ending stands for.
    ///
    /// # Errors
    /// The ending, when it stands for none.
    pub fn of(path: &Path) -> Result<Format, Error> {
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match ending.as_str() {
            "csv" | "tsv" | "txt" => Ok(Format::Csv),
            "parquet" => Ok(Format::Parquet),
            "mcap" => Ok(Format::Mcap),
            "bag" => Ok(Format::Bag),
            _ => Err(Error::UnknownFormat { ending: format!(".{ending}") }),
        }
    }
}

/// Reads a file; its ending says which format it is in. Without a map, a table's columns are what their names say and a
/// bag's topics are taken for a Husky's.
///
/// The file is read once, front to back (Parquet by columns), and of it only the numbers of the channels are held.
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
    let read = || {
        let format = Format::of(path)?;
        let name = path.file_stem().and_then(|stem| stem.to_str()).unwrap_or("recording");
        read_file(File::open(path)?, format, name, map, watch)
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
    file: File,
    format: Format,
    name: &str,
    map: Option<&Map>,
    watch: &Watch,
) -> Result<Reading, Error> {
    let file = Watched::new(file, Arc::clone(watch));
    let stopped = file.stopped();
    let reading = match format {
        Format::Csv => csv::read(file, name, map),
        Format::Parquet => parquet::read(file, name, map),
        Format::Mcap => mcap::read(file, name, map),
        Format::Bag => bag::read(file, name, map),
    };
    if stopped.load(Ordering::Relaxed) { Err(Error::Stopped) } else { reading }
}

/// A watch that lets everything pass.
fn unwatched() -> Watch {
    Arc::new(|_| ControlFlow::Continue(()))
}

/// Reads several files and puts their runs behind one another.
///
/// # Errors
/// The first file's that cannot be read.
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
    let (mut recordings, mut reports) = (Vec::new(), Vec::new());
    for path in paths {
        let reading = read_path_watched(path.as_ref(), map, watch)?;
        recordings.push(reading.recording);
        reports.push(reading.report);
    }
    Ok((Recording::join(recordings), reports))
}

/// Reads what is already in memory, as the body of a request. The name becomes that of the run where the recording has
/// none of its own.
///
/// # Errors
/// What is wrong, with line, row or topic.
pub fn read(bytes: Vec<u8>, format: Format, name: &str, map: Option<&Map>) -> Result<Reading, Error> {
    match format {
        Format::Parquet => parquet::read(bytes::Bytes::from(bytes), name, map),
        Format::Csv => csv::read(Cursor::new(bytes), name, map),
        Format::Mcap => mcap::read(Cursor::new(bytes), name, map),
        Format::Bag => bag::read(Cursor::new(bytes), name, map),
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
    pub(crate) fn finish(part: Part, name: &str, map: Option<&Map>) -> Result<Reading, Error> {
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
            // One side alone is the likelier slip: name the other side rather than every form of power.
            let half =
                PowerForm::ALL.iter().find(|(_, needs)| needs.iter().filter(|c| !lacks(c)).count() == 1);
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
        report.describe(&recording);
        report.suspicions = suspicion::find(&recording);
        Ok(Reading { recording, report })
    }
}

/// Fills a buffer with exactly so many bytes, or with what there is before the end; never holds more than was there.
pub(crate) fn read_up_to(source: &mut impl Read, bytes: u64, buffer: &mut Vec<u8>) -> Result<bool, Error> {
    buffer.clear();
    let got = source.take(bytes).read_to_end(buffer)?;
    Ok(got as u64 == bytes)
}
