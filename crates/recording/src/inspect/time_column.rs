//! Which column of a table tells time, and in which unit its numbers are.

use std::path::Path;

use serde_json::json;

use super::guess::time_unit;
use crate::{Error, Map, Recording, TimeError, reading::read_part};

/// The column of time, and the table as it is read by it.
pub(super) struct TimeColumn {
    pub(super) name: String,
    pub(super) unit: &'static str,
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
        Some(error) => Err(in_two_columns(names).unwrap_or(error)),
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
        TimeColumn { name, unit, reason, recording }
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

/// The refusal of a time that two columns tell together, as `secs` and `nsecs` of ROS 1.
fn in_two_columns(names: &[String]) -> Option<Error> {
    let ends = |name: &&String, ending: &[&str]| {
        let lower = name.to_lowercase();
        ending.iter().any(|ending| lower.rsplit(['.', '_', '/', ' ']).next() == Some(*ending))
    };
    let whole = names.iter().find(|name| ends(name, &["secs", "sec"]))?;
    let parts = names.iter().find(|name| ends(name, &["nsecs", "nsec", "nanosec"]))?;
    let reason = format!(
        "it tells time together with `{parts}`, and a map names one column; write {whole} + 1e-9 {parts} as a column `t_s`"
    );
    Some(Error::Field { topic: "of the table".into(), field: whole.clone(), reason })
}
