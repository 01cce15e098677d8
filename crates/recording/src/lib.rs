//! Drive logs of a robot as one table of channels on one clock.
//!
//! CSV and Parquet hold rows already; ROS 2 recordings (MCAP, SQLite) and ROS 1 bags hold streams, which a [`Map`] names and [`align`]
//! brings onto one clock. Every reading comes with a [`ReadingReport`]: what was found, used, left aside, repaired, missing
//! and suspicious. Axes and signs, for the whole program: heading counter-clockwise from +x (east), pitch positive nose-up,
//! roll positive left side up, yaw rate positive turning left, power positive when drawn from the battery. A gap is NaN
//! and stays one where it is longer than three steps of its channel; nothing is extrapolated. This crate knows nothing of models.

pub mod align;
mod arrow_schema;
mod bag;
mod bag_loss;
mod beginning;
mod blank_runs;
mod built_in_map;
mod bursts;
mod calendar;
mod cell;
mod channel;
mod clock;
mod clock_offset;
mod coarse;
mod column;
mod columns;
mod combine;
mod compression;
mod container;
mod csv;
mod csv_rows;
mod csv_text;
mod cursor;
mod cut_off;
mod definition;
mod dialect;
mod divide;
mod drawn;
mod error;
mod field;
mod format;
mod gap;
pub mod inspect;
mod joined;
mod label_column;
mod layout;
mod map;
mod mcap;
mod mcap_summary;
mod merge;
mod meter;
mod namespace;
mod open_quote;
mod opposed_part;
mod own_clocks;
mod packs;
mod pages;
mod parquet;
mod parquet_type;
mod plain_text;
mod publishers;
mod quaternion;
mod rate;
mod reading;
mod recording;
mod repeats;
mod report;
mod room;
mod rosbag2;
mod rows;
mod same_drive;
mod same_time;
mod schema;
mod sim_clock;
mod source_choice;
mod stream;
mod stuck_part;
mod suspicion;
mod table;
mod thinned;
mod topic;
mod ulog;
mod units;
mod units_row;
mod unused_runs;
mod walk;
mod watch;

pub use beginning::{BeginningColumn, MOST_COLUMNS, MOST_ROWS, beginning, beginning_of_bytes};
pub use channel::{Channel, Quantity, STANDS_MPS};
pub use clock::{GREATEST_TIME_S, LONGEST_STEP_S, SHORTEST_STEP_S, TimeEvidence, TimeUnit};
pub use columns::{ColumnValues, NamedColumn};
pub use combine::Combine;
pub use error::{Error, TimeError};
pub use format::Format;
pub use map::{Map, MapFile, Place, Sign, Source, Stamp, Target};
pub use reading::{
    Reading, bytes_on_disk, read, read_file, read_path, read_path_watched, read_paths, read_paths_watched,
    unwatched,
};
pub use recording::{Labels, PowerForm, Recording, Run};
pub use report::{
    AlignmentReport, ChannelReport, Ignored, ReadingReport, Repair, RunReport, StreamReport, Suspicion,
    SuspicionKind,
};
pub use room::Room;
pub use same_drive::{join_drives, same_rows};
pub use suspicion::suspicions;
pub use units::{Conversion, unit_names};
pub use watch::Watch;
