//! From the streams of topics to one table: which source is taken, whose stamps become the rows.

use std::collections::BTreeMap;

use crate::{
    Channel, Error, Ignored, Labels, Recording, Repair, Run, Sign,
    align::{Between, interpolate_within},
    clock_offset, drawn, gap,
    map::Target,
    meter, namespace, opposed_part, own_clocks, packs, publishers,
    rate::rates,
    reading::{Part, Reading},
    report::{AlignmentReport, ChannelReport, ReadingReport, StreamReport},
    rows::check_steps,
    sim_clock,
    stream::{Samples, Stream},
    stuck_part,
    topic::{Topic, Topics},
};

impl Topics<'_> {
    /// Brings what was read onto one clock.
    pub(crate) fn finish(mut self, name: &str, format: &'static str) -> Result<Reading, Error> {
        let mut report = ReadingReport::default();
        let mut streams = Vec::new();
        let (clocks, mut topics): (Vec<Topic>, Vec<Topic>) =
            std::mem::take(&mut self.topics).into_iter().partition(|topic| topic.sources.is_empty());
        self.repairs.extend(sim_clock::settle(clocks.first(), &mut topics));
        for topic in topics {
            self.looks().go_on()?;
            if let Some(reason) = &topic.first_bad {
                self.refuse_or_tell(&topic, reason)?;
            }
            if topic.samples.log_ns.is_empty() {
                self.ignored.push(Ignored { name: topic.name, reason: "it has no message".into() });
                continue;
            }
            let told = topic.told().map(|what| Repair { place: format!("topic {}", topic.name), what });
            self.repairs.extend(told);
            let messages = topic.samples.messages();
            let mut stream = self.stream(&topic.name, topic.samples, (&topic.sources, &topic.widths))?;
            self.combine(&topic.name, (&topic.sources, &topic.widths), &mut stream)?;
            let is_wheel = |(source, _): &(usize, usize)| self.map.sources[*source].target.is_wheel_speed();
            let wheels: Vec<bool> = topic.sources.iter().map(is_wheel).collect();
            self.repairs.extend(publishers::leave_zeros_out(&topic.name, &mut stream, &wheels));
            let step_s = gap::median_step_s(&stream.t_s(stream.t_ns.first().copied().unwrap_or(0)));
            let rate_hz = step_s.map(|step_s| 1.0 / step_s);
            let step_s = step_s.unwrap_or(f64::INFINITY);
            let (topic_name, clock, type_name) = (topic.name.clone(), stream.clock, topic.type_name);
            report.streams.push(StreamReport { topic: topic_name, type_name, messages, rate_hz, clock });
            streams.push(Named { topic: topic.name, sources: topic.sources, stream, step_s });
        }
        let other = namespace::others(self.map, &streams, &self.names)?;
        let chosen = self.choose(&streams, other.as_ref());
        if chosen.is_empty() {
            let map = &self.map.name;
            let found = match (self.names.as_slice(), self.unread().as_slice()) {
                ([], _) => "the file names no topic".to_owned(),
                (names, []) => {
                    format!("the file has {}, but map `{map}` reads none of them", names.join(", "))
                }
                (_, unread) => {
                    let lost = self.repairs.iter().map(|repair| format!("{}: {}", repair.place, repair.what));
                    let why: Vec<String> = unread.iter().cloned().chain(lost).collect();
                    format!("map `{map}` names topics of the file, but none can be read: {}", why.join("; "))
                }
            };
            return Err(Error::Empty { found });
        }
        let used: Vec<usize> = chosen.iter().map(|(_, stream, _)| *stream).collect();
        clock_offset::reconcile(&mut streams, &used, &mut self.repairs);
        let mut base = self.base(&streams, &chosen)?;
        let slow = self.slow_meter(&streams, &chosen, base);
        let meter = slow.map(|wheels| std::mem::replace(&mut base, wheels));
        if streams[base].stream.t_ns.len() < 2 {
            return Err(Error::OneMessage { topic: streams[base].topic.clone() });
        }
        check_steps(&streams[base])?;
        let recording = self.align(&streams, &chosen, (base, meter), name, &mut report)?;
        let looks = self.looks().clone();
        let unread = self.unread();
        report.ignored = self.ignored;
        report.repairs = self.repairs;
        let part = Part { recording, report, found: self.names, format };
        Reading::finish(part, name, Some(self.map), &looks).map_err(|error| error.with_unread(unread))
    }

    /// The samples of a topic in the order of their clock, those of several packs together.
    fn stream(
        &mut self,
        topic: &str,
        samples: Samples,
        (sources, widths): (&[(usize, usize)], &[usize]),
    ) -> Result<Stream, Error> {
        let packs = packs::apart(samples);
        let of_pack = |pack: Samples| pack.into_stream(topic, self.map.stamp, &mut self.repairs);
        let streams = packs.into_iter().map(of_pack).collect::<Result<Vec<_>, _>>()?;
        let of_source = |((index, _), width): (&(usize, usize), &usize)| {
            std::iter::repeat_n(&self.map.sources[*index].target, *width)
        };
        let targets: Vec<&Target> = sources.iter().zip(widths).flat_map(of_source).collect();
        let (stream, told) = packs::together(topic, &targets, streams, self.map);
        self.repairs.extend(told);
        Ok(stream)
    }

    /// Makes one column of those that a source has, rates of positions among them.
    fn combine(
        &mut self,
        topic: &str,
        (sources, widths): (&[(usize, usize)], &[usize]),
        stream: &mut Stream,
    ) -> Result<(), Error> {
        let t_s = stream.t_s(stream.t_ns.first().copied().unwrap_or(0));
        let mut columns = std::mem::take(&mut stream.columns).into_iter();
        for ((index, _), width) in sources.iter().zip(widths) {
            let source = &self.map.sources[*index];
            let mut parts: Vec<Vec<f64>> = columns.by_ref().take(*width).collect();
            let lone = stuck_part::lone_of_columns(&parts);
            if source.derivative {
                for part in &mut parts {
                    source.check_wraps(*index, part)?;
                    *part = rates(&t_s, part, source.wraps_at);
                }
            }
            let names =
                source.place.names().iter().map(|field| format!("{topic} {field}")).collect::<Vec<_>>();
            opposed_part::refuse(&parts, &names)?;
            let mut column = match parts.as_slice() {
                [_] => parts.swap_remove(0),
                _ => source.combine.of_rows(&parts),
            };
            let speed_mps = column.clone();
            self.repairs.extend(stuck_part::leave_out(&t_s, &lone, &speed_mps, &names, &mut column));
            stream.columns.push(column);
        }
        Ok(())
    }

    fn refuse_or_tell(&mut self, topic: &Topic, reason: &str) -> Result<(), Error> {
        if topic.samples.log_ns.is_empty() {
            return Err(Error::Undecodable {
                topic: topic.name.clone(),
                type_name: topic.type_name.clone(),
                messages: topic.bad,
                reason: reason.to_owned(),
            });
        }
        let what = format!(
            "{} messages are not what their definition says ({reason}); they were left out",
            topic.bad
        );
        self.repairs.push(Repair { place: format!("topic {}", topic.name), what });
        Ok(())
    }

    /// Brings all streams onto the stamps of a base; power of a meter that is slower is held over its periods.
    fn align(
        &mut self,
        streams: &[Named],
        chosen: &[(usize, usize, usize)],
        (base, meter): (usize, Option<usize>),
        name: &str,
        report: &mut ReadingReport,
    ) -> Result<Recording, Error> {
        let rows = self.rows(streams, chosen, base);
        self.repairs.extend(rows.told(&streams[base].topic, streams[base].stream.t_ns.len()));
        let (origin_ns, t_s) = rows.t_s();
        let mut recording = Recording::default();
        let mut max_gaps = BTreeMap::new();
        for &(source, at, column) in chosen {
            self.looks().go_on()?;
            let (source, named) = (&self.map.sources[source], &streams[at]);
            let values = &named.stream.columns[column];
            let is_held = meter.is_some()
                && matches!(&source.target, Target::Channel(c) if c.tells_power() && *c != Channel::Voltage)
                && meter::is_slow(named.step_s, streams[base].step_s, self.map.max_gap_s);
            let values = if at == base {
                rows.of_base(values)
            } else if is_held {
                let own_s = named.stream.t_s(origin_ns);
                let known = own_s.iter().zip(values).filter(|(_, value)| !value.is_nan());
                let readings: Vec<(f64, f64)> = known.map(|(t_s, value)| (*t_s, *value)).collect();
                let held = meter::held(&readings, &t_s);
                if Some(at) == meter && recording.reading_ends.is_empty() {
                    let step_s = named.step_s;
                    let what = own_clocks::meter_words(&named.topic, step_s);
                    self.repairs.push(Repair { place: format!("topic {}", named.topic), what });
                    recording.reading_ends = held.ends;
                }
                held.values
            } else {
                let own_s = named.stream.t_s(origin_ns);
                // Messages without a number of this source, as of an arm on the same topic, are no part of its rhythm.
                let max_gap_s =
                    self.map.max_gap_s.unwrap_or_else(|| gap::threshold_s(&with_numbers(&own_s, values)));
                max_gaps.insert(named.topic.clone(), max_gap_s);
                let between = if source.target == Target::Channel(Channel::Heading) {
                    Between::ShorterArc
                } else {
                    Between::Line
                };
                interpolate_within(&own_s, values, &t_s, self.map.max_gap_s, between)
            };
            if values.iter().all(|value| value.is_nan()) {
                let reason = format!("its stamps do not meet those of {}", streams[base].topic);
                self.ignored.push(Ignored { name: named.topic.clone(), reason });
                continue;
            }
            if source.combine.is_of_twist() {
                let what = format!(
                    "rim speeds are v ∓ ω b/2 of odometry, with b = {} m; give the controller's `wheel_separation_m` in a map if it has another",
                    source.separation_m
                );
                self.repairs.push(Repair { place: named.topic.clone(), what });
            }
            match &source.target {
                Target::Channel(channel) => {
                    let from = format!("{} {}", named.topic, source.place.names().join(", "));
                    let leader = recording.channels.get_mut(channel).filter(|_| source.is_further_part);
                    let known = report.channels.iter_mut().find(|known| known.channel == *channel);
                    if let (Some(sum), Some(known)) = (leader, known) {
                        sum.iter_mut().zip(values).for_each(|(sum, value)| *sum += value);
                        known.from = format!("{}, {from}", known.from);
                    } else {
                        report.channels.push(ChannelReport::new(*channel, from, source.unit.clone()));
                        recording.channels.insert(*channel, values);
                    }
                }
                Target::Aside(name) => {
                    recording.aside.insert(name.clone(), values);
                }
                Target::Time | Target::Run | Target::Surface => {}
            }
        }
        for &(source, at, _) in chosen {
            if self.map.sources[source].sign == Sign::Drawn {
                let place = format!("topic {}", streams[at].topic);
                self.repairs.extend(drawn::settle(&mut recording, &place));
            }
        }
        let start_unix_s = (origin_ns > 0).then_some(origin_ns as f64 / 1e9);
        recording.runs = vec![Run::new(name.to_owned(), 0..t_s.len(), &t_s, start_unix_s)];
        recording.surface = self.map.surface.as_ref().map(|surface| Labels::constant(surface, t_s.len()));
        recording.t_s = t_s;
        report.alignment = Some(alignment(&streams[base].topic, max_gaps));
        Ok(recording)
    }
}

