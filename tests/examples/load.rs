//! Loads a running service and prints what it stood: mixed goals, one hot goal, memory, and four times what it can do.
//!
//! `cargo run --release -p joulepath-tests --example load -- [--seconds 60] [--side 1000] [--requests 20000]`, after
//! `cargo build --release`. Every client asks again as soon as it is answered, so that 32 of them wait for each other.

#![allow(clippy::unwrap_used)]

use std::{
    cell::RefCell,
    rc::Rc,
    time::{Duration, Instant},
};

use http_body_util::{BodyExt, Full};
use hyper::{Request, body::Bytes, client::conn::http1::SendRequest};
use hyper_util::rt::TokioIo;
use joulepath_tests::{Server, file};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use serde_json::{Value, json};
use terrain::{
    Terrain,
    io::{json::JsonText, read_path},
    synthetic::mirrored,
};

/// Clients at the same time.
const CLIENTS: usize = 32;
/// Goals that are asked for in turns.
const GOALS: usize = 16;
/// Connections of the overload, which are all that it needs: who is refused is so at once.
const CROWD: usize = 256;

fn main() {
    let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build().unwrap();
    tokio::task::LocalSet::new().block_on(&runtime, run());
}

async fn run() {
    let (seconds, side, requests) =
        (option("--seconds", 60), option("--side", 1000), option("--requests", 20_000));
    let server = Server::start();
    let terrain = mirrored(&read_path(&file("maps/minnesota.tif")).unwrap(), side, side).unwrap();
    let places = Rc::new(Places::new(&server, &terrain));
    let time = Duration::from_secs(seconds as u64);
    let address: Rc<str> = server.url.trim_start_matches("http://").into();
    println!("{side} × {side} cells, {CLIENTS} clients");

    let mixed: Questions = {
        let places = Rc::clone(&places);
        Rc::new(move |random| places.mixed(random))
    };
    closed(&address, CLIENTS, Until::Requests(20 * GOALS), &mixed).await;
    let found = closed(&address, CLIENTS, Until::Time(time), &mixed).await;
    found.print("mixed goals, bound 1.05");
    let capacity = found.answered() as f64 / found.time.as_secs_f64();

    let before = server.metric("joulepath_resident_memory_bytes");
    let many = closed(&address, CLIENTS, Until::Requests(requests), &mixed).await;
    let after = server.metric("joulepath_resident_memory_bytes");
    many.print(&format!("{requests} requests"));
    println!(
        "memory            {:.1} MB before, {:.1} MB after, {:+.1} %",
        before / 1e6,
        after / 1e6,
        100.0 * (after / before - 1.0)
    );

    let goal = places.hold(&server);
    let hot: Questions = {
        let places = Rc::clone(&places);
        Rc::new(move |random| places.hot(&goal, random))
    };
    let walks = closed(&address, CLIENTS, Until::Time(time / 4), &hot).await;
    walks.print("hot goal, held");

    let errors: usize = [&found, &many, &walks].iter().map(|found| found.errors).sum();
    let refused: usize = [&found, &many, &walks].iter().map(|found| found.refused_ms.len()).sum();
    let rate = 4.0 * capacity;
    let flood = open(&address, rate, time / 2, &mixed).await;
    flood.print(&format!("overload, {rate:.0}/s asked"));
    assert_eq!(errors + flood.errors, 0, "some requests were neither answered nor refused");
    assert_eq!(refused, 0, "requests were refused that should have waited");
}

/// The value of a flag.
fn option(name: &str, default: usize) -> usize {
    let words: Vec<String> = std::env::args().collect();
    let at = words.iter().position(|word| word == name);
    at.and_then(|at| words.get(at + 1)?.parse().ok()).unwrap_or(default)
}

type Questions = Rc<dyn Fn(&mut Pcg64) -> String>;

/// A stored map, and places on it between which there is a path.
struct Places {
    map_id: Value,
    places_m: Vec<[f64; 2]>,
}

