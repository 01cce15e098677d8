//! Whose stamps become the rows of a bag.

use crate::{
    Error, Map, Repair, TimeError,
    clock::implausible_steps,
    gap,
    map::Target,
    merge::Named,
    meter,
    stream::{BY_HEADER, NS_PER_S},
    topic::Topics,
};

/// The rows of a bag: the stamps of the base, and those of the wheels before its first and behind its last.
pub(crate) struct Rows {
    t_ns: Vec<i64>,
    /// Rows before the base's first stamp.
    before: usize,
    /// Whose stamps the rows at the ends are.
    wheels: String,
}

impl Rows {
    /// The time of the first row \[ns\], and all times since \[s\].
    pub(crate) fn t_s(&self) -> (i64, Vec<f64>) {
        let origin_ns = self.t_ns.first().copied().unwrap_or(0);
        (origin_ns, self.t_ns.iter().map(|t| t.saturating_sub(origin_ns) as f64 / NS_PER_S).collect())
    }

    /// A column of the base in these rows.
    pub(crate) fn of_base(&self, values: &[f64]) -> Vec<f64> {
        let mut rows = vec![f64::NAN; self.before];
        rows.extend(values);
        rows.resize(self.t_ns.len(), f64::NAN);
        rows
    }

    /// That the base begins later or ends earlier than the drive.
    pub(crate) fn told(&self, base: &str, messages: usize) -> Option<Repair> {
        let behind = self.t_ns.len() - self.before - messages;
        if self.before + behind == 0 {
            return None;
        }
        let span_s = |from: usize, to: usize| match (self.t_ns.get(from), self.t_ns.get(to)) {
            (Some(from), Some(to)) => to.saturating_sub(*from) as f64 / NS_PER_S,
            _ => 0.0,
        };
        let late_s = span_s(0, self.before);
        let early_s = span_s((self.before + messages).saturating_sub(1), self.t_ns.len() - 1);
        let parts = [(late_s, "begins", "after"), (early_s, "ends", "before")].map(|(by_s, what, side)| {
            (by_s > 0.0).then(|| format!("{what} {by_s:.1} s {side} {}", self.wheels))
        });
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        let what = format!(
            "it {}: the rows there are of {}, without what {base} tells",
            parts.join(" and "),
            self.wheels
        );
        Some(Repair { place: format!("topic {base}"), what })
    }
}

impl Topics<'_> {
    /// The stream whose stamps become the rows: the map's, or the slowest of those that tell power.
    pub(crate) fn base(&self, streams: &[Named], chosen: &[(usize, usize, usize)]) -> Result<usize, Error> {
        if let Some(base) = &self.map.base {
            let named = streams.iter().position(|named| Map::topic_matches(base, &named.topic));
            return named.ok_or_else(|| {
                Error::missing_names(&[format!("the map's base {base}")], &[base], &self.names)
            });
        }
        let power =
            |source: usize| matches!(&self.map.sources[source].target, Target::Channel(c) if c.tells_power());
        let tells = chosen.iter().filter(|(source, ..)| power(*source)).map(|(_, stream, _)| *stream);
        let slowest = tells.max_by(|a, b| streams[*a].step_s.total_cmp(&streams[*b].step_s));
        Ok(slowest.or(chosen.first().map(|(_, stream, _)| *stream)).unwrap_or(0))
    }

    /// The stream of wheel speeds whose stamps become the rows, where the base is a power meter that is slower.
    pub(crate) fn slow_meter(
        &self,
        streams: &[Named],
        chosen: &[(usize, usize, usize)],
        base: usize,
    ) -> Option<usize> {
        if self.map.base.is_some() {
            return None;
        }
        let is_wheel = |source: usize| self.map.sources[source].target.is_wheel_speed();
        let wheels = chosen.iter().filter(|(source, ..)| is_wheel(*source)).map(|(_, stream, _)| *stream);
        let slowest = wheels.max_by(|a, b| streams[*a].step_s.total_cmp(&streams[*b].step_s))?;
        let is_slow = meter::is_slow(streams[base].step_s, streams[slowest].step_s, self.map.max_gap_s);
        (slowest != base && is_slow && streams[base].step_s.is_finite()).then_some(slowest)
    }

    /// The stamps of the base, and where the map does not choose it those of the wheels before and behind it: power that ends before the
    /// drive leaves seconds that are told, not fewer seconds.
    pub(crate) fn rows(&self, streams: &[Named], chosen: &[(usize, usize, usize)], base: usize) -> Rows {
        let own = &streams[base].stream.t_ns;
        let mut rows = Rows { t_ns: own.clone(), before: 0, wheels: String::new() };
        let is_wheel =
            |(source, ..): &&(usize, usize, usize)| self.map.sources[*source].target.is_wheel_speed();
        let wheels = chosen.iter().find(is_wheel).map(|(_, stream, _)| &streams[*stream]);
        let (Some(wheels), Some(&first), Some(&last)) = (wheels, own.first(), own.last()) else {
            return rows;
        };
        if self.map.base.is_some() || !streams[base].step_s.is_finite() {
            return rows;
        }
        let step_ns = (streams[base].step_s.max(wheels.step_s) * NS_PER_S) as i64;
        let stamps = &wheels.stream.t_ns;
        let ahead = spaced(stamps.iter().rev().copied(), first, -step_ns);
        rows.before = ahead.len();
        rows.t_ns = ahead.into_iter().rev().chain(own.iter().copied()).collect();
        rows.t_ns.extend(spaced(stamps.iter().copied(), last, step_ns));
        rows.wheels.clone_from(&wheels.topic);
        rows
    }
}

/// Stamps beyond an end, in the direction of a step and no closer to one another; none where they go no farther than a gap, within which any
/// two rhythms begin and end.
fn spaced(stamps: impl Iterator<Item = i64>, end_ns: i64, step_ns: i64) -> Vec<i64> {
    let (mut kept, mut last_ns) = (Vec::new(), end_ns);
    for stamp_ns in stamps {
        let apart_ns = stamp_ns.saturating_sub(last_ns).saturating_mul(step_ns.signum());
        if apart_ns as f64 >= (1.0 - gap::STEP_ROUNDING) * step_ns.abs() as f64 {
            kept.push(stamp_ns);
            last_ns = stamp_ns;
        }
    }
    let is_far = last_ns.abs_diff(end_ns) as f64 > gap::GAP_STEPS * step_ns.abs() as f64;
    if is_far { kept } else { Vec::new() }
}

/// Refuses stamps whose steps are not those of a drive log.
pub(crate) fn check_steps(base: &Named) -> Result<(), Error> {
    let origin_ns = base.stream.t_ns.first().copied().unwrap_or(0);
    match implausible_steps(&base.stream.t_s(origin_ns), |at| base.stream.weight(at)) {
        None => Ok(()),
        Some(evidence) => {
            let other = if base.stream.clock == BY_HEADER { "log" } else { "header" };
            Err(TimeError::TopicSteps { topic: base.topic.clone(), evidence, other }.into())
        }
    }
}
