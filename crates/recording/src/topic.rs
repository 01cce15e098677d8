//! The messages of a container: the topics that the map names, read by their definitions.

use std::collections::BTreeMap;

use crate::{
    Error, Ignored, Map, Repair, Source, Stamp,
    beginning::Looked,
    compression::decompress_message,
    format::ZSTD_MAGIC,
    layout::Layout,
    map::Place,
    packs,
    schema::Schema,
    sim_clock,
    stream::Samples,
    walk::Found,
    watch::{Budget, Looks},
};

/// Why most topics are not used.
const NOT_NAMED: &str = "the map does not name it";

/// The topics of a file while it is read.
pub(crate) struct Topics<'m> {
    pub(crate) map: &'m Map,
    /// By the container's number of a connection or channel, which topic it feeds.
    connections: BTreeMap<u32, Option<usize>>,
    pub(crate) topics: Vec<Topic>,
    pub(crate) names: Vec<String>,
    pub(crate) ignored: Vec<Ignored>,
    pub(crate) repairs: Vec<Repair>,
    /// The file of several that is being read.
    file: Option<String>,
    found: Found,
    /// A message that came compressed.
    plain: Vec<u8>,
    budget: Budget,
    /// Numbers held by all topics.
    numbers: usize,
    /// What was seen of all topics, where the file is only looked into.
    pub(crate) looked: Option<Looked>,
}

pub(crate) struct Topic {
    pub(crate) name: String,
    pub(crate) type_name: String,
    layout: Layout,
    /// Sources of the map that it feeds, and how many values of a message each takes.
    pub(crate) sources: Vec<(usize, usize)>,
    /// How many columns of the samples each has: one, or those of its parts.
    pub(crate) widths: Vec<usize>,
    values: Vec<f64>,
    pub(crate) samples: Samples,
    pub(crate) bad: usize,
    pub(crate) first_bad: Option<String>,
}

impl<'m> Topics<'m> {
    pub(crate) fn new(map: &'m Map, budget: Budget) -> Self {
        Topics {
            map,
            connections: BTreeMap::new(),
            topics: Vec::new(),
            names: Vec::new(),
            ignored: Vec::new(),
            repairs: Vec::new(),
            file: None,
            found: Found::default(),
            plain: Vec::new(),
            budget,
            numbers: 0,
            looked: None,
        }
    }

    /// The watch of the reading.
    pub(crate) fn looks(&mut self) -> &mut Looks {
        &mut self.budget.looks
    }

    /// Takes note of what is wrong at a byte of the file.
    pub(crate) fn tell(&mut self, at: u64, what: &str) {
        self.tell_of(&format!("byte {at}"), what);
    }

    /// Takes note of what is wrong somewhere in the file.
    pub(crate) fn tell_of(&mut self, place: &str, what: &str) {
        let file = self.file.as_ref().map_or(String::new(), |file| format!("{file}, "));
        self.repairs.push(Repair { place: format!("{file}{place}"), what: what.into() });
    }

    /// Begins another file of the same recording: its topics go on, its numbers of connections mean something else.
    pub(crate) fn next_file(&mut self) {
        self.connections.clear();
    }

    /// Begins another file that has a name of its own.
    pub(crate) fn begin_file(&mut self, file: Option<String>) {
        self.next_file();
        self.file = file;
    }

    /// Whether the map wants the messages of a connection.
    pub(crate) fn wants(&self, id: u32) -> bool {
        matches!(self.connections.get(&id), Some(Some(_)))
    }

    /// Topics that the map names and why they are not read.
    pub(crate) fn unread(&self) -> Vec<String> {
        let named = self.ignored.iter().filter(|ignored| ignored.reason != NOT_NAMED);
        named.map(|ignored| format!("{} ({})", ignored.name, ignored.reason)).collect()
    }

    /// Takes note of what is not used; the files of one recording say it only once.
    fn ignore(&mut self, name: String, reason: &str) {
        let ignored = Ignored { name, reason: reason.into() };
        if !self.ignored.contains(&ignored) {
            self.ignored.push(ignored);
        }
    }

