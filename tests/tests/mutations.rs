//! Ten thousand requests that somebody might send by mistake or on purpose: each has an answer, and none breaks the service.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    collections::BTreeMap,
    io::{Read, Write},
    net::TcpStream,
};

use joulepath_tests::{Answer, Server, drive_csv};
use rand::{RngExt, SeedableRng, seq::IndexedRandom};
use rand_pcg::Pcg64;
use serde_json::{Value, json};

const REQUESTS: usize = 10_000;
/// Streams of bytes that need not be HTTP at all.
const STREAMS: usize = 500;

struct Request {
    method: &'static str,
    path: String,
    content_type: &'static str,
    body: Vec<u8>,
}

/// Requests that are right, of every path that takes a body, and some that take none.
fn right(map_id: &str, recording_id: &str) -> Vec<Request> {
    let map =
        json!({ "cell_size_m": 1.0, "rows": 12, "columns": 12, "elevation_m": vec![vec![0.5; 12]; 12] });
    let (start, goal) =
        (json!({ "x_m": 3.5, "y_m": 3.5, "heading_rad": 0.0 }), json!({ "x_m": 8.5, "y_m": 8.5 }));
    let plan = json!({ "map": map, "robot": "husky-a200", "start": start, "goal": goal, "bound": 1.05, "reverse": true });
    let stored =
        json!({ "map_id": map_id, "robot": "husky-a200", "start": start, "goal": goal, "refine": false });
    let matrix = json!({ "map_id": map_id, "robot": "husky-a200", "sources": [start, goal] });
    let reachable = json!({ "map_id": map_id, "robot": "husky-a200", "from": start, "energies_j": [500.0] });
    let patch = json!({ "row": 1, "column": 1, "elevation_m": [[0.6]] });
    let job = json!({ "robot": "husky-a200", "recordings": [recording_id] });
    let ascii = "ncols 4\nnrows 3\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 1 1 1 1 2 2 1 1 1 1 1";
    let json = |path: &str, body: &Value| Request {
        method: "POST",
        path: path.into(),
        content_type: "application/json",
        body: body.to_string().into(),
    };
    let get = |path: String| Request { method: "GET", path, content_type: "text/plain", body: Vec::new() };
    let mut requests = vec![
        json("/v1/plan", &plan),
        json("/v1/plan", &stored),
        json("/v1/compare", &stored),
        json("/v1/alternatives", &stored),
        json("/v1/matrix", &matrix),
        json("/v1/reachable", &reachable),
        json("/v1/maps", &map),
        json("/v1/calibrate", &job),
        json("/v1/diagnose", &job),
        get("/v1/maps".into()),
        get(format!("/v1/maps/{map_id}")),
        get("/v1/robots/husky-a200".into()),
        get("/v1/status".into()),
        get("/v1/jobs/none".into()),
        get("/openapi.json".into()),
    ];
    requests.push(Request { method: "PATCH", ..json(&format!("/v1/maps/{map_id}"), &patch) });
    for (path, content_type, body) in [
        ("/v1/maps", "text/plain", ascii.to_owned()),
        ("/v1/recordings?name=a", "text/csv", drive_csv(1, 30)),
        ("/v1/maps", "image/tiff", "II*\0\u{8}\0\0\0".to_owned()),
        ("/v1/recordings", "application/mcap", "\u{89}MCAP0\r\n".to_owned()),
    ] {
        requests.push(Request { method: "POST", path: path.into(), content_type, body: body.into() });
    }
    requests
}

/// Somewhere in a document another value, a missing field, or one too many.
fn mutate_json(body: &[u8], random: &mut Pcg64) -> Vec<u8> {
    let Ok(mut document) = serde_json::from_slice::<Value>(body) else { return body.to_vec() };
    let odd = [
        Value::Null,
        json!(true),
        json!(-1),
        json!(0),
        json!(1e308),
        json!(-1e-308),
        json!(u64::MAX),
        json!(1e15),
        json!(""),
        json!("husky-a200"),
        json!([]),
        json!({}),
        json!([[[]]]),
        json!("é\u{0}\u{10ffff}"),
        json!("x".repeat(3000)),
    ];
    let mut pointers = vec![String::new()];
    collect(&document, "", &mut pointers);
    let pointer = pointers.choose(random).unwrap();
    if let Some(place) = document.pointer_mut(pointer) {
        match random.random_range(0..5) {
            0 => {
                place.as_object_mut().map(|fields| fields.insert("colour".into(), json!("red")));
            }
            1 => {
                if let Some(fields) = place.as_object_mut()
                    && let Some(key) = fields.keys().next().cloned()
                {
                    fields.remove(&key);
                }
            }
            _ => *place = odd.choose(random).unwrap().clone(),
        }
    }
    document.to_string().into()
}

fn collect(value: &Value, at: &str, pointers: &mut Vec<String>) {
    let mut inside = |key: String, value: &Value| {
        let pointer = format!("{at}/{key}");
        collect(value, &pointer, pointers);
        pointers.push(pointer);
    };
    match value {
        Value::Object(fields) => fields.iter().for_each(|(key, value)| inside(key.clone(), value)),
        Value::Array(values) => values.iter().take(3).enumerate().for_each(|(i, v)| inside(i.to_string(), v)),
        _ => {}
    }
}

