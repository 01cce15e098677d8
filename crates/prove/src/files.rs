//! What the diagnosis gets to see of a case.

use std::{fs::File, io::BufWriter, path::Path};

use world::Log;

use crate::Error;

/// The drive under suspicion.
pub const RECORDING: &str = "recording.csv";
/// The robot when it is healthy, as its file says.
pub const ROBOT: &str = "robot.json";
/// Drives of the same robot from before.
pub const REFERENCE: &str = "reference.csv";

/// The robot calibrated on these.
pub const CALIBRATED: &str = "calibrated.json";

/// How all cases together came out.
pub(crate) const SCOREBOARD: &str = "scoreboard.json";

/// The files of a case as it is dealt.
pub(crate) const ALL: [&str; 3] = [RECORDING, ROBOT, REFERENCE];

/// Writes a recording.
pub(crate) fn write_log(log: &Log, path: &Path) -> Result<(), Error> {
    let file = File::create(path).map_err(Error::file(path))?;
    log.write_csv(BufWriter::new(file)).map_err(Error::file(path))
}

/// Writes text.
pub(crate) fn write(path: &Path, text: &str) -> Result<(), Error> {
    std::fs::write(path, text).map_err(Error::file(path))
}

/// Makes a folder.
pub(crate) fn folder(path: &Path) -> Result<(), Error> {
    std::fs::create_dir_all(path).map_err(Error::file(path))
}

/// Copies a file.
pub(crate) fn copy(from: &Path, to: &Path) -> Result<(), Error> {
    std::fs::copy(from, to).map(|_| ()).map_err(Error::file(from))
}

/// Reads a file.
pub(crate) fn read(path: &Path) -> Result<Vec<u8>, Error> {
    std::fs::read(path).map_err(Error::file(path))
}
