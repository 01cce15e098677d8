//! Calibration as a job of the running service: its answer, its events, its end, and what is refused.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr)]

use std::{fs::OpenOptions, io::Write, path::PathBuf, process::Command};

use joulepath_tests::{Server, drive_csv, program};
use serde_json::{Value, json};

const RUNS: usize = 4;
const ROWS: usize = 300;

fn stored(server: &Server) -> String {
    let answer = server.post("/v1/recordings", "text/csv", drive_csv(RUNS, ROWS).as_bytes());
    assert_eq!(answer.status, 201, "{}", answer.text);
    answer.json()["id"].as_str().unwrap().to_owned()
}

fn started(server: &Server, body: &Value) -> String {
    let answer = server.post_json("/v1/calibrate", body);
    assert_eq!(answer.status, 202, "{}", answer.text);
    let id = answer.json()["id"].as_str().unwrap().to_owned();
    assert_eq!(answer.location.as_deref(), Some(format!("/v1/jobs/{id}").as_str()));
    id
}

fn ended(server: &Server, job: &str) -> Value {
    let last = server.events(&format!("/v1/jobs/{job}/events"), None).last().unwrap();
    assert_eq!(
        server.get(&format!("/v1/jobs/{job}")).json(),
        last.data,
        "the last event is the job as it stays"
    );
    last.data
}

#[test]
fn the_service_and_the_command_fit_the_same_robot_and_answer_with_the_same_document() {
    let server = Server::start();
    let id = stored(&server);
    for method in ["fit", "dogru-marques"] {
        let job = started(&server, &json!({ "robot": "husky-a200", "recordings": [id], "method": method }));
        let job = ended(&server, &job);
        assert_eq!((&job["kind"], &job["state"]), (&json!("calibrate"), &json!("done")), "{job}");
        let folder = tempfile::tempdir().unwrap();
        let (file, out) = (folder.path().join("drive.csv"), folder.path().join("robot.json"));
        std::fs::write(&file, drive_csv(RUNS, ROWS)).unwrap();
        let output = Command::new(program())
            .args(["calibrate", "--json", "--method", method, "--recording"])
            .args([&file])
            .args(["--out".as_ref(), out.as_os_str()])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let printed: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(printed, job["result"]);
        let robot: Value = serde_json::from_slice(&std::fs::read(&out).unwrap()).unwrap();
        assert_eq!(robot, job["result"]["robot"], "the file is the robot of the document");
    }
}

#[test]
fn a_fitted_robot_can_be_planned_with() {
    let server = Server::start();
    let id = stored(&server);
    let job = ended(&server, &started(&server, &json!({ "robot": "husky-a200", "recordings": [id] })));
    for field in ["name", "value", "unit", "interval_95", "determined"] {
        assert!(job["result"]["parameters"][0].get(field).is_some(), "parameters have no {field}");
    }
    assert!(job["result"]["held_out"]["rmse_w"].is_f64() && job["result"]["held_out"]["r2"].is_f64());
    let coverage = &job["result"]["coverage"];
    assert_eq!(coverage["runs"].as_array().unwrap().len(), RUNS, "{coverage}");
    let driven_s = RUNS as f64 * (ROWS - 1) as f64 / 10.0;
    for field in ["recorded_s", "used_s"] {
        assert!((coverage["total"][field].as_f64().unwrap() - driven_s).abs() < 1e-6, "{coverage}");
    }
    let flat: Vec<Vec<f64>> = vec![vec![0.0; 12]; 8];
    let plan = server.post_json(
        "/v1/plan",
        &json!({
            "map": { "cell_size_m": 1.0, "rows": 8, "columns": 12, "elevation_m": flat }, "robot": job["result"]["robot"],
            "start": { "x_m": 2.5, "y_m": 2.5 }, "goal": { "x_m": 9.5, "y_m": 5.5 }
        }),
    );
    assert_eq!(plan.status, 200, "{}", plan.text);
}

