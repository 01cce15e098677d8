//! Channels that stay at one value to the last digit while the robot drives and all else changes.

use std::{collections::BTreeSet, ops::Range};

use model::Robot;
use recording::{Channel, Recording, Run};

use super::{
    Doubt,
    cells::{Expected, power_channels},
    driving::STANDS_MPS,
    second::median,
};

/// Time for which a measured value does not stay the same to its last digit while the robot drives \[s\]: as for sensors of one side.
const LEAST_S: f64 = 10.0;
/// Different values of what lives beside it.
const LEAST_VALUES: usize = 10;
/// How many times longer than any ordinary stay a frozen one lasts: a decade apart, it is of another kind. Steps of coarse encoders and
/// meters, commands in the place of measurements and readings that are held stay long, and often.
const TIMES_ORDINARY: f64 = 10.0;
/// Steps of a meter that the power of a drive changes by, where the meter would have shown it.
const STEPS: f64 = 4.0;

/// Steps of a range up to which its scale is coarse: measured speeds have noise of a thousandth of it. Of fewer values of a fine scale some two lie
/// nearer to each other than their range over their number.
const RUNGS: f64 = 1000.0;

/// A stretch of rows in which channels stand still.
struct Held {
    run: usize,
    rows: Range<usize>,
    driven_s: f64,
}

/// Tells of power, or of wheel speeds of both sides, that are frozen.
pub(super) fn frozen(robot: &Robot, recording: &Recording) -> Option<Doubt> {
    // The voltage of a battery is no sign of life of its ammeter.
    let power: Vec<Channel> =
        power_channels(recording).into_iter().filter(|channel| *channel != Channel::Voltage).collect();
    let wheels = vec![Channel::LeftSpeed, Channel::RightSpeed];
    let is_missed = |held: &Held| changes(robot, recording, held).unwrap_or(false);
    told(recording, &power, &wheels, "power", is_missed).or_else(|| {
        told(recording, &wheels, &power, "wheel speed of both sides", |held| {
            !is_coarse(recording, &wheels, held)
        })
    })
}

/// What is told of channels that stand still together while some other one changes.
fn told(
    recording: &Recording,
    channels: &[Channel],
    others: &[Channel],
    quantity: &str,
    is_missed: impl Fn(&Held) -> bool,
) -> Option<Doubt> {
    let columns: Option<Vec<&[f64]>> = channels.iter().map(|channel| recording.channel(*channel)).collect();
    let columns = columns.filter(|columns| !columns.is_empty())?;
    let lives = |held: &Held| {
        others.iter().filter_map(|other| recording.channel(*other)).any(|values| {
            let known = values[held.rows.clone()].iter().filter(|x| x.is_finite());
            known.map(|x| x.to_bits()).collect::<BTreeSet<u64>>().len() >= LEAST_VALUES
        })
    };
    let (ordinary_s, long) = stays(recording, &columns);
    let all_s: f64 = recording.runs.iter().map(|run| driven_s(recording, run, run.rows.clone())).sum();
    // What is ordinary is told by as much other driving.
    let is_known = |one: &Held| all_s - one.driven_s >= one.driven_s;
    let is_frozen = |one: &Held| {
        one.driven_s >= TIMES_ORDINARY * ordinary_s && is_known(one) && lives(one) && is_missed(one)
    };
    let held: Vec<Held> = long.into_iter().filter(is_frozen).collect();
    let first = held.first()?;
    let total_s: f64 = held.iter().map(|one| one.driven_s).sum();
    let values: Vec<String> = channels
        .iter()
        .zip(&columns)
        .map(|(channel, values)| format!("`{}` at {}", channel.name(), values[first.rows.start]))
        .collect();
    Some(Doubt {
        name: "frozen",
        statement: format!(
            "{quantity} stands still to the last digit for {total_s:.0} s of driving, from {:.1} s of run `{}` on ({}), while the rest changes: its source seems frozen",
            recording.t_s[first.rows.start],
            recording.runs[first.run].name,
            values.join(", ")
        ),
        cure: "leave these cells empty, which makes gaps of them, or leave the runs out (`--runs` names those that are read)".to_owned(),
    })
}

