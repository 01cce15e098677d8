//! Runs that hold the same seconds of one drive: splits that overlap, copies with fewer rows or digits, a bag beside its own table.
//!
//! Both count in energies and fits, so that they are refused. Runs that are equal row by row are left to those who count: they leave one
//! out and say so. Two drives are the same where their clocks overlap and wheels and power agree there. Clocks that count from 1970 are strong
//! evidence alone; many drives count from 0, of which a copy agrees but for its rounding.

use std::ops::Range;

use crate::{Channel, Error, PowerForm, Recording, Run, Watch, clock::UNIX_TIMES_S, watch::Looks};

/// Rows that two runs are compared in, spread evenly over the time that both hold.
const SAMPLES: usize = 200;

/// Rows that rule out most pairs, and pairs of values that tell at least.
const FEW_SAMPLES: usize = 20;

/// Share of the variance that a copy has in common with its original: power rounded to 5 W of a standard deviation of 40 W keeps 0.9987.
const COPY_AGREES: f64 = 0.998;

/// The same where both clocks count from 1970: stamps of a bag and its table differ by some milliseconds, in which power changes.
const SAME_CLOCK_AGREES: f64 = 0.95;

/// Drives of several sources behind one another, each with the name of its source.
///
/// # Errors
/// [`Error::SameDrive`] where two runs hold the same seconds of one drive; [`Error::Stopped`] when the watch breaks.
pub fn join_drives(parts: Vec<(String, Recording)>, watch: &Watch) -> Result<Recording, Error> {
    let named = |(source, part): &(String, Recording)| vec![source.clone(); part.runs.len()];
    let sources: Vec<String> = parts.iter().flat_map(named).collect();
    let joined = Recording::join(parts.into_iter().map(|(_, part)| part));
    refuse_same_drives(&joined, &sources, &Looks::new(watch))?;
    Ok(joined)
}

/// Refuses runs of which two hold the same seconds of one drive, with the source of each run.
fn refuse_same_drives(recording: &Recording, sources: &[String], looks: &Looks) -> Result<(), Error> {
    // What no model uses counts nothing, and is told elsewhere.
    let unused: Vec<usize> = recording.unused_runs().into_iter().map(|(run, _)| run).collect();
    let used: Vec<usize> = (0..recording.runs.len()).filter(|run| !unused.contains(run)).collect();
    let source = |run: usize| sources.get(run).cloned().unwrap_or_default();
    for (index, second) in used.iter().copied().enumerate() {
        looks.go_on()?;
        for first in used[..index].iter().copied() {
            let [one, other] = [first, second].map(|run| &recording.runs[run]);
            let Some([from_s, until_s]) = Clock::shared(recording, one, other) else { continue };
            if repeats(recording, one, other) {
                continue;
            }
            return Err(Error::SameDrive {
                first: source(first),
                first_run: one.name.clone(),
                second: source(second),
                second_run: other.name.clone(),
                from_s,
                until_s,
            });
        }
    }
    Ok(())
}

/// What is added to the times of two runs for both to be on one clock \[s\], and how well a drive agrees with itself there.
struct Clock {
    offsets_s: [f64; 2],
    agrees: f64,
}

impl Clock {
    /// First and last time that two runs share, by the clock of the second, where both hold one drive \[s\].
    fn shared(recording: &Recording, one: &Run, other: &Run) -> Option<[f64; 2]> {
        let unix = [one, other].map(|run| unix_offset_s(recording, run));
        let same = match unix {
            [Some(one_s), Some(other_s)] => Clock { offsets_s: [one_s, other_s], agrees: SAME_CLOCK_AGREES },
            _ => Clock { offsets_s: [0.0; 2], agrees: COPY_AGREES },
        };
        let [ends, other_ends] = [one, other].map(|run| ends_s(recording, run));
        let shift_s = same.offsets_s[1] - same.offsets_s[0];
        let (ends, other_ends) = (ends?, other_ends?);
        let from_s = other_ends[0].max(ends[0] - shift_s);
        let until_s = other_ends[1].min(ends[1] - shift_s);
        if from_s >= until_s {
            return None;
        }
        let of_one = rows_within(recording, one, [from_s + shift_s, until_s + shift_s]);
        let of_other = rows_within(recording, other, [from_s, until_s]);
        // Rows that were left out of a copy are not on the line between those that stayed.
        let (dense, ahead_s, rows) = match of_one.len() < of_other.len() {
            true => (other, -shift_s, of_one),
            false => (one, shift_s, of_other),
        };
        let agree = |samples: usize, least: f64| {
            let at = spread(&rows, samples);
            let like = |channel: Channel| agreement(recording, (dense, ahead_s), &at, channel);
            let wheels = [Channel::LeftSpeed, Channel::RightSpeed].map(like);
            let power = recording.power_form().map(PowerForm::channels).into_iter().flatten().map(like);
            wheels.into_iter().chain(power).all(|like| like.is_some_and(|like| like >= least))
        };
        // Any two drives agree a little; few samples rule out nearly all.
        (agree(FEW_SAMPLES, 0.5) && agree(SAMPLES, same.agrees)).then_some([from_s, until_s])
    }
}