#[test]
fn wrong_requests_are_refused_at_once_with_the_pointer_to_the_field() {
    let server = Server::start();
    let id = stored(&server);
    let good = json!({ "robot": "husky-a200", "recordings": [id] });
    let unit = json!({ "name": "m", "sources": [{ "channel": "power_w", "column": "p", "unit": "A" }] });
    for (field, value, status, kind, at) in [
        (
            "recordings",
            json!([id, "0123456789abcdef0123456789abcdef"]),
            404,
            "unknown-recording",
            "/recordings/1",
        ),
        ("recordings", json!(["../../etc/passwd"]), 404, "unknown-recording", "/recordings/0"),
        ("recordings", json!([]), 400, "invalid-request", "/recordings"),
        ("recordings", json!(7), 400, "invalid-request", "/recordings"),
        ("robot", json!("r2d2"), 404, "unknown-robot", "/robot"),
        ("robot", json!({ "name": "x" }), 400, "invalid-request", "/robot/mass_kg"),
        ("method", json!("guess"), 400, "invalid-request", "/method"),
        ("map", json!("rover"), 400, "invalid-request", "/map"),
        ("map", unit, 400, "invalid-request", "/map/sources/0/unit"),
        ("lift", json!("side,force_n\nleft,3\n"), 400, "invalid-request", "/lift"),
        ("colour", json!("red"), 400, "invalid-request", "/colour"),
    ] {
        let mut body = good.clone();
        body[field] = value;
        let problem = server.post_json("/v1/calibrate", &body).problem(status, kind);
        assert_eq!(problem["errors"][0]["pointer"], at, "{problem}");
    }
    server.get("/v1/jobs/nothing").problem(404, "unknown-job");
    server.delete("/v1/jobs/nothing").problem(404, "unknown-job");
    server.get("/v1/jobs/nothing/events").problem(404, "unknown-job");
    server.post("/v1/calibrate", "text/csv", b"robot\n").problem(415, "unsupported-media-type");
}

#[test]
fn what_only_reading_can_tell_fails_the_job_with_a_problem() {
    let server = Server::start();
    let id = stored(&server);
    let currents = "t_s,v_left_mps,v_right_mps,motor_current_left_a,motor_current_right_a\n".to_owned()
        + &(0..200)
            .map(|row| format!("{},0.5,0.5,2.{},2.1\n", row as f64 / 10.0, row % 10))
            .collect::<String>();
    let currents = server.post("/v1/recordings", "text/csv", currents.as_bytes()).json()["id"].clone();
    let weave = "t_s,v_left_mps,v_right_mps,power_left_w,power_right_w\n".to_owned()
        + &(0..200)
            .map(|row| format!("{0},0.{1},0.5,2{1},31\n", row as f64 / 10.0, row % 10))
            .collect::<String>();
    let weave = server.post("/v1/recordings", "text/csv", weave.as_bytes()).json()["id"].clone();
    let map = json!({ "name": "m", "sources": [{ "channel": "pitch_rad", "column": "power_left_w" }] });
    for (body, kind, at, said) in [
        (
            json!({ "recordings": [currents], "reference_surface": "lava" }),
            "unknown-surface",
            "/reference_surface",
            "`lava`",
        ),
        (json!({ "recordings": [currents] }), "insufficient-recording", "/recordings", "record two or more"),
        (
            json!({ "recordings": [weave], "method": "dogru-marques" }),
            "insufficient-recording",
            "/recordings",
            "clearly different turning radii",
        ),
        (
            json!({ "recordings": [id], "map": map }),
            "invalid-recording",
            "/recordings/0",
            "power_left_w is missing",
        ),
    ] {
        let mut request = body.clone();
        request["robot"] = json!("husky-a200");
        let job = ended(&server, &started(&server, &request));
        assert_eq!((&job["state"], &job["problem"]["type"]), (&json!("failed"), &json!(kind)), "{job}");
        assert_eq!(job["problem"]["errors"][0]["pointer"], at, "{job}");
        assert!(job["problem"]["detail"].as_str().unwrap().contains(said), "{job}");
    }
}

/// A server whose recording is a pipe: jobs that read it wait for what the test writes.
struct Held {
    server: Server,
    recording: String,
    pipe: PathBuf,
    _folder: tempfile::TempDir,
}

fn held() -> Held {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start_with(&["--store", &folder.path().display().to_string()]);
    let recording = stored(&server);
    let pipe = folder.path().join("recordings").join(format!("{recording}.data"));
    std::fs::remove_file(&pipe).unwrap();
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    Held { server, recording, pipe, _folder: folder }
}

