//! What physics forbids of a recording beside a robot's file: signs, sides, units and mountings that are not what they seem.
//!
//! `predict`, `calibrate` and `diagnose` ask the same, before anything is believed. Nothing here changes a recording.

mod alike;
mod beyond;
mod cells;
mod change;
mod charging;
mod delay;
mod driving;
mod follow;
mod frozen;
mod heights;
mod lifted;
mod measure;
mod placeholder;
mod scale;
mod second;
mod stuck_sensor;
mod time_scale;
mod turning;

use std::borrow::Cow;

use model::Robot;
use recording::{Channel, Recording, Watch};
use serde::Serialize;

use self::second::Second;
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

/// Doubts about how drives were recorded: cells that are no measurement, times in another unit, sensors that stand still, wheels in the air.
///
/// # Errors
/// As [`crate::predict_watched()`].
pub fn circumstances(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Vec<Doubt>, Error> {
    let Looked { mut doubts, rest } = cells(robot, recording, watch)?;
    if let Some(rest) = rest {
        let rest = rest.thinned_watched(watch)?;
        let seconds = second::seconds(robot, &rest, watch)?;
        doubts.extend(sensors(robot, &rest, &seconds, watch)?);
    }
    Ok(doubts)
}

/// Doubts about single cells and times, and the recording in which no such cells are left; none where nothing else can be told of it.
struct Looked<'a> {
    doubts: Vec<Doubt>,
    rest: Option<Cow<'a, Recording>>,
}

/// What is told by cells as they were recorded, before they become means.
fn cells<'a>(robot: &Robot, recording: &'a Recording, watch: &Watch) -> Result<Looked<'a>, Error> {
    let beyond = beyond::beyond(robot, recording);
    let predicted_j = |recording: &Recording| second::predicted_j(robot, recording, watch).ok();
    let mut doubts: Vec<Doubt> = beyond::doubt(robot, recording, &beyond, predicted_j).into_iter().collect();
    let rest = match beyond.is_empty() {
        true => Cow::Borrowed(recording),
        false => Cow::Owned(cells::without(recording, &beyond)),
    };
    let no_measurement = time_scale::times(robot, &rest)
        .or_else(|| placeholder::doubt(&rest, &placeholder::placeholders(robot, &rest)))
        .or_else(|| frozen::frozen(robot, &rest))
        .or_else(|| alike::alike(&rest));
    // Signs, sides and units are told by drives as a robot makes them.
    let is_all = no_measurement.is_some();
    doubts.extend(no_measurement);
    Ok(Looked { doubts, rest: (!is_all).then_some(rest) })
}

/// Doubts about sensors that stand still, wheels in the air and turning without wheels.
fn sensors(
    robot: &Robot,
    recording: &Recording,
    seconds: &[Second],
    watch: &Watch,
) -> Result<Vec<Doubt>, Error> {
    let stuck = stuck(robot, recording, watch)?;
    if !stuck.is_empty() {
        return Ok(stuck);
    }
    let turning = || {
        let is_size = !scale::speeds(robot, recording).is_empty();
        if is_size { None } else { turning::turning(robot, recording, seconds) }
    };
    Ok(lifted::lifted(robot, recording, seconds).or_else(turning).into_iter().collect())
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
    let Looked { doubts: mut all, rest } = cells(robot, recording, watch)?;
    let Some(rest) = rest else { return Ok(all) };
    let recording = &*rest.thinned_watched(watch)?;
    let seconds = second::seconds(robot, recording, watch)?;
    let odd = sensors(robot, recording, &seconds, watch)?;
    if !odd.is_empty() {
        all.extend(odd);
        return Ok(all);
    }
    let known = all.len();
    all.extend(scale::speeds(robot, recording));
    let followed = follow::of(robot, recording, watch)?;
    let ratio_at = |recording: &Recording| follow::of(robot, recording, watch).ok().and_then(|of| of.ratio);
    let measures: Vec<Doubt> = measure::voltage(robot, recording, &followed)
        .into_iter()
        .chain(measure::temperatures(recording, ratio_at))
        .collect();
    let heights = heights::heights(robot, recording, watch)?;
    let is_told = heights.is_some() || !measures.is_empty();
    all.extend(heights.into_iter().chain(measures));
    if !is_told {
        // What has a reason of its own is no unit of power, nor a sign.
        all.extend(scale::power(&followed));
        all.extend(change::better(robot, recording, &followed, watch)?);
    }
    if all.len() == known {
        all.extend(delay::delay(robot, recording, watch)?);
    }
    if all.len() == known {
        all.extend(charging::charging(recording, &seconds));
    }
    Ok(all)
}