    /// Takes note of a connection; containers repeat them.
    pub(crate) fn connect(&mut self, id: u32, topic: &str, schema: &Schema<'_>) -> Result<(), Error> {
        if self.connections.contains_key(&id) {
            return Ok(());
        }
        if !self.names.iter().any(|name| name == topic) {
            self.names.push(topic.to_owned());
        }
        if let Some(looked) = &mut self.looked {
            self.connections.insert(id, looked.open(topic, schema));
            return Ok(());
        }
        let same = |known: &Topic| known.name == topic && known.type_name == schema.type_name;
        let known = self.topics.iter().position(same);
        let index = if known.is_some() { known } else { self.open(topic, schema)? };
        self.connections.insert(id, index);
        Ok(())
    }

    /// Plans the reading of a topic; `None` when the map does not want it.
    fn open(&mut self, topic: &str, schema: &Schema<'_>) -> Result<Option<usize>, Error> {
        let mut wanted: Vec<(usize, &[String])> = Vec::new();
        for (index, source) in self.map.sources.iter().enumerate() {
            if let Place::Topic { topic: pattern, fields } = &source.place
                && Map::topic_matches(pattern, topic)
            {
                wanted.push((index, fields));
            }
        }
        if topic == sim_clock::TOPIC && self.map.stamp == Stamp::Header {
            return Ok(self.open_clock(topic, schema));
        }
        if wanted.is_empty() {
            self.ignore(topic.into(), NOT_NAMED);
            return Ok(None);
        }
        let definition = match schema.parse() {
            Ok(definition) => definition,
            Err(reason) => {
                self.refuse_outright(topic, &wanted, "", &reason)?;
                self.ignore(topic.into(), &reason);
                return Ok(None);
            }
        };
        // Each source alone first, so that one that does not fit leaves the others be.
        let mut fitting = Vec::new();
        for (index, fields) in wanted {
            let paths: Vec<&str> = fields.iter().map(String::as_str).collect();
            match Layout::new(&definition, &paths, false, schema.encoding) {
                Ok(_) => fitting.push((index, paths)),
                Err((field, reason)) => {
                    let source = [(index, fields)];
                    self.refuse_outright(topic, &source, &field, &reason)?;
                    self.ignore(format!("{topic}, {}", named(&field, fields)), &reason);
                }
            }
        }
        let paths: Vec<&str> = fitting.iter().flat_map(|(_, paths)| paths.iter().copied()).collect();
        if paths.is_empty() {
            return Ok(None);
        }
        let is_of_packs = |(index, _): &(usize, Vec<&str>)| {
            self.map.sources.get(*index).is_some_and(|s| packs::is_of_packs(&s.target))
        };
        let has_packs = fitting.iter().any(is_of_packs);
        let layout = Layout::new(&definition, &paths, has_packs, schema.encoding);
        let layout = layout.map_err(|(field, reason)| Error::Field { topic: topic.into(), field, reason })?;
        if layout.is_standard {
            let what = format!(
                "the file holds no definition of {}; that of the standard package was taken",
                definition.name()
            );
            self.repairs.push(Repair { place: format!("topic {topic}"), what });
        }
        self.topics.push(Topic {
            name: topic.to_owned(),
            type_name: schema.type_name.to_owned(),
            layout,
            sources: fitting.iter().map(|(index, paths)| (*index, paths.len())).collect(),
            widths: fitting.iter().map(|(index, paths)| self.width(*index, paths.len())).collect(),
            values: vec![f64::NAN; paths.len() + usize::from(has_packs)],
            samples: {
                let columns = fitting.iter().flat_map(|(index, paths)| {
                    let width = self.width(*index, paths.len());
                    self.map.sources.get(*index).into_iter().cycle().take(width)
                });
                Samples::new(columns, has_packs)
            },
            bad: 0,
            first_bad: None,
        });
        Ok(Some(self.topics.len() - 1))
    }

    /// Plans the reading of a simulation's time; `None` of what is none.
    fn open_clock(&mut self, topic: &str, schema: &Schema<'_>) -> Option<usize> {
        let definition = schema.parse().ok()?;
        let layout = Layout::new(&definition, &[], false, schema.encoding).ok().filter(Layout::has_stamp)?;
        self.topics.push(Topic {
            name: topic.to_owned(),
            type_name: schema.type_name.to_owned(),
            layout,
            sources: Vec::new(),
            widths: Vec::new(),
            values: Vec::new(),
            samples: Samples::new(std::iter::empty(), false),
            bad: 0,
            first_bad: None,
        });
        Some(self.topics.len() - 1)
    }

