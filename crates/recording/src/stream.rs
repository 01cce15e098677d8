//! The samples of one topic, in the order of one clock.

use std::f64::consts::TAU;

use crate::{
    Channel, Error, Repair, Source, Stamp, Target, TimeError,
    bursts::Bursts,
    clock_offset::offset_ns,
    coarse::Coarse,
    gap::{self, Gaps},
};

/// A clock that moves by so much against the logging clock from one message to the next was set, not delayed \[s\]:
/// messages are delayed by fractions of a second on a robot's own network.
pub(crate) const CLOCK_JUMP_S: f64 = 2.0;

pub(crate) const NS_PER_S: f64 = 1e9;

/// Name of the clock of header stamps.
pub(crate) const BY_HEADER: &str = "header stamp";

/// Seconds after the first.
fn seconds(t_ns: &[i64]) -> Vec<f64> {
    let origin_ns = t_ns.first().copied().unwrap_or(0);
    t_ns.iter().map(|t| t.saturating_sub(origin_ns) as f64 / NS_PER_S).collect()
}

/// Samples as they were logged.
#[derive(Debug, Default)]
pub(crate) struct Samples {
    pub(crate) log_ns: Vec<i64>,
    /// The header's stamp; zero where it was not set.
    pub(crate) stamp_ns: Vec<i64>,
    /// By source, then by message.
    pub(crate) columns: Vec<Vec<f64>>,
    /// Where a column's numbers begin again, as headings do.
    periods: Vec<Option<f64>>,
    /// Whether the last column tells which pack a message is of.
    has_packs: bool,
    /// How a message stands for several of the file.
    coarse: Coarse,
}

/// Samples in increasing order of time.
#[derive(Debug, Default)]
pub(crate) struct Stream {
    pub(crate) t_ns: Vec<i64>,
    pub(crate) columns: Vec<Vec<f64>>,
    pub(crate) clock: &'static str,
    /// Messages of the file that each stands for; empty where each stands for itself.
    weight: Vec<u32>,
    /// What lies between log times and header stamps; 0 of a stream by log times.
    pub(crate) offset_ns: i64,
}

