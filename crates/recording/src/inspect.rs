//! What a log holds, and which map would read it: columns or topics with rate and range, and guesses with their reasons.

mod choice;
mod guess;
mod time_column;

use std::{fs::File, path::Path};

use serde::Serialize;
use serde_json::{Value, json};

use self::{
    choice::sources,
    guess::{Guess, guess},
    time_column::{TimeColumn, time_column},
};
use crate::{
    Channel, Conversion, Error, Map, Quantity, Recording,
    beginning::beginning,
    format::Format,
    map::Place,
    reading::{Reading, read_path, unwatched},
    report::ReadingReport,
};

pub(crate) use self::guess::Side;

/// What a log holds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspection {
    /// The file.
    pub source: String,
    /// Its columns or topics.
    pub fields: Vec<InspectedField>,
    /// A map that reads it as far as it was understood.
    pub map: Value,
    /// What is still missing or unclear.
    pub notes: Vec<String>,
}

/// One column of a table, or a topic with the fields that are read of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct InspectedField {
    /// Its name.
    pub name: String,
    /// How many numbers or messages it has.
    pub samples: usize,
    /// Numbers a second \[Hz\].
    pub rate_hz: Option<f64>,
    /// Least and greatest number; `null` for topics.
    pub range: Option<[f64; 2]>,
    /// The channel that it would be; `null` where nothing tells.
    pub channel: Option<String>,
    /// The unit that it would be in.
    pub unit: Option<String>,
    /// Why.
    pub reason: String,
}

/// Looks into a log.
///
/// # Errors
/// A file that cannot be read at all, with what is wrong.
pub fn inspect(path: &Path) -> Result<Inspection, Error> {
    let is_table = path.is_file() && matches!(Format::of(path), Ok(Format::Csv | Format::Parquet));
    if is_table { table(path) } else { topics(path) }
}

/// Names of the columns of a table.
fn names(path: &Path) -> Result<Vec<String>, Error> {
    match read_path(path, None) {
        Ok(reading) => {
            let of_channels = reading.report.channels.iter().map(|channel| channel.from.clone());
            let ignored = reading.report.ignored.iter().map(|ignored| ignored.name.clone());
            Ok(["t_s".to_owned()]
                .into_iter()
                .chain(of_channels)
                .chain(reading.report.aside.clone())
                .chain(ignored)
                .collect())
        }
        Err(error) => match error.found() {
            Some(found) => Ok(found.to_vec()),
            None => match beginning(File::open(path)?, Format::of(path)?, &unwatched()) {
                Ok(columns) => Ok(columns.into_iter().map(|column| column.name).collect()),
                Err(_) => Err(error),
            },
        },
    }
}

fn table(path: &Path) -> Result<Inspection, Error> {
    let names = names(path)?;
    let mut notes = Vec::new();
    let Some(time) = time_column(path, &names)? else {
        notes.push(format!(
            "none of the columns {} is named as a time: name the one that is `t_s`",
            names.join(", ")
        ));
        return Ok(Inspection {
            source: path.display().to_string(),
            fields: Vec::new(),
            map: Value::Null,
            notes,
        });
    };
    let TimeColumn { name: time, unit: time_unit, source: of_time, reason, recording } = time;
    let mut fields = Vec::new();
    let columns = recording.channels.iter().map(|(channel, values)| (channel.name().to_owned(), values));
    for (name, values) in columns.chain(recording.aside.iter().map(|(name, values)| (name.clone(), values))) {
        fields.push(field(&recording, name, values));
    }
    let chosen = sources(&mut fields);
    notes.extend(
        fields
            .iter()
            .filter(|field| field.reason.starts_with("left out"))
            .map(|field| format!("column `{}` is {}", field.name, field.reason)),
    );
    let sources: Vec<Value> = std::iter::once(of_time).chain(chosen).collect();
    fields.insert(
        0,
        InspectedField {
            name: time,
            samples: recording.rows(),
            rate_hz: rate_hz(&recording, |_| true),
            range: range(&recording.t_s),
            channel: Some("t_s".into()),
            unit: Some(time_unit.into()),
            reason,
        },
    );
    for channel in [Channel::LeftSpeed, Channel::RightSpeed] {
        if !fields.iter().any(|field| field.channel.as_deref() == Some(channel.name())) {
            notes.push(format!("no column was recognised as `{}`: name it in the map", channel.name()));
        }
    }
    let mut map = json!({"name": "inspected", "sources": sources});
    if fields.iter().any(|field| {
        matches!(field.unit.as_deref(), Some("rpm" | "rad/s"))
            && field.name.to_lowercase() != "yaw_rate_radps"
    }) {
        map["wheel_radius_m"] = json!(0.165);
        notes.push("wheel_radius_m in the map is a Husky's: put that of your robot".into());
    }
    notes.push("units are guesses by names and ranges: look at them before you trust an energy".into());
    Ok(Inspection { source: path.display().to_string(), fields, map, notes })
}

