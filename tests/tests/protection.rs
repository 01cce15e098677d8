//! What the service does against strangers, stalled clients, and more than it can do.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    io::{Read, Write},
    net::TcpStream,
    process::Command,
};

use joulepath_tests::{Server, program};
use serde_json::{Value, json};

const TOKEN: &str = "0123456789abcdef0123456789abcdef";

/// Rolling ground that a plan takes a while over, as an ESRI ASCII grid.
fn wide_map(side: usize) -> String {
    let mut text = format!("ncols {side}\nnrows {side}\nxllcorner 0\nyllcorner 0\ncellsize 1\n");
    for row in 0..side {
        for column in 0..side {
            let (x, y) = (column as f64 / 17.0, row as f64 / 23.0);
            text += &format!("{:.2} ", 3.0 * (x.sin() + y.cos() + (x * y / 40.0).sin()));
        }
        text.push('\n');
    }
    text
}

/// A question that keeps a computation busy for seconds: the exact cost from every pose.
fn long_question(server: &Server, side: usize) -> String {
    let stored = server.post("/v1/maps", "text/plain", wide_map(side).as_bytes());
    assert_eq!(stored.status, 201, "{}", stored.text);
    let far = side as f64 - 10.5;
    json!({
        "map_id": stored.json()["id"], "robot": "husky-a200", "hold_goal": true,
        "start": { "x_m": 10.5, "y_m": 10.5 }, "goal": { "x_m": far, "y_m": far },
        "snap_radius_m": 20
    })
    .to_string()
}

fn connect(server: &Server) -> TcpStream {
    TcpStream::connect(server.url.trim_start_matches("http://")).unwrap()
}

/// Sends a question and does not wait for the answer.
fn send(server: &Server, question: &str) -> TcpStream {
    let mut stream = connect(server);
    let length = question.len();
    let head = format!(
        "POST /v1/plan HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: {length}\r\nconnection: close\r\n\r\n"
    );
    stream.write_all(head.as_bytes()).unwrap();
    stream.write_all(question.as_bytes()).unwrap();
    stream
}

/// Everything that the server still says, until it closes the connection.
fn rest(stream: &mut TcpStream) -> String {
    let mut bytes = Vec::new();
    // A closed connection may also show as one that was reset.
    let _ = stream.read_to_end(&mut bytes);
    String::from_utf8_lossy(&bytes).into_owned()
}

fn wait_until(what: &str, mut holds: impl FnMut() -> bool) {
    for _ in 0..100_000 {
        if holds() {
            return;
        }
        std::thread::yield_now();
    }
    panic!("never came: {what}");
}

const RUNNING: &str = "joulepath_computations{state=\"running\"}";

/// What `serve` says when it does not start.
fn refused(arguments: &[&str]) -> String {
    let output =
        Command::new(program()).arg("serve").args(arguments).env_remove("JOULEPATH_TOKENS").output().unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(said.lines().count(), 1, "{said}");
    said
}

#[test]
fn an_address_that_others_reach_needs_tokens_or_a_word() {
    for bind in ["0.0.0.0:0", "[::]:0"] {
        let said = refused(&["--bind", bind]);
        assert!(said.contains("--token-file") && said.contains("--insecure-open"), "{said}");
    }
    let folder = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        path.display().to_string()
    };
    assert!(refused(&["--token-file", &file("weak", "abc\n")]).contains("token 1"));
    assert!(refused(&["--token-file", &file("none", "# none\n")]).contains("no token"));
    assert!(refused(&["--cors-origin", "maps.example.org"]).contains("--cors-origin"));
    assert!(refused(&["--bind", "here"]).contains("--bind here"));
}

