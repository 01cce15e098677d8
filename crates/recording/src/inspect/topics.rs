//! Topics of a log, as the best of the built-in maps reads them.

use std::path::Path;

use serde_json::{Value, json};

use super::{InspectedField, Inspection, unmapped::unmapped};
use crate::{
    Error, Map,
    map::Place,
    reading::{Reading, read_path},
    report::ReadingReport,
};

/// A built-in map that reads a log, and what it reads.
struct Candidate {
    name: &'static str,
    report: ReadingReport,
}

impl Candidate {
    /// Whether a topic is of a robot whose namespaces begin as those of the map.
    fn is_named(&self) -> bool {
        let namespace = Map::built_in_namespace(self.name);
        let is_of = |topic: &str, begin: &str| topic.trim_start_matches('/').starts_with(begin);
        namespace.is_some_and(|begin| self.report.streams.iter().any(|stream| is_of(&stream.topic, begin)))
    }

    /// Whether the map is made for robots of another name.
    fn is_anothers(&self) -> bool {
        Map::built_in_namespace(self.name).is_some() && !self.is_named()
    }

    /// Channels that it reads.
    fn channels(&self) -> usize {
        self.report.channels.len()
    }
}

/// Whether a reading fails since a map names too little of a log.
fn lacks_channels(error: &Error) -> bool {
    match error {
        Error::Empty { .. } | Error::Missing { .. } => true,
        Error::InFile { source, .. } => lacks_channels(source),
        _ => false,
    }
}

/// Names of the topics of a log, as one reading of it tells them; none where it tells none.
fn topic_names(read: &Result<Reading, Error>) -> Vec<String> {
    let first_word = |name: &String| name.split_whitespace().next().unwrap_or_default().to_owned();
    match read {
        Ok(Reading { report, .. }) => {
            let read = report.streams.iter().map(|stream| stream.topic.clone());
            read.chain(report.ignored.iter().map(|ignored| first_word(&ignored.name))).collect()
        }
        Err(error) => error.found().unwrap_or_default().iter().map(first_word).collect(),
    }
}

/// Whether a map names any of some topics.
fn names_any(map: &Map, topics: &[String]) -> bool {
    map.sources.iter().any(|source| match &source.place {
        Place::Topic { topic: pattern, .. } => topics.iter().any(|topic| Map::topic_matches(pattern, topic)),
        Place::Columns(_) => false,
    })
}

/// The built-in map that reads most of a log, and why it was taken; of several the one that is made for robots of this name, else the first.
/// The log is read once for each map that names one of its topics: what the first reading tells rules the others out.
fn best_map(path: &Path) -> Result<(Candidate, String), Error> {
    let mut first_error = None;
    let (mut read, mut topics) = (Vec::new(), Vec::new());
    for name in Map::BUILT_IN {
        let Some(map) = Map::built_in(name).filter(|map| !map.names_columns()) else { continue };
        if !topics.is_empty() && !names_any(&map, &topics) {
            continue;
        }
        let reading = read_path(path, Some(&map));
        if topics.is_empty() {
            topics = topic_names(&reading);
        }
        match reading {
            Ok(reading) => read.push(Candidate { name, report: reading.report }),
            Err(error) => first_error = first_error.or(Some(error)),
        }
    }
    let told: Vec<String> =
        read.iter().map(|one| format!("`{}` reads {} channels", one.name, one.channels())).collect();
    read.retain(|one| !one.is_anothers());
    // The last of equals is taken by `max_by_key`.
    let best = read.into_iter().rev().max_by_key(|one| (one.is_named(), one.channels()));
    match best {
        Some(best) => {
            let why = if best.is_named() { "its robots have such namespaces" } else { "it reads most" };
            let taken = format!(
                "the built-in map `{}` was taken, since {why}; of all, {}",
                best.name,
                told.join(", ")
            );
            Ok((best, taken))
        }
        None => Err(first_error.unwrap_or(Error::Empty { found: "no map".into() })),
    }
}

/// Topics as the best of the built-in maps reads them.
pub(super) fn topics(path: &Path) -> Result<Inspection, Error> {
    let (Candidate { name, report }, taken) = match best_map(path) {
        Ok(best) => best,
        Err(error) if lacks_channels(&error) => return unmapped(path, &error),
        Err(error) => return Err(error),
    };
    let ReadingReport { source, streams, channels, ignored, repairs, .. } = report;
    let mut fields = Vec::new();
    for stream in &streams {
        let own: Vec<_> = channels
            .iter()
            .filter(|channel| channel.from.starts_with(&format!("{} ", stream.topic)))
            .collect();
        let told: Vec<String> =
            own.iter().map(|channel| format!("{} [{}]", channel.channel, channel.unit)).collect();
        fields.push(InspectedField {
            name: stream.topic.clone(),
            samples: stream.messages,
            rate_hz: stream.rate_hz,
            range: None,
            channel: (!told.is_empty()).then(|| told.join(", ")),
            unit: None,
            reason: stream.type_name.clone(),
        });
    }
    let wheels =
        "wheel_radius_m and wheel_separation_m in the map are those of its robot: put those of yours";
    let mut notes = vec![taken, wheels.to_owned()];
    notes.extend(ignored.iter().map(|ignored| format!("not read: {} ({})", ignored.name, ignored.reason)));
    notes.extend(repairs.iter().map(|repair| format!("{}: {}", repair.place, repair.what)));
    let is_used = |source: &Value, topic: &str, channel: &str| {
        let pattern = source["topic"].as_str().unwrap_or_default();
        source["channel"] == json!(channel) && Map::topic_matches(pattern, topic)
    };
    let mut map = Map::built_in_document(name).unwrap_or_default();
    let all = map["sources"].as_array().cloned().unwrap_or_default();
    let mut kept = Vec::new();
    for channel in &channels {
        let Some((topic, of)) = channel.from.split_once(' ') else { continue };
        let has_fields = |source: &&Value| {
            let fields: Vec<&str> =
                source["fields"].as_array().into_iter().flatten().filter_map(Value::as_str).collect();
            fields.join(", ") == of
        };
        let found =
            all.iter().filter(|source| is_used(source, topic, channel.channel.name())).find(has_fields);
        if let Some(mut source) = found.cloned() {
            source["topic"] = json!(topic);
            kept.push(source);
        }
    }
    map["name"] = json!("inspected");
    map["sources"] = json!(kept);
    Ok(Inspection { source, fields, map, notes })
}