impl Samples {
    /// None yet, of these sources, and where asked of the pack that each message is of.
    pub(crate) fn new<'m>(sources: impl Iterator<Item = &'m Source>, has_packs: bool) -> Samples {
        let heading = |source: &Source| source.target == Target::Channel(Channel::Heading);
        let of_sources = sources.map(|source| heading(source).then_some(TAU));
        let periods: Vec<Option<f64>> = of_sources.chain(has_packs.then_some(None)).collect();
        Samples { columns: vec![Vec::new(); periods.len()], periods, has_packs, ..Samples::default() }
    }

    /// Which pack each message is of, where that was asked for.
    pub(crate) fn take_packs(&mut self) -> Option<Vec<f64>> {
        let asked = std::mem::take(&mut self.has_packs);
        self.periods.truncate(self.periods.len() - usize::from(asked));
        if asked { self.columns.pop() } else { None }
    }

    /// Some of the messages.
    pub(crate) fn picked(&self, rows: &[usize]) -> Samples {
        let of = |ns: &[i64]| rows.iter().filter_map(|row| ns.get(*row).copied()).collect();
        let columns = self.columns.iter().map(|column| rows.iter().map(|row| column[*row]).collect());
        Samples {
            log_ns: of(&self.log_ns),
            stamp_ns: of(&self.stamp_ns),
            columns: columns.collect(),
            periods: self.periods.clone(),
            ..Samples::default()
        }
    }

    /// Messages of the file that it holds.
    pub(crate) fn messages(&self) -> usize {
        self.coarse.first_in_file(self.log_ns.len())
    }

    /// Numbers of a message; stamps count like values.
    pub(crate) fn width(&self) -> usize {
        self.columns.len() + 2
    }

    /// Numbers held.
    pub(crate) fn numbers(&self) -> usize {
        self.width() * self.log_ns.len()
    }

    /// Makes one of neighbouring messages until half as many are left. False: there are none that follow one another.
    pub(crate) fn halve(&mut self) -> bool {
        self.join(self.log_ns.len() / 2)
    }

    fn join(&mut self, most: usize) -> bool {
        let t_s = seconds(&self.log_ns);
        let stamps = &self.stamp_ns;
        let packs = self.columns.last().filter(|_| self.has_packs);
        // What the stamps have of jumps and late messages is to be seen later.
        let follows = |at: usize| {
            let step_ns = |ns: &[i64]| Some(ns.get(at)?.saturating_sub(*ns.get(at - 1)?));
            let apart_s = |ns: i64| ns as f64 / NS_PER_S - (t_s[at] - t_s[at - 1]);
            packs.is_none_or(|packs| packs[at] == packs[at - 1])
                && step_ns(stamps).is_none_or(|ns| ns > 0 && apart_s(ns).abs() < CLOCK_JUMP_S)
        };
        let Some(groups) = self.coarse.group(&t_s, most, follows) else { return false };
        groups.average_ns(&mut self.log_ns);
        if self.stamp_ns.len() == t_s.len() {
            groups.average_ns(&mut self.stamp_ns);
        } else {
            self.stamp_ns.clear();
        }
        for (column, period) in self.columns.iter_mut().zip(&self.periods) {
            groups.average(column, *period);
        }
        true
    }

    /// Chooses the clock, refuses one that was set on the way, sorts late messages in and drops repeated stamps.
    pub(crate) fn into_stream(
        mut self,
        topic: &str,
        stamp: Stamp,
        repairs: &mut Vec<Repair>,
    ) -> Result<Stream, Error> {
        if self.coarse.is_joined() {
            // What was read last becomes as coarse as what was before, so that the stream has one rhythm.
            self.join(usize::MAX);
        }
        repairs.extend(self.coarse.told(&format!("topic {topic}"), &seconds(&self.log_ns)));
        let has_stamps = self.stamp_ns.len() == self.log_ns.len() && self.stamp_ns.iter().all(|ns| *ns != 0);
        let by_header = stamp == Stamp::Header && has_stamps;
        let (t_ns, clock) =
            if by_header { (self.stamp_ns, BY_HEADER) } else { (self.log_ns.clone(), "log time") };
        let other = if by_header { "log" } else { "header" };
        let stalls = refuse_jumps(topic, (&t_ns, by_header), &self.log_ns, other, &self.coarse)?;
        if let Some(stall) = stalls.first() {
            repairs.push(Repair { place: format!("topic {topic}"), what: stall.told(stalls.len()) });
        }
        let messages = if self.coarse.is_joined() { t_ns.len() } else { 0 };
        let weight = (0..messages).map(|at| self.coarse.weight(at)).collect();
        let offset_ns = if by_header { offset_ns(&t_ns, &self.log_ns).unwrap_or(0) } else { 0 };
        let mut stream = Stream { t_ns, columns: self.columns, clock, weight, offset_ns };
        let mut repair = |count: usize, what: &str| {
            if count > 0 {
                repairs.push(Repair { place: format!("topic {topic}"), what: format!("{count} {what}") });
            }
        };
        repair(stream.sort(), "messages came later than their successors; they were sorted by time");
        if let Some(told) = stream.spread_bursts() {
            repairs.push(Repair { place: format!("topic {topic}"), what: told });
        }
        let mut repair = |count: usize, what: &str| {
            if count > 0 {
                repairs.push(Repair { place: format!("topic {topic}"), what: format!("{count} {what}") });
            }
        };
        repair(stream.drop_repeats(), "messages repeat the stamp before them; the first of each was kept");
        Ok(stream)
    }
}

/// Where the recorder's clock moved against stamps that go on evenly.
struct Stall {
    message: usize,
    by_s: f64,
}

