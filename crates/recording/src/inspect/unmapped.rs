//! Topics of a log that no built-in map reads: all of them with their types, fields and rates, and guesses by the names of topic and field.

use std::path::Path;

use serde_json::{Value, json};

use super::{
    InspectedField, Inspection,
    choice::{Chosen, sources},
    guessed_field, guessed_map, left_out,
};
use crate::{
    Error,
    beginning::{MOST_ROWS, SeenTopic, seen_topics},
};

/// All topics, and a map of those whose names tell what they are. `why` no built-in map reads them is said.
///
/// # Errors
/// A log without topics: `why`.
pub(super) fn unmapped(path: &Path, why: &Error) -> Result<Inspection, Error> {
    let topics = seen_topics(path)?;
    let mut notes = vec![format!("no built-in map reads it: {why}")];
    notes.push(format!("ranges are those of the first {MOST_ROWS} messages of each topic"));
    let mut fields: Vec<InspectedField> = topics.iter().flat_map(fields_of).collect();
    let Chosen { sources, notes: told } = sources(&mut fields);
    notes.extend(told);
    notes.extend(left_out(&fields));
    let sources: Vec<Value> = sources.iter().filter_map(|source| of_topics(source, &mut notes)).collect();
    let map = match sources.as_slice() {
        [] => Value::Null,
        _ => guessed_map(&fields, &sources, &mut notes),
    };
    Ok(Inspection { source: path.display().to_string(), fields, map, notes })
}

/// The fields of a topic, or the topic alone where none of its numbers can be read.
fn fields_of(topic: &SeenTopic) -> Vec<InspectedField> {
    let whole = |name: String, values: &[f64]| {
        let field = guessed_field(name, values, topic.rate_hz);
        let reason = format!("{}; {}", topic.type_name, field.reason);
        let is_left_out = field.reason.starts_with("left out");
        InspectedField {
            samples: topic.messages,
            reason: if is_left_out { field.reason } else { reason },
            ..field
        }
    };
    if topic.fields.is_empty() {
        return vec![whole(topic.name.clone(), &[])];
    }
    topic.fields.iter().map(|(path, values)| whole(format!("{} {path}", topic.name), values)).collect()
}

/// A source of columns named `topic field` as one of topics; of several topics where they have the same field.
fn of_topics(source: &Value, notes: &mut Vec<String>) -> Option<Value> {
    let names: Vec<&str> = source["columns"].as_array()?.iter().filter_map(Value::as_str).collect();
    let places: Vec<(&str, &str)> = names.iter().filter_map(|name| name.split_once(' ')).collect();
    let (topic, field) = *places.first()?;
    let mut of = source.clone();
    of.as_object_mut()?.remove("columns");
    if places.iter().all(|(other, _)| *other == topic) {
        of["topic"] = json!(topic);
        of["fields"] = json!(places.iter().map(|(_, field)| field).collect::<Vec<_>>());
    } else if places.iter().all(|(_, other)| *other == field) {
        of["topics"] = json!(places.iter().map(|(topic, _)| topic).collect::<Vec<_>>());
        of["fields"] = json!([field]);
    } else {
        notes.push(format!("{} of different topics cannot be one source: choose", names.join(" and ")));
        return None;
    }
    Some(of)
}
