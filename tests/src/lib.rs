//! What the black-box tests share: the built program, a server of it, and requests that keep every answer.

#![allow(clippy::panic)]

pub mod churn;
pub mod extremes;
pub mod folder_store;
pub mod form;
pub mod kills;
pub mod published;
pub mod s3;

use std::{
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, Stdio},
};

use serde_json::{Value, json};

/// The built `joulepath` program, beside the tests' own executables.
///
/// # Panics
/// When it has not been built.
pub fn program() -> PathBuf {
    let mut path = std::env::current_exe().unwrap_or_default();
    path.pop();
    if path.ends_with("deps") || path.ends_with("examples") {
        path.pop();
    }
    path.push("joulepath");
    assert!(
        path.exists(),
        "{} is not built: run `cargo build --bin joulepath` in this profile",
        path.display()
    );
    path
}

/// A file of the repository.
pub fn file(path: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("..").join(path)
}

/// A map of cells of 1 m that rises by a twentieth to the east and a fiftieth to the north.
pub fn slope_map(rows: usize, columns: usize) -> Value {
    let row = |r: usize| (0..columns).map(|c| 0.05 * c as f64 + 0.02 * r as f64).collect::<Vec<_>>();
    json!({ "cell_size_m": 1.0, "rows": rows, "columns": columns, "elevation_m": (0..rows).map(row).collect::<Vec<_>>() })
}

/// Power of the left and the right side of a Husky at 0.3 to 0.6 m/s on the left and 0.3 to 0.7 m/s on the right \[W\].
const DRIVE_W: [[[f64; 2]; 5]; 4] = [
    [[19.7, 19.5], [-0.4, 56.6], [-3.0, 96.2], [-3.3, 134.2], [-2.9, 169.7]],
    [[58.4, -0.4], [25.5, 25.4], [3.7, 60.5], [-3.1, 98.4], [-5.0, 136.2]],
    [[99.6, -3.3], [61.4, 3.8], [31.2, 31.3], [9.1, 65.1], [-2.2, 101.6]],
    [[138.8, -4.3], [100.3, -3.1], [65.4, 9.3], [36.9, 37.3], [14.6, 70.1]],
];

/// A recording of several runs at 10 Hz, each of arcs that last five seconds. Its power is about that of a Husky on ground that rolls
/// a fifth harder than its file says, so that a robot can be fitted to it.
pub fn drive_csv(runs: usize, rows: usize) -> String {
    let mut text =
        "run,t_s,v_left_mps,v_right_mps,yaw_rate_radps,power_left_w,power_right_w,surface\n".to_owned();
    for run in 0..runs {
        for row in 0..rows {
            let t = row as f64 / 10.0;
            let arc = row / 50;
            let (left, right) =
                (0.3 + 0.1 * ((2 * arc + run) % 4) as f64, 0.3 + 0.1 * ((3 * arc) % 5) as f64);
            let yaw_rate = (right - left) / 0.9;
            let noise_w = 0.5 * (1.7 * row as f64).sin();
            let [left_w, right_w] = DRIVE_W[(2 * arc + run) % 4][(3 * arc) % 5].map(|w| w + noise_w);
            text += &format!(
                "drive-{run},{t:.1},{left:.5},{right:.5},{yaw_rate:.5},{left_w:.3},{right_w:.3},marble\n"
            );
        }
    }
    text
}

/// A running server, ended when dropped.
#[derive(Debug)]
pub struct Server {
    child: Child,
    /// Where it listens, as `http://127.0.0.1:41234`.
    pub url: String,
    /// Where it keeps what lasts as long as it does, which it cannot remove when it is killed.
    temporary: tempfile::TempDir,
}

impl Server {
    /// Starts a server on a free loopback port.
    ///
    /// # Panics
    /// When it does not start.
    pub fn start() -> Self {
        Server::start_with(&[])
    }

    /// Starts a server with more arguments.
    ///
    /// # Panics
    /// When it does not start.
    pub fn start_with(arguments: &[&str]) -> Self {
        Server::start_in("127.0.0.1:0", arguments, &[])
    }

    /// Starts a server over a folder, in which a killed service's jobs are taken up soon.
    ///
    /// # Panics
    /// When it does not start.
    pub fn start_over(folder: &Path) -> Self {
        Server::start_over_with(folder, &["--lease-s", "0.5"])
    }

    /// Starts a server over a folder with more arguments.
    ///
    /// # Panics
    /// When it does not start.
    pub fn start_over_with(folder: &Path, arguments: &[&str]) -> Self {
        let folder = folder.display().to_string();
        Server::start_with(&[&["--store", folder.as_str()], arguments].concat())
    }

    /// Starts a server at an address, with more arguments.
    ///
    /// # Panics
    /// When it does not start.
    pub fn start_at(bind: &str, arguments: &[&str]) -> Self {
        Server::start_in(bind, arguments, &[])
    }

