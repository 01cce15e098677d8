//! Asks a running service about robots whose every field lies at the edge of its range, with deadlines, and prints what it stood.
//!
//! `cargo run --release -p joulepath-tests --example extreme_robots -- [--minutes 30] [--seed 1] [--late-ms 50]`, after
//! `cargo build --release`. Fails on any answer of the class 5xx but 503, 504 and 507, on more memory than the limits and a
//! tenth, and, where `--late-ms` is given, on an answer later than its deadline by more.

#![allow(clippy::unwrap_used)]

use std::{
    collections::BTreeMap,
    time::{Duration, Instant},
};

use joulepath_tests::{
    Server,
    extremes::{self, Ground},
    file,
};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde_json::json;
use terrain::{
    io::{json::JsonText, read_path},
    synthetic::mirrored,
};

/// Most memory of requests, planners and maps that the service is given [bytes].
const LIMITS: [(&str, u64); 3] = [
    ("--request-memory-bytes", 400_000_000),
    ("--kept-bytes", 200_000_000),
    ("--kept-map-bytes", 100_000_000),
];
/// Time of a request that names none [s].
const PLAN_TIME_S: f64 = 2.0;
/// How often the machine's memory is read.
const MEMORY_EVERY: usize = 16;

fn main() {
    let seconds = 60.0 * option("--minutes").unwrap_or(30.0);
    let seed = option("--seed").unwrap_or(1.0) as u64;
    let mut trial = Trial::new(seed, option("--late-ms"));
    let end = Instant::now() + Duration::from_secs_f64(seconds);
    while Instant::now() < end {
        trial.ask();
    }
    trial.print();
    assert!(trial.faults.is_empty(), "{} faults, the first: {}", trial.faults.len(), trial.faults[0]);
}

/// The value of a flag.
fn option(name: &str) -> Option<f64> {
    let words: Vec<String> = std::env::args().collect();
    let at = words.iter().position(|word| word == name)?;
    words.get(at + 1)?.parse().ok()
}

struct Trial {
    server: Server,
    random: Pcg64,
    /// Maps that the service keeps.
    stored: Vec<Ground>,
    late_ms: Option<f64>,
    idle_bytes: u64,
    most_bytes: u64,
    asked: usize,
    statuses: BTreeMap<u16, usize>,
    /// Worst lateness of each endpoint [ms].
    overruns_ms: BTreeMap<String, f64>,
    faults: Vec<String>,
}

impl Trial {
    fn new(seed: u64, late_ms: Option<f64>) -> Self {
        let limits = LIMITS.map(|(flag, bytes)| [flag.to_owned(), bytes.to_string()]).concat();
        let time = ["--plan-time-s".to_owned(), PLAN_TIME_S.to_string()];
        let arguments: Vec<&str> = limits.iter().chain(&time).map(String::as_str).collect();
        let server = Server::start_with(&arguments);
        let idle_bytes = server.resident_memory_bytes().unwrap_or(0);
        let ground = read_path(&file("maps/minnesota.tif")).unwrap();
        let stored = [60, 300, 900].map(|side| {
            let terrain = mirrored(&ground, side, side).unwrap();
            let body = JsonText::of(&terrain).flatten().collect::<Vec<u8>>();
            let answer = server.post("/v1/maps", "application/json", &body);
            assert!(answer.status < 300, "{}", answer.text);
            Ground {
                fields: json!({ "map_id": answer.json()["id"] }),
                low_m: terrain.grid.at_fraction_m(0.0, 0.0),
                high_m: terrain.grid.at_fraction_m(1.0, 1.0),
            }
        });
        Trial {
            server,
            random: Pcg64::seed_from_u64(seed),
            stored: stored.to_vec(),
            late_ms,
            idle_bytes,
            most_bytes: 0,
            asked: 0,
            statuses: BTreeMap::new(),
            overruns_ms: BTreeMap::new(),
            faults: Vec::new(),
        }
    }

    /// Asks one random question and judges the answer.
    fn ask(&mut self) {
        let random = &mut self.random;
        let endpoint = extremes::ENDPOINTS[random.random_range(0..extremes::ENDPOINTS.len())];
        let ground = match random.random_range(0..3) {
            0 => self.stored[random.random_range(0..self.stored.len())].clone(),
            _ => Ground::inline(random),
        };
        let timeout_s = extremes::timeout_s(random);
        let request = extremes::request(random, endpoint, &ground, timeout_s);
        let body = request.to_string();
        let began = Instant::now();
        let answer = self.server.post(endpoint, "application/json", body.as_bytes());
        let overrun_ms = 1e3 * (began.elapsed().as_secs_f64() - timeout_s.min(PLAN_TIME_S));
        self.asked += 1;
        *self.statuses.entry(answer.status).or_default() += 1;
        let worst = self.overruns_ms.entry(endpoint.to_owned()).or_insert(f64::MIN);
        *worst = worst.max(overrun_ms);
        if answer.status >= 500 && ![503, 504, 507].contains(&answer.status) {
            self.fault(endpoint, &body, &format!("{}: {}", answer.status, answer.text));
        }
        if self.late_ms.is_some_and(|late_ms| overrun_ms > late_ms) {
            self.fault(endpoint, &body, &format!("{overrun_ms:.0} ms late"));
        }
        if self.asked.is_multiple_of(MEMORY_EVERY) {
            self.look_at_memory();
        }
    }

    fn look_at_memory(&mut self) {
        let bytes = self.server.resident_memory_bytes().unwrap_or(0);
        self.most_bytes = self.most_bytes.max(bytes);
        if bytes as f64 > self.allowed_bytes() {
            self.fault("memory", "", &format!("{} MB", bytes / 1_000_000));
        }
    }

    /// The limits and a tenth, beside what the service takes when nothing was asked.
    fn allowed_bytes(&self) -> f64 {
        let limits: u64 = LIMITS.iter().map(|(_, bytes)| bytes).sum();
        self.idle_bytes as f64 + 1.1 * limits as f64
    }

    /// Keeps a fault, with the question in a file that can be posted again.
    fn fault(&mut self, endpoint: &str, body: &str, what: &str) {
        let name = format!("extreme-robot-{}.json", self.asked);
        let kept = std::env::temp_dir().join(name);
        let _ = std::fs::write(&kept, body);
        let fault = format!("{endpoint} {what} ({})", kept.display());
        println!("fault: {fault}");
        self.faults.push(fault);
    }

    fn print(&self) {
        println!("asked              {}", self.asked);
        for (status, count) in &self.statuses {
            println!("status {status}         {count}");
        }
        for (endpoint, worst_ms) in &self.overruns_ms {
            println!("latest             {worst_ms:+.1} ms after the deadline, {endpoint}");
        }
        println!(
            "memory             {} MB at most, {:.0} MB allowed",
            self.most_bytes / 1_000_000,
            self.allowed_bytes() / 1e6
        );
        println!("faults             {}", self.faults.len());
    }
}
