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

/// Clients that talk to the service at the same time.
const CLIENTS: u64 = 4;
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
    /// Everything that was not as it had been acknowledged.
    pub faults: Vec<String>,
}

/// What clients know.
#[derive(Debug, Default)]
struct Ledger {
    /// What each path must be: there, gone, or either, while a request for it is under way or was cut off.
    paths: BTreeMap<String, Known>,
    jobs: BTreeSet<String>,
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
    let driven = drive_csv(2, 200);
    let recording = Server::start_over(folder).post("/v1/recordings", "text/csv", driven.as_bytes()).json();
    let recording = recording["id"].as_str().unwrap_or_default().to_owned();
    let ledger = Mutex::new(Ledger { recording: recording.clone(), ..Ledger::default() });
    for kill in 0..kills {
        let mut server = Server::start_over(folder);
        check(&server, &ledger);
        let killed = AtomicBool::new(false);
        let url = server.url.clone();
        thread::scope(|scope| {
            for client in 0..CLIENTS {
                let random = Pcg64Mcg::seed_from_u64(seed ^ (1 + kill as u64 * CLIENTS + client));
                let (ledger, killed, recording, url) = (&ledger, &killed, &recording, &url);
                scope.spawn(move || Client { url, ledger, recording, random }.work(killed));
            }
            thread::sleep(Duration::from_millis(random.random_range(LIFE_MS)));
            server.kill();
            killed.store(true, Ordering::Relaxed);
        });
        lock(&ledger).outcome.kills += 1;
    }
    let mut server = Server::start_over(folder);
    check(&server, &ledger);
    check_jobs(&server, &ledger);
    server.terminate();
    let mut last = Server::start_over(folder);
    last.terminate();
    let Ledger { mut outcome, .. } = ledger.into_inner().unwrap_or_else(PoisonError::into_inner);
    outcome.faults.extend(folder_store::faults(folder));
    outcome
}

fn lock(ledger: &Mutex<Ledger>) -> std::sync::MutexGuard<'_, Ledger> {
    ledger.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A client that does one thing after another until the service is gone.
struct Client<'a> {
    url: &'a str,
    ledger: &'a Mutex<Ledger>,
    recording: &'a str,
    random: Pcg64Mcg,
}

impl Client<'_> {
    fn work(mut self, killed: &AtomicBool) {
        while !killed.load(Ordering::Relaxed) {
            let done = match self.random.random_range(0..10) {
                0..2 => {
                    let z: Vec<f64> = (0..3000).map(|_| self.random.random_range(0.0..50.0)).collect();
                    let rows: Vec<&[f64]> = z.chunks(60).collect();
                    let map = json!({ "cell_size_m": 1.0, "rows": 50, "columns": 60, "elevation_m": rows });
                    self.upload("/v1/maps", "application/json", map.to_string())
                }
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
        let (status, answer) =
            ask(agent().post(format!("{}{path}", self.url)).content_type(kind).send(body))?;
        let mut ledger = lock(self.ledger);
        match answer["id"].as_str().filter(|_| status == 201) {
            Some(id) => {
                ledger.paths.insert(format!("{path}/{id}"), Known::There);
                ledger.outcome.uploads += 1;
            }
            None => ledger.outcome.faults.push(format!("an upload was answered by {status}: {answer}")),
        }
        Some(())
    }

    fn delete(&mut self) -> Option<()> {
        let path = {
            let mut ledger = lock(self.ledger);
            let there: Vec<&String> = ledger
                .paths
                .iter()
                .filter(|(_, known)| **known == Known::There)
                .map(|(path, _)| path)
                .collect();
            if there.is_empty() {
                return Some(());
            }
            let path = there[self.random.random_range(0..there.len())].clone();
            ledger.paths.insert(path.clone(), Known::Either);
            path
        };
        let (status, answer) = ask(agent().delete(format!("{}{path}", self.url)).call())?;
        let mut ledger = lock(self.ledger);
        if status == 204 {
            ledger.paths.insert(path, Known::Gone);
            ledger.outcome.deletes += 1;
        } else {
            ledger.outcome.faults.push(format!("deleting {path} was answered by {status}: {answer}"));
        }
        Some(())
    }

    fn job(&mut self) -> Option<()> {
        // Each another robot, and so another job.
        let mass_kg = self.random.random_range(50.0..100.0);
        let (_, mut robot) = ask(agent().get(format!("{}/v1/robots/husky-a200", self.url)).call())?;
        robot["mass_kg"] = json!(mass_kg);
        let body = json!({ "robot": robot, "recordings": [self.recording] }).to_string();
        let asked =
            agent().post(format!("{}/v1/calibrate", self.url)).content_type("application/json").send(body);
        let (status, answer) = ask(asked)?;
        let mut ledger = lock(self.ledger);
        match (status, answer["id"].as_str()) {
            (202, Some(id)) => {
                ledger.jobs.insert(format!("/v1/jobs/{id}"));
                ledger.outcome.jobs += 1;
            }
            // As many wait as may.
            (503, _) => {}
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

/// Looks at everything that was acknowledged, and whether everything that is listed can be read.
fn check(server: &Server, ledger: &Mutex<Ledger>) {
    let mut ledger = lock(ledger);
    let mut faults = Vec::new();
    for (path, known) in &mut ledger.paths {
        let status = server.get(path).status;
        match (status, *known) {
            (200, Known::There) | (404, Known::Gone) => {}
            // A delete that was cut off was done or was not.
            (200, Known::Either) => *known = Known::There,
            (404, Known::Either) => *known = Known::Gone,
            (_, known) => faults.push(format!("{path} must be {known:?}, but is answered by {status}")),
        }
    }
    for (path, list) in [("/v1/maps", "maps"), ("/v1/recordings", "recordings")] {
        for entry in server.get(path).json()[list].as_array().into_iter().flatten() {
            let path = format!("{path}/{}", entry["id"].as_str().unwrap_or_default());
            let found = server.get(&path);
            if found.status != 200 {
                faults.push(format!("{path} is listed, but is answered by {}: {}", found.status, found.text));
            }
            if !path.ends_with(&ledger.recording) {
                // An upload that was cut off, and done all the same.
                ledger.paths.entry(path).or_insert(Known::There);
            }
        }
    }
    for job in &ledger.jobs {
        let status = server.get(job).status;
        if status != 200 {
            faults.push(format!("{job} was accepted, but is answered by {status}"));
        }
    }
    ledger.outcome.faults.extend(faults);
}

/// Follows every accepted job to its end.
fn check_jobs(server: &Server, ledger: &Mutex<Ledger>) {
    let mut ledger = lock(ledger);
    let jobs = ledger.jobs.clone();
    for job in jobs {
        let events = server.events(&format!("{job}/events"), None);
        let last = events.last().map_or(Value::Null, |event| event.data);
        if last["state"] != "done" {
            ledger.outcome.faults.push(format!("{job} ended otherwise than done: {last}"));
        }
        ledger.outcome.taken_up_again += usize::from(last["attempt"].as_u64().unwrap_or(0) > 1);
    }
}
