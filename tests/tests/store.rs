//! What the service keeps: over a restart, between services over one store, and when it is killed.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr)]

use std::{fs, fs::OpenOptions, io::Write, path::Path, process::Command};

use joulepath_tests::{
    Server, churn::churn, drive_csv, folder_store, kills::kill_again_and_again, program, s3::S3,
};
use serde_json::{Value, json};

fn map() -> Value {
    let surface = json!([["grass", null, "clay"], ["clay", "grass", null]]);
    let obstacle = json!([[false, false, true], [false, false, false]]);
    json!({
        "cell_size_m": 0.5, "origin_m": [10.0, -20.0], "rows": 2, "columns": 3,
        "elevation_m": [[0.1, 0.2, 0.3], [0.4, null, 0.6]], "surface": surface, "obstacle": obstacle
    })
}

fn robot() -> Value {
    let mut robot = serde_json::to_value(model::builtin::husky_a200()).unwrap();
    robot["name"] = json!("one third heavier");
    robot["mass_kg"] = json!(90.0 * 4.0 / 3.0);
    robot
}

fn stored(server: &Server, path: &str, kind: &str, body: &[u8]) -> String {
    let answer = server.post(path, kind, body);
    assert!(answer.status == 201, "{} {}", answer.status, answer.text);
    answer.json()["id"].as_str().unwrap().to_owned()
}

/// Stores one thing of each kind and starts a job; answers the paths that they are found at.
fn filled(server: &Server) -> Vec<String> {
    let map = stored(server, "/v1/maps", "application/json", map().to_string().as_bytes());
    let robot = stored(server, "/v1/robots", "application/json", robot().to_string().as_bytes());
    let recording = stored(server, "/v1/recordings", "text/csv", drive_csv(4, 300).as_bytes());
    let job = asked(server, &json!({ "robot": robot, "recordings": [recording] }));
    assert_eq!(ended(server, &job)["state"], "done");
    vec![format!("/v1/maps/{map}"), format!("/v1/robots/{robot}"), format!("/v1/recordings/{recording}"), job]
}

fn asked(server: &Server, body: &Value) -> String {
    let answer = server.post_json("/v1/calibrate", body);
    assert_eq!(answer.status, 202, "{}", answer.text);
    answer.location.unwrap()
}

fn ended(server: &Server, job: &str) -> Value {
    server.events(&format!("{job}/events"), None).last().unwrap().data
}

/// What a service tells of paths and in lists.
fn told(server: &Server, paths: &[String]) -> Vec<Value> {
    let lists = ["/v1/maps", "/v1/robots", "/v1/recordings"].map(str::to_owned);
    paths.iter().chain(&lists).map(|path| server.get(path).json()).collect()
}

#[test]
fn everything_is_at_hand_after_a_restart_and_at_every_service_over_the_folder() {
    let folder = tempfile::tempdir().unwrap();
    let mut server = Server::start_over(folder.path());
    let other = Server::start_over(folder.path());
    let paths = filled(&server);
    let before = told(&server, &paths);
    assert_eq!(told(&other, &paths), before, "another service over the folder");
    drop(other);
    assert!(server.terminate().success());
    let server = Server::start_over(folder.path());
    assert_eq!(told(&server, &paths), before, "after the restart");
    for path in &paths[..1] {
        assert_eq!(server.delete(path).status, 204);
        server.get(path).problem(404, "unknown-map");
    }
}

#[test]
fn maps_of_every_layer_come_back_from_the_store_as_they_were_sent() {
    let folder = tempfile::tempdir().unwrap();
    let id = stored(
        &Server::start_over(folder.path()),
        "/v1/maps",
        "application/json",
        map().to_string().as_bytes(),
    );
    let server = Server::start_over(folder.path());
    let found = server.get(&format!("/v1/maps/{id}")).json();
    let again = server.post_json("/v1/maps", &found);
    assert_eq!((again.status, again.json()["id"].as_str()), (200, Some(id.as_str())));
    for layer in ["surface", "obstacle", "origin_m"] {
        assert_eq!(found[layer], map()[layer], "{layer}");
    }
}

