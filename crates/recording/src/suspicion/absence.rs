//! Channels without values, or with ones that stand still.

use std::borrow::Cow;

use super::LEAST_ROWS;
use crate::{
    Channel, Recording, Run,
    report::{Suspicion, SuspicionKind as Kind},
};

/// Values that are there, without a copy when all are.
pub(super) fn present(values: &[f64]) -> Cow<'_, [f64]> {
    if values.iter().any(|value| value.is_nan()) {
        values.iter().copied().filter(|value| !value.is_nan()).collect()
    } else {
        Cow::Borrowed(values)
    }
}

pub(super) fn sparse(present: usize, rows: usize) -> Option<String> {
    let missing = rows - present;
    // More gaps than values: what is fitted to the rest describes the minority of the drive.
    (missing > present).then(|| format!("{missing} of {rows} rows have no value"))
}

/// A run that tells nothing: of one of the channels that are needed it has no value.
pub(super) fn empty(recording: &Recording, run: &Run) -> Option<Suspicion> {
    let power = recording.power_form()?.channels();
    let needed = [Channel::LeftSpeed, Channel::RightSpeed].into_iter().chain(power);
    let lacks = |channel: &Channel| {
        let values = recording.channel(*channel).and_then(|values| values.get(run.rows.clone()));
        values.is_some_and(|values| values.iter().all(|value| value.is_nan()))
    };
    let channel = needed.into_iter().find(lacks)?;
    let statement = format!("it has no value in {} rows, so that this run tells nothing", run.rows.len());
    Some(Suspicion { channel, run: Some(run.name.clone()), kind: Kind::Sparse, statement })
}

pub(super) fn constant(present: &[f64]) -> Option<String> {
    let first = *present.first()?;
    present.iter().all(|value| *value == first).then(|| format!("it is {first} in every row"))
}

/// A spike of equal values at an extreme. A driven robot does reach its top speed often, but then values just below are
/// as frequent; a clipped signal has many times more at the limit itself.
pub(super) fn saturated(channel: Channel, present: &[f64]) -> Option<String> {
    /// Shares below this do little harm to a fit.
    const LEAST_SHARE: f64 = 0.01;
    /// How many times more frequent than the mean of its next neighbours an extreme must be.
    const SPIKE: f64 = 5.0;
    /// Neighbours that are looked at.
    const NEIGHBOURS: usize = 10;
    let (least, greatest) =
        present.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, g), v| (l.min(*v), g.max(*v)));
    let often = |value: f64| {
        let count = present.iter().filter(|v| **v == value).count();
        // Where all values have one sign, the least of them in size is where the channel rests, with its offset, and not where it
        // is clipped; zero is so in any case.
        let rests = value == 0.0 || (value == least && value > 0.0) || (value == greatest && value < 0.0);
        !rests && count >= LEAST_ROWS && count as f64 >= LEAST_SHARE * present.len() as f64
    };
    // Sorting a million rows takes longer than reading them, and hardly any channel needs it.
    if !often(least) && !often(greatest) {
        return None;
    }
    let mut sorted = present.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let counts: Vec<(f64, usize)> =
        sorted.chunk_by(|a, b| a == b).map(|equal| (equal[0], equal.len())).collect();
    if counts.len() <= NEIGHBOURS {
        return None;
    }
    // Encoders count, and a robot that drives or spins steadily stays at one count: it does so at others as well.
    let is_steady = |value: f64, count: usize| {
        let inner = counts.iter().filter(|(other, _)| *other != value && *other != 0.0);
        let most = inner.map(|(_, count)| *count).max().unwrap_or(0) as f64;
        matches!(channel, Channel::LeftSpeed | Channel::RightSpeed) && (count as f64) < SPIKE * most
    };
    let spike = |ends: &mut dyn Iterator<Item = &(f64, usize)>| {
        let (value, count) = *ends.next()?;
        let near: usize = ends.take(NEIGHBOURS).map(|(_, count)| count).sum();
        let is_spike = count as f64 >= SPIKE * near as f64 / NEIGHBOURS as f64;
        let clipped = often(value) && is_spike && !is_steady(value, count);
        clipped.then(|| format!("it stands at its limit {value} in {count} of {} rows", present.len()))
    };
    spike(&mut counts.iter().rev()).or_else(|| spike(&mut counts.iter()))
}
