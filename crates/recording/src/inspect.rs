//! What a log holds, and which map would read it: columns or topics with rate and range, and guesses with their reasons.

mod choice;
mod guess;
mod name;
mod numbers;
mod sides;
mod spelled_unit;
mod time_column;
mod topics;
mod unmapped;
mod vocabulary;

use std::{fs::File, path::Path};

use serde::Serialize;
use serde_json::{Value, json};

use self::{
    choice::{Chosen, sources},
    guess::guess,
    numbers::{Seen, agree},
    time_column::{TimeColumn, time_column},
    topics::topics,
};
use crate::{
    Channel, Error, Recording,
    beginning::beginning,
    format::Format,
    reading::{read_path, unwatched},
};

pub(crate) use self::name::Side;

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
    let Chosen { mut sources, notes: told } = sources(&mut fields);
    sides::leave_out(&recording, &mut sources, &mut fields);
    notes.extend(told);
    notes.extend(sides::draw_negative_current(&recording, &mut sources));
    notes.extend(left_out(&fields));
    sources.insert(0, of_time);
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
    let map = guessed_map(&fields, &sources, &mut notes);
    Ok(Inspection { source: path.display().to_string(), fields, map, notes })
}

/// What is said of columns or fields that are left out.
fn left_out(fields: &[InspectedField]) -> Vec<String> {
    let left = fields.iter().filter(|field| field.reason.starts_with("left out"));
    left.map(|field| format!("column `{}` is {}", field.name, field.reason)).collect()
}

/// A map of guessed sources, and what is to be looked at in it.
fn guessed_map(fields: &[InspectedField], sources: &[Value], notes: &mut Vec<String>) -> Value {
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
    map
}

fn field(recording: &Recording, name: String, values: &[f64]) -> InspectedField {
    let rate_hz = rate_hz(recording, |row| !values[row].is_nan());
    guessed_field(name, values, rate_hz)
}

fn guessed_field(name: String, values: &[f64], rate_hz: Option<f64>) -> InspectedField {
    let range = range(values);
    let is_contracts = Channel::from_name(&name).is_some();
    let found = guess(&name, &Seen::of(values))
        .and_then(|found| if is_contracts { Ok(found) } else { agree(found, values) });
    InspectedField {
        samples: values.iter().filter(|value| !value.is_nan()).count(),
        rate_hz,
        range,
        channel: found.as_ref().ok().map(|found| found.channel.name().to_owned()),
        unit: found.as_ref().ok().map(|found| found.unit.to_owned()),
        reason: found.map_or_else(|reason| reason, |found| found.reason),
        name,
    }
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