#[test]
fn ids_that_are_none_lead_nowhere() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start_over(folder.path());
    let secret = folder.path().join("secret.json");
    fs::write(&secret, "{}").unwrap();
    let long = "0".repeat(10_000);
    let upper = "0F".repeat(16);
    for id in
        ["..%2fsecret", "%2e%2e%2fsecret", "..%5csecret", "%00", "a%0ab", ".", long.as_str(), upper.as_str()]
    {
        for (path, kind) in [
            ("maps", "unknown-map"),
            ("robots", "unknown-robot"),
            ("recordings", "unknown-recording"),
            ("jobs", "unknown-job"),
        ] {
            let answer = server.get(&format!("/v1/{path}/{id}"));
            let known = [kind, "not-found"].map(Value::from).contains(&answer.json()["type"]);
            assert!(answer.status == 404 && known, "{path} {id}: {}", answer.text);
        }
    }
    assert!(secret.exists());
}

/// A service over a folder whose recording is a pipe: who reads it waits for what the test writes.
fn held(folder: &Path, server: &Server) -> (String, std::path::PathBuf) {
    let recording = stored(server, "/v1/recordings", "text/csv", drive_csv(4, 300).as_bytes());
    let pipe = folder.join("recordings").join(format!("{recording}.data"));
    fs::remove_file(&pipe).unwrap();
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    (recording, pipe)
}

#[test]
fn the_same_job_asked_of_several_services_runs_once() {
    let folder = tempfile::tempdir().unwrap();
    // With the lease that services have unless they are told otherwise: a busy machine must not end it.
    let servers: Vec<Server> = (0..2).map(|_| Server::start_over_with(folder.path(), &[])).collect();
    let (recording, pipe) = held(folder.path(), &servers[0]);
    let body = json!({ "robot": "husky-a200", "recordings": [recording] });
    let jobs: Vec<String> = std::thread::scope(|scope| {
        let asks: Vec<_> =
            (0..8).map(|i| (&servers[i % 2], &body)).map(|(s, b)| scope.spawn(move || asked(s, b))).collect();
        asks.into_iter().map(|ask| ask.join().unwrap()).collect()
    });
    assert!(jobs.iter().all(|job| *job == jobs[0]), "{jobs:?}");
    // Two readers would share what is written, and neither would read a recording.
    OpenOptions::new().write(true).open(&pipe).unwrap().write_all(drive_csv(4, 300).as_bytes()).unwrap();
    let found: Vec<Value> = servers.iter().map(|server| ended(server, &jobs[0])).collect();
    assert_eq!((&found[0]["state"], &found[0]["attempt"]), (&json!("done"), &json!(1)), "{}", found[0]);
    assert_eq!(found[0], found[1]);
    // Once more, and nobody reads: the pipe has no writer.
    assert_eq!(servers[1].post_json("/v1/calibrate", &body).json(), found[0]);
    let other = json!({ "robot": robot(), "recordings": [recording] });
    assert_ne!(asked(&servers[1], &other), jobs[0], "another robot is another job");
}

/// Follows a job until it runs for the time of a number.
fn runs(server: &Server, job: &str, attempt: u64) {
    let mut events = server.events(&format!("{job}/events"), None);
    let found = events.find(|event| event.data["attempt"] == attempt && event.data["state"] == "running");
    assert!(found.is_some(), "attempt {attempt} never ran");
}

