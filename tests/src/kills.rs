//! Kills a service at random moments while clients upload, delete and start jobs, and looks what became of everything that had
//! been acknowledged.

use std::{
    collections::{BTreeMap, BTreeSet},
    io::Read,
    path::Path,
    sync::{
        Mutex, PoisonError,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64Mcg;
use serde_json::{Value, json};

use crate::{Server, agent, drive_csv, folder_store};

/// Clients that talk to the service at the same time, each a tenant of its own: what it keeps, nobody else removes.
const CLIENTS: u64 = 4;
/// Maps that all tenants store and delete again and again, so that their data is shared.
const SHARED_MAPS: usize = 3;
/// How long a service lives before it is killed [ms].
const LIFE_MS: std::ops::Range<u64> = 5..250;

/// What was done and what was found.
#[derive(Debug, Default)]
pub struct Outcome {
    /// Services that were killed.
    pub kills: usize,
    /// Uploads that had been acknowledged.
    pub uploads: usize,
    /// Deletes that had been acknowledged.
    pub deletes: usize,
    /// Jobs that had been accepted.
    pub jobs: usize,
    /// Requests that were under way when the service was killed.
    pub cut_off: usize,
    /// Jobs that were taken up more than once.
    pub taken_up_again: usize,
    /// Jobs that were given up because two services died that worked on them.
    pub given_up: usize,
    /// Everything that was not as it had been acknowledged.
    pub faults: Vec<String>,
}

/// What clients know.
#[derive(Debug, Default)]
struct Ledger {
    /// What each path must be to a tenant: there, gone, or either, while a request for it is under way or was cut off.
    paths: BTreeMap<(u64, String), Known>,
    /// Paths of the shared maps, once one was stored.
    shared: BTreeMap<usize, String>,
    jobs: BTreeSet<(u64, String)>,
    /// The recording that jobs read, which nobody deletes.
    recording: String,
    outcome: Outcome,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Known {
    There,
    Gone,
    Either,
}

/// Kills so many services over a folder, one after the other.
///
/// # Panics
/// When a service does not start.
pub fn kill_again_and_again(folder: &Path, kills: usize, seed: u64) -> Outcome {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let tokens = tempfile::NamedTempFile::new().unwrap_or_else(|error| panic!("no file of tokens: {error}"));
    let lines: Vec<String> =
        (0..CLIENTS).map(|tenant| format!("tenant-{tenant}:{}", token(tenant))).collect();
    std::fs::write(tokens.path(), lines.join("\n")).unwrap_or_else(|error| panic!("no tokens: {error}"));
    let tokens = tokens.path().display().to_string();
    let start = || Server::start_over_with(folder, &["--lease-s", "0.5", "--token-file", &tokens]);

    let driven = drive_csv(2, 200);
    let mut recording = String::new();
    let first = start();
    for tenant in 0..CLIENTS {
        let authorization = bearer(tenant);
        let headers = [("authorization", authorization.as_str()), ("content-type", "text/csv")];
        let stored = first.ask("POST", "/v1/recordings", &headers, driven.as_bytes()).json();
        stored["id"].as_str().unwrap_or_default().clone_into(&mut recording);
    }
    drop(first);
    let ledger = Mutex::new(Ledger { recording: recording.clone(), ..Ledger::default() });
    for kill in 0..kills {
        let mut server = start();
        check(&server, &ledger);
        let killed = AtomicBool::new(false);
        let url = server.url.clone();
        thread::scope(|scope| {
            for tenant in 0..CLIENTS {
                let random = Pcg64Mcg::seed_from_u64(seed ^ (1 + kill as u64 * CLIENTS + tenant));
                let (ledger, killed, recording, url) = (&ledger, &killed, &recording, &url);
                scope.spawn(move || Client { url, tenant, ledger, recording, random }.work(killed));
            }
            thread::sleep(Duration::from_millis(random.random_range(LIFE_MS)));
            server.kill();
            killed.store(true, Ordering::Relaxed);
        });
        lock(&ledger).outcome.kills += 1;
    }
    let mut server = start();
    check(&server, &ledger);
    check_jobs(&server, &ledger);
    server.terminate();
    let mut last = start();
    last.terminate();
    let Ledger { mut outcome, .. } = ledger.into_inner().unwrap_or_else(PoisonError::into_inner);
    outcome.faults.extend(folder_store::faults(folder));
    outcome
}

fn token(tenant: u64) -> String {
    format!("0123456789abcdef-{tenant}")
}

fn bearer(tenant: u64) -> String {
    format!("Bearer {}", token(tenant))
}

fn lock(ledger: &Mutex<Ledger>) -> std::sync::MutexGuard<'_, Ledger> {
    ledger.lock().unwrap_or_else(PoisonError::into_inner)
}

/// How often what was deleted while it was stored is sent again.
const SENT_AGAIN: usize = 5;

/// A client that does one thing after another until the service is gone.
struct Client<'a> {
    url: &'a str,
    tenant: u64,
    ledger: &'a Mutex<Ledger>,
    recording: &'a str,
    random: Pcg64Mcg,
}

impl Client<'_> {
    fn work(mut self, killed: &AtomicBool) {
        while !killed.load(Ordering::Relaxed) {
            let done = match self.random.random_range(0..10) {
                0 => {
                    let z: Vec<f64> = (0..3000).map(|_| self.random.random_range(0.0..50.0)).collect();
                    self.upload("/v1/maps", "application/json", map(&z))
                }
                1 => self.share(),
                2..4 => {
                    let run = format!("drive-{}", self.random.random::<u64>());
                    self.upload("/v1/recordings", "text/csv", drive_csv(1, 300).replace("drive-0", &run))
                }
                // Half of all that is asked, so that about as much goes as comes.
                4..9 => self.delete(),
                _ => self.job(),
            };
            if done.is_none() {
                lock(self.ledger).outcome.cut_off += 1;
                return;
            }
        }
    }

    /// `None`: the service was gone before it answered.
    fn upload(&mut self, path: &str, kind: &str, body: String) -> Option<()> {
        let (status, answer) = self.post(path, kind, body)?;
        let mut ledger = lock(self.ledger);
        match answer["id"].as_str().filter(|_| status == 201) {
            Some(id) => {
                ledger.paths.insert((self.tenant, format!("{path}/{id}")), Known::There);
                ledger.outcome.uploads += 1;
            }
            None => ledger.outcome.faults.push(format!("an upload was answered by {status}: {answer}")),
        }
        Some(())
    }

    /// Stores a map that other tenants store as well, whether this one has it or not.
    fn share(&mut self) -> Option<()> {
        let which = self.random.random_range(0..SHARED_MAPS);
        {
            let mut ledger = lock(self.ledger);
            let path = ledger.shared.get(&which).cloned().map(|path| (self.tenant, path));
            if let Some(path) = path.filter(|path| ledger.paths.get(path) != Some(&Known::There)) {
                ledger.paths.insert(path, Known::Either);
            }
        }
        let body = map(&vec![which as f64; 3000]);
        let (mut status, mut answer) = self.post("/v1/maps", "application/json", body.clone())?;
        // One that another tenant deleted meanwhile is to be sent again, as the answer says.
        for _ in 0..SENT_AGAIN {
            if status != 503 || !answer["detail"].as_str().is_some_and(|said| said.ends_with("send it again"))
            {
                break;
            }
            (status, answer) = self.post("/v1/maps", "application/json", body.clone())?;
        }
        let mut ledger = lock(self.ledger);
        let Some(id) = answer["id"].as_str().filter(|_| matches!(status, 200 | 201)) else {
            ledger.outcome.faults.push(format!("a shared map was answered by {status}: {answer}"));
            return Some(());
        };
        let path = format!("/v1/maps/{id}");
        ledger.shared.insert(which, path.clone());
        let before = ledger.paths.insert((self.tenant, path), Known::There);
        if before == Some(Known::There) && status != 200 {
            ledger.outcome.faults.push(format!("a shared map was there, but answered by {status}"));
        }
        ledger.outcome.uploads += 1;
        Some(())
    }

    fn post(&self, path: &str, kind: &str, body: String) -> Option<(u16, Value)> {
        let request = agent().post(format!("{}{path}", self.url)).content_type(kind);
        ask(request.header("authorization", bearer(self.tenant)).send(body))
    }

    fn delete(&mut self) -> Option<()> {
        let path = {
            let mut ledger = lock(self.ledger);
            let there: Vec<&String> = ledger
                .paths
                .iter()
                .filter(|((tenant, _), known)| *tenant == self.tenant && **known == Known::There)
                .map(|((_, path), _)| path)
                .collect();
            if there.is_empty() {
                return Some(());
            }
            let path = there[self.random.random_range(0..there.len())].clone();
            ledger.paths.insert((self.tenant, path.clone()), Known::Either);
            path
        };
        let request = agent().delete(format!("{}{path}", self.url));
        let (status, answer) = ask(request.header("authorization", bearer(self.tenant)).call())?;
        let mut ledger = lock(self.ledger);
        if status == 204 {
            ledger.paths.insert((self.tenant, path), Known::Gone);
            ledger.outcome.deletes += 1;
        } else {
            ledger.outcome.faults.push(format!("deleting {path} was answered by {status}: {answer}"));
        }
        Some(())
    }

    fn job(&mut self) -> Option<()> {
        // Each another robot, and so another job.
        let mass_kg = self.random.random_range(50.0..100.0);
        let request = agent().get(format!("{}/v1/robots/husky-a200", self.url));
        let (_, mut robot) = ask(request.header("authorization", bearer(self.tenant)).call())?;
        robot["mass_kg"] = json!(mass_kg);
        let body = json!({ "robot": robot, "recordings": [self.recording] }).to_string();
        let (status, answer) = self.post("/v1/calibrate", "application/json", body)?;
        let mut ledger = lock(self.ledger);
        match (status, answer["id"].as_str()) {
            (202, Some(id)) => {
                ledger.jobs.insert((self.tenant, format!("/v1/jobs/{id}")));
                ledger.outcome.jobs += 1;
            }
            // As many wait as may.
            (429 | 503, _) => {}
            _ => ledger.outcome.faults.push(format!("a job was answered by {status}: {answer}")),
        }
        Some(())
    }
}