impl Stall {
    fn told(&self, count: usize) -> String {
        format!(
            "the recorder's clock moves by {:.3} s against the header stamps before message {} ({count} such moves in all); the stamps themselves \
             are even and were used",
            -self.by_s, self.message
        )
    }
}

/// Refuses a clock that was set on the way. Of header stamps that go on evenly it is the recorder that stalled and wrote late, which is told.
fn refuse_jumps(
    topic: &str,
    (t_ns, by_header): (&[i64], bool),
    log_ns: &[i64],
    other: &'static str,
    coarse: &Coarse,
) -> Result<Vec<Stall>, Error> {
    let mut sorted = t_ns.to_vec();
    sorted.sort_unstable();
    let sorted_s = seconds(&sorted);
    let (step_s, even_s) = (gap::median_step_s(&sorted_s).unwrap_or(0.0), gap::threshold_s(&sorted_s));
    let gaps = Gaps::of(&sorted_s, None);
    let is_even = by_header && (1..sorted_s.len()).all(|at| !gaps.is_gap(&sorted_s, at - 1));
    let since_s = |ns: &[i64], at: usize| ns[at].saturating_sub(ns[at - 1]) as f64 / NS_PER_S;
    // What was held up is written in a burst, with what came meanwhile among it.
    let is_recorders = |at: usize| {
        is_even && ((0.0..=even_s).contains(&since_s(t_ns, at)) || since_s(log_ns, at).abs() < 0.5 * step_s)
    };
    let jump = |at: usize, by_ns: i64| {
        let by_s = by_ns as f64 / NS_PER_S;
        (by_s.abs() > CLOCK_JUMP_S).then_some((coarse.first_in_file(at) + 1, by_s))
    };
    let (mut latest_ns, mut stalls) = (i64::MIN, Vec::new());
    for (at, (&t, &log)) in t_ns.iter().zip(log_ns).enumerate() {
        if at > 0 {
            let offset = |t: i64, log: i64| t.saturating_sub(log);
            let moved = offset(t, log).saturating_sub(offset(t_ns[at - 1], log_ns[at - 1]));
            let back = t.saturating_sub(latest_ns).min(0);
            match jump(at, moved).or_else(|| jump(at, back)) {
                Some((message, by_s)) if is_recorders(at) => stalls.push(Stall { message, by_s }),
                Some((message, by_s)) => {
                    return Err(TimeError::ClockJump { topic: topic.to_owned(), message, by_s, other }.into());
                }
                None => {}
            }
        }
        latest_ns = latest_ns.max(t);
    }
    Ok(stalls)
}

impl Stream {
    #[cfg(test)]
    pub(crate) fn of(t_ns: Vec<i64>, columns: Vec<Vec<f64>>) -> Stream {
        Stream { t_ns, columns, clock: BY_HEADER, weight: Vec::new(), offset_ns: 0 }
    }

    fn sort(&mut self) -> usize {
        let mut latest = i64::MIN;
        let late = self.t_ns.iter().filter(|t| {
            let late = **t < latest;
            latest = latest.max(**t);
            late
        });
        let late = late.count();
        if late > 0 {
            let mut order: Vec<usize> = (0..self.t_ns.len()).collect();
            order.sort_by_key(|&at| self.t_ns[at]);
            self.pick(&order);
        }
        late
    }

    /// Spreads messages that came in bursts evenly; says so.
    fn spread_bursts(&mut self) -> Option<String> {
        let origin_ns = *self.t_ns.first()?;
        // Equal stamps of headers are messages that were sent twice.
        if self.clock == BY_HEADER && self.t_ns.windows(2).any(|pair| pair[0] == pair[1]) {
            return None;
        }
        let bursts = Bursts::of(&self.t_s(origin_ns))?;
        // The first burst may begin before the first stamp.
        let nanoseconds = |t_s: &f64| origin_ns.saturating_add((t_s * NS_PER_S).round() as i64);
        self.t_ns = bursts.t_s.iter().map(nanoseconds).collect();
        Some(bursts.told("messages"))
    }

