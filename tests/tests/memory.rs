//! Memory of requests: what they take together, from the first byte of a body to the last of an answer, keeps to the limit.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    io::{Read, Write},
    net::TcpStream,
};

use flate2::{Compression, write::GzEncoder};
use joulepath_tests::Server;
use serde_json::{Value, json};

/// What requests may take together [bytes].
const LIMIT_BYTES: u64 = 100_000_000;
/// What a process takes that serves anything at all: threads, code, buffers of connections [bytes].
const BASE_BYTES: u64 = 60_000_000;

fn server(arguments: &[&str]) -> Server {
    let limit = LIMIT_BYTES.to_string();
    Server::start_with(&[&["--request-memory-bytes", limit.as_str()], arguments].concat())
}

/// Most memory that the service may have held.
fn check_peak(server: &Server, what: &str) {
    let Some(peak) = server.peak_memory_bytes() else { return };
    let most = BASE_BYTES + LIMIT_BYTES + LIMIT_BYTES / 10;
    assert!(peak <= most, "{what}: {peak} bytes were resident, {most} are allowed");
}

/// A text of some 60 MB, an element many times between a head and a tail, encoded to some 60 kB.
fn bomb(head: &str, element: &str, tail: &str) -> Vec<u8> {
    const TEXT_BYTES: usize = 60_000_000;
    let part = format!("{element},").repeat(10_000);
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(head.as_bytes()).unwrap();
    for _ in 0..TEXT_BYTES / part.len() {
        packed.write_all(part.as_bytes()).unwrap();
    }
    packed.write_all(format!("{element}{tail}").as_bytes()).unwrap();
    packed.finish().unwrap()
}

/// Sends a request whose answer nobody reads.
fn send(server: &Server, head: &str, body: &[u8]) -> TcpStream {
    let mut stream = TcpStream::connect(server.url.trim_start_matches("http://")).unwrap();
    write!(stream, "{head}\r\nhost: localhost\r\ncontent-length: {}\r\n\r\n", body.len()).unwrap();
    stream.write_all(body).unwrap();
    stream
}

fn wait_until(what: &str, mut is_so: impl FnMut() -> bool) {
    let end = std::time::Instant::now() + std::time::Duration::from_secs(120);
    while !is_so() {
        assert!(std::time::Instant::now() < end, "there was no {what} within 120 s");
        std::thread::yield_now();
    }
}