/// Stretches of rows in which all columns stay as they are, with the numbers of their runs.
fn stretches<'a>(
    recording: &'a Recording,
    columns: &'a [&'a [f64]],
) -> impl Iterator<Item = (usize, Range<usize>)> + 'a {
    recording.runs.iter().enumerate().flat_map(move |(number, run)| {
        let mut start = run.rows.start;
        run.rows.clone().filter_map(move |row| {
            let goes_on =
                row + 1 < run.rows.end && columns.iter().all(|values| values[row] == values[row + 1]);
            (!goes_on).then(|| (number, std::mem::replace(&mut start, row + 1)..row + 1))
        })
    })
}

/// The longest ordinary stay while the robot drives \[s\], and those that are longer than manoeuvres.
fn stays(recording: &Recording, columns: &[&[f64]]) -> (f64, Vec<Held>) {
    let (mut ordinary_s, mut long) = (0.0_f64, Vec::new());
    for (run, rows) in stretches(recording, columns) {
        let driven_s = driven_s(recording, &recording.runs[run], rows.clone());
        if driven_s >= LEAST_S {
            long.push(Held { run, rows, driven_s });
        } else {
            ordinary_s = ordinary_s.max(driven_s);
        }
    }
    (ordinary_s, long)
}

/// Whether a channel has a coarse scale, on which a steady speed stays: its values come back again and again, and those of a fine scale hardly
/// ever do. Of five real drives of a Husky each came 30 times and more.
fn is_coarse(recording: &Recording, channels: &[Channel], held: &Held) -> bool {
    channels.iter().filter_map(|channel| recording.channel(*channel)).any(|values| {
        let others = (0..values.len()).filter(|row| !held.rows.contains(row) && drives(recording, *row));
        let mut others: Vec<f64> = others.map(|row| values[row]).filter(|x| x.is_finite()).collect();
        let rows = others.len();
        others.sort_by(f64::total_cmp);
        others.dedup();
        let rung = others.windows(2).map(|w| w[1] - w[0]).fold(f64::INFINITY, f64::min);
        let range = others.last().zip(others.first()).map_or(0.0, |(most, least)| most - least);
        rows >= LEAST_VALUES * others.len() || range < RUNGS.min(rows as f64) * rung
    })
}

/// Time in which wheels turn \[s\].
fn driven_s(recording: &Recording, run: &Run, rows: Range<usize>) -> f64 {
    rows.filter(|row| drives(recording, *row)).filter_map(|row| recording.step_s(run, row)).sum()
}

fn drives(recording: &Recording, row: usize) -> bool {
    let sides = [Channel::LeftSpeed, Channel::RightSpeed].map(|side| recording.channel(side));
    sides.into_iter().flatten().any(|values| values[row].abs() > STANDS_MPS)
}

/// Whether the power that the robot's file expects changes in a stretch by more than steps that the meter shows elsewhere.
fn changes(robot: &Robot, recording: &Recording, held: &Held) -> Option<bool> {
    let expected = Expected::new(robot, recording)?;
    let changes = |channel: Channel| {
        let values = recording.channel(channel)?;
        // A meter that cannot tell what is given back rests at nothing.
        let is_at_rest = values[held.rows.start] == 0.0;
        let of_row = |row: usize| {
            let watts = expected.of_channel(channel, row);
            if is_at_rest { watts.max(0.0) } else { watts }
        };
        let mut expected_w: Vec<f64> = held.rows.clone().map(of_row).filter(|w| w.is_finite()).collect();
        expected_w.sort_by(f64::total_cmp);
        let at = |share: f64| expected_w.get((share * expected_w.len() as f64) as usize).copied();
        Some(at(0.9)? - at(0.1)? > STEPS * step_w(recording, channel)?)
    };
    let all: Option<Vec<bool>> = power_channels(recording)
        .into_iter()
        .filter(|channel| *channel != Channel::Voltage)
        .map(changes)
        .collect();
    Some(all?.into_iter().any(|one| one))
}

/// What a meter's reading changes by from row to row where it does \[W\]; nothing of motor currents, which are no watts.
fn step_w(recording: &Recording, channel: Channel) -> Option<f64> {
    let values = recording.channel(channel)?;
    let steps = values.windows(2).map(|w| (w[1] - w[0]).abs()).filter(|step| *step > 0.0);
    let step = median(steps.collect())?;
    match channel {
        Channel::Current => {
            let known = recording.channel(Channel::Voltage)?.iter().copied().filter(|v| v.is_finite());
            Some(step * median(known.collect())?)
        }
        Channel::LeftMotorCurrent | Channel::RightMotorCurrent => Some(0.0),
        _ => Some(step),
    }
}