impl Places {
    fn new(server: &Server, terrain: &Terrain) -> Self {
        let body: Vec<u8> = JsonText::of(terrain).flatten().collect();
        let stored = server.post("/v1/maps", "application/json", &body);
        assert!(stored.status < 300, "{}", stored.text);
        let mut places = Places { map_id: stored.json()["id"].clone(), places_m: Vec::new() };
        let mut random = Pcg64::seed_from_u64(7);
        let center_m = terrain.grid.at_fraction_m(0.5, 0.5);
        while places.places_m.len() < 4 * GOALS {
            let [x, y] = [random.random_range(0.05..0.95), random.random_range(0.05..0.95)];
            let place = terrain.grid.at_fraction_m(x, y);
            if server.post("/v1/plan", "application/json", places.question(place, center_m).as_bytes()).status
                == 200
            {
                places.places_m.push(place);
            }
        }
        places
    }

    fn question(&self, start_m: [f64; 2], goal_m: [f64; 2]) -> String {
        let place = |[x, y]: [f64; 2]| json!({ "x_m": x, "y_m": y });
        json!({
            "map_id": self.map_id, "robot": "husky-a200", "start": place(start_m), "goal": place(goal_m),
            "bound": 1.05, "refine": false, "snap_radius_m": 10.0
        })
        .to_string()
    }

    fn mixed(&self, random: &mut Pcg64) -> String {
        let start = random.random_range(GOALS..self.places_m.len());
        self.question(self.places_m[start], self.places_m[random.random_range(0..GOALS)])
    }

    /// Keeps the cost from everywhere to a place.
    fn hold(&self, server: &Server) -> [f64; 2] {
        let goal = self.places_m[0];
        let mut question: Value = serde_json::from_str(&self.question(self.places_m[1], goal)).unwrap();
        question["hold_goal"] = json!(true);
        assert_eq!(server.post_json("/v1/plan", &question).status, 200);
        goal
    }

    /// From about twenty metres away.
    fn hot(&self, goal: &[f64; 2], random: &mut Pcg64) -> String {
        let mut beside = || 20.0 * (random.random::<f64>() - 0.5);
        self.question([goal[0] + beside(), goal[1] + beside()], *goal)
    }
}

/// When to stop asking.
#[derive(Clone, Copy)]
enum Until {
    Requests(usize),
    Time(Duration),
}

/// What a run found.
#[derive(Default)]
struct Found {
    time: Duration,
    /// How long answers and refusals took [ms].
    answered_ms: Vec<f64>,
    refused_ms: Vec<f64>,
    /// Anything but an answer and a refusal.
    errors: usize,
    bytes: usize,
}

impl Found {
    fn answered(&self) -> usize {
        self.answered_ms.len()
    }

    fn print(&self, what: &str) {
        let rate = |count: usize| count as f64 / self.time.as_secs_f64();
        let percentile = |times: &[f64], share: f64| {
            let mut sorted = times.to_vec();
            sorted.sort_by(f64::total_cmp);
            sorted
                .get(((sorted.len() as f64 * share) as usize).min(sorted.len().saturating_sub(1)))
                .copied()
                .unwrap_or(0.0)
        };
        let (answered, refused) = (&self.answered_ms, &self.refused_ms);
        println!(
            "{what:<26}{:8.0}/s  p50 {:6.1} ms  p99 {:6.1} ms  refused {} ({:.0}/s, p99 {:.1} ms)  errors {}  {:.1} kB each",
            rate(answered.len()),
            percentile(answered, 0.5),
            percentile(answered, 0.99),
            refused.len(),
            rate(refused.len()),
            percentile(refused, 0.99),
            self.errors,
            self.bytes as f64 / 1e3 / answered.len().max(1) as f64
        );
    }

    fn count(&mut self, outcome: Option<(u16, usize)>, took: Duration) {
        let took_ms = took.as_secs_f64() * 1e3;
        match outcome {
            Some((200, bytes)) => {
                self.answered_ms.push(took_ms);
                self.bytes += bytes;
            }
            Some((503, _)) => self.refused_ms.push(took_ms),
            _ => self.errors += 1,
        }
    }
}

