//! What physics forbids of a recording beside a robot's file: signs, sides, units and mountings that are not what they seem.
//!
//! `predict`, `calibrate` and `diagnose` ask the same, before anything is believed. Nothing here changes a recording.

mod change;
mod charging;
mod follow;
mod lifted;
mod scale;
mod second;
mod stuck_sensor;

use model::Robot;
use recording::{Channel, Recording, Watch};
use serde::Serialize;

pub use self::{change::mends, scale::speeds};
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

/// Doubts about how drives were recorded: sensors of one side that stand still, wheels in the air.
///
/// # Errors
/// As [`crate::predict_watched()`].
pub fn circumstances(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Vec<Doubt>, Error> {
    let stuck = stuck(robot, recording, watch)?;
    if !stuck.is_empty() {
        return Ok(stuck);
    }
    let seconds = second::seconds(robot, recording, watch)?;
    Ok(lifted::lifted(robot, recording, &seconds).into_iter().collect())
}

/// Doubts about sensors of one side.
fn stuck(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Vec<Doubt>, Error> {
    let found = stuck_sensor::stuck_sensors(robot, recording, true);
    let is_shown = found.is_empty() || recording.channel(Channel::YawRate).is_some();
    if is_shown || follow::of(robot, recording, watch)?.r2 <= change::FOLLOWS_WELL {
        return Ok(found);
    }
    Ok(stuck_sensor::stuck_sensors(robot, recording, false))
}

/// A doubt about a battery that is charged in the drives, where nothing else is doubtful.
///
/// # Errors
/// As [`crate::predict_watched()`].
pub fn charged(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Option<Doubt>, Error> {
    Ok(charging::charging(recording, &second::seconds(robot, recording, watch)?))
}

/// All doubts about a recording of a robot.
///
/// # Errors
/// As [`crate::predict_watched()`].
pub fn doubts(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Vec<Doubt>, Error> {
    let recording = recording.thinned_watched(watch)?;
    let stuck = stuck(robot, &recording, watch)?;
    if !stuck.is_empty() {
        // Signs, sides and units are told by drives as a robot makes them.
        return Ok(stuck);
    }
    let seconds = second::seconds(robot, &recording, watch)?;
    if let Some(lifted) = lifted::lifted(robot, &recording, &seconds) {
        return Ok(vec![lifted]);
    }
    let mut all = scale::speeds(robot, &recording);
    let followed = follow::of(robot, &recording, watch)?;
    all.extend(scale::power(&followed));
    all.extend(change::better(robot, &recording, &followed, watch)?);
    if all.is_empty() {
        all.extend(charging::charging(&recording, &seconds));
    }
    Ok(all)
}