/// Status and document of an answer; `None` when the service was gone before all of it had come.
fn ask(answer: Result<ureq::http::Response<ureq::Body>, ureq::Error>) -> Option<(u16, Value)> {
    let mut response = answer.ok()?;
    let mut text = String::new();
    response.body_mut().as_reader().read_to_string(&mut text).ok()?;
    Some((response.status().as_u16(), serde_json::from_str(&text).unwrap_or(Value::Null)))
}

/// A map of 50 × 60 cells.
fn map(elevation_m: &[f64]) -> String {
    let rows: Vec<&[f64]> = elevation_m.chunks(60).collect();
    json!({ "cell_size_m": 1.0, "rows": 50, "columns": 60, "elevation_m": rows }).to_string()
}

/// Looks at everything that was acknowledged, and whether everything that is listed can be read.
fn check(server: &Server, ledger: &Mutex<Ledger>) {
    let mut ledger = lock(ledger);
    let mut faults = Vec::new();
    let get = |tenant: u64, path: &str| server.ask_as(&token(tenant), "GET", path, &Value::Null);
    for ((tenant, path), known) in &mut ledger.paths {
        let status = get(*tenant, path).status;
        match (status, *known) {
            (200, Known::There) | (404, Known::Gone) => {}
            // A request that was cut off was done or was not.
            (200, Known::Either) => *known = Known::There,
            (404, Known::Either) => *known = Known::Gone,
            (_, known) => faults.push(format!("{path} must be {known:?}, but is answered by {status}")),
        }
    }
    for tenant in 0..CLIENTS {
        for (path, list) in [("/v1/maps", "maps"), ("/v1/recordings", "recordings")] {
            for entry in get(tenant, path).json()[list].as_array().into_iter().flatten() {
                let path = format!("{path}/{}", entry["id"].as_str().unwrap_or_default());
                let found = get(tenant, &path);
                if found.status != 200 {
                    let (status, text) = (found.status, found.text);
                    faults.push(format!("{path} is listed, but is answered by {status}: {text}"));
                }
                if !path.ends_with(&ledger.recording) {
                    // An upload that was cut off, and done all the same.
                    ledger.paths.entry((tenant, path)).or_insert(Known::There);
                }
            }
        }
    }
    for (tenant, job) in &ledger.jobs {
        let status = get(*tenant, job).status;
        if status != 200 {
            faults.push(format!("{job} was accepted, but is answered by {status}"));
        }
    }
    ledger.outcome.faults.extend(faults);
}

/// Follows every accepted job to its end: done, or given up after two services died that worked on it.
fn check_jobs(server: &Server, ledger: &Mutex<Ledger>) {
    let mut ledger = lock(ledger);
    let jobs = ledger.jobs.clone();
    for (tenant, job) in jobs {
        let events = server.ask_as(&token(tenant), "GET", &format!("{job}/events"), &Value::Null).text;
        let last = events.lines().filter_map(|line| line.strip_prefix("data: ")).next_back();
        let last: Value = last.and_then(|data| serde_json::from_str(data).ok()).unwrap_or_default();
        let attempts = last["attempt"].as_u64().unwrap_or(0);
        let is_given_up = last["problem"]["type"] == "abandoned" && attempts >= 2;
        if last["state"] != "done" && !is_given_up {
            ledger.outcome.faults.push(format!("{job} ended otherwise than done or given up: {last}"));
        }
        ledger.outcome.taken_up_again += usize::from(attempts > 1);
        ledger.outcome.given_up += usize::from(is_given_up);
    }
}
