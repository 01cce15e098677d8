//! Sensors of one side that stand still while the other side's live.

use std::{collections::BTreeSet, ops::Range};

use model::Robot;
use recording::{Channel, Recording, SuspicionKind, suspicions};

use super::{Doubt, cells::Expected, driving::STANDS_MPS};

/// Time for which a measured value does not stay the same to its last digit while the robot drives \[s\]: manoeuvres are shorter, and sensors
/// have noise.
const LEAST_S: f64 = 10.0;
/// Different values of the other side by which it lives: more than a commanded speed has that is logged in the place of a measured one.
const LEAST_VALUES: usize = 10;

/// Sides of each quantity, and its name.
const SIDES: [([Channel; 2], &str); 3] = [
    ([Channel::LeftSpeed, Channel::RightSpeed], "wheel speed"),
    ([Channel::LeftPower, Channel::RightPower], "power"),
    ([Channel::LeftMotorCurrent, Channel::RightMotorCurrent], "motor current"),
];

/// Doubts about sensors that are stuck or saturated on one side alone. Wheel speeds are looked at where asked: without a gyroscope they are
/// as likely the true ones where power follows them.
pub(super) fn stuck_sensors(robot: &Robot, recording: &Recording, with_speeds: bool) -> Vec<Doubt> {
    let mut doubts = Vec::new();
    for (sides, quantity) in SIDES.into_iter().filter(|(sides, _)| with_speeds || sides[0].tells_power()) {
        for (one, other) in [(sides[0], sides[1]), (sides[1], sides[0])] {
            doubts.extend(stuck(robot, recording, (one, other), quantity));
        }
    }
    if doubts.is_empty() { saturated(recording) } else { doubts }
}

fn stuck(
    robot: &Robot,
    recording: &Recording,
    (one, other): (Channel, Channel),
    quantity: &str,
) -> Option<Doubt> {
    let (values, living) = (recording.channel(one)?, recording.channel(other)?);
    // A side that stands draws nothing, and a speed that stands is told by the other side's.
    let is_speed = matches!(one, Channel::LeftSpeed | Channel::RightSpeed);
    let wheel = if is_left(one) == is_speed { Channel::RightSpeed } else { Channel::LeftSpeed };
    let moves = recording.channel(wheel)?;
    // What a side draws changes with its speed, and the other way round.
    let beside = beside(one).into_iter().find_map(|channel| recording.channel(channel));
    let mut stuck = Vec::new();
    let expected = Expected::new(robot, recording);
    // A meter that cannot read what a side gives back rests at nothing where the ground drives it.
    let rests = |channel: Channel, rows: Range<usize>| {
        let Some(expected) = expected.as_ref().filter(|_| values[rows.start] == 0.0 && !is_speed) else {
            return false;
        };
        let asked = rows.clone().filter(|row| expected.of_channel(channel, *row) > 0.0).count();
        values.iter().all(|x| *x >= 0.0 || x.is_nan()) && 2 * asked < rows.len()
    };
    for run in &recording.runs {
        for rows in equal(values, run.rows.clone()) {
            let driven_s: f64 = rows
                .clone()
                .filter(|row| moves[*row].abs() > STANDS_MPS)
                .filter_map(|row| recording.step_s(run, row))
                .sum();
            let lives = |values: &[f64]| {
                let driven = rows.clone().filter(|row| moves[*row].abs() > STANDS_MPS);
                let known = driven.filter(|row| values[*row].is_finite()).map(|row| values[row].to_bits());
                known.collect::<BTreeSet<u64>>().len() >= LEAST_VALUES
            };
            if driven_s >= LEAST_S
                && lives(living)
                && beside.is_none_or(lives)
                && !(is_speed && turns_so(robot, recording, rows.clone()))
                && !rests(one, rows.clone())
            {
                stuck.push((driven_s, rows.start, run));
            }
        }
    }
    let total_s: f64 = stuck.iter().map(|piece| piece.0).sum();
    let (_, row, run) = stuck.first()?;
    let (side, opposite) = if is_left(one) { ("left", "right") } else { ("right", "left") };
    Some(Doubt {
        name: if is_left(one) { "left_sensor_stuck" } else { "right_sensor_stuck" },
        statement: format!(
            "{quantity} of the {side} side (`{}`) stands at {} for {total_s:.0} s, from {:.1} s of run `{}` on, while the {opposite} side drives and its {quantity} changes: \
             its sensor seems stuck",
            one.name(),
            values[*row],
            recording.t_s[*row],
            run.name
        ),
        cure: "look at the encoder, its cable and the field that the column is read from; leave these runs out (`--runs` names those that are read)".to_owned(),
    })
}

