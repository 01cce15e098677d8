//! Recordings at the running service: what is stored, what is told of it, what is refused.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    io::{Read, Write},
    net::TcpStream,
};

use joulepath_tests::{Server, drive_csv};
use serde_json::{Value, json};

const CSV: &str = "text/csv";

#[test]
fn a_recording_is_stored_with_its_reading_report_and_forgotten_when_deleted() {
    let server = Server::start();
    let text = drive_csv(2, 100);
    let stored = server.post("/v1/recordings", CSV, text.as_bytes());
    assert_eq!(stored.status, 201, "{}", stored.text);
    let stored = stored.json();
    assert_eq!((&stored["rows"], &stored["runs"]), (&json!(200), &json!(["drive-0", "drive-1"])));
    assert_eq!((&stored["format"], &stored["bytes"]), (&json!("csv"), &json!(text.len())));
    assert_eq!(stored["report"]["power_form"], "sides");
    assert_eq!(server.post("/v1/recordings", CSV, text.as_bytes()).status, 200, "it is at hand already");
    let path = format!("/v1/recordings/{}", stored["id"].as_str().unwrap());
    assert_eq!(server.get(&path).json(), stored);
    assert_eq!(server.get("/v1/recordings").json()["recordings"][0]["id"], stored["id"]);
    assert_eq!(server.delete(&path).status, 204);
    server.get(&path).problem(404, "unknown-recording");
    server.delete(&path).problem(404, "unknown-recording");
    assert_eq!(server.get("/v1/recordings").json()["recordings"], json!([]));
}

#[test]
fn a_log_is_looked_into_without_being_stored() {
    const PARQUET: &str = "application/vnd.apache.parquet";
    let server = Server::start();
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../crates/recording/tests/files/drive-pandas.parquet");
    let columns = server.post("/v1/recordings/columns", PARQUET, &std::fs::read(path).unwrap());
    assert_eq!(columns.status, 200, "{}", columns.text);
    let columns = columns.json();
    let named =
        |name: &str| columns["columns"].as_array().unwrap().iter().find(|one| one["name"] == name).cloned();
    assert!(named("v_left_mps").unwrap()["cells"][0].as_str().unwrap().parse::<f64>().is_ok());
    assert_eq!(server.get("/v1/recordings").json()["recordings"], json!([]));
    server.post("/v1/recordings/columns", PARQUET, b"PAR1 no more").problem(400, "invalid-recording");
    let text = server.post("/v1/recordings/columns", CSV, b"a,b\n1,2\n").json();
    assert_eq!(text, json!({"columns": [{"name": "a", "cells": ["1"]}, {"name": "b", "cells": ["2"]}]}));
    server.post("/v1/recordings/columns", "text/plain", b"a").problem(415, "unsupported-media-type");
}

#[test]
fn recordings_in_a_folder_outlive_the_service() {
    let folder = tempfile::tempdir().unwrap();
    let store = folder.path().join("store").display().to_string();
    let mut server = Server::start_with(&["--store", &store]);
    let stored = server.post("/v1/recordings", CSV, drive_csv(1, 50).as_bytes()).json();
    assert!(server.terminate().success());
    let server = Server::start_with(&["--store", &store]);
    assert_eq!(server.get(&format!("/v1/recordings/{}", stored["id"].as_str().unwrap())).json(), stored);
}

#[test]
fn a_map_in_the_query_names_columns_and_units() {
    let server = Server::start();
    let text = "time,L,R,P\n0,0.1,0.2,0.05\n1,0.2,0.3,0.06\n";
    let problem = server.post("/v1/recordings", CSV, text.as_bytes()).problem(400, "invalid-recording");
    assert!(problem["detail"].as_str().unwrap().contains("found: time, L, R, P"), "{problem}");
    let source = |channel: &str, column: &str, unit: &str| json!({ "channel": channel, "column": column, "unit": unit });
    let map = |power_unit: &str| {
        let sources = [
            source("t_s", "time", "s"),
            source("v_left_mps", "L", "m/s"),
            source("v_right_mps", "R", "m/s"),
            source("power_w", "P", power_unit),
        ];
        let map = json!({ "name": "lab", "sources": sources }).to_string();
        let escaped: String = map.bytes().map(|byte| format!("%{byte:02x}")).collect();
        format!("/v1/recordings?name=yard&map={escaped}")
    };
    let stored = server.post(&map("kW"), CSV, text.as_bytes()).json();
    assert_eq!(stored["runs"], json!(["yard"]));
    let power =
        stored["report"]["channels"].as_array().unwrap().iter().find(|c| c["channel"] == "power_w").unwrap();
    assert_eq!((&power["unit"], &power["greatest"]), (&json!("kW"), &json!(60.0)));
    let problem = server.post(&map("A"), CSV, text.as_bytes()).problem(400, "invalid-request");
    assert_eq!(problem["errors"][0]["pointer"], "/map/sources/3/unit", "{problem}");
    for (query, said) in
        [("map=rover", "husky, clearpath-a200"), ("colour=red", "colour"), ("map=%7B", "no valid JSON")]
    {
        let answer = server.post(&format!("/v1/recordings?{query}"), CSV, text.as_bytes());
        let problem = answer.problem(400, "invalid-request");
        assert!(problem["detail"].as_str().unwrap().contains(said), "{problem}");
    }
}

