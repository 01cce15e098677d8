//! Drives each endpoint into each of its long steps and prints how much later than its deadline it answers.
//!
//! `cargo run --release -p joulepath-tests --example overruns -- [--side 1400] [--most-ms 50] [--most-held-ms 1000] [--only compare]`,
//! after `cargo build --release`. Every question is asked with each of [`DEADLINES_S`], so that the deadline falls into one step
//! after another. A job has no deadline of its own: it is cancelled, and late is the time until its turn is free, which may
//! take a second: the service looks at the store for the wish twice a second.

#![allow(clippy::unwrap_used)]

use std::time::{Duration, Instant};

use joulepath_tests::{Server, drive_csv, file};
use serde_json::{Value, json};
use terrain::{
    Grid, Terrain,
    io::{json::JsonText, read_path},
    synthetic::mirrored,
};

/// Deadlines of every question [s].
const DEADLINES_S: [f64; 9] = [0.01, 0.03, 0.06, 0.1, 0.1, 0.2, 0.4, 0.8, 1.6];
/// Times after which a job is cancelled [s].
const CANCELLED_S: [f64; 6] = [0.1, 0.3, 1.0, 3.0, 6.0, 10.0];
/// Longest wait for a cancelled job's turn to be free [s].
const LONGEST_WAIT_S: f64 = 60.0;

fn main() {
    let side = option("--side", 1400.0) as usize;
    let only = word_after("--only").unwrap_or_default();
    let trial = Trial::new(side);
    let (mut late_ms, mut held_ms) = (0.0_f64, 0.0_f64);
    println!("{:<44} {:>12}  after each deadline [ms]: status", "question", "latest");
    for question in trial.questions().iter().filter(|question| question.name.contains(&only)) {
        let answers = trial.ask(question);
        let latest_ms = answers.iter().map(|(late_ms, _)| *late_ms).fold(f64::MIN, f64::max);
        late_ms = late_ms.max(latest_ms);
        let each: Vec<String> =
            answers.iter().map(|(late_ms, status)| format!("{late_ms:+.0}: {status}")).collect();
        println!("{:<44} {latest_ms:>+9.1} ms  {}", question.name, each.join(", "));
    }
    for job in trial.jobs().iter().filter(|job| job.name.contains(&only)) {
        let latest_ms = trial.cancel(job);
        held_ms = held_ms.max(latest_ms);
        println!("{:<44} {latest_ms:>+9.1} ms  cancelled", job.name);
    }
    println!("latest answer {late_ms:+.1} ms after its deadline, longest cancelled job {held_ms:.1} ms");
    for (worst_ms, name, most_ms) in [(late_ms, "--most-ms", 50.0), (held_ms, "--most-held-ms", 1000.0)] {
        let most_ms = option(name, most_ms);
        assert!(worst_ms < most_ms, "{worst_ms:.1} ms, {most_ms} ms are allowed ({name})");
    }
}

/// The value of a flag.
fn option(name: &str, default: f64) -> f64 {
    word_after(name).and_then(|word| word.parse().ok()).unwrap_or(default)
}

/// The word after a flag.
fn word_after(name: &str) -> Option<String> {
    std::env::args().skip_while(|word| word != name).nth(1)
}

/// A request without its deadline.
struct Question {
    name: String,
    path: &'static str,
    body: Value,
}

struct Trial {
    server: Server,
    /// Hilly ground that needs all of a search.
    hills: Stored,
    /// Walls with gaps at alternating ends: the path is as long as the map is large.
    maze: Stored,
    recordings: Vec<Value>,
}

struct Stored {
    id: Value,
    grid: Grid,
}

impl Stored {
    fn new(server: &Server, terrain: &Terrain) -> Self {
        let body = JsonText::of(terrain).flatten().collect::<Vec<u8>>();
        let answer = server.post("/v1/maps", "application/json", &body);
        assert!(answer.status < 300, "{}", answer.text);
        Stored { id: answer.json()["id"].clone(), grid: terrain.grid }
    }

    fn place(&self, x: f64, y: f64) -> Value {
        let [x_m, y_m] = self.grid.at_fraction_m(x, y);
        json!({ "x_m": x_m, "y_m": y_m })
    }

    /// A question over this map, from its south-west to its north-east, with more fields.
    fn ask(&self, fields: &Value) -> Value {
        let mut body = json!({ "map_id": self.id, "robot": "husky-a200", "start": self.place(0.06, 0.06), "snap_radius_m": 30.0 });
        for (name, value) in fields.as_object().unwrap() {
            body[name] = value.clone();
        }
        body
    }

    fn to_goal(&self, fields: &Value) -> Value {
        let mut body = self.ask(fields);
        body["goal"] = self.place(0.93, 0.91);
        body
    }
}

