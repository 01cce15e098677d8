//! Requests at the edges of HTTP: hosts and origins, ids, codings, and heads that cannot be parsed.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    io::{Read, Write},
    net::{TcpListener, TcpStream},
    process::Command,
};

use flate2::{
    Compression,
    write::{DeflateEncoder, GzEncoder, ZlibEncoder},
};
use joulepath_tests::{Answer, Server, drive_csv, program};
use serde_json::{Value, json};

fn question() -> String {
    let map =
        json!({ "cell_size_m": 1.0, "rows": 20, "columns": 20, "elevation_m": vec![vec![0.5; 20]; 20] });
    let (start, goal) = (json!({ "x_m": 4.5, "y_m": 4.5 }), json!({ "x_m": 15.5, "y_m": 15.5 }));
    json!({ "map": map, "robot": "husky-a200", "start": start, "goal": goal }).to_string()
}

fn gzip(bytes: &[u8]) -> Vec<u8> {
    let mut packed = GzEncoder::new(Vec::new(), Compression::fast());
    packed.write_all(bytes).unwrap();
    packed.finish().unwrap()
}

fn encoded(server: &Server, path: &str, media_type: &str, codings: &[&str], body: &[u8]) -> Answer {
    let mut headers = vec![("content-type", media_type)];
    headers.extend(codings.iter().map(|coding| ("content-encoding", *coding)));
    server.ask("POST", path, &headers, body)
}

#[test]
fn names_of_codings_are_taken_in_any_case_and_in_lists() {
    let server = Server::start();
    let text = question();
    let plan =
        |codings: &[&str], body: &[u8]| encoded(&server, "/v1/plan", "application/json", codings, body);
    let once = gzip(text.as_bytes());
    for name in ["gzip", "GZIP", "x-gzip", "X-GZip", "identity, gzip", "gzip, identity"] {
        assert_eq!(plan(&[name], &once).status, 200, "{name}");
    }
    for name in ["identity", "IDENTITY", ""] {
        assert_eq!(plan(&[name], text.as_bytes()).status, 200, "{name}");
    }
    let mut zlib = ZlibEncoder::new(Vec::new(), Compression::fast());
    zlib.write_all(text.as_bytes()).unwrap();
    let zlib = zlib.finish().unwrap();
    let mut bare = DeflateEncoder::new(Vec::new(), Compression::fast());
    bare.write_all(text.as_bytes()).unwrap();
    for body in [&zlib, &bare.finish().unwrap()] {
        assert_eq!(plan(&["Deflate"], body).status, 200);
    }
    let twice = gzip(&zlib);
    assert_eq!(plan(&["deflate, gzip"], &twice).status, 200);
    assert_eq!(plan(&["deflate", "gzip"], &twice).status, 200, "several fields are one list");
    plan(&["gzip, deflate"], &twice).problem(400, "invalid-request");
    for name in ["compress", "gzip, snappy", "gzip;q=1"] {
        let refused = plan(&[name], &once);
        refused.problem(415, "unsupported-media-type");
        assert_eq!(refused.header("accept-encoding"), "gzip, deflate, br, zstd", "{name}");
    }
}

#[test]
fn a_recording_of_several_members_is_stored_whole_or_not_at_all() {
    let server = Server::start();
    let text = drive_csv(1, 400);
    let half = text.len() / 2;
    let store = |body: &[u8]| encoded(&server, "/v1/recordings", "text/csv", &["gzip"], body);
    let members = [gzip(&text.as_bytes()[..half]), gzip(&text.as_bytes()[half..])].concat();
    let whole = store(&members);
    assert_eq!((whole.status, &whole.json()["rows"]), (201, &json!(400)), "{}", whole.text);
    let plain = server.post("/v1/recordings", "text/csv", text.as_bytes());
    assert_eq!((plain.status, &plain.json()["id"]), (200, &whole.json()["id"]), "the same content");
    for (body, said) in [
        (members[..members.len() - 3].to_vec(), "too early"),
        ([&members[..], b"rest"].concat(), "gzip"),
        ([&members[..], &[0; 512]].concat(), "gzip"),
        ([&members[..], &gzip(b"more")[..8]].concat(), "gzip"),
    ] {
        let problem = store(&body).problem(400, "invalid-request");
        assert!(problem["detail"].as_str().unwrap().contains(said), "{problem}");
    }
    let held = server.get("/v1/recordings").json();
    assert_eq!(held["recordings"].as_array().map(Vec::len), Some(1), "{held}");
}