#[test]
fn without_a_token_only_probes_and_pages_answer() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("tokens");
    std::fs::write(&path, format!("# the team\n{TOKEN}\nanother-token-0123\n")).unwrap();
    let path = path.display().to_string();
    let server = Server::start_at("0.0.0.0:0", &["--token-file", &path]);
    for path in ["/v1/maps", "/v1/status", "/v1/jobs/none", "/v1/jobs/none/events", "/metrics"] {
        let answer = server.get(path);
        answer.problem(401, "unauthorized");
        assert_eq!(answer.header("www-authenticate"), "Bearer", "{path}");
        for wrong in ["Bearer wrong", &format!("Basic {TOKEN}"), &format!("Bearer {TOKEN}0"), "Bearer"] {
            assert_eq!(
                server.ask("GET", path, &[("authorization", wrong)], b"").status,
                401,
                "{path} {wrong}"
            );
        }
    }
    server.post_json("/v1/plan", &json!({})).problem(401, "unauthorized");
    assert_eq!(server.delete("/v1/maps/abc").status, 401);
    for path in ["/healthz", "/readyz", "/openapi.json", "/docs/", "/docs/guide/"] {
        assert_eq!(server.get(path).status, 200, "{path}");
    }
    for token in [TOKEN, "another-token-0123"] {
        let field = format!("Bearer {token}");
        for path in ["/v1/maps", "/metrics"] {
            assert_eq!(server.ask("GET", path, &[("authorization", &field)], b"").status, 200, "{path}");
        }
    }
    let description = server.get("/openapi.json").json();
    let plan = &description["paths"]["/v1/plan"]["post"];
    assert!(plan["security"].is_array() && plan["responses"]["401"].is_object(), "{plan}");
}

#[test]
fn a_client_that_stalls_in_the_head_or_the_body_is_let_go() {
    let server = Server::start_with(&["--head-time-s", "0.2", "--body-pause-s", "0.2"]);
    let mut silent = connect(&server);
    let mut half = connect(&server);
    half.write_all(b"GET /healthz HTTP/1.1\r\nhost: localhost\r\nx-").unwrap();
    assert!(!rest(&mut silent).contains(" 200 "));
    assert!(!rest(&mut half).contains(" 200 "));
    let mut body = connect(&server);
    body.write_all(b"POST /v1/plan HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 100\r\n\r\n{")
        .unwrap();
    let said = rest(&mut body);
    assert!(said.starts_with("HTTP/1.1 408") && said.contains("too-slow"), "{said}");
    let mut recording = connect(&server);
    recording
        .write_all(b"POST /v1/recordings HTTP/1.1\r\nhost: localhost\r\ncontent-type: text/csv\r\ncontent-length: 100\r\n\r\nt_s")
        .unwrap();
    assert!(rest(&mut recording).starts_with("HTTP/1.1 408"));
    assert_eq!(server.get("/healthz").status, 200);
}

#[test]
fn more_connections_than_allowed_are_refused_at_once() {
    let server = Server::start_with(&["--connections", "3"]);
    let held: Vec<TcpStream> = (0..3).map(|_| connect(&server)).collect();
    let mut other = connect(&server);
    let said = rest(&mut other);
    assert!(said.starts_with("HTTP/1.1 503") && said.to_lowercase().contains("retry-after"), "{said}");
    drop(held);
    wait_until("a place", || {
        let mut stream = connect(&server);
        let _ = stream.write_all(b"GET /healthz HTTP/1.1\r\nhost: localhost\r\nconnection: close\r\n\r\n");
        rest(&mut stream).starts_with("HTTP/1.1 200")
    });
}

#[test]
fn a_computation_ends_when_its_client_leaves() {
    let server = Server::start();
    let question = long_question(&server, 1000);
    let client = send(&server, &question);
    wait_until("the computation", || server.metric(RUNNING) == 1.0);
    drop(client);
    wait_until("its end", || server.metric(RUNNING) == 0.0);
    let left = server.get("/metrics").text.lines().any(|line| line.contains("status=\"499\""));
    assert!(left, "the request is counted as one whose client left");
}

#[test]
fn what_cannot_be_answered_soon_is_refused_at_once() {
    let server =
        Server::start_with(&["--parallel-plans", "1", "--patient-plans", "1", "--queued-plans", "1"]);
    let question = long_question(&server, 1000);
    let running = send(&server, &question);
    wait_until("the computation", || server.metric(RUNNING) == 1.0);
    let waiting = send(&server, &question);
    wait_until("the queue", || server.metric("joulepath_computations{state=\"waiting\"}") == 1.0);
    let refused = server.post("/v1/plan", "application/json", question.as_bytes());
    refused.problem(503, "overloaded");
    assert!(refused.header("retry-after").parse::<u64>().unwrap() >= 1);
    assert_eq!(server.metric("joulepath_shed_total{reason=\"queue\"}"), 1.0);
    assert_eq!(server.get("/v1/maps").status, 200, "what needs no computation is answered");
    drop((running, waiting));
    wait_until("the end", || server.metric(RUNNING) == 0.0);
}

