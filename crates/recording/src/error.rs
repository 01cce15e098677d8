//! What can be wrong with a recording or a map of one.

mod missing;
mod time;

use self::missing::{hints, reasons};
pub use self::time::TimeError;
use crate::Channel;

/// An error of the recording crate; the message names file, place and channel, and says how to mend it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An error in a named file.
    #[error("{path}: {source}")]
    InFile {
        /// The file.
        path: String,
        /// What is wrong with it.
        source: Box<Error>,
    },
    /// The file cannot be read at all.
    #[error("{0}")]
    Io(#[from] std::io::Error),
    /// A file name that says nothing about its format.
    #[error(
        "`{ending}` is no recording: the name must end in .csv (or .csv.gz, .csv.zst), .parquet, .mcap, .db3, .bag or .ulg, or be that of a folder of \
         `ros2 bag record`"
    )]
    UnknownFormat {
        /// The ending found.
        ending: String,
    },
    /// The map file is not the JSON that a map needs.
    #[error("map, {0}")]
    Json(#[from] document::Error),
    /// A field of the map contradicts another or names what does not exist.
    #[error("map, {path}: {message}")]
    Map {
        /// Where in the document, as `sources[3].unit`.
        path: String,
        /// What is wrong there.
        message: String,
    },
    /// A source of the map gives a unit that its channel cannot come in.
    #[error("map, sources[{index}].unit: `{unit}` is no unit of {channel}; it may be {}{}", known.join(", "),
        if *needs_radius { ", and wheel_radius_m must be given" } else { "" })]
    Unit {
        /// Which source, from 0.
        index: usize,
        /// The unit found.
        unit: String,
        /// The channel it was given for.
        channel: String,
        /// The units it may be.
        known: Vec<&'static str>,
        /// The unit would do if the map gave the wheel radius.
        needs_radius: bool,
    },
    /// Something of the map is not in the recording, or is of another kind there.
    #[error("topic {topic}, field `{field}`: {reason}")]
    Field {
        /// The topic.
        topic: String,
        /// The field path.
        field: String,
        /// Why it cannot be read.
        reason: String,
    },
    /// Channels without which a recording tells nothing.
    #[error("{missing} missing; found: {}{}{}", found.join(", "), hints(nearest), reasons(unread))]
    Missing {
        /// What is missing, in words.
        missing: String,
        /// The columns or topics of the file.
        found: Vec<String>,
        /// The nearest of them, with the name that was looked for.
        nearest: Vec<(String, String)>,
        /// Topics that the map names, and why they could not be read.
        unread: Vec<String>,
    },
    /// A file among those to be joined on time that is no table.
    #[error(
        "only tables, .csv or .parquet, can be joined by `+`, and this is .{ending}; a bag holds all of its topics"
    )]
    NoTable {
        /// The ending of its name.
        ending: String,
    },
    /// Tables to be joined that have different drives.
    #[error(
        "{first} has the runs {first_runs} and {second} has {second_runs}; give both the same names in a column `run`, or one run each"
    )]
    JoinedRuns {
        /// A table.
        first: String,
        /// Its runs.
        first_runs: String,
        /// Another.
        second: String,
        /// Its runs.
        second_runs: String,
    },
    /// Tables to be joined that were not recorded at the same time.
    #[error(
        "the times of {first} ({} to {} s) and {second} ({} to {} s) do not meet; both must count from the same moment",
        first_s[0], first_s[1], second_s[0], second_s[1]
    )]
    Apart {
        /// A table.
        first: String,
        /// Its first and last time \[s\].
        first_s: [f64; 2],
        /// Another.
        second: String,
        /// Its first and last time \[s\].
        second_s: [f64; 2],
    },
    /// Runs that hold the same seconds of one drive, which would count twice.
    #[error(
        "run `{first_run}` of {first} and run `{second_run}` of {second} hold the same drive from {from_s:.1} s to {until_s:.1} s of the latter; \
         leave one of them out, or cut off what both hold"
    )]
    SameDrive {
        /// A file.
        first: String,
        /// Its run.
        first_run: String,
        /// The file of the other run.
        second: String,
        /// The other run.
        second_run: String,
        /// First time that both hold, by the clock of the latter \[s\].
        from_s: f64,
        /// Last time that both hold, by the clock of the latter \[s\].
        until_s: f64,
    },
    /// Tables to be joined that give the same channel.
    #[error("both {first} and {second} give {channel}; remove or rename one of the columns")]
    GivenTwice {
        /// The channel.
        channel: Channel,
        /// A table.
        first: String,
        /// Another.
        second: String,
    },
    /// Two columns of one name, or two columns for one channel.
    #[error("two columns give {channel}: `{first}` and `{second}`; rename one of them or map it `aside`")]
    Duplicate {
        /// The channel.
        channel: String,
        /// One column.
        first: String,
        /// The other.
        second: String,
    },
    /// A cell of a numeric column that holds no number.
    #[error("{position}, column `{column}`: `{found}` is no finite number; {remedy}")]
    Number {
        /// Line or row.
        position: Position,
        /// The column.
        column: String,
        /// What stands there.
        found: String,
        /// How to mend it.
        remedy: String,
    },
    /// Columns in memory that do not belong to one table.
    #[error("column `{column}` has {rows} rows, but `{first}` has {expected}; give every column as many")]
    Ragged {
        /// The column.
        column: String,
        /// Its rows.
        rows: usize,
        /// The first column.
        first: String,
        /// Rows of the first column.
        expected: usize,
    },
    /// Two encoders of one side that turn against each other.
    #[error(
        "`{first}` and `{second}` are of one side and turn in opposite directions in {rows} of {of} rows in which both turn: one has the other \
         sign, and their mean is none of both; turn its sign in the file, or leave it out of the map"
    )]
    Opposed {
        /// An encoder.
        first: String,
        /// Another.
        second: String,
        /// Rows in which they turn against each other.
        rows: usize,
        /// Rows in which both turn.
        of: usize,
    },
    /// A table of one number a row, with its name beside it.
    #[error(
        "each of its rows has one number in `{values}`, and its name in `{names}`: make one column of each name, as pandas does by \
         `df.pivot(columns=\"{names}\", values=\"{values}\", index=...)` with the column of times as index"
    )]
    LongTable {
        /// The column of names.
        names: String,
        /// The column of numbers.
        values: String,
    },
    /// A row of units below the header that contradicts what the columns are taken to be in.
    #[error(
        "line {line}, column `{column}`: the row of units says `{found}`, {}",
        if *is_known {
            format!("but the column is taken to be in `{taken}`; name it with its unit in a map, and remove the line if that agrees")
        } else {
            format!("which is no unit that is known, where `{taken}` was expected; remove the line if the column is in `{taken}`")
        }
    )]
    UnitsRow {
        /// Line of the row.
        line: u64,
        /// The column.
        column: String,
        /// What stands there.
        found: String,
        /// The unit that its name or a map says.
        taken: String,
        /// Whether it is a unit of the quantity.
        is_known: bool,
    },
    /// Something is wrong with times.
    #[error(transparent)]
    Time(#[from] TimeError),
    /// The CSV text is malformed.
    #[error("line {line}: {message}")]
    Csv {
        /// Line from 1.
        line: u64,
        /// What is wrong there.
        message: String,
    },
    /// The Parquet library refused the file.
    #[error("not a readable Parquet file: {}", parquet_reason(.0))]
    Parquet(#[from] parquet::errors::ParquetError),
    /// The file is not of the format that its name says.
    #[error("this is no {format} file: {reason}")]
    NotTheFormat {
        /// The format expected.
        format: &'static str,
        /// What is there instead.
        reason: String,
    },
    /// SQLite refuses a file, or a place in it.
    #[error("{place}: {reason}; `sqlite3 FILE .recover` saves what is whole")]
    Database {
        /// Where, as `table messages, after id 120`.
        place: String,
        /// What SQLite says.
        reason: String,
    },
    /// A file that is held or copied as a whole and is longer than any.
    #[error(
        "it has more than {most} bytes when unpacked, and is not read so; unpack it with `zstd -d` first"
    )]
    TooLong {
        /// The most that is read \[bytes\].
        most: u64,
    },
    /// A folder that holds no recording.
    #[error("the folder holds no .mcap or .db3 file: {found}")]
    NoStorage {
        /// What it holds, or its `metadata.yaml` names.
        found: String,
    },
    /// A folder of files that nothing says to be splits of one recording.
    #[error(
        "the folder has no metadata.yaml, and its files are no splits of one recording, as drive_0.mcap and drive_1.mcap: name them one by \
         one; {found}"
    )]
    NotOneRecording {
        /// What it holds.
        found: String,
    },
    /// A topic that the map names has no message that could be read.
    #[error(
        "topic {topic}: none of its {messages} messages is a {type_name} as its definition says: {reason}"
    )]
    Undecodable {
        /// The topic.
        topic: String,
        /// Its type.
        type_name: String,
        /// Messages there.
        messages: usize,
        /// What was wrong with the first.
        reason: String,
    },
    /// A text column with so many names that it must be something else.
    #[error(
        "{position}, column `{column}`: more than {most} different names; is it a number? Rename the column"
    )]
    TooManyNames {
        /// Line or row.
        position: Position,
        /// The column.
        column: String,
        /// The most that are read.
        most: usize,
    },
    /// More rows or messages than are held in memory, of which neighbours cannot become one.
    #[error(
        "the file has more than the {most} rows that are held in memory, and neighbours cannot be joined where time does not increase \
         or runs take turns: sort it by run and time, or cut it into several files"
    )]
    TooLarge {
        /// The most that are held.
        most: usize,
    },
    /// A table that claims more rows than any recording has.
    #[error(
        "the file claims {rows} rows, which no recording has; it is damaged, or cut it into several files"
    )]
    Claims {
        /// What it claims.
        rows: u64,
    },
    /// Several robots, of which none is named.
    #[error("it holds several robots, with the namespaces {}; give the one that is meant as `namespace` in a map", namespaces.join(" and "))]
    SeveralRobots {
        /// Their namespaces.
        namespaces: Vec<String>,
    },

    /// A topic that all rows would come from has one message.
    #[error(
        "topic {topic} has one message only, from which power cannot be told; record it for as long as the robot drives"
    )]
    OneMessage {
        /// The topic.
        topic: String,
    },
    /// Who asked for it stopped the reading.
    #[error("the reading was stopped")]
    Stopped,
    /// The file holds no rows or no messages of the topics that the map names.
    #[error("there is nothing to read: {found}")]
    Empty {
        /// What was found instead.
        found: String,
    },
}