fn field(recording: &Recording, name: String, values: &[f64]) -> InspectedField {
    let range = range(values);
    let greatest = range.map_or(0.0, |[low, high]| high.abs().max(low.abs()));
    let is_contracts = Channel::from_name(&name).is_some();
    let found =
        guess(&name, greatest).and_then(|found| if is_contracts { Ok(found) } else { agree(found, values) });
    InspectedField {
        samples: values.iter().filter(|value| !value.is_nan()).count(),
        rate_hz: rate_hz(recording, |row| !values[row].is_nan()),
        range,
        channel: found.as_ref().ok().map(|found| found.channel.name().to_owned()),
        unit: found.as_ref().ok().map(|found| found.unit.to_owned()),
        reason: found.map_or_else(|reason| reason, |found| found.reason),
        name,
    }
}

/// The guess if its numbers may be those of its channel in its unit, or why they are not.
fn agree(guess: Guess, values: &[f64]) -> Result<Guess, String> {
    let mut sorted: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
    if is_counted_up(&sorted)
        && matches!(guess.channel.quantity(), Quantity::Speed | Quantity::Power | Quantity::Current)
    {
        return Err(format!(
            "left out: it never falls, as an energy or a count of ticks, and {} does",
            guess.channel
        ));
    }
    // Wheels of any radius a robot has turn as their angular rates say.
    let Some(unit) = Conversion::from_unit(guess.channel.quantity(), guess.unit, None) else {
        return Ok(guess);
    };
    sorted.iter_mut().for_each(|value| *value = unit.apply(*value).abs());
    sorted.sort_unstable_by(f64::total_cmp);
    let Some(&high) = sorted.get(sorted.len().saturating_sub(1) * 99 / 100) else { return Ok(guess) };
    let [least, most] = guess.channel.plausible_magnitude();
    if high > most || (high > 0.0 && high < least) {
        let Guess { channel, unit, .. } = guess;
        return Err(format!(
            "left out: as {channel} in {unit} its numbers reach {high:.4}, and a robot's lie between {least} and {most}; name its unit in the map"
        ));
    }
    Ok(guess)
}

/// Whether numbers rise all the way, as those of counters do.
fn is_counted_up(values: &[f64]) -> bool {
    /// More rises in a row than any drive begins with.
    const RISES: usize = 100;
    let rises = values.windows(2).filter(|pair| pair[1] > pair[0]).count();
    rises >= RISES && values.windows(2).all(|pair| pair[1] >= pair[0])
}

fn range(values: &[f64]) -> Option<[f64; 2]> {
    let known = values.iter().filter(|value| !value.is_nan());
    let [low, high] =
        known.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], value| [value.min(l), value.max(h)]);
    (low <= high).then_some([low, high])
}

/// Numbers a second.
fn rate_hz(recording: &Recording, is_there: impl Fn(usize) -> bool) -> Option<f64> {
    let run = recording.runs.first()?;
    let rows: Vec<usize> = run.rows.clone().filter(|row| is_there(*row)).collect();
    let span_s = recording.t_s[*rows.last()?] - recording.t_s[*rows.first()?];
    (span_s > 0.0).then(|| (rows.len() - 1) as f64 / span_s)
}

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
fn topics(path: &Path) -> Result<Inspection, Error> {
    let (Candidate { name, report }, taken) = best_map(path)?;
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