/// Somewhere in the bytes others, fewer, or some of them again.
fn mutate_bytes(body: &mut Vec<u8>, random: &mut Pcg64) {
    for _ in 0..random.random_range(1..4) {
        if body.is_empty() {
            body.push(random.random());
        }
        let at = random.random_range(0..body.len());
        match random.random_range(0..5) {
            0 => body[at] = random.random(),
            1 => body.truncate(at),
            2 => body.insert(at, *b"\0\"{[}]-9eE,\xff".choose(random).unwrap()),
            3 => {
                body.remove(at);
            }
            _ => body.extend_from_within(at..(at + 40).min(body.len())),
        }
    }
}

fn mutate(request: &mut Request, random: &mut Pcg64) -> Vec<(&'static str, String)> {
    let mut headers = vec![("content-type", request.content_type.to_owned())];
    match random.random_range(0..10) {
        0..5 => request.body = mutate_json(&request.body, random),
        5..7 => mutate_bytes(&mut request.body, random),
        7 => {
            request.method =
                ["GET", "POST", "PUT", "PATCH", "DELETE", "HEAD", "OPTIONS", "BREW"].choose(random).unwrap();
        }
        8 => {
            let odd =
                ["/", "//", "/..", "/%2e%2e", "/%00", "?map=%ff", "?a=b&a=c", "?name=", "/\u{7e}", "?map={}"];
            request.path += odd.choose(random).unwrap();
        }
        _ => {
            let odd = [
                ("content-type", "application/xml"),
                ("content-type", "application/json; charset=latin-1"),
                ("content-type", ""),
                ("accept", "image/png"),
                ("accept", ";;q=x,*/*;q=0"),
                ("content-encoding", "gzip"),
                ("content-encoding", "zstd"),
                ("content-encoding", "br, br"),
                ("if-none-match", "\"a\", W/"),
                ("authorization", "Bearer"),
                ("last-event-id", "-1"),
                ("x-request-id", "{}\"'<>"),
                ("origin", "null"),
                ("range", "bytes=0-1"),
                ("expect", "nothing"),
            ];
            let (name, value) = odd.choose(random).unwrap();
            headers.retain(|(other, _)| other != name);
            headers.push((name, (*value).to_owned()));
        }
    }
    headers
}

fn check(answer: &Answer, request: &Request) {
    let shown = || {
        format!(
            "{} {} {}: {}",
            request.method,
            request.path,
            String::from_utf8_lossy(&request.body),
            answer.text
        )
    };
    // What is refused for want of time or room is refused on purpose; a body may ask for no time at all.
    assert!(answer.status < 500 || [503, 504].contains(&answer.status), "{}", shown());
    assert!(answer.request_id.is_some(), "{}", shown());
    if answer.status >= 400 && request.method != "HEAD" {
        assert_eq!(answer.content_type, "application/problem+json", "{}", shown());
        assert!(answer.json()["type"].is_string(), "{}", shown());
    }
}

#[test]
fn ten_thousand_mutated_requests_find_no_fault() {
    let server = Server::start_with(&["--plan-time-s", "5"]);
    let map =
        json!({ "cell_size_m": 1.0, "rows": 20, "columns": 20, "elevation_m": vec![vec![0.5; 20]; 20] });
    let map_id = server.post_json("/v1/maps", &map).json()["id"].as_str().unwrap().to_owned();
    let recording = server.post("/v1/recordings", "text/csv", drive_csv(1, 30).as_bytes());
    let recording_id = recording.json()["id"].as_str().unwrap().to_owned();
    for request in right(&map_id, &recording_id) {
        let answer = server.ask(
            request.method,
            &request.path,
            &[("content-type", request.content_type)],
            &request.body,
        );
        check(&answer, &request);
    }
    let mut random = Pcg64::seed_from_u64(20_261_121);
    let mut statuses: BTreeMap<u16, usize> = BTreeMap::new();
    for _ in 0..REQUESTS {
        let mut requests = right(&map_id, &recording_id);
        let chosen = random.random_range(0..requests.len());
        let mut request = requests.swap_remove(chosen);
        let headers = mutate(&mut request, &mut random);
        let headers: Vec<(&str, &str)> = headers.iter().map(|(name, value)| (*name, &value[..])).collect();
        let answer = server.ask(request.method, &request.path, &headers, &request.body);
        check(&answer, &request);
        *statuses.entry(answer.status).or_default() += 1;
    }
    println!("answers by status: {statuses:?}");
    assert!(statuses[&200] > 500 && statuses[&400] > 1000, "{statuses:?}");
    assert_eq!(server.metric("joulepath_panics_total"), 0.0);
    assert_eq!(server.get("/readyz").status, 200);
}

#[test]
fn streams_of_bytes_that_are_not_http_do_no_harm() {
    let server = Server::start_with(&["--head-time-s", "1", "--body-pause-s", "1"]);
    let right = b"POST /v1/plan HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 2\r\nconnection: close\r\n\r\n{}";
    let mut random = Pcg64::seed_from_u64(7);
    for _ in 0..STREAMS {
        let mut bytes = right.to_vec();
        mutate_bytes(&mut bytes, &mut random);
        let mut stream = TcpStream::connect(server.url.trim_start_matches("http://")).unwrap();
        let _ = stream.write_all(&bytes);
        let _ = stream.shutdown(std::net::Shutdown::Write);
        let mut said = Vec::new();
        let _ = stream.read_to_end(&mut said);
        let said = String::from_utf8_lossy(&said);
        assert!(said.is_empty() || said.starts_with("HTTP/1.1 4"), "{said}");
    }
    assert_eq!(server.get("/readyz").status, 200);
    assert_eq!(server.metric("joulepath_panics_total"), 0.0);
}