    fn drop_repeats(&mut self) -> usize {
        if self.t_ns.windows(2).all(|pair| pair[0] != pair[1]) {
            return 0;
        }
        let new = |at: &usize| *at == 0 || self.t_ns[*at] != self.t_ns[at - 1];
        let kept: Vec<usize> = (0..self.t_ns.len()).filter(new).collect();
        let dropped = self.t_ns.len() - kept.len();
        if dropped > 0 {
            self.pick(&kept);
        }
        dropped
    }

    fn pick(&mut self, order: &[usize]) {
        self.t_ns = order.iter().map(|&at| self.t_ns[at]).collect();
        for column in &mut self.columns {
            *column = order.iter().map(|&at| column[at]).collect();
        }
        if !self.weight.is_empty() {
            self.weight = order.iter().map(|&at| self.weight[at]).collect();
        }
    }

    /// Messages of the file that one stands for.
    pub(crate) fn weight(&self, at: usize) -> u32 {
        self.weight.get(at).copied().unwrap_or(1)
    }

    /// Times in seconds after an origin.
    pub(crate) fn t_s(&self, origin_ns: i64) -> Vec<f64> {
        self.t_ns.iter().map(|t| t.saturating_sub(origin_ns) as f64 / NS_PER_S).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn samples(t_s: &[f64]) -> Samples {
        let ns: Vec<i64> = t_s.iter().map(|t| (t * NS_PER_S) as i64).collect();
        let columns = vec![(0..t_s.len()).map(|at| at as f64).collect()];
        let log_ns = (0..ns.len() as i64).map(|i| i * 100_000_000).collect();
        Samples { log_ns, stamp_ns: ns, columns, periods: vec![None], ..Samples::default() }
    }

    #[test]
    fn late_and_repeated_messages_are_mended_and_told() {
        let mut repairs = Vec::new();
        let stream =
            samples(&[1.0, 1.2, 1.1, 1.2, 1.3]).into_stream("/t", Stamp::Header, &mut repairs).unwrap();
        assert_eq!(stream.columns[0], [0.0, 2.0, 1.0, 4.0]);
        assert!(repairs[0].what.starts_with("1 messages came later"), "{repairs:?}");
        assert!(repairs[1].what.starts_with("1 messages repeat"), "{repairs:?}");
    }

    #[test]
    fn a_clock_that_is_set_on_the_way_is_refused_by_message() {
        for times in [[1.0, 1.1, 500.0, 500.1], [500.0, 500.1, 1.0, 1.1]] {
            let error = samples(&times).into_stream("/t", Stamp::Header, &mut Vec::new()).unwrap_err();
            assert!(error.to_string().contains("topic /t, message 3: its clock jumps by"), "{error}");
        }
        assert!(samples(&[1.0, 1.1, 500.0]).into_stream("/t", Stamp::Log, &mut Vec::new()).is_ok());
    }

    #[test]
    fn a_recorder_that_stalls_while_stamps_go_on_evenly_is_told_and_the_stamps_are_used() {
        let times: Vec<f64> = (0..40).map(|i| 1.0 + 0.1 * f64::from(i)).collect();
        let mut stalled = samples(&times);
        stalled.log_ns.iter_mut().skip(20).for_each(|ns| *ns += 3_000_000_000);
        let mut repairs = Vec::new();
        let stream = stalled.into_stream("/t", Stamp::Header, &mut repairs).unwrap();
        assert_eq!((stream.clock, stream.t_ns.len()), (BY_HEADER, 40));
        assert!(repairs[0].what.starts_with("the recorder's clock moves by 3.000 s"), "{repairs:?}");
    }

    #[test]
    fn a_topic_with_an_unset_stamp_goes_by_the_log() {
        let stream = samples(&[0.0, 1.1, 1.2]).into_stream("/t", Stamp::Header, &mut Vec::new()).unwrap();
        assert_eq!((stream.clock, stream.t_ns[1]), ("log time", 100_000_000));
    }
}
