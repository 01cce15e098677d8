//! Recordings that would follow the model if a side, a sign or an axis were another.

use std::f64::consts::FRAC_PI_2;

use model::Robot;
use recording::{Channel, Recording, SuspicionKind, Watch, suspicions};

use super::{Doubt, follow, follow::Followed};
use crate::Error;

/// A changed recording is believed when it leaves less than this share of the scatter that the given one leaves.
const CLEARLY_BETTER: f64 = 0.5;
/// And when predictions then follow the recording at least so well (r²).
const FOLLOWS: f64 = 0.5;
/// Recordings that are followed so well are not doubted: half of the rest would be a twentieth of the scatter.
pub(super) const FOLLOWS_WELL: f64 = 0.9;

/// What may have been wrong with a recording, and the recording with that mended; none where it lacks the channels.
struct Change {
    /// Name of the doubt.
    name: &'static str,
    /// What seems wrong, in words.
    words: &'static str,
    /// What mends it.
    cure: &'static str,
    /// The recording with that mended.
    mended: fn(&Recording) -> Option<Recording>,
}

const SCALE: &str = "give its source \"scale\": -1 in a map";

/// All changes that are tried.
const CHANGES: [Change; 10] = [
    Change {
        name: "power_sign",
        words: "power seems to have the wrong sign (drawn from the battery must be positive, charging negative)",
        cure: SCALE,
        mended: |of| turned(of, &[Channel::LeftPower, Channel::RightPower, Channel::Power, Channel::Current]),
    },
    Change {
        name: "left_power_sign",
        words: "power of the left side seems to have its sign mirrored",
        cure: SCALE,
        mended: |of| turned(of, &[Channel::LeftPower]),
    },
    Change {
        name: "right_power_sign",
        words: "power of the right side seems to have its sign mirrored",
        cure: SCALE,
        mended: |of| turned(of, &[Channel::RightPower]),
    },
    Change {
        name: "sides_of_power",
        words: "power of the left and the right side seem swapped",
        cure: "swap both sources in a map",
        mended: |of| swapped(of, Channel::LeftPower, Channel::RightPower),
    },
    Change {
        name: "sides_of_currents",
        words: "motor currents of the left and the right side seem swapped",
        cure: "swap both sources in a map",
        mended: |of| swapped(of, Channel::LeftMotorCurrent, Channel::RightMotorCurrent),
    },
    Change {
        name: "sides_of_speeds",
        words: "wheel speeds of the left and the right side seem swapped",
        cure: "swap both sources in a map",
        mended: |of| swapped(of, Channel::LeftSpeed, Channel::RightSpeed),
    },
    Change {
        name: "pitch_sign",
        words: "pitch seems to have the wrong sign (nose up must be positive), as of an IMU that is mounted back to front or tells axes north-east-down",
        cure: SCALE,
        mended: |of| has_slopes(of).then(|| turned(of, &[Channel::Pitch]))?,
    },
    Change {
        name: "angle_unit",
        words: "pitch or roll seems to be in degrees",
        cure: "give their sources the unit `deg` in a map",
        mended: in_degrees,
    },
    Change {
        name: "imu_turned_left",
        words: "pitch seems to be roll, as of an IMU that is mounted a quarter turn about the vertical",
        cure: "name `orientation.roll` as the source of `pitch_rad` in a map, and `orientation.pitch` as that of `roll_rad`",
        mended: |of| has_slopes(of).then(|| exchanged(of, [1.0, -1.0]))?,
    },
    Change {
        name: "imu_turned_right",
        words: "pitch seems to be roll of the other sign, as of an IMU that is mounted a quarter turn about the vertical",
        cure: "name `orientation.roll` with \"scale\": -1 as the source of `pitch_rad` in a map, and `orientation.pitch` as that of `roll_rad`",
        mended: |of| has_slopes(of).then(|| exchanged(of, [-1.0, 1.0]))?,
    },
];

/// The change that would mend a recording best, if any clearly does.
///
/// # Errors
/// As [`crate::predict_watched()`].
pub fn mends(robot: &Robot, recording: &Recording, watch: &Watch) -> Result<Option<Doubt>, Error> {
    let recording = recording.thinned_watched(watch)?;
    better(robot, &recording, &follow::of(robot, &recording, watch)?, watch)
}

