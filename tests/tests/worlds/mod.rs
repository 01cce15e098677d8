//! Drives in the independent world, as a diagnosis gets them.

#![allow(clippy::panic)]

#[path = "../../shared/logs.rs"]
mod logs;

use logs::read_back;
use model::Robot;
use recording::Recording;
use world::{Case, CaseKind, Drive, DriveKind, Effect, EffectName, RobotFile, Sensors, World, simulate};

/// A rich drive of the built-in robot over gentle hills, the same robot and hills whatever the seed.
///
/// # Panics
/// When a world with these effects cannot be.
#[allow(dead_code)]
pub(crate) fn drive(seed: u64, duration_s: f64, effects: Vec<Effect>) -> Recording {
    drive_of(&model::builtin::husky_a200(), &Drive::new(DriveKind::Rich, duration_s, seed), effects)
}

/// The same of any robot, with sensors of its size, and of any kind of drive.
///
/// # Panics
/// When a world with these effects cannot be.
pub(crate) fn drive_of(robot: &Robot, drive: &Drive, effects: Vec<Effect>) -> Recording {
    let seed = drive.seed;
    let text = format!(r#"{{"terrain": {{"rolling": {{"grade": 0.03}}}}, "seed": {seed}, "robot_seed": 5}}"#);
    let recorded = || -> Result<Recording, Box<dyn std::error::Error>> {
        let robot = RobotFile::from_json(&serde_json::to_string(robot)?)?;
        let world = World { effects, sensors: Sensors::of(&robot), ..World::from_json(&text)? };
        Ok(read_back(&simulate(&world, &robot, drive)?).recording)
    };
    recorded().unwrap_or_else(|error| panic!("seed {seed}: {error}"))
}

/// A drive of the built-in robot that conceals an effect of such a share of power, as trials draw them, and healthy drives beside it.
///
/// # Panics
/// When no such world can be.
#[allow(dead_code)]
pub(crate) fn drawn(seed: u64, effect: EffectName, share: f64) -> [Recording; 2] {
    let recorded = || -> Result<[Recording; 2], Box<dyn std::error::Error>> {
        let robot = RobotFile::from_json(&serde_json::to_string(&model::builtin::husky_a200())?)?;
        let case = Case::draw(seed, CaseKind::One(effect), share, &robot)?;
        Ok([simulate(&case.world, &robot, &case.drive)?, case.reference(&robot)?]
            .map(|log| read_back(&log).recording))
    };
    recorded().unwrap_or_else(|error| panic!("seed {seed}: {error}"))
}
