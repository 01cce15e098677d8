//! What the world wrote, as a file of it is read.

#![allow(clippy::panic)]

use recording::{Reading, read_path};
use world::Log;

/// Writes a log to a file and reads that back.
///
/// # Panics
/// When there is no room for the file, and when it is no recording.
pub(crate) fn read_back(log: &Log) -> Reading {
    let read = || -> Result<Reading, Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("drive.csv");
        log.write_csv(std::fs::File::create(&path)?)?;
        Ok(read_path(&path, None)?)
    };
    read().unwrap_or_else(|error| panic!("a log that is no recording: {error}"))
}