/// A copy with every second row.
#[test]
fn seconds_that_two_recordings_hold_fail_the_job_with_both_names() {
    let server = Server::start();
    let whole = drive_csv(RUNS, ROWS);
    let mut lines = whole.lines();
    let header = lines.next().unwrap();
    let copy: String =
        std::iter::once(header).chain(lines.step_by(2)).map(|line| format!("{line}\n")).collect();
    let ids = [&whole, &copy].map(|text| {
        let answer = server.post("/v1/recordings", "text/csv", text.as_bytes());
        answer.json()["id"].as_str().unwrap().to_owned()
    });
    let job = ended(&server, &started(&server, &json!({ "robot": "husky-a200", "recordings": ids })));
    let problem = &job["problem"];
    assert_eq!((&job["state"], &problem["type"]), (&json!("failed"), &json!("invalid-recording")), "{job}");
    assert!(problem["detail"].as_str().unwrap().contains("hold the same drive from"), "{job}");
    assert!(problem["errors"][0]["pointer"].as_str().unwrap().starts_with("/recordings"), "{job}");
}

#[test]
fn who_comes_back_to_the_events_of_a_job_is_told_the_rest() {
    let Held { server, recording, pipe, _folder } = held();
    let job = started(&server, &json!({ "robot": "husky-a200", "recordings": [recording] }));
    let path = format!("/v1/jobs/{job}/events");
    let text = drive_csv(RUNS, ROWS);
    let (first, rest) = text.split_at(text.len() / 2);
    let mut pipe = OpenOptions::new().write(true).open(pipe).unwrap();
    pipe.write_all(first.as_bytes()).unwrap();
    let of_reading = json!("reading recording 1 of 1");
    let reading =
        server.events(&path, None).find(|event| event.data["progress"]["step"] == of_reading).unwrap();
    assert_eq!((reading.name.as_str(), &reading.data["state"]), ("progress", &json!("running")));
    let fraction = reading.data["progress"]["fraction"].as_f64().unwrap();
    assert!((0.0..=0.51).contains(&fraction), "{fraction}");
    pipe.write_all(rest.as_bytes()).unwrap();
    drop(pipe);

    let later: Vec<_> = server.events(&path, Some(&reading.id)).collect();
    let number = |id: &str| id.parse::<u64>().unwrap();
    assert!(later.iter().all(|event| number(&event.id) > number(&reading.id)), "{later:?}");
    let last = later.last().unwrap();
    assert_eq!((last.name.as_str(), &last.data["state"]), ("done", &json!("done")));
    assert_eq!(server.events(&path, Some(&last.id)).status, 204, "there is no more to tell");
    let again: Vec<_> = server.events(&path, Some("no number")).collect();
    assert_eq!(again.len(), 1, "who lost its place is told the end");
}

#[test]
fn a_cancelled_job_stays_cancelled_and_can_then_be_forgotten() {
    let Held { server, recording, pipe, _folder } = held();
    let body = json!({ "robot": "husky-a200", "recordings": [recording] });
    let job = started(&server, &body);
    let path = format!("/v1/jobs/{job}");
    let mut events = server.events(&format!("{path}/events"), None);
    assert_eq!(events.next().unwrap().name, "progress");
    // This returns once the work reads from the other end; a job called off before would never begin to.
    let mut writer = OpenOptions::new().write(true).open(&pipe).unwrap();
    let cancelled = server.delete(&path);
    assert_eq!((cancelled.status, &cancelled.json()["state"]), (200, &json!("cancelled")));
    assert_eq!(events.last().unwrap().name, "cancelled");
    // The work itself ends at the next bytes that it reads: the writer is then alone.
    let endless = std::iter::repeat_n(drive_csv(1, ROWS), 10_000);
    let refused = endless.map(|text| writer.write_all(text.as_bytes())).find_map(Result::err);
    assert_eq!(refused.map(|error| error.kind()), Some(std::io::ErrorKind::BrokenPipe));
    assert_eq!(server.get(&path).json()["state"], "cancelled");
    assert_eq!(server.delete(&path).status, 204);
    server.get(&path).problem(404, "unknown-job");
}

/// A request that differs from others by its robot, and so is another job.
fn another(recording: &str, number: usize) -> Value {
    let mut robot = serde_json::to_value(model::builtin::husky_a200()).unwrap();
    robot["mass_kg"] = json!(80 + number);
    json!({ "robot": robot, "recordings": [recording] })
}

