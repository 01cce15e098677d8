//! Which of several sources of one channel is taken: the first of the map that covers most of the drive, and what has to be said of the others.

use crate::{
    Channel, Ignored, Map, Repair, Target,
    gap::{Gaps, median_step_s},
    map::Place,
    merge::Named,
    namespace::Others,
    topic::Topics,
    units::si_unit,
};

/// A source of the map, the stream that it has its numbers from, and the column there.
pub(crate) type Chosen = (usize, usize, usize);

impl Topics<'_> {
    /// For each target its source, with all parts that it has in other topics.
    pub(crate) fn choose(&mut self, streams: &[Named], other: Option<&Others>) -> Vec<Chosen> {
        let held = self.held(streams, other);
        let drive_s = self.drive_s(streams, &held);
        let mut chosen: Vec<Chosen> = Vec::new();
        for leader in held.iter().filter(|(source, ..)| !self.map.sources[*source].is_further_part) {
            let target = &self.map.sources[leader.0].target;
            if chosen.iter().any(|(source, ..)| self.map.sources[*source].target == *target) {
                continue;
            }
            let is_rival = |(source, ..): &&Chosen| {
                let source = &self.map.sources[*source];
                source.target == *target && !source.is_further_part
            };
            let rivals: Vec<Chosen> = held.iter().filter(is_rival).copied().collect();
            let taken = self.covering(streams, &rivals, drive_s);
            let parts = self.parts(&held, taken);
            if let Some(parts) = parts {
                self.tell_rivals(streams, taken, &rivals);
                chosen.push(taken);
                chosen.extend(parts);
            }
        }
        chosen.sort_unstable();
        self.tell_unused(streams, &held, &chosen);
        self.tell_absent(&chosen);
        chosen
    }

    /// Sources that hold a number, in the order of the map.
    fn held(&mut self, streams: &[Named], other: Option<&Others>) -> Vec<Chosen> {
        let mut held = Vec::new();
        for (index, source) in self.map.sources.iter().enumerate() {
            for (at, named) in streams.iter().enumerate() {
                let Some(column) = named.sources.iter().position(|(source, _)| *source == index) else {
                    continue;
                };
                let reason = match other.and_then(|other| other.why_not(&named.topic)) {
                    Some(reason) => reason,
                    None if named.stream.columns[column].iter().any(|value| !value.is_nan()) => {
                        held.push((index, at, column));
                        continue;
                    }
                    None => "it holds no number".into(),
                };
                self.ignored.push(Ignored { name: place(named, &source.place), reason });
            }
        }
        held
    }

    /// How long the drive is: the longest of what tells wheel speeds \[s\].
    fn drive_s(&self, streams: &[Named], held: &[Chosen]) -> f64 {
        let is_wheel = |(source, ..): &&Chosen| self.map.sources[*source].target.is_wheel_speed();
        held.iter().filter(is_wheel).map(|(_, at, _)| span_s(&streams[*at])).fold(0.0, f64::max)
    }

    /// The first that covers most of the drive; where none does the first. What covers less describes the minority of the drive.
    fn covering(&mut self, streams: &[Named], rivals: &[Chosen], drive_s: f64) -> Chosen {
        let first = rivals[0];
        if rivals.iter().all(|(_, at, _)| *at == first.1) {
            return first;
        }
        let covers = |one: &&Chosen| covered_s(streams, **one) > 0.5 * drive_s;
        let taken = rivals.iter().find(covers).copied().unwrap_or(first);
        if taken != first {
            let of = |one: Chosen| place(&streams[one.1], &self.map.sources[one.0].place);
            let what = format!(
                "it has numbers for {:.1} s of a drive of {drive_s:.1} s; `{}`, which has them for {:.1} s, was taken",
                covered_s(streams, first),
                of(taken),
                covered_s(streams, taken)
            );
            self.repairs.push(Repair { place: format!("topic {}", of(first)), what });
        }
        taken
    }

    /// Further topics of a source; `None` where one of them holds no number, so that the whole would lack a part.
    fn parts(&mut self, held: &[Chosen], leader: Chosen) -> Option<Vec<Chosen>> {
        let further = self.map.sources.iter().enumerate().skip(leader.0 + 1);
        let mut parts = Vec::new();
        for (index, source) in further.take_while(|(_, source)| source.is_further_part) {
            let Some(part) = held.iter().find(|(of, ..)| *of == index) else {
                let Place::Topic { topic, .. } = &source.place else { continue };
                let reason = "the map adds it to other topics, and the file has no numbers of it".into();
                self.ignored.push(Ignored { name: topic.clone(), reason });
                return None;
            };
            parts.push(*part);
        }
        Some(parts)
    }

    /// Says of a map of the user that two of its sources give what is measured once. Those of built-in maps are alternatives.
    fn tell_rivals(&mut self, streams: &[Named], taken: Chosen, rivals: &[Chosen]) {
        let Target::Channel(channel) = self.map.sources[taken.0].target else { return };
        let of = |one: &Chosen| place(&streams[one.1], &self.map.sources[one.0].place);
        let is_other = |rival: &&Chosen| **rival != taken && of(rival) != of(&taken);
        let Some(other) = rivals.iter().find(is_other) else { return };
        if self.map.is_built_in() {
            return;
        }
        let unit = si_unit(channel.quantity());
        let means = [&taken, other].map(|one| mean(&streams[one.1].stream.columns[one.2]));
        let means = format!(", {:.4} and {:.4} {unit} on average", means[0], means[1]);
        let both = [of(&taken), of(other)];
        let together = "`topics`, or as `fields` of one topic";
        self.repairs.extend(told_rivals(channel, &both, &means, together));
    }

    fn tell_unused(&mut self, streams: &[Named], held: &[Chosen], chosen: &[Chosen]) {
        for one in held.iter().filter(|one| !chosen.contains(one)) {
            let name = place(&streams[one.1], &self.map.sources[one.0].place);
            // Two sources of a map may name the same field of a topic.
            let is_taken = |other: &&Chosen| {
                let same_target = self.map.sources[other.0].target == self.map.sources[one.0].target;
                same_target && place(&streams[other.1], &self.map.sources[other.0].place) == name
            };
            if !chosen.iter().any(|other| is_taken(&other)) {
                let reason = "another source gives the same channel".into();
                self.ignored.push(Ignored { name, reason });
            }
        }
    }

    /// Says of a map of the user which topics the file lacks, where nothing else gives their channels.
    fn tell_absent(&mut self, chosen: &[Chosen]) {
        if self.map.is_built_in() || chosen.is_empty() {
            return;
        }
        for source in &self.map.sources {
            let Place::Topic { topic, .. } = &source.place else { continue };
            let is_there = self.names.iter().any(|name| Map::topic_matches(topic, name));
            let is_given = chosen.iter().any(|(other, ..)| self.map.sources[*other].target == source.target);
            let reason = "the map names it, but the file has no such topic";
            let ignored = Ignored { name: topic.clone(), reason: reason.into() };
            if !is_there && !is_given && !self.ignored.contains(&ignored) {
                self.ignored.push(ignored);
            }
        }
    }
}