/// What the service says to bytes on a connection of their own.
fn raw(server: &Server, bytes: &[u8]) -> String {
    let mut stream = TcpStream::connect(server.url.trim_start_matches("http://")).unwrap();
    let _ = stream.write_all(bytes);
    let mut said = Vec::new();
    let _ = stream.read_to_end(&mut said);
    String::from_utf8_lossy(&said).into_owned()
}

fn raw_problem(said: &str, status: u16, kind: &str) {
    assert!(said.starts_with(&format!("HTTP/1.1 {status} ")), "{said}");
    let (head, body) = said.split_once("\r\n\r\n").unwrap();
    let head = head.to_lowercase();
    assert!(
        head.contains("content-type: application/problem+json") && head.contains("x-request-id: "),
        "{said}"
    );
    let problem: Value = serde_json::from_str(body).unwrap_or_else(|error| panic!("{error} in {said}"));
    assert_eq!((&problem["type"], &problem["status"]), (&json!(kind), &json!(status)), "{said}");
}

#[test]
fn a_head_that_cannot_be_parsed_is_refused_by_a_problem_document() {
    let server = Server::start();
    for malformed in [
        "no request\r\n\r\n",
        "GET / HTTP/9.9\r\nhost: localhost\r\n\r\n",
        "GET / HTTP/1.1\r\nhost localhost\r\n\r\n",
        "GET / HTTP/1.1\r\nhost: localhost\r\nbad name: 1\r\n\r\n",
        "POST /v1/plan HTTP/1.1\r\nhost: localhost\r\ncontent-length: -1\r\n\r\n",
        "GE\u{1}T / HTTP/1.1\r\nhost: localhost\r\n\r\n",
    ] {
        raw_problem(&raw(&server, malformed.as_bytes()), 400, "invalid-request");
    }
    let long = format!("GET /{} HTTP/1.1\r\nhost: localhost\r\n\r\n", "x".repeat(70_000));
    raw_problem(&raw(&server, long.as_bytes()), 414, "target-too-long");
    let fields: String = (0..101).map(|i| format!("x-{i}: 1\r\n")).collect();
    let many = format!("GET / HTTP/1.1\r\nhost: localhost\r\n{fields}\r\n");
    raw_problem(&raw(&server, many.as_bytes()), 431, "header-too-large");
    let after = "GET /healthz HTTP/1.1\r\nhost: localhost\r\n\r\nno request\r\n\r\n";
    let said = raw(&server, after.as_bytes());
    assert!(said.starts_with("HTTP/1.1 200 "), "{said}");
    raw_problem(
        &said[said.find("HTTP/1.1 400").unwrap_or_else(|| panic!("{said}"))..],
        400,
        "invalid-request",
    );
}

#[test]
fn a_request_says_whom_it_asks() {
    let server = Server::start();
    for host in ["", "host: localhost\r\nhost: localhost\r\n"] {
        let text = format!("GET /healthz HTTP/1.1\r\n{host}connection: close\r\n\r\n");
        raw_problem(&raw(&server, text.as_bytes()), 400, "invalid-request");
    }
    let old = raw(&server, b"GET /healthz HTTP/1.0\r\n\r\n");
    assert!(
        old.starts_with("HTTP/1.0 200 ") || old.starts_with("HTTP/1.1 200 "),
        "HTTP/1.0 has no Host: {old}"
    );
}