    /// Starts a server at an address, with more arguments and variables of the environment.
    ///
    /// # Panics
    /// When it does not start.
    pub fn start_in(bind: &str, arguments: &[&str], environment: &[(&str, &str)]) -> Self {
        let temporary =
            tempfile::tempdir().unwrap_or_else(|error| panic!("no folder for the server: {error}"));
        let mut child = Command::new(program())
            .args(["serve", "--bind", bind])
            .args(arguments)
            .env("TMPDIR", temporary.path())
            .envs(environment.iter().copied())
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap_or_else(|error| panic!("the server does not start: {error}"));
        let stdout = child.stdout.take().unwrap_or_else(|| panic!("the server's output was not kept"));
        let mut line = String::new();
        let read = BufReader::new(stdout).read_line(&mut line);
        let url = line.trim().strip_prefix("listening on ").map(|url| url.replace("0.0.0.0", "127.0.0.1"));
        let url = url.unwrap_or_else(|| panic!("the server said {line:?} ({read:?})"));
        Server { child, url, temporary }
    }

    /// Sends a body with a content type.
    pub fn post(&self, path: &str, content_type: &str, body: &[u8]) -> Answer {
        let request = agent().post(format!("{}{path}", self.url)).content_type(content_type);
        Answer::from(request.send(body))
    }

    /// Sends a body of unknown length as it is read.
    pub fn post_stream(&self, path: &str, content_type: &str, mut body: impl std::io::Read) -> Answer {
        let request = agent().post(format!("{}{path}", self.url)).content_type(content_type);
        Answer::from(request.send(ureq::SendBody::from_reader(&mut body)))
    }

    /// Sends a JSON document.
    pub fn post_json(&self, path: &str, body: &Value) -> Answer {
        self.post(path, "application/json", body.to_string().as_bytes())
    }

    /// Sends a JSON document that changes something.
    pub fn patch_json(&self, path: &str, body: &Value) -> Answer {
        let request = agent().patch(format!("{}{path}", self.url)).content_type("application/json");
        Answer::from(request.send(body.to_string().as_bytes()))
    }

    /// Sends any request.
    ///
    /// # Panics
    /// When it cannot be put together, or the server does not answer.
    pub fn ask(&self, method: &str, path: &str, headers: &[(&str, &str)], body: &[u8]) -> Answer {
        let mut request = ureq::http::Request::builder().method(method).uri(format!("{}{path}", self.url));
        for (name, value) in headers {
            request = request.header(*name, *value);
        }
        let request = request.body(body).unwrap_or_else(|error| panic!("{method} {path}: {error}"));
        Answer::from(agent().run(request))
    }

    /// The value of a line of `/metrics`, as `joulepath_shed_total{reason="queue"}`; 0 where there is none yet.
    ///
    /// # Panics
    /// When it is no number.
    pub fn metric(&self, name: &str) -> f64 {
        let text = self.get("/metrics").text;
        let value = text.lines().find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
        value.map_or(0.0, |value| value.parse().unwrap_or_else(|_| panic!("{name} is {value}")))
    }

    /// Gets a path.
    pub fn get(&self, path: &str) -> Answer {
        Answer::from(agent().get(format!("{}{path}", self.url)).call())
    }

    /// Sends any request with a token.
    ///
    /// # Panics
    /// When it cannot be put together, or the server does not answer.
    pub fn ask_as(&self, token: &str, method: &str, path: &str, body: &Value) -> Answer {
        let field = format!("Bearer {token}");
        let headers = [("authorization", field.as_str()), ("content-type", "application/json")];
        let body = if body.is_null() { String::new() } else { body.to_string() };
        let headers = if body.is_empty() { &headers[..1] } else { &headers[..] };
        self.ask(method, path, headers, body.as_bytes())
    }

    /// Opens a stream of server-sent events, as who has seen all up to an event.
    ///
    /// # Panics
    /// When the server does not answer.
    pub fn events(&self, path: &str, last_event_id: Option<&str>) -> Events {
        let mut request = agent().get(format!("{}{path}", self.url)).header("accept", "text/event-stream");
        if let Some(id) = last_event_id {
            request = request.header("last-event-id", id);
        }
        let response = request.call().unwrap_or_else(|error| panic!("the server did not answer: {error}"));
        let status = response.status().as_u16();
        Events { status, lines: BufReader::new(Box::new(response.into_body().into_reader())) }
    }

    /// Deletes a path.
    pub fn delete(&self, path: &str) -> Answer {
        Answer::from(agent().delete(format!("{}{path}", self.url)).call())
    }

    /// The folder that stands for that of all temporary files.
    pub fn temporary(&self) -> &Path {
        self.temporary.path()
    }

    /// Asks the server to end, as a process manager does, and waits until it has.
    ///
    /// # Panics
    /// When it cannot be asked.
    pub fn terminate(&mut self) -> std::process::ExitStatus {
        self.ask_to_end();
        self.wait()
    }

    /// Asks the server to end.
    ///
    /// # Panics
    /// When it cannot be asked.
    pub fn ask_to_end(&self) {
        let asked = Command::new("kill").args(["-TERM", &self.child.id().to_string()]).status();
        assert!(asked.is_ok_and(|status| status.success()), "the server could not be asked to end");
    }

