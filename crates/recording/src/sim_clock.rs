//! The time of a simulation, which `/clock` tells beside the log's: what a robot drives in it takes so long as it says.

use crate::{
    Repair,
    stream::{CLOCK_JUMP_S, NS_PER_S, Samples},
    topic::Topic,
};

/// The topic on which nodes hear the time (ROS, *Clock and Time*; REP 2000 onwards `rosgraph_msgs/msg/Clock`).
pub(crate) const TOPIC: &str = "/clock";

/// Log times and the times of `/clock` at them, both increasing \[ns\].
struct SimClock {
    log_ns: Vec<i64>,
    clock_ns: Vec<i64>,
}

impl SimClock {
    fn new(samples: &Samples) -> Option<SimClock> {
        if samples.stamp_ns.len() != samples.log_ns.len() {
            return None;
        }
        let mut clock = SimClock { log_ns: Vec::new(), clock_ns: Vec::new() };
        for (&log_ns, &clock_ns) in samples.log_ns.iter().zip(&samples.stamp_ns) {
            let is_later = clock.log_ns.last().is_none_or(|last| log_ns > *last);
            match clock.clock_ns.last() {
                Some(last) if clock_ns < *last => return None,
                Some(last) if clock_ns == *last || !is_later => {}
                _ => {
                    clock.log_ns.push(log_ns);
                    clock.clock_ns.push(clock_ns);
                }
            }
        }
        (clock.log_ns.len() >= 2).then_some(clock)
    }

    /// How much of its time passes in that of the log.
    fn rate(&self) -> f64 {
        let span = |ns: &[i64]| {
            ns.last().zip(ns.first()).map_or(0.0, |(last, first)| last.saturating_sub(*first) as f64)
        };
        span(&self.clock_ns) / span(&self.log_ns)
    }

    /// Its time at a log time; before and behind it the pairs at the ends go on.
    fn at(&self, log_ns: i64) -> i64 {
        let behind = self.log_ns.partition_point(|ns| *ns <= log_ns).clamp(1, self.log_ns.len() - 1);
        let [log, clock] = [&self.log_ns, &self.clock_ns].map(|ns| [ns[behind - 1], ns[behind]]);
        let share = log_ns.saturating_sub(log[0]) as f64 / log[1].saturating_sub(log[0]) as f64;
        clock[0].saturating_add((share * clock[1].saturating_sub(clock[0]) as f64).round() as i64)
    }

    /// Whether the header stamps of a topic, where it has any, are of this time.
    fn agrees(&self, topic: &Topic) -> bool {
        let Some(&stamp_ns) = topic.samples.stamp_ns.first().filter(|ns| **ns != 0) else { return true };
        let jump_ns = (CLOCK_JUMP_S * NS_PER_S) as i64;
        let [first, last] = [self.clock_ns[0], self.clock_ns[self.clock_ns.len() - 1]];
        (first.saturating_sub(jump_ns)..=last.saturating_add(jump_ns)).contains(&stamp_ns)
    }
}

/// Brings log times onto that of `/clock`, where all header stamps are of it or unset, and says so.
pub(crate) fn settle(clock: Option<&Topic>, topics: &mut [Topic]) -> Option<Repair> {
    let clock = SimClock::new(&clock?.samples)?;
    if !topics.iter().all(|topic| clock.agrees(topic)) {
        return None;
    }
    for topic in topics {
        topic.samples.log_ns.iter_mut().for_each(|ns| *ns = clock.at(*ns));
    }
    let what = format!(
        "times are those of {TOPIC}, as in a simulation; it runs at {:.3} of the speed of the log's clock",
        clock.rate()
    );
    Some(Repair { place: format!("topic {TOPIC}"), what })
}
