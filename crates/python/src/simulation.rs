//! Drives through a world of its own, which may conceal effects.

use std::path::PathBuf;

use pyo3::prelude::*;
use recording::{Format, read};
use service::{Problem, ProblemType};
use world::{Drive, Key, RobotFile, World};

use crate::{
    computation::beside,
    problem::{Failure, internal, invalid_recording},
    recording::Recording,
    robot::Robot,
};

/// What a simulated drive's run is called: as that of a file `drive.csv`.
const RUN_NAME: &str = "drive";

/// A recording as `joulepath simulate` writes it, and what is true of it as JSON where that is asked for.
#[pyfunction]
#[pyo3(signature = (robot, world, drive, folder, with_key))]
pub(crate) fn simulate(
    py: Python<'_>,
    robot: &Robot,
    world: &str,
    drive: &str,
    folder: Option<PathBuf>,
    with_key: bool,
) -> PyResult<(Recording, Vec<u8>, Option<String>)> {
    let robot = robot.robot.clone();
    let found = beside(py, None, |_| {
        let text = serde_json::to_string(&*robot).map_err(internal)?;
        let robot = RobotFile::from_json(&text).map_err(|error| refused(&error, "/robot"))?;
        let world = World::from_json(world).map_err(|error| refused(&error, "/world"))?;
        let world = match &folder {
            Some(folder) => world.beside(folder),
            None => world,
        };
        let drive = Drive::from_json(drive).map_err(|error| refused(&error, "/drive"))?;
        let log = world::simulate(&world, &robot, &drive).map_err(|error| refused(&error, "/world"))?;
        let mut csv = Vec::new();
        log.write_csv(&mut csv).map_err(internal)?;
        let key = with_key
            .then(|| Key::of(&world, &robot, &drive).map_err(|error| refused(&error, "/world")))
            .transpose()?;
        let key = key.map(|key| serde_json::to_string(&key).map_err(internal)).transpose()?;
        // The text that a file would hold, so that both are the same recording to the last digit.
        let reading =
            read(csv.clone(), Format::Csv, RUN_NAME, None).map_err(|error| invalid_recording(&error))?;
        Ok::<_, Failure>((reading, csv, key))
    });
    found.map(|(reading, csv, key)| (Recording::of(reading), csv, key))
}

/// A world, drive or robot that cannot be simulated; `under` is where it stands.
fn refused(error: &world::Error, under: &str) -> Problem {
    let place =
        error.field().map_or(String::new(), |field| field.split('.').map(document::pointer).collect());
    Problem::new(ProblemType::InvalidRequest, error.to_string()).at(format!("{under}{place}"))
}
