//! Header stamps by a clock that is not the recorder's.
//!
//! A message is logged after it was stamped, by the delay of the robot's own network: never before it, and by fractions of a second. What is more
//! than that between stamps and log times is an offset between two clocks. Where all topics have it alike, stamps agree with one another;
//! where topics differ, their stamps would lay power beside wheel speeds of another time.

use crate::{
    Repair,
    merge::Named,
    stream::{BY_HEADER, CLOCK_JUMP_S, NS_PER_S},
};

/// Stamps that are so much later than their log times are no delay, since that cannot be negative \[s\]: more than the clocks of a robot's computers
/// that are held together by NTP differ by.
const AHEAD_S: f64 = 0.1;
/// Delays from which on it is said that they may be a clock's offset \[s\]: half of the second over which power is compared.
const DOUBTED_S: f64 = 0.5;

/// Which of the messages, in order of their delay, tells the offset: the fastest were delayed least, and a few may have been stamped wrongly.
const FASTEST_SHARE: f64 = 0.05;

/// What lies between log times and stamps of the fastest messages \[ns\].
pub(crate) fn offset_ns(stamp_ns: &[i64], log_ns: &[i64]) -> Option<i64> {
    let mut apart: Vec<i64> =
        stamp_ns.iter().zip(log_ns).map(|(stamp, log)| log.saturating_sub(*stamp)).collect();
    if apart.is_empty() {
        return None;
    }
    let at = (FASTEST_SHARE * apart.len() as f64) as usize;
    Some(*apart.select_nth_unstable(at).1)
}

/// Brings the streams that are used onto the log's clock where their header stamps are by clocks that differ, and says what was found.
pub(crate) fn reconcile(streams: &mut [Named], used: &[usize], repairs: &mut Vec<Repair>) {
    let offset_s = |named: &Named| named.stream.offset_ns as f64 / NS_PER_S;
    let is_off = |offset_s: f64| !(-AHEAD_S..=CLOCK_JUMP_S).contains(&offset_s);
    let offsets_s = || used.iter().map(|at| offset_s(&streams[*at]));
    let least_s = offsets_s().fold(f64::INFINITY, f64::min);
    let most_s = offsets_s().fold(f64::NEG_INFINITY, f64::max);
    let differ = offsets_s().any(is_off)
        && (most_s - least_s > CLOCK_JUMP_S || least_s < -AHEAD_S)
        && most_s - least_s > AHEAD_S;
    let mut told: Vec<usize> = used.to_vec();
    told.retain(|at| streams[*at].stream.clock == BY_HEADER);
    told.sort_unstable();
    told.dedup();
    for at in told {
        let apart_s = offset_s(&streams[at]);
        let named = &mut streams[at];
        let (size_s, side) = (apart_s.abs(), if apart_s > 0.0 { "behind" } else { "ahead of" });
        let what = if differ && is_off(apart_s) {
            let shift_ns = named.stream.offset_ns;
            named.stream.t_ns.iter_mut().for_each(|t| *t = t.saturating_add(shift_ns));
            format!(
                "its header stamps are {size_s:.3} s {side} the log times, and those of other topics are not: they are by another clock, and were moved by \
                 that; if the stamps are right, log them all by one clock, or give `\"stamp\": \"log\"` in a map to go by log times alone"
            )
        } else if is_off(apart_s) {
            format!(
                "its header stamps are {size_s:.3} s {side} the log times, as those of all other topics that are used: the recorder had another clock; the \
                 stamps are used as they are"
            )
        } else if apart_s > DOUBTED_S && apart_s - least_s > DOUBTED_S {
            format!(
                "every message was logged at least {size_s:.3} s after its header stamp, and those of other topics sooner: if that is no delay, its clock \
                 is behind; the stamps are used as they are, and `\"stamp\": \"log\"` in a map goes by log times"
            )
        } else {
            continue;
        };
        repairs.push(Repair { place: format!("topic {}", named.topic), what });
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stream::Stream;

    /// Topics of 100 messages whose stamps are so much behind their log times.
    fn topics(offsets_s: &[f64]) -> Vec<Named> {
        let stream = |offset_s: &f64| {
            let log_ns: Vec<i64> = (0..100).map(|i| 1_700_000_000_000_000_000 + i * 100_000_000).collect();
            let by_ns = (offset_s * NS_PER_S) as i64;
            let jitter = |i: i64| i % 7 * 1_000_000;
            let stamp_ns: Vec<i64> = log_ns.iter().zip(0..).map(|(t, i)| t - by_ns - jitter(i)).collect();
            let mut stream = Stream::of(stamp_ns.clone(), Vec::new());
            stream.offset_ns = offset_ns(&stamp_ns, &log_ns).unwrap();
            Named::new(format!("/by_{offset_s}"), stream)
        };
        offsets_s.iter().map(stream).collect()
    }

    fn reconciled(offsets_s: &[f64]) -> (Vec<f64>, Vec<String>) {
        let (mut streams, mut repairs) = (topics(offsets_s), Vec::new());
        let used: Vec<usize> = (0..streams.len()).collect();
        reconcile(&mut streams, &used, &mut repairs);
        let first_ns = streams[0].stream.t_ns[0];
        let apart = streams.iter().map(|named| (named.stream.t_ns[0] - first_ns) as f64 / NS_PER_S);
        (apart.collect(), repairs.into_iter().map(|repair| repair.what).collect())
    }

    #[test]
    fn a_topic_by_another_clock_is_moved_onto_the_logs_and_said() {
        for offset_s in [3600.0, 5.0, -0.8, -30.0] {
            let (apart_s, said) = reconciled(&[0.01, offset_s]);
            assert!(apart_s[1].abs() < 0.02, "{offset_s}: {apart_s:?}");
            assert!(said.len() == 1 && said[0].contains("by another clock"), "{offset_s}: {said:?}");
        }
    }

    #[test]
    fn delays_and_an_offset_that_all_share_are_left_as_they_are() {
        let (apart_s, said) = reconciled(&[0.01, 0.3]);
        assert!((apart_s[1] + 0.29).abs() < 1e-6 && said.is_empty(), "{said:?}");
        let (apart_s, said) = reconciled(&[3600.0, 3600.2]);
        assert!((apart_s[1] + 0.2).abs() < 1e-6 && said.len() == 2, "{said:?}");
        let (apart_s, said) = reconciled(&[0.01, 1.2]);
        assert!(apart_s[1] < -1.1 && said[0].contains("if that is no delay"), "{said:?}");
    }
}
