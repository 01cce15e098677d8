//! Drives in the independent world, as a diagnosis gets them.

#![allow(clippy::panic)]

use recording::{Recording, read_paths};
use world::{Drive, DriveKind, Effect, RobotFile, World, simulate};

/// A rich drive of the built-in robot over gentle hills, the same robot and hills whatever the seed.
///
/// # Panics
/// When a world with these effects cannot be.
pub(crate) fn drive(seed: u64, duration_s: f64, effects: Vec<Effect>) -> Recording {
    let text = format!(r#"{{"terrain": {{"rolling": {{"grade": 0.03}}}}, "seed": {seed}, "robot_seed": 5}}"#);
    let recorded = || -> Result<Recording, Box<dyn std::error::Error>> {
        let world = World { effects, ..World::from_json(&text)? };
        let robot = RobotFile::from_json(&serde_json::to_string(&model::builtin::husky_a200())?)?;
        let folder = tempfile::tempdir()?;
        let path = folder.path().join("drive.csv");
        let log = simulate(&world, &robot, &Drive::new(DriveKind::Rich, duration_s, seed))?;
        log.write_csv(std::fs::File::create(&path)?)?;
        Ok(read_paths(&[path], None)?.0)
    };
    recorded().unwrap_or_else(|error| panic!("seed {seed}: {error}"))
}