/// Clients that ask again as soon as they are answered.
async fn closed(address: &Rc<str>, clients: usize, until: Until, questions: &Questions) -> Found {
    let found = Rc::new(RefCell::new(Found::default()));
    let left = Rc::new(RefCell::new(match until {
        Until::Requests(requests) => requests,
        Until::Time(_) => usize::MAX,
    }));
    let began = Instant::now();
    let clients: Vec<_> = (0..clients)
        .map(|i| {
            let (found, left, questions) = (Rc::clone(&found), Rc::clone(&left), Rc::clone(questions));
            let address = Rc::clone(address);
            tokio::task::spawn_local(async move {
                let mut random = Pcg64::seed_from_u64(i as u64);
                let mut sender = connect(&address).await;
                while *left.borrow() > 0 && !matches!(until, Until::Time(time) if began.elapsed() >= time) {
                    *left.borrow_mut() -= 1;
                    let question = questions(&mut random);
                    let asked = Instant::now();
                    let outcome = ask(&mut sender, question).await;
                    found.borrow_mut().count(outcome, asked.elapsed());
                    if outcome.is_none() {
                        sender = connect(&address).await;
                    }
                }
            })
        })
        .collect();
    for client in clients {
        client.await.unwrap();
    }
    let mut found = Rc::into_inner(found).unwrap().into_inner();
    found.time = began.elapsed();
    found
}

/// So many questions a second, whether the earlier ones are answered or not.
async fn open(address: &Rc<str>, rate: f64, time: Duration, questions: &Questions) -> Found {
    let found = Rc::new(RefCell::new(Found::default()));
    let began = Instant::now();
    // One clock for all: each of the crowd takes the next question that is due.
    let next = Rc::new(RefCell::new(0usize));
    let crowd: Vec<_> = (0..CROWD)
        .map(|i| {
            let (found, next, questions) = (Rc::clone(&found), Rc::clone(&next), Rc::clone(questions));
            let address = Rc::clone(address);
            tokio::task::spawn_local(async move {
                let mut random = Pcg64::seed_from_u64(i as u64);
                let mut sender = connect(&address).await;
                loop {
                    let due = Duration::from_secs_f64(next.replace_with(|next| *next + 1) as f64 / rate);
                    if due >= time {
                        return;
                    }
                    tokio::time::sleep_until((began + due).into()).await;
                    let question = questions(&mut random);
                    let asked = Instant::now();
                    let outcome = ask(&mut sender, question).await;
                    found.borrow_mut().count(outcome, asked.elapsed());
                    if outcome.is_none() {
                        sender = connect(&address).await;
                    }
                }
            })
        })
        .collect();
    for client in crowd {
        client.await.unwrap();
    }
    let mut found = Rc::into_inner(found).unwrap().into_inner();
    found.time = began.elapsed();
    found
}

async fn connect(address: &str) -> SendRequest<Full<Bytes>> {
    let stream = tokio::net::TcpStream::connect(address).await.unwrap();
    stream.set_nodelay(true).unwrap();
    let (sender, connection) = hyper::client::conn::http1::handshake(TokioIo::new(stream)).await.unwrap();
    tokio::task::spawn_local(connection);
    sender
}

/// Status and size of an answer; none where the connection broke.
async fn ask(sender: &mut SendRequest<Full<Bytes>>, question: String) -> Option<(u16, usize)> {
    sender.ready().await.ok()?;
    let request = Request::post("/v1/plan")
        .header("host", "localhost")
        .header("content-type", "application/json")
        .body(Full::new(Bytes::from(question)))
        .ok()?;
    let response = sender.send_request(request).await.ok()?;
    let status = response.status().as_u16();
    let bytes = response.into_body().collect().await.ok()?.to_bytes();
    Some((status, bytes.len()))
}
