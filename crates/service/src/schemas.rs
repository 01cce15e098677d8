//! JSON Schemas of the files that people write, made from the types that read them.

use axum::{Router, extract::Path, http::header, response::IntoResponse, routing::get};
use serde_json::{Map, Value, json};
use utoipa::ToSchema;

use crate::{
    Engine,
    problem::{Problem, ProblemType},
};

/// Names of the schemas, each with what it describes.
pub const SCHEMAS: [(&str, &str); 4] = [
    ("robot", "A robot: masses, motors, friction by surface, and how well they are known"),
    ("map", "A terrain as a JSON grid"),
    ("recording-map", "Which columns or topics of a log hold which channels"),
    ("world", "A world of the independent simulator"),
];

/// A schema by its name; `None` for a name that is none of [`SCHEMAS`].
pub fn schema(name: &str) -> Option<Value> {
    let title = SCHEMAS.iter().find(|(known, _)| *known == name)?.1;
    Some(match name {
        "robot" => document::<model::robot::RobotFile>(name, title),
        "map" => document::<terrain::MapFile>(name, title),
        "recording-map" => document::<recording::MapFile>(name, title),
        "world" => document::<world::World>(name, title),
        _ => return None,
    })
}

/// `GET /schemas/{name}.json`.
pub(crate) fn routes() -> Router<Engine> {
    Router::new().route(
        "/schemas/{file}",
        get(async |Path(file): Path<String>| {
            let found = file.strip_suffix(".json").and_then(schema);
            match found {
                Some(document) => ([(header::CONTENT_TYPE, "application/schema+json")], document.to_string())
                    .into_response(),
                None => {
                    let known = SCHEMAS.map(|(name, _)| format!("{name}.json")).join(", ");
                    Problem::new(ProblemType::NotFound, format!("there is no such schema; there are {known}"))
                        .into_response()
                }
            }
        }),
    )
}

/// The schema of a type with all that it refers to, as a document of JSON Schema 2020-12.
fn document<T: ToSchema>(name: &str, title: &str) -> Value {
    let mut parts = Vec::new();
    T::schemas(&mut parts);
    let parts: Map<String, Value> = parts
        .into_iter()
        .map(|(name, part)| (name, local(serde_json::to_value(part).unwrap_or_default())))
        .collect();
    let mut root = local(serde_json::to_value(T::schema()).unwrap_or_default());
    if let Some(root) = root.as_object_mut() {
        root.insert("$schema".into(), json!("https://json-schema.org/draft/2020-12/schema"));
        root.insert("$id".into(), json!(format!("/schemas/{name}.json")));
        root.insert("title".into(), json!(title));
        root.insert("$defs".into(), Value::Object(parts));
    }
    root
}

/// The same with references into the document itself instead of into an OpenAPI description.
fn local(value: Value) -> Value {
    match value {
        Value::String(text) => match text.strip_prefix("#/components/schemas/") {
            Some(name) => Value::String(format!("#/$defs/{name}")),
            None => Value::String(text),
        },
        Value::Array(items) => Value::Array(items.into_iter().map(local).collect()),
        Value::Object(fields) => {
            Value::Object(fields.into_iter().map(|(key, inner)| (key, local(inner))).collect())
        }
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every reference of a document.
    fn references(value: &Value, found: &mut Vec<String>) {
        match value {
            Value::Object(fields) => {
                found.extend(fields.get("$ref").and_then(Value::as_str).map(str::to_owned));
                fields.values().for_each(|inner| references(inner, found));
            }
            Value::Array(items) => items.iter().for_each(|inner| references(inner, found)),
            _ => {}
        }
    }

    #[test]
    fn every_schema_holds_all_that_it_refers_to_and_takes_no_unknown_field() {
        for (name, _) in SCHEMAS {
            let document = schema(name).unwrap();
            assert_eq!(document["additionalProperties"], false, "{name}");
            let mut found = Vec::new();
            references(&document, &mut found);
            for reference in found {
                let part = reference.strip_prefix("#/$defs/").unwrap();
                assert!(document["$defs"].get(part).is_some(), "{name}: {reference}");
            }
        }
        assert!(schema("robots").is_none());
    }
}