/// What turns the times of a run into Unix times \[s\]; `None` where nothing tells.
fn unix_offset_s(recording: &Recording, run: &Run) -> Option<f64> {
    let [low_s, high_s] = UNIX_TIMES_S;
    let is_unix = |t_s: &f64| (low_s..=high_s).contains(t_s);
    let is_stamped = recording.t_s.get(run.rows.start).is_some_and(is_unix);
    run.start_unix_s.or(is_stamped.then_some(0.0))
}

fn ends_s(recording: &Recording, run: &Run) -> Option<[f64; 2]> {
    let t_s = recording.t_s.get(run.rows.clone())?;
    Some([*t_s.first()?, *t_s.last()?])
}

/// Rows of a run from one time to another \[s\].
fn rows_within(recording: &Recording, run: &Run, [from_s, until_s]: [f64; 2]) -> Range<usize> {
    let t_s = &recording.t_s[run.rows.clone()];
    let start = run.rows.start;
    start + t_s.partition_point(|t| *t < from_s)..start + t_s.partition_point(|t| *t <= until_s)
}

/// Rows spread evenly over others.
fn spread(rows: &Range<usize>, most: usize) -> Vec<usize> {
    let count = rows.len().min(most);
    (0..count).map(|sample| rows.start + sample * rows.len() / count).collect()
}

/// Share of the variance of a channel in some rows that another run, whose clock is ahead by so much, has as well; `None` where too few tell.
fn agreement(
    recording: &Recording,
    (run, ahead_s): (&Run, f64),
    rows: &[usize],
    channel: Channel,
) -> Option<f64> {
    let values = recording.channel(channel)?;
    let pairs: Vec<(f64, f64)> = rows
        .iter()
        .filter_map(|row| {
            Some((value_at(recording, run, values, recording.t_s[*row] + ahead_s)?, values[*row]))
        })
        .filter(|(one, other)| one.is_finite() && other.is_finite())
        .collect();
    let mean = pairs.iter().map(|pair| pair.1).sum::<f64>() / pairs.len() as f64;
    let sum = |of: &dyn Fn(&(f64, f64)) -> f64| pairs.iter().map(of).sum::<f64>();
    let variance = sum(&|(_, other)| (other - mean).powi(2));
    let difference = sum(&|(one, other)| (one - other).powi(2));
    let tells = 2 * pairs.len() >= FEW_SAMPLES && variance > 0.0;
    tells.then(|| 1.0 - difference / variance)
}

/// A channel of a run at a time, on the line between its neighbours; `None` in a gap.
fn value_at(recording: &Recording, run: &Run, values: &[f64], at_s: f64) -> Option<f64> {
    let t_s = &recording.t_s[run.rows.clone()];
    let next = run.rows.start + t_s.partition_point(|t| *t < at_s);
    if next < run.rows.end && recording.t_s[next] == at_s {
        return Some(values[next]);
    }
    let before = next.checked_sub(1)?;
    let step_s = recording.step_s(run, before)?;
    let share = (at_s - recording.t_s[before]) / step_s;
    Some(values[before] + share * (values[next] - values[before]))
}

/// Whether one of two runs is the other from its first row on, row by row.
fn repeats(recording: &Recording, one: &Run, other: &Run) -> bool {
    same_rows(recording, [one.rows.start, other.rows.start], one.rows.len().min(other.rows.len()))
}

/// Whether wheel speeds and power are the same to the last digit in so many rows from two of them on, whatever other sensors read.
pub fn same_rows(recording: &Recording, [a, b]: [usize; 2], count: usize) -> bool {
    let told = [
        Channel::LeftSpeed,
        Channel::RightSpeed,
        Channel::LeftMotorCurrent,
        Channel::Power,
        Channel::LeftPower,
    ];
    let is_same = |values: &[f64]| (0..count).all(|i| values[a + i].to_bits() == values[b + i].to_bits());
    told.into_iter().filter_map(|channel| recording.channel(channel)).all(is_same)
}