#[test]
fn a_job_whose_service_was_killed_is_taken_up_by_another_once_and_then_given_up_with_a_problem() {
    let folder = tempfile::tempdir().unwrap();
    // A lease that a busy machine does not end.
    let start = || Server::start_over_with(folder.path(), &["--lease-s", "3"]);
    let (mut first, mut second) = (start(), start());
    let (recording, pipe) = held(folder.path(), &first);
    let body = json!({ "robot": "husky-a200", "recordings": [recording] });
    let job = asked(&first, &body);
    runs(&first, &job, 1);
    first.kill();
    runs(&second, &job, 2);
    second.kill();
    let third = start();
    let found = ended(&third, &job);
    assert_eq!((&found["state"], &found["attempt"]), (&json!("failed"), &json!(2)), "{found}");
    let problem = &found["problem"];
    assert_eq!(problem["type"], "abandoned", "{problem}");
    assert!(problem["detail"].as_str().unwrap().contains("died 2 times"), "{problem}");
    // The report is there before the lease is gone.
    while !folder_store::files(&folder.path().join("jobs")).is_empty() {
        std::thread::yield_now();
    }
    // Asked again, it is done anew.
    fs::remove_file(&pipe).unwrap();
    fs::write(&pipe, drive_csv(4, 300)).unwrap();
    assert_eq!(asked(&third, &body), job);
    assert_eq!(ended(&third, &job)["state"], "done");
}

#[test]
fn a_job_whose_service_ends_in_order_or_dies_while_the_job_waits_is_taken_up_each_time() {
    let folder = tempfile::tempdir().unwrap();
    let start = || Server::start_over_with(folder.path(), &["--lease-s", "3", "--parallel-jobs", "1"]);
    let mut server = start();
    let (recording, _pipe) = held(folder.path(), &server);
    let robots = [json!("husky-a200"), robot()];
    let jobs = robots.map(|robot| asked(&server, &json!({ "robot": robot, "recordings": [recording] })));
    // Which of the two runs, while the other waits.
    let one_runs = |server: &Server| {
        let state = |job: &String| server.get(job).json()["state"].clone();
        while !jobs.iter().any(|job| state(job) == "running") {
            std::thread::yield_now();
        }
    };
    for _ in 0..3 {
        one_runs(&server);
        assert!(server.terminate().success());
        server = start();
    }
    one_runs(&server);
    server.kill();
    let server = start();
    one_runs(&server);
    for job in &jobs {
        let found = server.get(job).json();
        assert!(["queued", "running"].map(Value::from).contains(&found["state"]), "{found}");
        assert!(found["attempt"].as_u64().unwrap() >= 4, "{found}");
        assert_eq!(server.delete(job).json()["state"], "cancelled");
    }
}

#[test]
fn a_cancelled_job_that_does_not_end_frees_the_only_worker_and_readiness_tells() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start_over_with(folder.path(), &["--parallel-jobs", "1", "--parallel-plans", "1"]);
    let good = stored(&server, "/v1/recordings", "text/csv", drive_csv(3, 300).as_bytes());
    let (recording, pipe) = held(folder.path(), &server);
    let job = asked(&server, &json!({ "robot": "husky-a200", "recordings": [recording] }));
    runs(&server, &job, 1);
    let next = asked(&server, &json!({ "robot": "husky-a200", "recordings": [good] }));
    assert_eq!(server.get("/readyz").status, 200);
    assert_eq!(server.delete(&job).json()["state"], "cancelled");
    assert_eq!(ended(&server, &next)["state"], "done");
    let problem = server.get("/readyz").problem(503, "not-ready");
    assert!(problem["detail"].as_str().unwrap().contains("restart"), "{problem}");
    assert_eq!(server.metric("joulepath_stuck_threads"), 1.0);
    assert_eq!(server.get("/healthz").status, 200);
    // Its thread ends when the pipe does.
    drop(OpenOptions::new().write(true).open(&pipe).unwrap());
    while server.get("/readyz").status != 200 {
        std::thread::yield_now();
    }
    assert_eq!(server.metric("joulepath_stuck_threads"), 0.0);
}