#[test]
fn what_is_no_recording_is_refused_by_place_and_leaves_nothing_behind() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start_with(&["--store", &folder.path().display().to_string()]);
    let good = drive_csv(1, 30);
    let lines: Vec<&str> = good.lines().collect();
    let swapped = [&lines[..5], &[lines[6], lines[5]], &lines[7..]].concat().join("\n");
    for (kind, body, said) in [
        (CSV, swapped.as_bytes(), "line 7: time goes back from 0.5 s to 0.4 s in run `drive-0`"),
        (
            CSV,
            good.replace("power_left_w", "power_lft_w").as_bytes(),
            "did you mean `power_lft_w` for power_left_w",
        ),
        (CSV, b"".as_slice(), "an empty file"),
        ("application/vnd.apache.parquet", good.as_bytes(), "not a readable Parquet file"),
        ("application/vnd.apache.parquet", b"PAR1".as_slice(), "not a readable Parquet file"),
        ("application/mcap", good.as_bytes(), "no MCAP file"),
        ("application/mcap", b"\x89MCAP0\r\n".as_slice(), "nothing to read"),
        ("application/vnd.sqlite3", good.as_bytes(), "not a database"),
        ("text/csv", b"#ROSBAG V2.0\n".as_slice(), "nothing to read"),
        ("application/x-rosbag", good.as_bytes(), "no ROS 1 bag"),
        ("application/x-rosbag", b"#ROSBAG V2.0\n".as_slice(), "nothing to read"),
    ] {
        let problem = server.post("/v1/recordings", kind, body).problem(400, "invalid-recording");
        assert!(problem["detail"].as_str().unwrap().contains(said), "{said}: {problem}");
    }
    server.post("/v1/recordings", "image/png", b"x").problem(415, "unsupported-media-type");
    server.post_json("/v1/recordings", &json!({})).problem(415, "unsupported-media-type");
    for id in ["0123", "..%2f..%2fetc%2fpasswd", "%00", "00000000000000000000000000000000"] {
        server.get(&format!("/v1/recordings/{id}")).problem(404, "unknown-recording");
        server.delete(&format!("/v1/recordings/{id}")).problem(404, "unknown-recording");
    }
    assert_eq!(
        std::fs::read_dir(folder.path().join("recordings")).unwrap().count(),
        0,
        "nothing half-done remains"
    );
}

#[test]
fn a_line_that_breaks_off_at_the_end_is_left_out_and_told() {
    let server = Server::start();
    let text = drive_csv(1, 30);
    let cut = &text.as_bytes()[..text.len() - 30];
    let stored = server.post("/v1/recordings", CSV, cut).json();
    assert_eq!(stored["rows"], 29);
    let repair = &stored["report"]["repairs"][0];
    assert!(repair["what"].as_str().unwrap().contains("breaks off"), "{stored}");
}

#[test]
fn a_body_that_is_too_large_is_refused_before_it_is_sent_and_one_that_ends_early_is_not_kept() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start_with(&["--store", &folder.path().display().to_string()]);
    let address = server.url.trim_start_matches("http://");
    let head = |length: u64| {
        format!(
            "POST /v1/recordings HTTP/1.1\r\nhost: localhost\r\ncontent-type: text/csv\r\ncontent-length: {length}\r\nconnection: close\r\n\r\n"
        )
    };
    let mut stream = TcpStream::connect(address).unwrap();
    stream.write_all(head(1 << 40).as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 413") && answer.contains("too-large"), "{answer}");

    let mut stream = TcpStream::connect(address).unwrap();
    let text = drive_csv(1, 30);
    stream.write_all(head(2 * text.len() as u64).as_bytes()).unwrap();
    stream.write_all(text.as_bytes()).unwrap();
    stream.shutdown(std::net::Shutdown::Write).unwrap();
    // Whether it still answers is the server's affair; that it has dealt with the request is seen by the connection's end.
    let _ = stream.read_to_string(&mut String::new());
    assert_eq!(server.get("/v1/recordings").json()["recordings"], json!([]));
}

/// So many bytes of CSV: a long text beside few numbers, as logs with messages have.
struct Wordy {
    row: usize,
    rows: usize,
    line: Vec<u8>,
}

impl Read for Wordy {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        if self.line.is_empty() && self.row < self.rows {
            let words = "word ".repeat(400);
            let (t, v) = (self.row as f64 / 10.0, 0.5 + 0.1 * (self.row % 7) as f64);
            self.line = format!("{t},{v},{v},{},{words}\n", 100.0 * v).into_bytes();
            self.row += 1;
        }
        let bytes = buffer.len().min(self.line.len());
        buffer[..bytes].copy_from_slice(&self.line[..bytes]);
        self.line.drain(..bytes);
        Ok(bytes)
    }
}

#[test]
fn a_large_recording_goes_to_disk_without_filling_the_memory() {
    let server = Server::start();
    let rows = 100_000;
    let head = b"t_s,v_left_mps,v_right_mps,power_w,note\n".to_vec();
    let stored = server.post_stream("/v1/recordings", CSV, Wordy { row: 0, rows, line: head });
    assert_eq!(stored.status, 201, "{}", stored.text);
    let stored = stored.json();
    assert_eq!(stored["rows"], rows);
    assert!(stored["bytes"].as_u64().unwrap() > 200_000_000, "{stored}");
    let ignored: &Value = &stored["report"]["ignored"][0];
    assert_eq!(ignored["name"], "note");
    if let Some(bytes) = server.peak_memory_bytes() {
        assert!(bytes < 60_000_000, "{bytes} bytes");
    }
}
