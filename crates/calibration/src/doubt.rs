//! What physics forbids of a recording beside a robot's file: signs, sides, units and mountings that are not what they seem.
//!
//! `predict`, `calibrate` and `diagnose` ask the same, before anything is believed. Nothing here changes a recording.

mod alike;
mod angles;
mod askew;
mod beyond;
mod cells;
mod change;
mod charging;
mod clipped;
mod dead;
mod delay;
mod driving;
mod follow;
mod frozen;
mod heights;
mod lifted;
mod measure;
mod of_runs;
mod opposed;
mod part_sign;
mod placeholder;
mod saturated;
mod scale;
mod second;
mod stopped;
mod stuck_sensor;
mod time_scale;
mod turning;
mod two_powers;
mod unfollowed;
mod way;

use std::borrow::Cow;

use model::Robot;
use recording::{Channel, Recording, Watch};
use serde::Serialize;

pub(crate) use self::clipped::clipped_note;
pub(crate) use self::scale::POWER_LEVEL;
pub use self::{change::mends, scale::speeds};
use self::{follow::Followed, second::Second};
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
        let odd = sensors(robot, &rest, &seconds, watch)?;
        let saturated = || saturated::saturated(robot, &rest);
        let other =
            if odd.is_empty() { lifted::lifted(robot, &rest, &seconds).or_else(saturated) } else { None };
        doubts.extend(odd.into_iter().chain(other));
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

/// Doubts about sensors that stand still and turning without wheels.
fn sensors(
    robot: &Robot,
    recording: &Recording,
    seconds: &[Second],
    watch: &Watch,
) -> Result<Vec<Doubt>, Error> {
    if let Some(dead) = dead::dead(recording) {
        return Ok(vec![dead]);
    }
    let stuck = stuck(robot, recording, watch)?;
    if !stuck.is_empty() {
        return Ok(stuck);
    }
    let is_size = || !scale::speeds(robot, recording).is_empty();
    let turning = turning::turning(robot, recording, seconds).filter(|_| !is_size());
    Ok(turning.or_else(|| stopped::stopped(robot, recording, seconds)).into_iter().collect())
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

/// All doubts about a recording of a robot: of all drives together, and of each alone.
///
/// # Errors
/// As [`crate::predict_watched()`].
pub fn doubts(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Vec<Doubt>, Error> {
    of_runs::with_runs(robot, recording, together(robot, recording, watch)?, watch)
}

/// Doubts about drives as one recording.
fn together(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Vec<Doubt>, Error> {
    let Looked { doubts: mut all, rest } = cells(robot, recording, watch)?;
    let Some(rest) = rest else { return Ok(all) };
    let recording = &*rest.thinned_watched(watch)?;
    all.extend(measure::wheel_radius(robot, recording));
    all.extend(two_powers::contradicting(recording));
    let opposed = opposed::opposed(robot, recording);
    let is_mirrored = opposed.iter().any(|doubt| doubt.name.ends_with("_speed_sign"));
    all.extend(opposed);
    if is_mirrored {
        // Power is not that of wheels which turn the other way.
        return Ok(all);
    }
    let seconds = second::seconds(robot, recording, watch)?;
    let odd = sensors(robot, recording, &seconds, watch)?;
    if !odd.is_empty() {
        all.extend(odd);
        return Ok(all);
    }
    let known = all.len();
    let speeds = scale::speeds(robot, recording);
    let way = if speeds.is_empty() { way::way(robot, recording) } else { None };
    all.extend(speeds.into_iter().chain(way));
    let followed = follow::of(robot, recording, watch)?;
    all.extend(reasons(robot, recording, (&followed, &seconds), watch)?);
    if all.len() == known {
        all.extend(lifted::lifted(robot, recording, &seconds));
    }
    if all.len() == known {
        all.extend(delay::delay(robot, recording, watch)?);
    }
    if all.len() == known {
        let charged = charging::charging(recording, &seconds);
        all.extend(unfollowed::unfollowed(&followed).or(charged));
    }
    Ok(all)
}

/// Doubts about what is measured, its unit, sign and axes; what has a reason of its own is no unit of power, nor a sign.
fn reasons(
    robot: &Robot,
    recording: &Recording,
    (followed, seconds): (&Followed, &[Second]),
    watch: &Watch,
) -> Result<Vec<Doubt>, Error> {
    let ratio_at = |recording: &Recording| follow::of(robot, recording, watch).ok().and_then(|of| of.ratio);
    let mut all: Vec<Doubt> = heights::heights(robot, recording, watch)?.into_iter().collect();
    all.extend(measure::voltage(robot, recording, followed));
    all.extend(measure::temperatures(recording, ratio_at));
    let askew = askew::askew(robot, recording);
    all.extend(saturated::saturated(robot, recording));
    let better = change::better(robot, recording, followed, watch)?;
    // Power tells whose sign is wrong where pitch and heights oppose each other.
    let is_pitch = better.as_ref().is_some_and(|better| better.name == "pitch_sign");
    all.extend(if is_pitch { better.clone() } else { askew });
    if !all.is_empty() {
        return Ok(all);
    }
    all.extend(scale::power(followed).or_else(|| scale::on_known_ground(robot, recording, followed)));
    all.extend(match better {
        Some(better) => Some(better),
        None => part_sign::part_sign(robot, recording, (followed, seconds), watch)?,
    });
    Ok(all)
}