impl Trial {
    fn new(side: usize) -> Self {
        let server = Server::start_with(&[
            "--plan-states",
            "1000000000",
            "--plan-time-s",
            "120",
            "--kept-bytes",
            "8000000000",
        ]);
        let ground = read_path(&file("maps/minnesota.tif")).unwrap();
        let hills = Stored::new(&server, &mirrored(&ground, side, side).unwrap());
        let maze = Stored::new(&server, &maze(side));
        let recordings = [(2, 20_000), (2, 500_000)].map(|(runs, rows)| {
            let stored = server.post("/v1/recordings", "text/csv", drive_csv(runs, rows).as_bytes());
            assert!(stored.status < 300, "{}", stored.text);
            stored.json()["id"].clone()
        });
        Trial { server, hills, maze, recordings: recordings.to_vec() }
    }

    /// Asks with every deadline; how late each answer was [ms], and its status.
    fn ask(&self, question: &Question) -> Vec<(f64, u16)> {
        let mut answers = Vec::new();
        for (count, timeout_s) in DEADLINES_S.into_iter().enumerate() {
            let mut body = question.body.clone();
            body["timeout_s"] = json!(timeout_s);
            if body["robot"].is_object() {
                // Another name is another planner, with nothing at hand.
                body["robot"]["name"] = json!(format!("{}-{count}", question.name));
            }
            let began = Instant::now();
            let answer = self.server.post_json(question.path, &body);
            answers.push((1e3 * (began.elapsed().as_secs_f64() - timeout_s), answer.status));
        }
        answers
    }

    fn questions(&self) -> Vec<Question> {
        let question = |name: &str, path, body| Question { name: name.to_owned(), path, body };
        let (hills, maze) = (&self.hills, &self.maze);
        let none = json!({});
        let places = |count: usize| -> Value {
            (0..count)
                .map(|i| {
                    hills.place(
                        0.1 + 0.8 * ((7 * i) % 41) as f64 / 41.0,
                        0.1 + 0.8 * ((11 * i) % 43) as f64 / 43.0,
                    )
                })
                .collect()
        };
        let mut questions = vec![
            question("plan, field and search", "/v1/plan", hills.to_goal(&json!({ "robot": fresh_robot() }))),
            question("plan, search and refinement at hand", "/v1/plan", hills.to_goal(&none)),
            question("plan at bound 1.2", "/v1/plan", hills.to_goal(&json!({ "robot": fresh_robot(), "bound": 1.2 }))),
            question("plan, distance", "/v1/plan", hills.to_goal(&json!({ "objective": "distance", "reverse": true }))),
            question("plan, no rolling resistance", "/v1/plan", hills.to_goal(&json!({ "robot": smooth_robot(), "objective": "distance" }))),
            question("plan, exact costs to the goal", "/v1/plan", hills.to_goal(&json!({ "robot": fresh_robot(), "hold_goal": true }))),
            question("plan through a maze", "/v1/plan", maze.to_goal(&none)),
            question("plan within limits", "/v1/plan", hills.to_goal(&json!({ "max_time_s": 4000.0, "max_distance_m": 2500.0 }))),
            question("plan within a slope", "/v1/plan", hills.to_goal(&json!({ "max_slope_rad": 0.05 }))),
            question("alternatives", "/v1/alternatives", hills.to_goal(&json!({ "epsilon": 0.0, "count": 50 }))),
            question("matrix", "/v1/matrix", {
                let mut body = hills.ask(&json!({ "sources": places(50) }));
                body.as_object_mut().unwrap().remove("start");
                body
            }),
            question("reachable, there and back", "/v1/reachable", hills.ask(&json!({ "kind": "out-and-back", "energies_j": [1e3, 1e5, 1e6] }))),
            question("reachable, outward, fresh", "/v1/reachable", hills.ask(&json!({ "robot": fresh_robot(), "energies_j": [1e6] }))),
            question("range, many draws", "/v1/range", hills.to_goal(&json!({ "samples": 100_000 }))),
            question("range, own paths", "/v1/range", hills.to_goal(&json!({ "samples": 100, "replanned": 100 }))),
            question("range there and back", "/v1/range", hills.to_goal(&json!({ "return": true }))),
            question("range without a goal", "/v1/range", hills.ask(&json!({ "robot": endless_robot(), "samples": 100_000 }))),
            question("range without a goal, and back", "/v1/range", hills.ask(&json!({ "return": true }))),
            question("mission of 12", "/v1/mission", hills.ask(&json!({ "waypoints": places(12), "samples": 100_000 }))),
            question("mission of 40", "/v1/mission", hills.ask(&json!({ "waypoints": places(40), "return": true }))),
            question("mission with a charger and a deadline", "/v1/mission", hills.ask(&json!({
                "waypoints": places(9), "deadline_s": 50_000.0, "charge": 0.5,
                "chargers": [{ "x_m": hills.place(0.5, 0.5)["x_m"], "y_m": hills.place(0.5, 0.5)["y_m"], "power_w": 200.0 }]
            }))),
        ];
        for (name, robot) in
            [("lattice of a huge robot", huge_robot()), ("lattice of tiny cells", fresh_robot())]
        {
            let map = json!({ "cell_size_m": 0.01, "origin_m": [0, 0], "rows": 12, "columns": 12, "elevation_m": vec![vec![0.0; 12]; 12] });
            let place = json!({ "x_m": 0.06, "y_m": 0.06 });
            let body = json!({ "map": map, "robot": robot, "start": place, "goal": place, "reverse": true });
            questions.push(question(name, "/v1/plan", body));
        }
        let compare = json!({ "robot": fresh_robot() });
        questions.push(question("compare", "/v1/compare", hills.to_goal(&compare)));
        questions
    }