/// What is said of two sources of one channel in a map of the user, of which the first is taken; nothing of what may well be told twice.
pub(crate) fn told_rivals(
    channel: Channel,
    [taken, other]: &[String; 2],
    means: &str,
    together: &str,
) -> Option<Repair> {
    let is_wheel = matches!(channel, Channel::LeftSpeed | Channel::RightSpeed);
    if !channel.tells_power() && !is_wheel {
        return None;
    }
    let add = if is_wheel || channel == Channel::Voltage {
        String::new()
    } else {
        format!(
            "if they are parts of one whole, name both in one source as {together}, with `\"combine\": \"sum\"`; "
        )
    };
    let what = format!(
        "both `{taken}` and `{other}` give it{means}, and `{taken}` alone was taken; {add}if they are one quantity, leave one out of the map"
    );
    Some(Repair { place: channel.to_string(), what })
}

/// A source as reports name it.
fn place(named: &Named, place: &Place) -> String {
    format!("{}, {}", named.topic, place.names().join(", "))
}

fn span_s(named: &Named) -> f64 {
    let t_s = named.stream.t_s(named.stream.t_ns.first().copied().unwrap_or(0));
    t_s.last().copied().unwrap_or(0.0)
}

/// Time between neighbouring numbers of a source, but for gaps \[s\].
fn covered_s(streams: &[Named], (_, at, column): Chosen) -> f64 {
    let stream = &streams[at].stream;
    let times = stream.t_s(stream.t_ns.first().copied().unwrap_or(0));
    let known = times.iter().zip(&stream.columns[column]).filter(|(_, value)| !value.is_nan());
    let t_s: Vec<f64> = known.map(|(t_s, _)| *t_s).collect();
    if median_step_s(&t_s).is_none() {
        return 0.0;
    }
    let gaps = Gaps::of(&t_s, None);
    (1..t_s.len()).filter(|at| !gaps.is_gap(&t_s, at - 1)).map(|at| t_s[at] - t_s[at - 1]).sum()
}

fn mean(values: &[f64]) -> f64 {
    let known = || values.iter().filter(|value| !value.is_nan());
    known().sum::<f64>() / known().count().max(1) as f64
}
