//! The OpenAPI description: complete, without contradictions, and true of the running service.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::collections::{BTreeSet, HashMap};

use joulepath_tests::{Answer, Server};
use serde_json::Value;

const METHODS: [&str; 5] = ["get", "post", "put", "patch", "delete"];

/// An operation of the description.
struct Operation<'a> {
    path: &'a str,
    method: &'static str,
    value: &'a Value,
}

fn operations(description: &Value) -> Vec<Operation<'_>> {
    let mut all = Vec::new();
    for (path, item) in description["paths"].as_object().unwrap() {
        for method in METHODS {
            if let Some(value) = item.get(method) {
                all.push(Operation { path, method, value });
            }
        }
    }
    all
}

impl<'a> Operation<'a> {
    fn id(&self) -> &'a str {
        self.value["operationId"].as_str().unwrap()
    }

    fn parameters(&self) -> &'a [Value] {
        self.value["parameters"].as_array().map_or(&[], Vec::as_slice)
    }

    /// Media types of the body with their examples.
    fn examples(&self) -> Vec<(&'a str, &'a Value)> {
        let content = self.value["requestBody"]["content"].as_object();
        let with_example = |(media_type, content): (&'a String, &'a Value)| {
            content.get("example").map(|example| (media_type.as_str(), example))
        };
        content.into_iter().flatten().filter_map(with_example).collect()
    }

    /// Sends a request of the parameters' examples; those of jobs are replaced by the last job's.
    fn send(&self, server: &Server, job: Option<&str>, body: Option<(&str, &Value)>) -> Answer {
        let (mut path, mut query, mut headers) = (self.path.to_owned(), Vec::new(), Vec::new());
        for parameter in self.parameters() {
            let (name, example) = (parameter["name"].as_str().unwrap(), text(&parameter["example"]));
            // The frame of an array, which has no example: any other map is refused with one.
            if self.id() == "createMap" && ["cell_size_m", "origin_m", "crs"].contains(&name) {
                continue;
            }
            match parameter["in"].as_str().unwrap() {
                "path" => {
                    let value =
                        if self.path.starts_with("/v1/jobs/") { job.unwrap().to_owned() } else { example };
                    path = path.replace(&format!("{{{name}}}"), &value);
                }
                "query" => query.push(format!("{name}={}", percent_encoded(&example))),
                _ => headers.push((name, example)),
            }
        }
        if !query.is_empty() {
            path = format!("{path}?{}", query.join("&"));
        }
        if let Some((media_type, _)) = body {
            headers.push(("content-type", media_type.to_owned()));
        }
        let body = body.map_or(String::new(), |(_, example)| text(example));
        let headers: Vec<(&str, &str)> =
            headers.iter().map(|(name, value)| (*name, value.as_str())).collect();
        server.ask(&self.method.to_uppercase(), &path, &headers, body.as_bytes())
    }
}

/// A value as it is sent: a text as it stands, anything else as JSON.
fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

fn percent_encoded(text: &str) -> String {
    let encoded = |byte: u8| match byte {
        b'a'..=b'z' | b'A'..=b'Z' | b'0'..=b'9' | b'-' | b'_' => char::from(byte).to_string(),
        _ => format!("%{byte:02X}"),
    };
    text.bytes().map(encoded).collect()
}

#[test]
fn operation_ids_are_unique_and_say_the_verb_and_noun_of_the_path() {
    let description = Server::start().get("/openapi.json").json();
    let mut ids = HashMap::new();
    for operation in operations(&description) {
        let at = format!("{} {}", operation.method, operation.path);
        if let Some(other) = ids.insert(operation.id(), at.clone()) {
            panic!("{other} and {at} are both {}", operation.id());
        }
    }
    for (id, at) in [
        ("plan", "post /v1/plan"),
        ("compare", "post /v1/compare"),
        ("createMap", "post /v1/maps"),
        ("readMap", "get /v1/maps/{id}"),
        ("listMaps", "get /v1/maps"),
        ("deleteMap", "delete /v1/maps/{id}"),
        ("listRecordings", "get /v1/recordings"),
        ("diagnose", "post /v1/diagnose"),
    ] {
        assert_eq!(ids.get(id).map(String::as_str), Some(at));
    }
}