    /// Waits until the server has ended.
    ///
    /// # Panics
    /// When that cannot be seen.
    pub fn wait(&mut self) -> std::process::ExitStatus {
        self.child.wait().unwrap_or_else(|error| panic!("the server's end was not seen: {error}"))
    }

    /// Kills the server at once, as the system does when memory runs out.
    pub fn kill(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }

    /// Memory that the server holds now [bytes], where the system tells (Linux).
    pub fn resident_memory_bytes(&self) -> Option<u64> {
        status_bytes(&self.child.id().to_string(), "VmRSS:")
    }

    /// The most memory that the server has held [bytes], where the system tells (Linux).
    pub fn peak_memory_bytes(&self) -> Option<u64> {
        peak_memory_bytes(&self.child.id().to_string())
    }
}

/// The most memory that a process, by its number or `self`, has held [bytes], where the system tells (Linux).
pub fn peak_memory_bytes(process: &str) -> Option<u64> {
    status_bytes(process, "VmHWM:")
}

fn status_bytes(process: &str, name: &str) -> Option<u64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find(|line| line.starts_with(name))?;
    let kibibytes: u64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes * 1024)
}

impl Drop for Server {
    fn drop(&mut self) {
        self.kill();
    }
}

/// A stream of server-sent events.
#[allow(missing_debug_implementations)]
pub struct Events {
    /// HTTP status of the stream.
    pub status: u16,
    lines: BufReader<Box<dyn std::io::Read + Send>>,
}

/// One event.
#[derive(Debug)]
pub struct Event {
    /// Its name.
    pub name: String,
    /// Its id.
    pub id: String,
    /// Its data.
    pub data: Value,
}

impl Iterator for Events {
    type Item = Event;

    fn next(&mut self) -> Option<Event> {
        let mut event = Event { name: String::new(), id: String::new(), data: Value::Null };
        loop {
            let mut line = String::new();
            if self.lines.read_line(&mut line).ok()? == 0 {
                return None;
            }
            match line.trim_end().split_once(": ") {
                Some(("event", name)) => event.name = name.to_owned(),
                Some(("id", id)) => event.id = id.to_owned(),
                Some(("data", data)) => event.data = serde_json::from_str(data).ok()?,
                None if line.trim().is_empty() && !event.name.is_empty() => return Some(event),
                _ => {}
            }
        }
    }
}

/// An HTTP answer, whatever its status.
#[derive(Debug)]
pub struct Answer {
    /// HTTP status.
    pub status: u16,
    /// Media type.
    pub content_type: String,
    /// The server's id of the request.
    pub request_id: Option<String>,
    /// Where what was made is found.
    pub location: Option<String>,
    /// All headers.
    pub headers: Vec<(String, String)>,
    /// The body as it came.
    pub body: Vec<u8>,
    /// The body as text.
    pub text: String,
}

impl Answer {
    /// A header's value, empty where there is none.
    pub fn header(&self, name: &str) -> &str {
        self.headers.iter().find(|(other, _)| other == name).map_or("", |(_, value)| value)
    }

    /// The body as JSON.
    ///
    /// # Panics
    /// When it is not JSON.
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.text).unwrap_or_else(|error| panic!("{error} in {}", self.text))
    }

    /// The problem document that it must be.
    ///
    /// # Panics
    /// When it is none, or another.
    pub fn problem(&self, status: u16, kind: &str) -> Value {
        assert_eq!(self.status, status, "{}", self.text);
        assert_eq!(self.content_type, "application/problem+json", "{}", self.text);
        let problem = self.json();
        assert_eq!(problem["type"], kind, "{problem}");
        assert_eq!(problem["status"], status);
        let detail = problem["detail"].as_str().is_some_and(|detail| detail.len() > 10);
        assert!(problem["title"].is_string() && detail, "{problem}");
        problem
    }

    fn from(result: Result<ureq::http::Response<ureq::Body>, ureq::Error>) -> Self {
        let mut response = result.unwrap_or_else(|error| panic!("the server did not answer: {error}"));
        let text = |value: &ureq::http::HeaderValue| String::from_utf8_lossy(value.as_bytes()).into_owned();
        let headers: Vec<(String, String)> =
            response.headers().iter().map(|(name, value)| (name.to_string(), text(value))).collect();
        let header = |name: &str| headers.iter().find(|(other, _)| other == name).map(|(_, v)| v.clone());
        let (content_type, request_id) = (header("content-type").unwrap_or_default(), header("x-request-id"));
        let location = header("location");
        let status = response.status().as_u16();
        let body = response.body_mut().with_config().limit(256 << 20).read_to_vec();
        let body = body.unwrap_or_else(|error| panic!("the answer broke off: {error}"));
        let text = String::from_utf8_lossy(&body).into_owned();
        Answer { status, content_type, request_id, location, headers, body, text }
    }
}

fn agent() -> ureq::Agent {
    ureq::Agent::config_builder().http_status_as_error(false).allow_non_standard_methods(true).build().into()
}