/// Times at which there is a number.
fn with_numbers(t_s: &[f64], values: &[f64]) -> Vec<f64> {
    t_s.iter().zip(values).filter(|(_, value)| !value.is_nan()).map(|(t, _)| *t).collect()
}

/// A topic's stream, and the sources of the map that its columns are.
pub(crate) struct Named {
    pub(crate) topic: String,
    pub(crate) sources: Vec<(usize, usize)>,
    pub(crate) stream: Stream,
    /// Its median step \[s\]; infinite for a single message.
    pub(crate) step_s: f64,
}

#[cfg(test)]
impl Named {
    pub(crate) fn new(topic: String, stream: Stream) -> Named {
        Named { topic, sources: Vec::new(), stream, step_s: 0.1 }
    }
}

fn alignment(base: &str, max_gaps: BTreeMap<String, f64>) -> AlignmentReport {
    let max_gap_s: Vec<(String, f64)> = max_gaps.into_iter().collect();
    let gaps: Vec<String> =
        max_gap_s.iter().map(|(topic, gap_s)| format!("{gap_s:.3} s of {topic}")).collect();
    let others = match gaps.as_slice() {
        [] => "no other topic is used".to_owned(),
        _ => format!(
            "others interpolated linearly, headings on the shorter arc, between neighbours at most {} apart; nothing \
             beyond either end",
            gaps.join(", ")
        ),
    };
    AlignmentReport {
        base: base.to_owned(),
        method: format!("rows are the stamps of {base}; {others}"),
        max_gap_s,
    }
}