#[test]
fn a_job_beyond_its_time_fails_with_a_problem_and_frees_the_only_worker() {
    let folder = tempfile::tempdir().unwrap();
    let server = Server::start_over_with(folder.path(), &["--parallel-jobs", "1", "--job-time-s", "0.01"]);
    let (recording, _pipe) = held(folder.path(), &server);
    let job = asked(&server, &json!({ "robot": "husky-a200", "recordings": [recording] }));
    let found = ended(&server, &job);
    assert_eq!(
        (&found["state"], &found["problem"]["type"]),
        (&json!("failed"), &json!("timeout")),
        "{found}"
    );
    assert_eq!(server.get("/v1/status").json()["tenant"]["jobs"], 0);
}

#[test]
fn a_store_out_of_reach_is_told_by_readiness() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("store");
    let server = Server::start_over(&root);
    assert_eq!(server.get("/readyz").status, 200);
    fs::remove_dir_all(&root).unwrap();
    fs::write(&root, "no folder").unwrap();
    server.get("/readyz").problem(503, "store-unavailable");
}

#[test]
fn a_job_is_cancelled_wherever_it_runs_and_then_done_anew_when_asked() {
    let folder = tempfile::tempdir().unwrap();
    let start = || Server::start_over_with(folder.path(), &["--lease-s", "3"]);
    let (first, second) = (start(), start());
    let (recording, pipe) = held(folder.path(), &first);
    let body = json!({ "robot": "husky-a200", "recordings": [recording] });
    let job = asked(&first, &body);
    // This returns once the work reads from the other end; a job called off before would never begin to.
    let writer = OpenOptions::new().write(true).open(&pipe).unwrap();
    assert_eq!(second.delete(&job).json()["state"], "cancelled");
    // The service that worked on it finds out, and its followers with it.
    let last = ended(&first, &job);
    assert!(["cancelled", "queued"].map(Value::from).contains(&last["state"]), "{last}");
    assert_eq!(first.get(&job).json()["state"], "cancelled");
    // Whoever waits at the pipe reads nothing of use.
    drop(writer);
    fs::remove_file(&pipe).unwrap();
    fs::write(&pipe, drive_csv(4, 300)).unwrap();
    assert_eq!(asked(&second, &body), job, "the same job");
    assert_eq!(ended(&second, &job)["state"], "done");
    assert_eq!(first.get(&job).json()["state"], "done");
}

#[test]
fn a_job_that_can_no_longer_be_done_fails_with_a_problem() {
    let folder = tempfile::tempdir().unwrap();
    let mut first = Server::start_over(folder.path());
    let (recording, _pipe) = held(folder.path(), &first);
    let job = asked(&first, &json!({ "robot": "husky-a200", "recordings": [recording] }));
    assert_eq!(first.delete(&format!("/v1/recordings/{recording}")).status, 204);
    first.kill();
    let second = Server::start_over(folder.path());
    let found = ended(&second, &job);
    assert_eq!(
        (&found["state"], &found["problem"]["type"]),
        (&json!("failed"), &json!("unknown-recording")),
        "{found}"
    );
}

#[test]
fn killed_services_lose_nothing_that_was_acknowledged_and_leave_nothing_half_written() {
    let folder = tempfile::tempdir().unwrap();
    let outcome = kill_again_and_again(folder.path(), 5, 7);
    assert_eq!((outcome.kills, outcome.faults), (5, Vec::new()));
}

#[test]
fn uploads_and_deletes_leave_nothing_on_disk() {
    let folder = tempfile::tempdir().unwrap();
    let growth = churn(folder.path(), 20);
    assert_eq!((growth.files_after, growth.bytes_after), (growth.files_before, growth.bytes_before));
}

#[test]
fn a_service_that_ends_in_order_removes_the_folder_that_lasts_as_long_as_it_does() {
    let mut server = Server::start();
    filled(&server);
    let kept = |server: &Server| fs::read_dir(server.temporary()).unwrap().count();
    assert_eq!(kept(&server), 1);
    assert!(server.terminate().success());
    assert_eq!(kept(&server), 0);
}