/// A place in a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Position {
    /// A line of a text file, from 1.
    Line(u64),
    /// A row of a table, from 1.
    Row(u64),
}

impl std::fmt::Display for Position {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Position::Line(line) => write!(f, "line {line}"),
            Position::Row(row) => write!(f, "row {row}"),
        }
    }
}

impl Error {
    /// Says in which file it happened.
    #[must_use]
    pub fn in_file(self, path: &std::path::Path) -> Error {
        Error::InFile { path: path.display().to_string(), source: Box::new(self) }
    }

    /// The columns or topics of the file, where something is missing.
    pub(crate) fn found(&self) -> Option<&[String]> {
        match self {
            Error::Missing { found, .. } => Some(found),
            Error::InFile { source, .. } => source.found(),
            _ => None,
        }
    }

    /// Says why topics that the map names were not read, where something is missing.
    pub(crate) fn with_unread(mut self, reasons: Vec<String>) -> Error {
        if let Error::Missing { unread, .. } = &mut self {
            *unread = reasons;
        }
        self
    }
}

/// What the Parquet library says, and how to mend it.
fn parquet_reason(error: &parquet::errors::ParquetError) -> String {
    let said = error.to_string();
    match said.split_once("Disabled feature at compile time: ") {
        Some((_, codec)) => format!(
            "its columns are compressed with {codec}, which is not read here; write it with zstd, snappy, gzip or none"
        ),
        None if said.contains("checksum") => said,
        None => format!("{said}; was it closed by its writer?"),
    }
}

/// The beginning of what stands in a file, short enough for a message.
pub(crate) fn excerpt(text: &str) -> String {
    text.chars().take(60).collect()
}