#[test]
fn small_bodies_that_decode_to_large_documents_keep_to_the_limit() {
    let server = server(&[]);
    let map = r#"{"map":{"cell_size_m":1,"rows":1,"columns":1,"elevation_m":["#;
    let end = r#"},"robot":"husky-a200","start":{"x_m":0,"y_m":0},"goal":{"x_m":0,"y_m":0}}"#;
    let bombs = [
        ("/v1/plan", bomb(map, "[]", &format!("]{end}"))),
        ("/v1/plan", bomb(map, "[1]", &format!("]{end}"))),
        ("/v1/plan", bomb(&format!("{map}["), "1", &format!("]]{end}"))),
        ("/v1/plan", bomb(&format!("{map}[1]],\"surface\":[["), "\"\"", &format!("]]{end}"))),
        ("/v1/matrix", bomb(r#"{"sources":["#, "{}", "]}")),
        ("/v1/reachable", bomb(r#"{"energies_j":["#, "1", "]}")),
        ("/v1/calibrate", bomb(r#"{"map":["#, "[1]", "]}")),
        ("/v1/maps", bomb(r#"{"elevation_m":["#, "[]", "]}")),
        ("/v1/robots", bomb(r#"{"name":""#, "long", r#""}"#)),
    ];
    let head = |path: &str| {
        format!(
            "POST {path} HTTP/1.1\r\ncontent-type: application/json\r\ncontent-encoding: gzip\r\nconnection: close"
        )
    };
    let all: Vec<TcpStream> =
        bombs.iter().cycle().take(27).map(|(path, body)| send(&server, &head(path), body)).collect();
    for (mut stream, (path, _)) in all.into_iter().zip(bombs.iter().cycle()) {
        let mut said = String::new();
        let _ = stream.read_to_string(&mut said);
        let status = said.get(9..12).unwrap_or_default();
        assert!(["400", "413", "503"].contains(&status), "{path}: {said}");
    }
    check_peak(&server, "bombs");
    assert_eq!(server.metric("joulepath_reserved_memory_bytes"), 0.0, "all of it was given back");
}

#[test]
fn documents_that_wait_for_their_turn_are_counted() {
    let server = server(&["--parallel-plans", "1"]);
    let side = 300;
    let rows: Vec<Vec<f64>> =
        (0..side).map(|y| (0..side).map(|x| ((x * 7 + y * 13) % 17) as f64 * 0.01).collect()).collect();
    let question = json!({
        "map": { "cell_size_m": 1.0, "rows": side, "columns": side, "elevation_m": rows },
        "robot": "husky-a200", "start": { "x_m": 5.5, "y_m": 5.5 }, "goal": { "x_m": 290.5, "y_m": 288.5 },
        "samples": 1000, "replanned": 100
    });
    let body = question.to_string();
    let head = "POST /v1/range HTTP/1.1\r\ncontent-type: application/json";
    let _running = send(&server, head, body.as_bytes());
    wait_until("computation", || server.metric("joulepath_computations{state=\"running\"}") == 1.0);
    let alone = server.metric("joulepath_reserved_memory_bytes");
    let _waiting = send(&server, head, body.as_bytes());
    wait_until("queue", || server.metric("joulepath_computations{state=\"waiting\"}") == 1.0);
    let both = server.metric("joulepath_reserved_memory_bytes");
    // At least the map as it is kept, eight bytes a cell.
    assert!(both >= alone + (8 * side * side) as f64, "{alone} bytes, then {both}");
}

#[test]
fn clients_that_never_read_their_maps_keep_to_the_limit() {
    const READERS: usize = 60;
    let server = server(&[]);
    let side = 1000;
    let row: String = (0..side).map(|x| format!("{}.25 ", x % 900)).collect();
    let text = format!(
        "ncols {side}\nnrows {side}\nxllcorner 0\nyllcorner 0\ncellsize 1\n{}",
        format!("{row}\n").repeat(side)
    );
    let id = server.post("/v1/maps", "text/plain", text.as_bytes()).json()["id"].clone();
    let path = format!("/v1/maps/{}", id.as_str().unwrap());
    let forms = ["application/json", "application/octet-stream"];
    let codings = ["identity", "gzip", "zstd", "br"];
    let readers: Vec<TcpStream> = (0..READERS)
        .map(|i| {
            let (form, coding) = (forms[i % 2], codings[i / 2 % 4]);
            send(&server, &format!("GET {path} HTTP/1.1\r\naccept: {form}\r\naccept-encoding: {coding}"), b"")
        })
        .collect();
    let count =
        "joulepath_http_request_duration_seconds_count{method=\"GET\",path=\"/v1/maps/{id}\",status=\"200\"}";
    wait_until("answer for each", || server.metric(count) == READERS as f64);
    assert_eq!(server.get("/healthz").status, 200);
    check_peak(&server, "readers");
    drop(readers);
    wait_until("end of all answers", || server.metric("joulepath_reserved_memory_bytes") == 0.0);
    let whole: Value = server.get(&path).json();
    assert_eq!(whole["elevation_m"].as_array().map(Vec::len), Some(side), "{}", whole["rows"]);
    assert_eq!(whole["elevation_m"][side - 1][side - 1], 99.25);
}

#[test]
fn clients_that_never_read_their_paths_keep_to_the_limit() {
    let server = server(&[]);
    let side = 200;
    let map = json!({ "cell_size_m": 1.0, "rows": side, "columns": side, "elevation_m": vec![vec![0.5; side]; side] });
    let id = server.post_json("/v1/maps", &map).json()["id"].clone();
    let question = json!({
        "map_id": id, "robot": "husky-a200", "start": { "x_m": 5.5, "y_m": 5.5 },
        "energies_j": (1..=32).map(|i| 500.0 * f64::from(i)).collect::<Vec<_>>()
    });
    let body = question.to_string();
    let head = "POST /v1/reachable HTTP/1.1\r\ncontent-type: application/json";
    let readers: Vec<TcpStream> = (0..40).map(|_| send(&server, head, body.as_bytes())).collect();
    wait_until("answer for each", || {
        let text = server.get("/metrics").text;
        let counts = text.lines().filter(|line| {
            line.starts_with("joulepath_http_request_duration_seconds_count")
                && line.contains("/v1/reachable")
        });
        counts.filter_map(|line| line.rsplit(' ').next()?.parse::<usize>().ok()).sum::<usize>() == 40
    });
    check_peak(&server, "readers");
    drop(readers);
}
