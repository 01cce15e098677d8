//! Which column of a table tells time, and in which unit its numbers are.

use std::path::Path;

use serde_json::{Value, json};

use super::guess::time_unit;
use crate::{Error, Map, Recording, TimeError, reading::read_part};

/// The column of time, and the table as it is read by it.
pub(super) struct TimeColumn {
    pub(super) name: String,
    pub(super) unit: &'static str,
    /// The source of a map that reads it.
    pub(super) source: Value,
    pub(super) reason: String,
    pub(super) recording: Recording,
}

/// The first column that is named as a time and whose numbers are the times of a log; `None` where none is named so. A unit is taken from the
/// name, and from the numbers where the name says none or seconds that they contradict.
///
/// # Errors
/// What is wrong with the first column that is named as a time, where none can be read.
pub(super) fn time_column(path: &Path, names: &[String]) -> Result<Option<TimeColumn>, Error> {
    let mut first_error = None;
    for name in names {
        let Some(unit) = time_unit(name) else { continue };
        match read_in(path, name, unit) {
            Ok(column) => return Ok(Some(column)),
            Err(error) => first_error = first_error.or(Some(error)),
        }
    }
    match first_error {
        None => Ok(None),
        Some(error) => of_two_columns(path, names).unwrap_or(Err(error)).map(Some),
    }
}

fn read_in(path: &Path, name: &str, named: Option<&'static str>) -> Result<TimeColumn, Error> {
    let of = |unit: Option<&str>| -> Result<Recording, Error> {
        let mut source = json!({"channel": "t_s", "column": name});
        unit.into_iter().for_each(|unit| source["unit"] = json!(unit));
        read_part(path, &Map::from_value(&json!({"name": "inspected", "sources": [source]}))?)
    };
    let column = |unit, reason: &str, recording| {
        let (name, reason) = (name.to_owned(), reason.to_owned());
        let source = json!({"channel": "t_s", "column": name, "unit": unit});
        TimeColumn { name, unit, source, reason, recording }
    };
    // Seconds that a map names are believed; here the numbers have to show them.
    let by_name = of(named.filter(|unit| *unit != "s"));
    let error = match by_name {
        Ok(recording) => {
            return Ok(column(
                named.unwrap_or("s"),
                "by its name; its numbers are those of a log",
                recording,
            ));
        }
        Err(error) => error,
    };
    match time_error(&error) {
        // The file says by the column's type what its numbers are, which a map leaves as it is.
        Some(TimeError::TypedUnit { .. }) => {
            Ok(column("s", "by its name; its unit is that of its type", of(None)?))
        }
        Some(TimeError::NotSeconds { evidence, .. }) if named.is_none_or(|unit| unit == "s") => {
            match evidence.likely_units().as_slice() {
                [only] => {
                    let reason = format!("by its name; its unit by its numbers: as seconds, {evidence}");
                    Ok(column(only.symbol, &reason, of(Some(only.symbol))?))
                }
                _ => Err(error),
            }
        }
        _ => Err(error),
    }
}

fn time_error(error: &Error) -> Option<&TimeError> {
    match error {
        Error::Time(error) => Some(error),
        Error::InFile { source, .. } => time_error(source),
        _ => None,
    }
}

/// The time that two columns tell together, as `secs` and `nsecs` of a ROS stamp; `None` where there are no such two.
fn of_two_columns(path: &Path, names: &[String]) -> Option<Result<TimeColumn, Error>> {
    let split = |name: &str| -> (String, String) {
        let lower = name.to_lowercase();
        let at = lower.rfind(['.', '_', '/', ' ']).map_or(0, |at| at + 1);
        (lower[..at].to_owned(), lower[at..].to_owned())
    };
    let ends = |endings: &'static [&str]| move |name: &&String| endings.contains(&split(name).1.as_str());
    // Of several stamps those of one message belong together.
    let pair = names.iter().filter(ends(&["secs", "sec"])).find_map(|whole| {
        let is_beside = |part: &&String| split(part).0 == split(whole).0;
        let parts = names.iter().filter(ends(&["nsecs", "nsec", "nanosecs", "nanosec"])).find(is_beside)?;
        Some([whole.clone(), parts.clone()])
    })?;
    let source = json!({"channel": "t_s", "columns": pair, "combine": "seconds_and_nanoseconds"});
    let read = || {
        let map = Map::from_value(&json!({"name": "inspected", "sources": [source]}))?;
        let recording = read_part(path, &map)?;
        let reason = "whole seconds and nanoseconds beside them, by their names".to_owned();
        Ok(TimeColumn { name: pair.join(", "), unit: "s", source: source.clone(), reason, recording })
    };
    Some(read())
}