#[test]
fn every_operation_and_answer_is_described() {
    let description = Server::start().get("/openapi.json").json();
    for operation in operations(&description) {
        assert!(operation.value["summary"].is_string(), "{}", operation.id());
        for (status, response) in operation.value["responses"].as_object().unwrap() {
            let described = response["description"].as_str().is_some_and(|text| !text.is_empty());
            assert!(described, "{} {status}", operation.id());
        }
        for parameter in operation.parameters() {
            assert!(parameter["description"].is_string(), "{}: {parameter}", operation.id());
            assert!(!parameter["example"].is_null(), "{}: {parameter}", operation.id());
        }
        // Forms of files have no examples.
        let body = operation.value.pointer("/requestBody/content").and_then(Value::as_object);
        let is_form = |content: &serde_json::Map<String, Value>| {
            content.keys().all(|kind| kind == "multipart/form-data")
        };
        assert!(
            body.is_none_or(is_form) || !operation.examples().is_empty(),
            "{} has no example",
            operation.id()
        );
    }
}

#[test]
fn parameters_in_the_path_are_those_of_its_template() {
    let description = Server::start().get("/openapi.json").json();
    for operation in operations(&description) {
        let parts = operation.path.split('/').filter_map(|part| part.strip_prefix('{')?.strip_suffix('}'));
        let in_path = operation.parameters().iter().filter(|parameter| parameter["in"] == "path");
        let named: BTreeSet<&str> = in_path.map(|parameter| parameter["name"].as_str().unwrap()).collect();
        assert_eq!(named, parts.collect(), "{}", operation.id());
    }
}

/// Generators of clients cannot read a schema that is a boolean.
#[test]
fn no_array_is_closed_by_a_boolean_and_no_bytes_are_an_array() {
    fn walk(value: &Value, place: &str) {
        assert_ne!(value.get("items"), Some(&Value::Bool(false)), "{place}");
        let binary = ["image/tiff", "application/x-npy", "application/octet-stream", "application/mcap"];
        match value {
            Value::Object(fields) => {
                for (name, field) in fields {
                    assert!(
                        !binary.contains(&name.as_str()) || field["schema"]["format"] == "binary",
                        "{place}"
                    );
                    walk(field, &format!("{place}/{name}"));
                }
            }
            Value::Array(elements) => elements.iter().for_each(|element| walk(element, place)),
            _ => {}
        }
    }
    walk(&Server::start().get("/openapi.json").json(), "");
}

/// Whoever tries an operation with its examples gets an answer: things are made, then asked for, changed and removed.
#[test]
fn every_example_is_answered() {
    let server = Server::start();
    let description = server.get("/openapi.json").json();
    let mut all = operations(&description);
    let turn = |operation: &Operation<'_>| {
        let creates = operation.id().starts_with("create");
        METHODS.iter().rposition(|method| *method == operation.method).map(|rank| match rank {
            1 if creates => 0,
            1 => 1,
            0 => 2,
            rank => rank,
        })
    };
    all.sort_by_key(turn);
    let mut job = None;
    for operation in all {
        let mut bodies: Vec<Option<(&str, &Value)>> = operation.examples().into_iter().map(Some).collect();
        if operation.value.get("requestBody").is_none() {
            bodies.push(None);
        }
        for body in bodies {
            let answer = operation.send(&server, job.as_deref(), body);
            assert!(
                (200..300).contains(&answer.status),
                "{} {}: {}",
                operation.id(),
                answer.status,
                answer.text
            );
            if answer.status == 202 {
                job = Some(answer.json()["id"].as_str().unwrap().to_owned());
            }
        }
    }
}

/// The examples of jobs do not only start: what they are asked for is found.
#[test]
fn the_example_of_a_diagnosis_comes_to_its_end() {
    let server = Server::start();
    let description = server.get("/openapi.json").json();
    let example = |id: &str, kind: &str| {
        let all = operations(&description);
        let operation = all.iter().find(|operation| operation.id() == id).unwrap();
        text(operation.examples().iter().find(|(media_type, _)| *media_type == kind).unwrap().1)
    };
    let drive = server.post("/v1/recordings", "text/csv", example("createRecording", "text/csv").as_bytes());
    assert_eq!(drive.status, 201, "{}", drive.text);
    for id in ["diagnose", "calibrate"] {
        let started =
            server.post(&format!("/v1/{id}"), "application/json", example(id, "application/json").as_bytes());
        let path = format!("/v1/jobs/{}", started.json()["id"].as_str().unwrap());
        let last = server.events(&format!("{path}/events"), None).last().unwrap();
        assert_eq!(last.name, "done", "{:?}", last.data);
    }
}
