//! Recordings that would follow the model if a side, a sign or an axis were another.

use model::Robot;
use recording::{Channel, Recording, SuspicionKind, Watch, suspicions};

use super::{
    Doubt,
    angles::{exchanged, has_slopes, in_degrees, level, righted},
    driving::ALIKE_S,
    follow,
    follow::Followed,
};
use crate::Error;

/// A changed recording is believed when it leaves less than this share of the scatter that the given one leaves.
const CLEARLY_BETTER: f64 = 0.5;
/// And when predictions then follow the recording at least so well (r²).
pub(super) const FOLLOWS: f64 = 0.5;
/// Recordings that are followed so well are not doubted: half of the rest would be a twentieth of the scatter.
pub(super) const FOLLOWS_WELL: f64 = 0.9;

/// Evidence from which a change is believed, whatever the length of a drive: very strong, as of a delay (Kass & Raftery 1995: twice the
/// logarithm of the ratio of likelihoods above 10).
pub(super) const EVIDENCE: f64 = 10.0;

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

const RIGHTED: &str =
    "turn its orientation by its mounting before it is logged, or leave its topic out of the map";
const SCALE: &str = "give its source \"scale\": -1 in a map";

/// All changes that are tried.
const CHANGES: [Change; 13] = [
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
    Change {
        name: "imu_upside_down",
        words: "roll is about half a turn all the time, as of an IMU that is mounted upside down",
        cure: RIGHTED,
        mended: |of| righted(of, 1.0),
    },
    Change {
        name: "imu_upside_down",
        words: "roll is about half a turn all the time and pitch of the wrong sign, as of an IMU that is mounted upside down",
        cure: RIGHTED,
        mended: |of| righted(of, -1.0),
    },
    Change {
        name: "pitch_misleads",
        words: "predictions with the recorded pitch and roll are worse than on level ground",
        cure: "look at the source of `pitch_rad`: its axes, its unit and the order of a quaternion's elements (w first or last); or leave it out, so that the \
               ground is taken for level",
        mended: level,
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
    let mut best: Option<(f64, Doubt)> = None;
    for change in &CHANGES {
        let Some(mended) = (change.mended)(recording) else { continue };
        if change.name == "sides_of_speeds" && turns_as_wheels_say(recording) {
            continue;
        }
        let other = follow::of(robot, &mended, watch)?;
        if is_believed(given, &other) && best.as_ref().is_none_or(|(r2, _)| other.r2 > *r2) {
            best = Some((other.r2, change.doubt(given, &other)));
        }
    }
    Ok(best.map(|(_, doubt)| doubt))
}

/// Whether a recording is followed so much better with something mended that it was wrong: clearly, and in more driving than chance explains.
pub(super) fn is_believed(given: &Followed, mended: &Followed) -> bool {
    let is_clear = mended.r2 > FOLLOWS && 1.0 - mended.r2 < CLEARLY_BETTER * (1.0 - given.r2);
    let evidence = given.driven_s / ALIKE_S * ((1.0 - given.r2) / (1.0 - mended.r2)).ln();
    // Sensors are mounted and wired the same in every run: two runs on grounds of their own differ by more than a sign.
    is_clear && evidence >= EVIDENCE && mended.within_runs_r2 > given.within_runs_r2
}

/// How much better power would be followed, in words.
pub(super) fn said_better(given: &Followed, mended: &Followed) -> String {
    let instead = match given.r2 > 0.0 {
        true => format!("instead of {:.0} %", 100.0 * given.r2),
        false => "and not run against it".to_owned(),
    };
    format!("with that mended the model would follow {:.0} % of the variation {instead}", 100.0 * mended.r2)
}

impl Change {
    fn doubt(&self, given: &Followed, mended: &Followed) -> Doubt {
        Doubt {
            name: self.name,
            statement: format!("{}: {}", self.words, said_better(given, mended)),
            cure: self.cure.to_owned(),
        }
    }
}

/// Whether a gyroscope or compass tells that the sides of wheel speeds are not swapped.
fn turns_as_wheels_say(recording: &Recording) -> bool {
    let is_told = [Channel::YawRate, Channel::Heading].iter().any(|turn| recording.channel(*turn).is_some());
    is_told && !suspicions(recording).iter().any(|doubt| doubt.kind == SuspicionKind::Opposed)
}

fn swapped(recording: &Recording, left: Channel, right: Channel) -> Option<Recording> {
    let mut changed = recording.clone();
    let (a, b) = (changed.channels.remove(&left)?, changed.channels.remove(&right)?);
    changed.channels.insert(left, b);
    changed.channels.insert(right, a);
    Some(changed)
}

pub(super) fn turned(recording: &Recording, channels: &[Channel]) -> Option<Recording> {
    scaled(recording, channels, |x| -x)
}

pub(super) fn scaled(
    recording: &Recording,
    channels: &[Channel],
    by: impl Fn(f64) -> f64,
) -> Option<Recording> {
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