#[test]
fn a_service_without_tokens_answers_to_its_own_names_only() {
    let ask = |server: &Server, host: &str| {
        let origin = format!("http://{host}");
        let headers = [
            ("host", host),
            ("origin", origin.as_str()),
            ("sec-fetch-site", "same-origin"),
            ("content-type", "application/json"),
        ];
        server.ask("POST", "/v1/plan", &headers, question().as_bytes())
    };
    let server = Server::start();
    let port = server.url.rsplit(':').next().unwrap().to_owned();
    for own in [format!("localhost:{port}"), format!("127.0.0.1:{port}"), "[::1]".to_owned()] {
        assert_eq!(ask(&server, &own).status, 200, "{own}");
    }
    for other in
        [format!("evil.example:{port}"), format!("127.0.0.1.evil.example:{port}"), "10.0.0.1".to_owned()]
    {
        let problem = ask(&server, &other).problem(421, "misdirected-request");
        assert!(problem["detail"].as_str().unwrap().contains("--host"), "{problem}");
        for path in ["/healthz", "/v1/maps", "/", "/docs/"] {
            assert_eq!(server.ask("GET", path, &[("host", other.as_str())], b"").status, 421, "{path}");
        }
    }
    let named = Server::start_with(&["--host", "maps.example.org", "--host", "10.0.0.1"]);
    for own in ["maps.example.org", "Maps.Example.org:8443", "10.0.0.1:80", "localhost"] {
        assert_eq!(ask(&named, own).status, 200, "{own}");
    }
    ask(&named, "evil.example").problem(421, "misdirected-request");
    let guarded = Server::start_in("127.0.0.1:0", &[], &[("JOULEPATH_TOKENS", "0123456789abcdef")]);
    ask(&guarded, "evil.example").problem(401, "unauthorized");
}

#[test]
fn an_id_that_is_none_is_replaced() {
    let server = Server::start();
    let longest = "x".repeat(128);
    for id in ["mine-17", &longest] {
        assert_eq!(server.ask("GET", "/healthz", &[("x-request-id", id)], b"").header("x-request-id"), id);
    }
    for id in ["x".repeat(129), "a b".to_owned(), "{}\"'<>".to_owned(), String::new()] {
        let answer = server.ask("GET", "/healthz", &[("x-request-id", &id)], b"");
        let own = answer.header("x-request-id");
        assert!(own != id && own.len() == 36, "{id} gave {own}");
    }
}

#[test]
fn a_bucket_that_refuses_is_told_without_its_keys() {
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let endpoint = format!("http://{}", listener.local_addr().unwrap());
    let key = "AKIAEXAMPLEOFAKEY123";
    let document = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<Error><Code>InvalidAccessKeyId</Code><Message>The key does not exist.</Message>\
         <AWSAccessKeyId>{key}</AWSAccessKeyId><StringToSign>AWS4-HMAC-SHA256</StringToSign></Error>"
    );
    // It ends with the test's process.
    std::thread::spawn(move || {
        for stream in listener.incoming() {
            let mut stream = stream.unwrap();
            let _ = stream.read(&mut [0; 10_000]);
            let _ = write!(
                stream,
                "HTTP/1.1 403 Forbidden\r\ncontent-type: application/xml\r\ncontent-length: {}\r\nconnection: close\r\n\r\n{document}",
                document.len()
            );
        }
    });
    let output = Command::new(program())
        .args(["serve", "--bind", "127.0.0.1:0", "--store", "s3://bucket/prefix"])
        .envs([
            ("AWS_ENDPOINT_URL", endpoint.as_str()),
            ("AWS_ALLOW_HTTP", "true"),
            ("AWS_REGION", "us-east-1"),
            ("AWS_ACCESS_KEY_ID", key),
            ("AWS_SECRET_ACCESS_KEY", "a-secret-of-the-owner"),
        ])
        .output()
        .unwrap();
    let said = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("InvalidAccessKeyId") && said.contains("s3://bucket/prefix"), "{said}");
    for secret in [key, "a-secret-of-the-owner", "StringToSign"] {
        assert!(!said.contains(secret), "{said}");
    }
}

#[test]
fn settings_that_let_nothing_happen_are_refused_in_a_line() {
    for (flag, value) in [
        ("--connections", "0"),
        ("--body-bytes", "0"),
        ("--request-memory-bytes", "0"),
        ("--parallel-plans", "0"),
        ("--plan-time-s", "0"),
        ("--host", "https://maps.example.org/"),
    ] {
        let output =
            Command::new(program()).args(["serve", "--bind", "127.0.0.1:0", flag, value]).output().unwrap();
        let said = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{flag}: {said}");
        assert!(said.contains(flag), "{said}");
    }
}