/// The fit of so long a recording takes many times as long as reading it; a turn for the next job comes only when it has ended.
#[test]
fn a_fit_under_way_gives_up_its_turn_soon_after_it_is_called_off() {
    let server = Server::start();
    let long = server.post("/v1/recordings", "text/csv", drive_csv(40, 10_000).as_bytes());
    let long = long.json()["id"].as_str().unwrap().to_owned();
    let short = stored(&server);
    // As many as run side by side, so that the short one has to wait for one of them.
    let turns = std::thread::available_parallelism().map_or(1, usize::from);
    let jobs: Vec<String> = (0..turns).map(|i| started(&server, &another(&long, i))).collect();
    let fitting = |event: &joulepath_tests::Event| event.data["progress"]["step"] == "fitting";
    let events = server.events(&format!("/v1/jobs/{}/events", jobs[0]), None);
    assert!(events.into_iter().any(|event| fitting(&event)), "it ended before it was called off");
    for job in &jobs {
        assert_eq!(server.delete(&format!("/v1/jobs/{job}")).json()["state"], "cancelled");
    }
    let job = ended(&server, &started(&server, &json!({ "robot": "husky-a200", "recordings": [short] })));
    assert_eq!(job["state"], "done", "{job}");
    for job in &jobs {
        let job = server.get(&format!("/v1/jobs/{job}")).json();
        assert_eq!((&job["state"], &job["result"]), (&json!("cancelled"), &Value::Null), "{job}");
    }
}

#[test]
fn jobs_are_bounded_and_do_not_keep_plans_or_the_end_waiting() {
    let Held { mut server, recording, pipe: _, _folder } = held();
    let jobs: Vec<String> = (0..32).map(|i| started(&server, &another(&recording, i))).collect();
    server.post_json("/v1/calibrate", &another(&recording, 32)).problem(503, "too-many-jobs");
    assert_eq!(started(&server, &another(&recording, 31)), jobs[31], "the same job is not one more");
    assert_eq!(server.get(&format!("/v1/jobs/{}", jobs[31])).json()["state"], "queued");
    assert_eq!(server.delete(&format!("/v1/jobs/{}", jobs[31])).status, 200);
    started(&server, &another(&recording, 32));
    let events = server.events(&format!("/v1/jobs/{}/events", jobs[0]), None);
    assert!(server.terminate().success());
    let last = events.last().unwrap().data;
    assert_eq!((&last["state"], &last["progress"]["step"]), (&json!("queued"), &json!("handed back")));
}

#[test]
fn the_end_of_a_service_without_a_store_is_the_end_of_its_jobs() {
    let mut server = Server::start();
    let recording = server.post("/v1/recordings", "text/csv", drive_csv(8, 4000).as_bytes()).json();
    let job = started(&server, &another(recording["id"].as_str().unwrap(), 0));
    let events = server.events(&format!("/v1/jobs/{job}/events"), None);
    assert!(server.terminate().success());
    let last = events.last().unwrap().name;
    assert!(["cancelled", "done"].contains(&last.as_str()), "{last}");
}

#[test]
fn times_in_another_unit_are_refused_on_arrival_and_in_a_job_which_frees_its_worker() {
    let server = Server::start();
    let row = |row: i64| format!("{},0.5,0.5,80\n", 1_764_338_400_000_000_000 + 100_000_000 * row);
    let rows: String = (0..50).map(row).collect();
    let nanoseconds = format!("t_s,v_left_mps,v_right_mps,power_w\n{rows}");
    let problem = server.post("/v1/recordings", "text/csv", nanoseconds.as_bytes());
    let problem = problem.problem(400, "invalid-recording");
    let detail = problem["detail"].as_str().unwrap();
    assert!(detail.contains("must be in seconds") && detail.contains("nanoseconds"), "{detail}");
    // A map may give a unit that makes no times of a stored recording.
    let id = stored(&server);
    let map = json!({ "name": "lab", "sources": [{ "channel": "t_s", "column": "t_s", "unit": "ns" }] });
    let body = json!({ "robot": "husky-a200", "recordings": [id], "map": map });
    let job = ended(&server, &started(&server, &body));
    assert_eq!(job["state"], "failed", "{job}");
    let detail = job["problem"]["detail"].as_str().unwrap();
    assert!(detail.contains("the map gives its unit as `ns`"), "{detail}");
    assert_eq!(job["problem"]["errors"][0]["pointer"], "/recordings/0", "{job}");
    let next = ended(&server, &started(&server, &json!({ "robot": "husky-a200", "recordings": [id] })));
    assert_eq!(next["state"], "done", "{next}");
}