/// The same, of a recording that is followed as given.
pub(super) fn better(
    robot: &Robot,
    recording: &Recording,
    given: &Followed,
    watch: &Watch,
) -> Result<Option<Doubt>, Error> {
    if given.r2 > FOLLOWS_WELL {
        return Ok(None);
    }
    let mut best: Option<(f64, &Change)> = None;
    for change in &CHANGES {
        let Some(mended) = (change.mended)(recording) else { continue };
        if change.name == "sides_of_speeds" && turns_as_wheels_say(recording) {
            continue;
        }
        let other = follow::of(robot, &mended, watch)?;
        let is_clear = other.r2 > FOLLOWS && 1.0 - other.r2 < CLEARLY_BETTER * (1.0 - given.r2);
        // Sensors are mounted and wired the same in every run: two runs on grounds of their own differ by more than a sign.
        let is_believed = is_clear && other.within_runs_r2 > given.within_runs_r2;
        if is_believed && best.is_none_or(|(r2, _)| other.r2 > r2) {
            best = Some((other.r2, change));
        }
    }
    Ok(best.map(|(r2, change)| Doubt {
        name: change.name,
        statement: format!(
            "{}: with that mended the model would follow {:.0} % of the variation {}",
            change.words,
            100.0 * r2,
            if given.r2 > 0.0 {
                format!("instead of {:.0} %", 100.0 * given.r2)
            } else {
                "and not run against it".to_owned()
            }
        ),
        cure: change.cure.to_owned(),
    }))
}

/// Whether a gyroscope or compass tells that the sides of wheel speeds are not swapped.
fn turns_as_wheels_say(recording: &Recording) -> bool {
    let is_told = [Channel::YawRate, Channel::Heading].iter().any(|turn| recording.channel(*turn).is_some());
    is_told && !suspicions(recording).iter().any(|doubt| doubt.kind == SuspicionKind::Opposed)
}

/// Whether drives have slopes by which the axes of an inclinometer are told: on level ground they differ by its own error.
fn has_slopes(recording: &Recording) -> bool {
    /// What an inclinometer is askew by (2 degrees) \[rad\].
    const ERROR_RAD: f64 = 0.035;
    [Channel::Pitch, Channel::Roll]
        .into_iter()
        .filter_map(|axis| range(recording, axis))
        .any(|x| x > ERROR_RAD)
}

/// How far pitch or roll ranges; what shakes does not count \[rad\].
fn range(recording: &Recording, channel: Channel) -> Option<f64> {
    /// Shares of rows between which it ranges farther.
    const BETWEEN: [f64; 2] = [0.05, 0.95];
    let mut all: Vec<f64> = recording.channel(channel)?.iter().copied().filter(|x| !x.is_nan()).collect();
    all.sort_by(f64::total_cmp);
    let [low, high] = BETWEEN.map(|share| all.get((share * all.len() as f64) as usize).copied());
    Some(high? - low?)
}

/// Pitch and roll as they are if they were told in degrees: both, or the one of them that no robot can have in radians.
fn in_degrees(recording: &Recording) -> Option<Recording> {
    /// From the steepest descent that a robot is driven down to the steepest climb, by the default of `max_pitch_rad` \[rad\]. An inclinometer
    /// that is askew ranges no farther than the ground.
    const STEEPEST_RAD: f64 = 2.0 * 0.52;
    let is_steep = |axis: Channel| range(recording, axis).is_some_and(|range| range > STEEPEST_RAD);
    if !is_steep(Channel::Pitch) && !is_steep(Channel::Roll) {
        return None;
    }
    let of = |channel: Channel| Some((channel, recording.channel(channel)?));
    let angles: Vec<(Channel, &[f64])> = [Channel::Pitch, Channel::Roll].into_iter().filter_map(of).collect();
    let impossible = angles.iter().filter(|(_, values)| values.iter().any(|x| x.abs() > FRAC_PI_2));
    let channels: Vec<Channel> = impossible.map(|(channel, _)| *channel).collect();
    let channels = if channels.is_empty() { vec![Channel::Pitch, Channel::Roll] } else { channels };
    scaled(recording, &channels, f64::to_radians)
}

fn swapped(recording: &Recording, left: Channel, right: Channel) -> Option<Recording> {
    let mut changed = recording.clone();
    let (a, b) = (changed.channels.remove(&left)?, changed.channels.remove(&right)?);
    changed.channels.insert(left, b);
    changed.channels.insert(right, a);
    Some(changed)
}

fn turned(recording: &Recording, channels: &[Channel]) -> Option<Recording> {
    scaled(recording, channels, |x| -x)
}

fn scaled(recording: &Recording, channels: &[Channel], by: impl Fn(f64) -> f64) -> Option<Recording> {
    let mut changed = recording.clone();
    let mut any = false;
    for channel in channels {
        if let Some(values) = changed.channels.get_mut(channel) {
            values.iter_mut().for_each(|x| *x = by(*x));
            any = true;
        }
    }
    any.then_some(changed)
}

/// Roll in the place of pitch and pitch in that of roll, each times a sign.
fn exchanged(recording: &Recording, [of_roll, of_pitch]: [f64; 2]) -> Option<Recording> {
    let mut changed = recording.clone();
    let (pitch, roll) = (changed.channels.remove(&Channel::Pitch)?, changed.channels.remove(&Channel::Roll)?);
    changed.channels.insert(Channel::Pitch, roll.iter().map(|x| of_roll * x).collect());
    changed.channels.insert(Channel::Roll, pitch.iter().map(|x| of_pitch * x).collect());
    Some(changed)
}
