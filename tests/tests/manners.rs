//! What every path of the service does alike: ids, forms, tags, packing, and failures with a shape.

#![allow(clippy::unwrap_used)]

use std::io::{Read, Write};

use flate2::{Compression, read::GzDecoder, write::GzEncoder};
use joulepath_tests::Server;
use serde_json::{Value, json};

fn map(side: usize) -> Value {
    json!({ "cell_size_m": 1.0, "rows": side, "columns": side, "elevation_m": vec![vec![0.5; side]; side] })
}

fn question() -> Value {
    json!({
        "map": map(20), "robot": "husky-a200",
        "start": { "x_m": 4.5, "y_m": 4.5 }, "goal": { "x_m": 15.5, "y_m": 15.5 }
    })
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(bytes).unwrap();
    packed.finish().unwrap()
}

#[test]
fn every_answer_carries_the_id_that_the_request_came_with_or_one_of_its_own() {
    let server = Server::start();
    for (method, path, status) in [
        ("GET", "/healthz", 200),
        ("GET", "/v1/maps", 200),
        ("GET", "/nowhere", 404),
        ("DELETE", "/v1/maps", 405),
        ("POST", "/v1/plan", 415),
        ("GET", "/v1/jobs/none", 404),
    ] {
        let mine = server.ask(method, path, &[("x-request-id", "mine-17")], b"");
        assert_eq!((mine.status, mine.header("x-request-id")), (status, "mine-17"), "{method} {path}");
        let own = server.ask(method, path, &[], b"");
        assert!(own.header("x-request-id").len() >= 16, "{method} {path}");
        if status >= 400 {
            assert_eq!(own.content_type, "application/problem+json", "{method} {path}");
        }
    }
}

#[test]
fn a_form_that_is_not_offered_is_refused_with_those_that_are() {
    let server = Server::start();
    let body = question().to_string();
    let json = ("content-type", "application/json");
    let refused = server.ask("POST", "/v1/plan", &[json, ("accept", "image/png")], body.as_bytes());
    let problem = refused.problem(406, "not-acceptable");
    assert!(problem["detail"].as_str().unwrap().contains("application/geo+json"), "{problem}");
    let geojson =
        server.ask("POST", "/v1/plan", &[json, ("accept", "application/geo+json")], body.as_bytes());
    assert_eq!((geojson.status, &geojson.content_type[..]), (200, "application/geo+json"));
    assert!(geojson.header("vary").contains("accept"), "{:?}", geojson.headers);
    for path in ["/v1/maps", "/v1/robots", "/healthz", "/metrics", "/v1/status"] {
        assert_eq!(server.ask("GET", path, &[("accept", "image/png")], b"").status, 406, "{path}");
        assert_eq!(server.ask("GET", path, &[("accept", "*/*")], b"").status, 200, "{path}");
    }
    assert_eq!(server.ask("GET", "/v1/jobs/none", &[("accept", "*/*")], b"").status, 404);
}

#[test]
fn what_the_client_has_is_not_sent_again_until_it_changes() {
    let server = Server::start();
    let list = server.get("/v1/maps");
    let tag = list.header("etag").to_owned();
    assert!(tag.starts_with("W/\"") && list.header("cache-control").contains("no-cache"), "{tag}");
    let again = server.ask("GET", "/v1/maps", &[("if-none-match", &tag)], b"");
    assert_eq!((again.status, again.text.len(), again.header("etag")), (304, 0, &tag[..]));

    let id = server.post_json("/v1/maps", &map(20)).json()["id"].as_str().unwrap().to_owned();
    let changed = server.ask("GET", "/v1/maps", &[("if-none-match", &tag)], b"");
    assert_eq!(changed.status, 200, "another map is in the list");
    assert_ne!(changed.header("etag"), tag);

    let path = format!("/v1/maps/{id}");
    let stored = server.get(&path);
    assert!(stored.header("cache-control").contains("no-cache"), "its name may change");
    let cells = server.ask("GET", &path, &[("accept", "application/octet-stream")], b"");
    assert!(cells.header("cache-control").contains("immutable"), "its content may not");
    let held = [("if-none-match", stored.header("etag"))];
    assert_eq!(server.ask("GET", &path, &held, b"").status, 304);
    assert_eq!(server.delete(&path).status, 204);
    assert_eq!(server.ask("GET", &path, &held, b"").status, 404, "what is gone has not stayed the same");
    for path in ["/healthz", "/v1/status", "/metrics"] {
        assert_eq!(server.get(path).header("cache-control"), "no-store", "{path}");
    }
}