#[test]
fn a_store_that_cannot_be_used_is_told_in_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("file");
    fs::write(&file, "").unwrap();
    for (store, said) in [
        (file.display().to_string(), "give --store a folder that can be written to"),
        ("ftp://somewhere".to_owned(), "give a folder or s3://BUCKET/PREFIX"),
        ("s3://bucket/prefix".to_owned(), "s3://bucket/prefix"),
    ] {
        let output = Command::new(program())
            .args(["serve", "--bind", "127.0.0.1:0", "--store", &store])
            .env("AWS_ENDPOINT_URL", "http://127.0.0.1:1")
            .env("AWS_ALLOW_HTTP", "true")
            .env("AWS_ACCESS_KEY_ID", "x")
            .env("AWS_SECRET_ACCESS_KEY", "x")
            .output()
            .unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        let last = stderr.lines().filter(|line| !line.starts_with('{')).collect::<Vec<_>>();
        assert!(last.len() == 1 && last[0].contains(said), "{store}: {stderr}");
        assert_eq!(output.status.code(), Some(2), "{store}: {stderr}");
    }
}

#[test]
fn a_folder_that_is_gone_is_told_as_a_store_out_of_reach() {
    let folder = tempfile::tempdir().unwrap();
    let root = folder.path().join("store");
    let server = Server::start_over(&root);
    fs::remove_dir_all(&root).unwrap();
    fs::write(&root, "no folder").unwrap();
    let refused = server.post_json("/v1/maps", &map());
    refused.problem(503, "store-unavailable");
}

#[test]
fn services_over_a_bucket_share_everything() {
    let Some(mut s3) = S3::start() else {
        eprintln!("skipped: tests/run makes the Python environment that has moto");
        return;
    };
    let (mut first, second) = (s3.service(), s3.service());
    let paths = filled(&first);
    let before = told(&first, &paths);
    assert_eq!(told(&second, &paths), before);
    let recording = paths[2].rsplit('/').next().unwrap();

    // A large recording goes in parts.
    let head = b"t_s,v_left_mps,v_right_mps,power_w,note\n".to_vec();
    let long: Vec<u8> = (0..30_000)
        .flat_map(|row| {
            format!("{},0.5,0.{},{},{}\n", row as f64 / 10.0, row % 9, row % 70, "word ".repeat(200))
                .into_bytes()
        })
        .collect();
    let long = [head, long].concat();
    let large = second.post("/v1/recordings", "text/csv", &long);
    assert_eq!(large.status, 201, "{}", large.text);
    let id = large.json()["id"].as_str().unwrap().to_owned();
    assert_eq!(first.get(&format!("/v1/recordings/{id}")).json()["bytes"], long.len());
    assert_eq!(first.delete(&format!("/v1/recordings/{id}")).status, 204);
    second.get(&format!("/v1/recordings/{id}")).problem(404, "unknown-recording");

    // The same job runs once; one whose service was killed is done by the other.
    let body = json!({ "robot": robot(), "recordings": [recording], "method": "dogru-marques" });
    let jobs = [asked(&first, &body), asked(&second, &body)];
    assert_eq!(jobs[0], jobs[1]);
    assert_eq!(ended(&second, &jobs[0])["attempt"], 1);
    let body = json!({ "robot": "husky-a200", "recordings": [recording], "reference_surface": "marble" });
    let job = asked(&first, &body);
    first.kill();
    assert_eq!(ended(&second, &job)["state"], "done");

    s3.stop();
    let refused = second
        .post_json("/v1/maps", &json!({ "cell_size_m": 1, "rows": 1, "columns": 1, "elevation_m": [[9]] }));
    refused.problem(503, "store-unavailable");
}