    fn jobs(&self) -> Vec<Question> {
        let question = |name: String, path, body| Question { name, path, body };
        let sized = |recording: &Value, rows: &str| {
            [
                question(
                    format!("calibrate, {rows} rows"),
                    "/v1/calibrate",
                    json!({ "robot": "husky-a200", "recordings": [recording] }),
                ),
                question(
                    format!("diagnose, {rows} rows"),
                    "/v1/diagnose",
                    json!({ "robot": "husky-a200", "recordings": [recording] }),
                ),
            ]
        };
        let names = ["40 000", "1 000 000"];
        self.recordings.iter().zip(names).flat_map(|(recording, rows)| sized(recording, rows)).collect()
    }

    /// Starts a job and cancels it after each of [`CANCELLED_S`]; how long its turn was held at most after that [ms].
    fn cancel(&self, job: &Question) -> f64 {
        let mut late_ms = f64::MIN;
        for (count, after_s) in CANCELLED_S.into_iter().enumerate() {
            let mut body = job.body.clone();
            let mut robot = fresh_robot();
            robot["name"] = json!(format!("{}-{count}", job.name));
            body["robot"] = robot;
            let answer = self.server.post_json(job.path, &body);
            assert!(answer.status < 300, "{}", answer.text);
            let id = answer.json()["id"].as_str().unwrap().to_owned();
            std::thread::sleep(Duration::from_secs_f64(after_s));
            let began = Instant::now();
            self.server.delete(&format!("/v1/jobs/{id}"));
            while self.server.metric("joulepath_computations{state=\"running\"}") > 0.0 {
                assert!(began.elapsed().as_secs_f64() < LONGEST_WAIT_S, "{} holds its turn", job.name);
            }
            late_ms = late_ms.max(1e3 * began.elapsed().as_secs_f64());
        }
        late_ms
    }
}

/// A Husky that no planner is at hand for.
fn fresh_robot() -> Value {
    json!({
        "name": "fresh", "mass_kg": 90.0, "wheelbase_m": 0.54, "track_m": 0.54, "wheel_radius_m": 0.165, "max_wheel_speed_mps": 1.0,
        "motors": { "left": { "k1_w_per_n2": 0.0023, "k2": 1.7158 }, "right": { "k1_w_per_n2": 0.0016, "k2": 1.7723 } },
        "battery": { "capacity_wh": 480.0, "nominal_voltage_v": 24.0, "reserve_fraction": 0.2 },
        "limits": { "max_side_force_n": 600.0, "max_pitch_rad": 0.52, "max_roll_rad": 0.45 },
        "surfaces": { "ground": { "mu_roll": 0.063, "mu_skid": 0.29, "slip_angle_scale_rad": 0.3 } }, "default_surface": "ground"
    })
}

/// One that level ground takes nothing from.
fn smooth_robot() -> Value {
    let mut robot = fresh_robot();
    robot["surfaces"]["ground"]["mu_roll"] = json!(0.0);
    robot
}

/// One whose battery lasts for months.
fn endless_robot() -> Value {
    let mut robot = fresh_robot();
    robot["battery"]["capacity_wh"] = json!(1e6);
    robot["surfaces"]["ground"]["mu_roll"] = json!(1e-6);
    robot
}

/// The largest that a robot file may describe.
fn huge_robot() -> Value {
    let mut robot = fresh_robot();
    for (field, value) in
        [("mass_kg", 20_000.0), ("wheelbase_m", 10.0), ("track_m", 10.0), ("wheel_radius_m", 2.0)]
    {
        robot[field] = json!(value);
    }
    robot
}

/// Level ground with a wall across it every 40 cells, open at one end.
fn maze(side: usize) -> Terrain {
    let grid = Grid { rows: side, columns: side, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let wall = |row: usize, column: usize| {
        let gap = 6;
        row % 40 == 39 && if (row / 40).is_multiple_of(2) { column + gap < side } else { column >= gap }
    };
    let obstacle = (0..side).flat_map(|row| (0..side).map(move |column| wall(row, column))).collect();
    Terrain::new(grid, &vec![0.0; side * side]).unwrap().with_obstacles(obstacle)
}
