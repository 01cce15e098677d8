//! Several battery packs that tell of themselves on one topic, told apart by the texts in their messages.
//!
//! Packs in parallel share what a robot draws: its power is the sum of theirs, and their voltage is one. A pack that took the place of another
//! tells after it, not beside it, and is the same source.

use std::collections::BTreeMap;

use crate::{
    Channel, Map, Repair, Target,
    align::{Between, interpolate_within},
    stream::{Samples, Stream},
};

/// Texts of a message by which drivers name the pack that it is of (`sensor_msgs/BatteryState`, `clearpath_platform_msgs`).
pub(crate) const NAMES: [&str; 3] = ["serial_number", "location", "header.frame_id"];

/// More packs than this are none: a text that changes with every message names something else.
const MOST: usize = 8;

/// Whether a channel is what a pack tells of itself.
pub(crate) fn is_of_packs(target: &Target) -> bool {
    matches!(target, Target::Channel(Channel::Current | Channel::Power | Channel::Voltage))
}

/// The samples of each pack, where there are several beside one another; else all of them.
pub(crate) fn apart(mut samples: Samples) -> Vec<Samples> {
    let Some(packs) = samples.take_packs() else { return vec![samples] };
    let mut rows: BTreeMap<u64, Vec<usize>> = BTreeMap::new();
    for (row, of) in packs.iter().enumerate() {
        rows.entry(of.to_bits()).or_default().push(row);
    }
    let mut packs: Vec<Vec<usize>> = rows.into_values().collect();
    packs.sort_by_key(|rows| rows[0]);
    // One that took another's place begins when that has ended.
    let are_beside = packs.windows(2).all(|pair| pair[1][0] < pair[0][pair[0].len() - 1]);
    let are_packs = (2..=MOST).contains(&packs.len()) && packs.iter().all(|rows| rows.len() > 1);
    if are_packs && are_beside {
        packs.iter().map(|rows| samples.picked(rows)).collect()
    } else {
        vec![samples]
    }
}

/// One stream of those of several packs, at the stamps of the first: their currents and powers are added up, and their voltages averaged.
pub(crate) fn together(
    topic: &str,
    targets: &[&Target],
    streams: Vec<Stream>,
    map: &Map,
) -> (Stream, Option<Repair>) {
    let count = streams.len();
    let mut streams = streams.into_iter();
    let Some(mut first) = streams.next() else { return (Stream::default(), None) };
    let origin_ns = first.t_ns.first().copied().unwrap_or(0);
    let at_s = first.t_s(origin_ns);
    for other in streams {
        let own_s = other.t_s(origin_ns);
        for ((column, values), target) in first.columns.iter_mut().zip(&other.columns).zip(targets) {
            if is_of_packs(target) {
                let there = interpolate_within(&own_s, values, &at_s, map.max_gap_s, Between::Line);
                column.iter_mut().zip(there).for_each(|(sum, value)| *sum += value);
            }
        }
    }
    for (column, target) in first.columns.iter_mut().zip(targets) {
        if **target == Target::Channel(Channel::Voltage) {
            column.iter_mut().for_each(|sum| *sum /= count as f64);
        }
    }
    let what = format!(
        "its messages are of {count} packs, by their serial numbers, locations or frames: what they draw was added up, and their voltages averaged"
    );
    (first, (count > 1).then(|| Repair { place: format!("topic {topic}"), what }))
}

/// A number that stands for a text, the same for the same text (FNV-1a, of 52 bits so that a double holds it).
pub(crate) fn number(text: &[u8]) -> f64 {
    const OFFSET: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0100_0000_01b3;
    let hash = text.iter().fold(OFFSET, |hash, byte| (hash ^ u64::from(*byte)).wrapping_mul(PRIME));
    (hash >> 12) as f64
}