#[test]
fn bodies_come_and_go_packed() {
    let server = Server::start();
    let packed = gzip(question().to_string().as_bytes());
    let headers =
        [("content-type", "application/json"), ("content-encoding", "gzip"), ("accept-encoding", "gzip")];
    let answer = server.ask("POST", "/v1/plan", &headers, &packed);
    assert_eq!((answer.status, answer.header("content-encoding")), (200, "gzip"), "{}", answer.text);
    let mut text = String::new();
    GzDecoder::new(&answer.body[..]).read_to_string(&mut text).unwrap();
    let plan: Value = serde_json::from_str(&text).unwrap();
    assert!(plan["energy_j"].as_f64().unwrap() > 0.0);
    for encoding in ["br", "zstd"] {
        let answer = server.ask("GET", "/openapi.json", &[("accept-encoding", encoding)], b"");
        assert_eq!((answer.status, answer.header("content-encoding")), (200, encoding));
    }
    let broken = server.ask("POST", "/v1/plan", &headers[..2], b"this is not gzip");
    broken.problem(400, "invalid-request");
    let unknown = [("content-type", "application/json"), ("content-encoding", "compress")];
    let refused = server.ask("POST", "/v1/plan", &unknown, b"{}");
    assert!(refused.problem(415, "unsupported-media-type")["detail"].as_str().unwrap().contains("gzip"));
    assert_eq!(refused.header("accept-encoding"), "gzip, deflate, br, zstd");
}

#[test]
fn a_small_body_that_unpacks_to_a_huge_one_is_refused_before_it_takes_memory() {
    let server = Server::start_with(&["--body-bytes", "1000000"]);
    // As many blanks as fit into what is sent at once, so that the answer is read before the connection closes.
    let mut packed = GzEncoder::new(Vec::new(), Compression::best());
    for _ in 0..60 {
        packed.write_all(&[b' '; 1_000_000]).unwrap();
    }
    let packed = packed.finish().unwrap();
    let before = server.peak_memory_bytes();
    for path in ["/v1/plan", "/v1/maps"] {
        let headers = [("content-type", "application/json"), ("content-encoding", "gzip")];
        server.ask("POST", path, &headers, &packed).problem(413, "too-large");
    }
    if let (Some(before), Some(after)) = (before, server.peak_memory_bytes()) {
        assert!(after < before + 30_000_000, "{before} bytes, then {after}");
    }
}

#[test]
fn a_path_that_takes_other_methods_says_which() {
    let server = Server::start();
    for (method, path, allowed) in [
        ("DELETE", "/v1/maps", vec!["GET", "HEAD", "POST"]),
        ("GET", "/v1/plan", vec!["POST"]),
        ("PUT", "/v1/maps/abc", vec!["DELETE", "GET", "HEAD", "PATCH"]),
        ("POST", "/healthz", vec!["GET", "HEAD"]),
    ] {
        let answer = server.ask(method, path, &[], b"");
        answer.problem(405, "method-not-allowed");
        let mut found: Vec<&str> = answer.header("allow").split(',').map(str::trim).collect();
        found.sort_unstable();
        assert_eq!(found, allowed, "{method} {path}");
    }
    server.get("/v1/nowhere").problem(404, "not-found");
    server.get("/v1/maps/").problem(404, "not-found");
}

#[test]
fn the_reference_page_needs_nothing_from_elsewhere() {
    let server = Server::start();
    let page = server.get("/docs/");
    assert_eq!(page.status, 200, "{}", page.text);
    let loaded: Vec<&str> = page
        .text
        .split(['"', '\''])
        .filter(|part| part.ends_with(".js") || part.ends_with(".css") || part.ends_with(".png"))
        .collect();
    assert!(loaded.len() >= 3, "{}", page.text);
    for part in loaded {
        assert!(!part.contains("//"), "{part}");
        let file = server.get(&format!("/docs/{}", part.trim_start_matches("./")));
        assert_eq!(file.status, 200, "{part}");
    }
    assert!(server.get("/docs/swagger-initializer.js").text.contains("/openapi.json"));
}

#[test]
fn the_status_publishes_version_limits_and_maps() {
    let server = Server::start_with(&["--plan-time-s", "2.5", "--body-bytes", "500000"]);
    server.post_json("/v1/maps", &map(20));
    let status = server.get("/v1/status").json();
    assert_eq!(status["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(
        (&status["limits"]["plan_time_s"], &status["limits"]["body_bytes"]),
        (&json!(2.5), &json!(500_000))
    );
    assert_eq!(status["maps"][0]["rows"], 20);
}