    /// Columns that a source has until all messages are read: encoders of a side are looked at one by one.
    fn width(&self, index: usize, fields: usize) -> usize {
        if self.map.sources.get(index).is_some_and(Source::is_mean_of_wheels) { fields } else { 1 }
    }

    /// A topic named outright must be readable; one found through `*` may be something else of the same name.
    fn refuse_outright(
        &self,
        topic: &str,
        sources: &[(usize, &[String])],
        field: &str,
        reason: &str,
    ) -> Result<(), Error> {
        for (index, fields) in sources {
            let source = self.map.sources.get(*index);
            let alternatives =
                self.map.sources.iter().filter(|s| source.is_some_and(|t| t.target == s.target)).count();
            let outright = matches!(source.map(|s| &s.place), Some(Place::Topic { topic, .. }) if !topic.starts_with('*'));
            if outright && alternatives == 1 {
                let field = named(field, fields);
                return Err(Error::Field { topic: topic.into(), field, reason: reason.into() });
            }
        }
        Ok(())
    }

    /// Reads a message, if its topic is wanted.
    pub(crate) fn message(&mut self, id: u32, log_ns: i64, bytes: &[u8]) -> Result<(), Error> {
        let Some(Some(index)) = self.connections.get(&id) else { return Ok(()) };
        if let Some(looked) = &mut self.looked {
            looked.message(*index, log_ns, bytes, &mut self.found);
            return Ok(());
        }
        let Some(topic) = self.topics.get_mut(*index) else { return Ok(()) };
        let read = match topic.layout.is_cdr() && bytes.starts_with(&ZSTD_MAGIC) {
            true => decompress_message(bytes, &mut self.plain),
            false => Ok(bytes),
        };
        let read = read.and_then(|bytes| topic.layout.read(bytes, &mut self.found, &mut topic.values));
        let stamp_ns = match read {
            Ok(stamp_ns) => stamp_ns,
            Err(reason) => {
                topic.bad += 1;
                let message = topic.samples.messages() + topic.bad;
                topic.first_bad.get_or_insert_with(|| format!("message {message}: {reason}"));
                return Ok(());
            }
        };
        topic.samples.log_ns.push(log_ns);
        if let Some(stamp_ns) = stamp_ns {
            topic.samples.stamp_ns.push(stamp_ns);
        }
        let (mut values, mut columns) = (topic.values.iter(), topic.samples.columns.iter_mut());
        for ((source, count), width) in topic.sources.iter().zip(&topic.widths) {
            let Some(source) = self.map.sources.get(*source) else { continue };
            if *width > 1 {
                let parts = values.by_ref().take(*count);
                columns
                    .by_ref()
                    .zip(parts)
                    .for_each(|(column, part)| column.push(source.conversion.apply(*part)));
            } else if let Some(column) = columns.next() {
                let value = source.combine.of(values.by_ref().take(*count).copied(), source.separation_m);
                column.push(source.conversion.apply(value));
            }
        }
        // Which pack it is of.
        columns.zip(values).for_each(|(column, value)| column.push(*value));
        self.numbers += topic.samples.width();
        if self.numbers < self.budget.room.numbers() { Ok(()) } else { self.make_room() }
    }

    /// Makes one of neighbouring messages, of the topic with the most first, until half of the room is free.
    fn make_room(&mut self) -> Result<(), Error> {
        let numbers =
            |topics: &[Topic]| -> usize { topics.iter().map(|topic| topic.samples.numbers()).sum() };
        while numbers(&self.topics) > self.budget.room.numbers() / 2 {
            let Some(topic) = self.topics.iter_mut().max_by_key(|topic| topic.samples.log_ns.len()) else {
                break;
            };
            let most = topic.samples.log_ns.len();
            self.budget.looks.go_on()?;
            if !topic.samples.halve() {
                return Err(Error::TooLarge { most });
            }
        }
        self.numbers = numbers(&self.topics);
        Ok(())
    }
}

impl Topic {
    /// What has to be said of what its messages hold.
    pub(crate) fn told(&self) -> Option<String> {
        self.layout.told()
    }
}

/// The field at fault, or all of a source.
fn named(field: &str, fields: &[String]) -> String {
    if field.is_empty() { fields.join(", ") } else { field.to_owned() }
}
