//! Pitch and roll as they would be of another unit, another mounting or none at all.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use recording::{Channel, Recording};

use super::change::scaled;

/// Steepest slope that a robot is driven on, by the default of `max_pitch_rad` \[rad\].
const STEEPEST_RAD: f64 = 0.52;

/// Whether drives have slopes by which the axes of an inclinometer are told: on level ground they differ by its own error.
pub(super) fn has_slopes(recording: &Recording) -> bool {
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
    let mut all: Vec<f64> = known(recording, channel)?;
    all.sort_by(f64::total_cmp);
    let [low, high] = BETWEEN.map(|share| all.get((share * all.len() as f64) as usize).copied());
    Some(high? - low?)
}

/// Pitch and roll as they are if they were told in degrees: both, or the one of them that no robot can have in radians.
pub(super) fn in_degrees(recording: &Recording) -> Option<Recording> {
    // From the steepest descent to the steepest climb. An inclinometer that is askew ranges no farther than the ground.
    let is_steep = |axis: Channel| range(recording, axis).is_some_and(|range| range > 2.0 * STEEPEST_RAD);
    if is_overturned(recording) || !is_steep(Channel::Pitch) && !is_steep(Channel::Roll) {
        return None;
    }
    let of = |channel: Channel| Some((channel, recording.channel(channel)?));
    let angles: Vec<(Channel, &[f64])> = [Channel::Pitch, Channel::Roll].into_iter().filter_map(of).collect();
    let impossible = angles.iter().filter(|(_, values)| values.iter().any(|x| x.abs() > FRAC_PI_2));
    let channels: Vec<Channel> = impossible.map(|(channel, _)| *channel).collect();
    let channels = if channels.is_empty() { vec![Channel::Pitch, Channel::Roll] } else { channels };
    scaled(recording, &channels, f64::to_radians)
}

/// Roll in the place of pitch and pitch in that of roll, each times a sign.
pub(super) fn exchanged(recording: &Recording, [of_roll, of_pitch]: [f64; 2]) -> Option<Recording> {
    let mut changed = recording.clone();
    let (pitch, roll) = (changed.channels.remove(&Channel::Pitch)?, changed.channels.remove(&Channel::Roll)?);
    changed.channels.insert(Channel::Pitch, roll.iter().map(|x| of_roll * x).collect());
    changed.channels.insert(Channel::Roll, pitch.iter().map(|x| of_pitch * x).collect());
    Some(changed)
}

/// The same on level ground.
pub(super) fn level(recording: &Recording) -> Option<Recording> {
    recording.channel(Channel::Pitch)?;
    scaled(recording, &[Channel::Pitch, Channel::Roll], |x| 0.0 * x)
}

/// Roll half a turn farther, and pitch of a sign, of an IMU that hangs upside down.
pub(super) fn righted(recording: &Recording, sign_of_pitch: f64) -> Option<Recording> {
    if !is_overturned(recording) {
        return None;
    }
    let righted = scaled(recording, &[Channel::Roll], |x| (x + TAU).rem_euclid(TAU) - PI)?;
    scaled(&righted, &[Channel::Pitch], |x| sign_of_pitch * x)
}

/// Whether roll is about half a turn all the time, nearer to it than robots tilt: angles in degrees come by everything else as well.
fn is_overturned(recording: &Recording) -> bool {
    /// Share of rows, as that between which [`range`] is told.
    const MOST: f64 = 0.9;
    let Some(all) = known(recording, Channel::Roll).filter(|all| !all.is_empty()) else { return false };
    let over = all.iter().filter(|x| (PI - x.abs()).abs() < STEEPEST_RAD).count();
    over as f64 > MOST * all.len() as f64
}

/// Values of a channel that are none of its gaps.
fn known(recording: &Recording, channel: Channel) -> Option<Vec<f64>> {
    Some(recording.channel(channel)?.iter().copied().filter(|x| !x.is_nan()).collect())
}