#[test]
fn what_takes_more_memory_than_there_is_is_refused_before_it_is_begun() {
    let server = Server::start_with(&["--request-memory-bytes", "20000000"]);
    let question = long_question(&server, 300);
    let answer = server.post("/v1/plan", "application/json", question.as_bytes());
    let problem = answer.problem(413, "too-large");
    assert!(problem["detail"].as_str().unwrap().contains("20 MB"), "{problem}");
    assert_eq!(server.metric("joulepath_reserved_memory_bytes"), 0.0);
}

#[test]
fn pages_of_other_origins_are_let_in_only_by_name() {
    let origin = "https://maps.example.org";
    let from = |server: &Server, origin: &str| {
        let headers = [("origin", origin), ("sec-fetch-site", "cross-site"), ("content-type", "text/plain")];
        server.ask("POST", "/v1/maps", &headers, b"ncols 1\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1")
    };
    let closed = Server::start();
    from(&closed, origin).problem(403, "cross-origin");
    let list = closed.ask("GET", "/v1/maps", &[("origin", origin)], b"");
    assert_eq!(list.header("access-control-allow-origin"), "", "the browser keeps the answer from the page");

    let open = Server::start_with(&["--cors-origin", origin]);
    assert_eq!(from(&open, origin).status, 201);
    from(&open, "https://other.example.org").problem(403, "cross-origin");
    let list = open.ask("GET", "/v1/maps", &[("origin", origin)], b"");
    assert_eq!(list.header("access-control-allow-origin"), origin);
    let preflight = [
        ("origin", origin),
        ("access-control-request-method", "DELETE"),
        ("access-control-request-headers", "authorization"),
    ];
    let preflight = open.ask("OPTIONS", "/v1/maps/abc", &preflight, b"");
    assert_eq!(preflight.status, 200);
    assert!(preflight.header("access-control-allow-methods").contains("DELETE"));
}

#[test]
fn ids_lead_to_no_file() {
    let server = Server::start();
    for id in ["..%2f..%2fetc%2fpasswd", "%2e%2e", "..\\..", "%00", "%ff", "a%2fb", &"x".repeat(5000)] {
        for path in ["/v1/maps", "/v1/recordings", "/v1/jobs", "/v1/robots", "/docs"] {
            let answer = server.ask("GET", &format!("{path}/{id}"), &[], b"");
            assert!([400, 404].contains(&answer.status), "{path}/{id}: {}", answer.text);
            assert!(!answer.text.contains("root:"), "{path}/{id}");
        }
    }
}

#[test]
fn metrics_tell_what_was_asked_and_what_it_took() {
    let server = Server::start();
    let stored: Value = server.post("/v1/maps", "text/plain", wide_map(60).as_bytes()).json();
    let question = json!({
        "map_id": stored["id"], "robot": "husky-a200",
        "start": { "x_m": 10.5, "y_m": 10.5 }, "goal": { "x_m": 45.5, "y_m": 45.5 }, "snap_radius_m": 10
    });
    for _ in 0..3 {
        assert_eq!(server.post_json("/v1/plan", &question).status, 200);
    }
    assert_eq!(server.metric("joulepath_planner_cache_requests_total{outcome=\"miss\"}"), 1.0);
    assert_eq!(server.metric("joulepath_planner_cache_requests_total{outcome=\"hit\"}"), 2.0);
    assert!(server.metric("joulepath_expansions_total") > 0.0);
    assert!(server.metric("joulepath_resident_memory_bytes") > 1e6);
    assert!(server.metric("joulepath_kept_memory_bytes") > 1e3);
    let count =
        "joulepath_http_request_duration_seconds_count{method=\"POST\",path=\"/v1/plan\",status=\"200\"}";
    assert_eq!(server.metric(count), 3.0);
    server.get("/v1/maps/no-such-map");
    server.get("/made/up/path");
    let text = server.get("/metrics").text;
    assert!(text.contains("path=\"/v1/maps/{id}\",status=\"404\""), "{text}");
    assert!(text.contains("path=\"none\",status=\"404\"") && !text.contains("made/up"), "{text}");
    assert!(text.ends_with("# EOF\n"));
}
