//! What physics forbids of a recording beside a robot's file: signs, sides, units and mountings that are not what they seem.
//!
//! `predict`, `calibrate` and `diagnose` ask the same, before anything is believed. Nothing here changes a recording.

mod change;
mod follow;
mod scale;

use model::Robot;
use recording::{Recording, Watch};
use serde::Serialize;

pub use self::{
    change::{CHANGES, Change},
    scale::speeds,
};
use crate::Error;

/// A doubt about a recording, with the numbers that show it and what to do.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Doubt {
    /// Its name, by which it can be overruled.
    pub name: &'static str,
    /// What seems wrong, with the numbers that show it.
    pub statement: String,
    /// What mends it.
    pub cure: String,
}

impl std::fmt::Display for Doubt {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}: {}; {}", self.name, self.statement, self.cure)
    }
}

/// All doubts about a recording of a robot.
///
/// # Errors
/// As [`crate::predict_watched()`].
pub fn doubts(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Vec<Doubt>, Error> {
    let recording = recording.thinned_watched(watch)?;
    let mut all = scale::speeds(robot, &recording);
    let followed = follow::of(robot, &recording, watch)?;
    all.extend(scale::power(&followed));
    all.extend(change::mends(robot, &recording, &followed, watch)?);
    Ok(all)
}