/// Channels that a side's own channel goes with: power or current with speed, and speed with these.
fn beside(channel: Channel) -> Vec<Channel> {
    use Channel::{LeftMotorCurrent, LeftPower, LeftSpeed, RightMotorCurrent, RightPower, RightSpeed};
    match channel {
        LeftSpeed => vec![LeftPower, LeftMotorCurrent],
        RightSpeed => vec![RightPower, RightMotorCurrent],
        _ if is_left(channel) => vec![LeftSpeed],
        _ => vec![RightSpeed],
    }
}

/// Whether the gyroscope tells that the robot turns as wheels do of which one side's stand at a speed.
fn turns_so(robot: &Robot, recording: &Recording, rows: Range<usize>) -> bool {
    /// Share of the turn meant by the wheels that is seen where the ground lets them turn the robot.
    const LEAST_SHARE: f64 = 0.5;
    let columns = [Channel::LeftSpeed, Channel::RightSpeed, Channel::YawRate].map(|c| recording.channel(c));
    let [Some(left), Some(right), Some(rate)] = columns else { return false };
    let (meant, seen) = rows.filter(|row| rate[*row].is_finite()).fold((0.0, 0.0), |(meant, seen), row| {
        let difference = right[row] - left[row];
        (meant + difference * difference, seen + difference * rate[row] * robot.slip_track_m)
    });
    seen > LEAST_SHARE * meant
}

fn is_left(channel: Channel) -> bool {
    matches!(channel, Channel::LeftSpeed | Channel::LeftPower | Channel::LeftMotorCurrent)
}

/// Stretches of rows with one value, to the last digit.
fn equal(values: &[f64], rows: Range<usize>) -> impl Iterator<Item = Range<usize>> {
    let mut start = rows.start;
    values[rows].chunk_by(|a, b| a == b).map(move |piece| {
        let rows = start..start + piece.len();
        start = rows.end;
        rows
    })
}

/// Channels of one side that stand at their limit while those of the other do not.
fn saturated(recording: &Recording) -> Vec<Doubt> {
    let found = suspicions(recording);
    let of = |channel: Channel| {
        found.iter().find(|one| one.channel == channel && one.kind == SuspicionKind::Saturated)
    };
    let mut doubts = Vec::new();
    // A robot drives at its top speed often; meters have no such limit.
    for (sides, quantity) in SIDES.into_iter().filter(|(sides, _)| sides[0].tells_power()) {
        for (one, other) in [(sides[0], sides[1]), (sides[1], sides[0])] {
            let (Some(limit), None) = (of(one), of(other)) else { continue };
            if recording.channel(other).is_none() {
                continue;
            }
            let side = if is_left(one) { "left" } else { "right" };
            doubts.push(Doubt {
                name: if is_left(one) { "left_sensor_saturated" } else { "right_sensor_saturated" },
                statement: format!(
                    "{quantity} of the {side} side alone (`{}`) seems cut off: {}",
                    one.name(),
                    limit.statement
                ),
                cure: "widen the range of its sensor, or leave out the runs in which it is at its limit"
                    .to_owned(),
            });
        }
    }
    doubts
}
