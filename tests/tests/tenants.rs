//! Tenants: what one keeps is not there for others, whatever they know of it, and nobody keeps more than its share.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{fs, path::Path};

use joulepath_tests::{Answer, Server, drive_csv, folder_store};
use serde_json::{Value, json};

const ALICE: &str = "alice-0123456789abcdef";
const BOB: &str = "bob-0123456789abcdef";
const ADMIN: &str = "admin-0123456789abcdef";
/// A token as they were before tenants had names.
const OLD: &str = "0123456789abcdef0123456789abcdef";

/// Starts a service over a folder for all of the tenants, with more arguments.
fn start(folder: &Path, arguments: &[&str]) -> Server {
    let tokens = folder.join("tokens");
    fs::write(&tokens, format!("# all of them\nalice:{ALICE}\nBob:{BOB}, admin:{ADMIN}\n{OLD}\n")).unwrap();
    let tokens = tokens.display().to_string();
    let store = folder.join("store");
    Server::start_over_with(&store, &[&["--token-file", &tokens, "--lease-s", "0.5"], arguments].concat())
}

/// A tenant at a service.
#[derive(Clone, Copy)]
struct Client<'a> {
    server: &'a Server,
    token: &'a str,
}

impl<'a> Client<'a> {
    fn all(server: &'a Server) -> [Client<'a>; 4] {
        [ALICE, BOB, ADMIN, OLD].map(|token| Client { server, token })
    }

    fn get(&self, path: &str) -> Answer {
        self.server.ask_as(self.token, "GET", path, &Value::Null)
    }

    fn delete(&self, path: &str) -> Answer {
        self.server.ask_as(self.token, "DELETE", path, &Value::Null)
    }

    fn post(&self, path: &str, body: &Value) -> Answer {
        self.server.ask_as(self.token, "POST", path, body)
    }

    fn record(&self, name: &str, csv: &str) -> Answer {
        let field = format!("Bearer {}", self.token);
        let headers = [("authorization", field.as_str()), ("content-type", "text/csv")];
        self.server.ask("POST", &format!("/v1/recordings?name={name}"), &headers, csv.as_bytes())
    }

    /// The ids of a list.
    fn ids(&self, path: &str, list: &str) -> Vec<String> {
        let answer = self.get(path).json();
        let ids = answer[list].as_array().unwrap_or_else(|| panic!("{answer}")).iter();
        ids.map(|entry| entry["id"].as_str().unwrap().to_owned()).collect()
    }

    /// Stores one thing of each kind and has a job done; answers their ids.
    fn fill(&self) -> Ids {
        let map = created(&self.post("/v1/maps", &map(0.0)));
        let robot = created(&self.post("/v1/robots", &robot("shared")));
        let recording = created(&self.record("first", &drive_csv(2, 300)));
        let job = self.post("/v1/calibrate", &json!({ "robot": robot, "recordings": [recording] }));
        assert_eq!(job.status, 202, "{}", job.text);
        let job = job.json()["id"].as_str().unwrap().to_owned();
        Ids { map, robot, recording, job }
    }

    /// The last that a job's events tell.
    fn ended(&self, job: &str) -> String {
        self.get(&format!("/v1/jobs/{job}/events")).text
    }
}

struct Ids {
    map: String,
    robot: String,
    recording: String,
    job: String,
}

impl Ids {
    fn paths(&self) -> [(String, &'static str); 4] {
        let Ids { map, robot, recording, job } = self;
        [
            (format!("/v1/maps/{map}"), "unknown-map"),
            (format!("/v1/robots/{robot}"), "unknown-robot"),
            (format!("/v1/recordings/{recording}"), "unknown-recording"),
            (format!("/v1/jobs/{job}"), "unknown-job"),
        ]
    }
}

fn created(answer: &Answer) -> String {
    assert_eq!(answer.status, 201, "{}", answer.text);
    answer.json()["id"].as_str().unwrap().to_owned()
}

fn map(height_m: f64) -> Value {
    let row: Vec<f64> = (0..12).map(|i| height_m + 0.01 * f64::from(i)).collect();
    json!({ "cell_size_m": 1.0, "rows": 12, "columns": 12, "elevation_m": vec![row; 12] })
}

fn robot(name: &str) -> Value {
    let mut robot = serde_json::to_value(model::builtin::husky_a200()).unwrap();
    robot["name"] = json!(name);
    robot
}

fn question(map: &str, robot: &str) -> Value {
    let [start, goal] = [json!({ "x_m": 2.5, "y_m": 2.5 }), json!({ "x_m": 9.5, "y_m": 8.5 })];
    json!({ "map_id": map, "robot": robot, "start": start, "goal": goal })
}

/// A recording in the store whose reader waits for a writer.
fn held(folder: &Path, recording: &str) {
    let pipe = folder.join(format!("store/recordings/{recording}.data"));
    fs::remove_file(&pipe).unwrap();
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
}

#[test]
fn what_a_tenant_keeps_is_not_there_for_others_though_they_know_its_id() {
    let folder = tempfile::tempdir().unwrap();
    let server = start(folder.path(), &[]);
    let [alice, bob, admin, old] = Client::all(&server);
    let ids = alice.fill();
    alice.ended(&ids.job);
    for (path, kind) in ids.paths() {
        assert_eq!(alice.get(&path).status, 200, "{path}");
        assert_eq!(admin.get(&path).status, 200, "{path}");
        for other in [bob, old] {
            other.get(&path).problem(404, kind);
            other.delete(&path).problem(404, kind);
        }
    }
    bob.get(&format!("/v1/jobs/{}/events", ids.job)).problem(404, "unknown-job");
    for (path, list, id) in [
        ("/v1/maps", "maps", &ids.map),
        ("/v1/robots", "stored", &ids.robot),
        ("/v1/recordings", "recordings", &ids.recording),
        ("/v1/jobs", "jobs", &ids.job),
        ("/v1/status", "maps", &ids.map),
    ] {
        for sees in [alice, admin] {
            assert_eq!(sees.ids(path, list), std::slice::from_ref(id), "{path}");
        }
        for other in [bob, old] {
            assert_eq!(other.ids(path, list), Vec::<String>::new(), "{path}");
        }
    }
}

#[test]
fn no_request_reaches_what_another_tenant_keeps() {
    let folder = tempfile::tempdir().unwrap();
    let server = start(folder.path(), &[]);
    let [alice, bob, ..] = Client::all(&server);
    let ids = alice.fill();
    let own = question(&ids.map, "husky-a200");
    assert_eq!(alice.post("/v1/plan", &own).status, 200);
    let spot = json!({ "x_m": 9.5, "y_m": 8.5 });
    for (path, extra) in [
        ("/v1/plan", json!({})),
        ("/v1/compare", json!({})),
        ("/v1/range", json!({})),
        ("/v1/alternatives", json!({})),
        ("/v1/matrix", json!({ "start": null, "goal": null, "sources": [spot], "targets": [spot] })),
        ("/v1/reachable", json!({ "goal": null, "charges": [0.9] })),
        ("/v1/mission", json!({ "goal": null, "waypoints": [spot] })),
    ] {
        let mut asked = own.clone();
        asked.as_object_mut().unwrap().extend(extra.as_object().unwrap().clone());
        asked.as_object_mut().unwrap().retain(|_, value| !value.is_null());
        assert_eq!(alice.post(path, &asked).status, 200, "{path}: {}", alice.post(path, &asked).text);
        let problem = bob.post(path, &asked).problem(404, "unknown-map");
        assert_eq!(problem["errors"][0]["pointer"], "/map_id", "{path}");
    }
    let theirs = created(&bob.post("/v1/maps", &map(1.0)));
    let problem = bob.post("/v1/plan", &question(&theirs, &ids.robot)).problem(404, "unknown-robot");
    assert_eq!(problem["errors"][0]["pointer"], "/robot");
    let change = json!({ "row": 0, "column": 0, "elevation_m": [[5.0]] });
    server.ask_as(BOB, "PATCH", &format!("/v1/maps/{}", ids.map), &change).problem(404, "unknown-map");
    for path in ["/v1/calibrate", "/v1/diagnose"] {
        let job = json!({ "robot": "husky-a200", "recordings": [ids.recording] });
        bob.post(path, &job).problem(404, "unknown-recording");
    }
}

#[test]
fn the_same_content_is_stored_once_and_stays_until_both_have_dropped_it() {
    let folder = tempfile::tempdir().unwrap();
    let server = start(folder.path(), &[]);
    let [alice, bob, ..] = Client::all(&server);
    let (csv, other_name) = (drive_csv(2, 300), "second");
    let of_alice = [
        created(&alice.post("/v1/maps", &map(0.0))),
        created(&alice.post("/v1/robots", &robot("shared"))),
        created(&alice.record("first", &csv)),
    ];
    // To Bob they are new, which also tells nothing of Alice.
    let of_bob = [
        created(&bob.post("/v1/maps", &map(0.0))),
        created(&bob.post("/v1/robots", &robot("shared"))),
        created(&bob.record(other_name, &csv)),
    ];
    assert_eq!(of_alice, of_bob);
    assert_eq!(bob.post("/v1/maps", &map(0.0)).status, 200);
    let data = || {
        let files = folder_store::files(&folder.path().join("store"));
        files.iter().filter(|path| path.extension().is_some_and(|ending| ending == "data")).count()
    };
    assert_eq!(data(), 2, "a map and a recording");
    let [map_path, robot_path, recording_path] =
        [("maps", 0), ("robots", 1), ("recordings", 2)].map(|(kind, i)| format!("/v1/{kind}/{}", of_bob[i]));
    for path in [&map_path, &robot_path, &recording_path] {
        assert_eq!(alice.delete(path).status, 204, "{path}");
        assert_eq!(alice.get(path).status, 404, "{path}");
        assert_eq!(alice.delete(path).status, 404, "{path}");
        assert_eq!(bob.get(path).status, 200, "{path}");
    }
    assert_eq!(bob.post("/v1/plan", &question(&of_bob[0], &of_bob[1])).status, 200);
    for path in [&map_path, &robot_path, &recording_path] {
        assert_eq!(bob.delete(path).status, 204, "{path}");
        assert_eq!(bob.get(path).status, 404, "{path}");
    }
    assert_eq!(data(), 0);
    assert_eq!(folder_store::faults(&folder.path().join("store")), Vec::<String>::new());
}

#[test]
fn what_a_tenant_says_of_a_recording_is_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let server = start(folder.path(), &[]);
    let [alice, bob, ..] = Client::all(&server);
    let csv = "t_s,v_left_mps,v_right_mps,power_w\n0,0.1,0.1,20\n1,0.1,0.1,20\n2,0.1,0.1,20\n";
    let id = created(&alice.record("of-alice", csv));
    assert_eq!(created(&bob.record("of-bob", csv)), id);
    for (tenant, own, other) in [(alice, "of-alice", "of-bob"), (bob, "of-bob", "of-alice")] {
        let text = tenant.get(&format!("/v1/recordings/{id}")).text;
        assert!(text.contains(own) && !text.contains(other), "{text}");
    }
}

#[test]
fn the_same_job_of_two_tenants_is_two_jobs_and_neither_cancels_that_of_the_other() {
    let folder = tempfile::tempdir().unwrap();
    let server = start(folder.path(), &["--parallel-jobs", "2"]);
    let [alice, bob, admin, _] = Client::all(&server);
    let csv = drive_csv(2, 300);
    let recording = created(&alice.record("first", &csv));
    created(&bob.record("first", &csv));
    held(folder.path(), &recording);
    let body = json!({ "robot": "husky-a200", "recordings": [recording] });
    let [of_alice, of_bob] = [alice, bob].map(|tenant| {
        let answer = tenant.post("/v1/calibrate", &body);
        assert_eq!(answer.status, 202, "{}", answer.text);
        answer.json()["id"].as_str().unwrap().to_owned()
    });
    assert_ne!(of_alice, of_bob);
    let path = format!("/v1/jobs/{of_alice}");
    bob.get(&path).problem(404, "unknown-job");
    bob.delete(&path).problem(404, "unknown-job");
    bob.get(&format!("{path}/events")).problem(404, "unknown-job");
    assert_eq!(bob.ids("/v1/jobs", "jobs"), std::slice::from_ref(&of_bob));
    let mut all = admin.ids("/v1/jobs", "jobs");
    all.sort();
    let mut both = [of_alice.clone(), of_bob.clone()];
    both.sort();
    assert_eq!(all, both);
    assert_eq!(bob.delete(&format!("/v1/jobs/{of_bob}")).json()["state"], "cancelled");
    assert!(["queued", "running"].map(Value::from).contains(&alice.get(&path).json()["state"]));
    assert_eq!(admin.delete(&path).json()["state"], "cancelled");
    assert_eq!(alice.get(&path).json()["state"], "cancelled");
}

#[test]
fn jobs_are_listed_with_where_they_stand_and_forgotten_ones_are_not() {
    let server = Server::start();
    assert_eq!(server.get("/v1/jobs").json(), json!({ "jobs": [] }));
    let recording = server.post("/v1/recordings", "text/csv", drive_csv(2, 300).as_bytes()).json();
    let mut jobs = Vec::new();
    for method in ["fit", "dogru-marques"] {
        let body = json!({ "robot": "husky-a200", "recordings": [recording["id"]], "method": method });
        let job = server.post_json("/v1/calibrate", &body).location.unwrap();
        let last = server.events(&format!("{job}/events"), None).last().unwrap().data;
        jobs.push((job, last));
    }
    let listed = server.get("/v1/jobs").json();
    let listed = listed["jobs"].as_array().unwrap();
    assert_eq!(listed.len(), 2);
    for ((_, last), found) in jobs.iter().rev().zip(listed) {
        for field in ["id", "kind", "state", "attempt", "progress"] {
            assert_eq!(found[field], last[field], "{field}");
        }
        assert!(found.get("result").is_none(), "{found}");
    }
    assert_eq!(server.delete(&jobs[0].0).status, 204);
    assert_eq!(server.get("/v1/jobs").json()["jobs"].as_array().unwrap().len(), 1);
}

#[test]
fn robots_are_removed_by_id_and_built_in_ones_are_not() {
    let server = Server::start();
    let stored = server.post_json("/v1/robots", &robot("h"));
    assert_eq!(stored.status, 201, "{}", stored.text);
    let path = format!("/v1/robots/{}", stored.json()["id"].as_str().unwrap());
    assert_eq!(server.delete(&path).status, 204);
    server.get(&path).problem(404, "unknown-robot");
    server.delete(&path).problem(404, "unknown-robot");
    assert_eq!(server.get("/v1/robots").json()["stored"], json!([]));
    let problem = server.delete("/v1/robots/husky-a200").problem(403, "built-in");
    assert!(problem["detail"].as_str().unwrap().contains("husky-a200"), "{problem}");
    for name in [String::new(), "n".repeat(300_000), "a\nb".to_owned()] {
        let problem = server.post_json("/v1/robots", &robot(&name)).problem(400, "invalid-robot");
        assert_eq!(problem["errors"][0]["pointer"], "/name");
        assert!(problem.to_string().len() < 1000, "the name is not told again");
    }
    let mut wide = robot("wide");
    let surface = wide["surfaces"]["marble"].clone();
    for i in 0..10_000 {
        wide["surfaces"][format!("surface-{i}")] = surface.clone();
    }
    server.post_json("/v1/robots", &wide).problem(413, "too-large");
}

#[test]
fn quotas_hold_for_each_tenant_at_all_services_and_after_a_restart() {
    let folder = tempfile::tempdir().unwrap();
    let arguments = ["--tenant-objects", "3", "--tenant-jobs", "1"];
    let mut server = start(folder.path(), &arguments);
    let second = start(folder.path(), &arguments);
    let [alice, bob, admin, _] = Client::all(&server);
    let elsewhere = Client { server: &second, token: ALICE };
    created(&alice.post("/v1/maps", &map(0.0)));
    created(&elsewhere.post("/v1/robots", &robot("one")));
    let recording = created(&alice.record("first", &drive_csv(2, 300)));
    for full in [alice, elsewhere] {
        let problem = full.post("/v1/robots", &robot("two")).problem(507, "store-full");
        let detail = problem["detail"].as_str().unwrap();
        assert!(detail.contains("`alice`") && detail.contains("4 of 3"), "{problem}");
        full.post("/v1/maps", &map(1.0)).problem(507, "store-full");
        full.record("second", &drive_csv(1, 300)).problem(507, "store-full");
    }
    assert_eq!(alice.post("/v1/maps", &map(0.0)).status, 200, "what it has already is no more");
    created(&bob.post("/v1/robots", &robot("two")));
    for number in 0..5 {
        created(&admin.post("/v1/robots", &robot(&format!("of the admin {number}"))));
    }
    held(folder.path(), &recording);
    let job = |mass_kg: f64| {
        let mut robot = robot("lighter");
        robot["mass_kg"] = json!(mass_kg);
        json!({ "robot": robot, "recordings": [recording] })
    };
    assert_eq!(alice.post("/v1/calibrate", &job(80.0)).status, 202);
    for full in [alice, elsewhere] {
        let refused = full.post("/v1/calibrate", &job(70.0));
        refused.problem(429, "quota-exceeded");
        assert!(refused.header("retry-after").parse::<u64>().unwrap() >= 1);
        assert_eq!(full.post("/v1/calibrate", &job(80.0)).status, 202, "the same job is no more");
    }
    let told = alice.get("/v1/status").json()["tenant"].clone();
    assert_eq!((&told["name"], &told["objects"], &told["jobs"]), (&json!("alice"), &json!(3), &json!(1)));
    drop(second);
    server.kill();
    let server = start(folder.path(), &arguments);
    let [alice, ..] = Client::all(&server);
    alice.post("/v1/robots", &robot("two")).problem(507, "store-full");
    alice.post("/v1/calibrate", &job(70.0)).problem(429, "quota-exceeded");
    let again = alice.get("/v1/status").json()["tenant"].clone();
    assert_eq!(again, told, "nothing is counted anew or forgotten");
    let robots = alice.ids("/v1/robots", "stored");
    assert_eq!(alice.delete(&format!("/v1/robots/{}", robots[0])).status, 204);
    created(&alice.post("/v1/robots", &robot("two")));
}

#[test]
fn bytes_are_counted_as_they_lie_in_the_store() {
    let folder = tempfile::tempdir().unwrap();
    let server = start(folder.path(), &["--tenant-bytes", "20000"]);
    let [alice, bob, ..] = Client::all(&server);
    let used = || alice.get("/v1/status").json()["tenant"]["bytes"].as_u64().unwrap();
    assert_eq!(used(), 0);
    created(&alice.post("/v1/maps", &map(0.0)));
    created(&alice.post("/v1/robots", &robot("one")));
    let before = used();
    assert_eq!(before, folder_store::bytes(&folder.path().join("store")));
    let csv = drive_csv(1, 1000);
    assert!(csv.len() > 20_000);
    let problem = alice.record("long", &csv).problem(507, "store-full");
    assert!(problem["detail"].as_str().unwrap().contains("delete"), "{problem}");
    assert_eq!(used(), before, "nothing is left of what was refused");
    assert_eq!(folder_store::bytes(&folder.path().join("store")), before);
    // Content that another keeps counts in full.
    created(&bob.post("/v1/maps", &map(0.0)));
    assert!(bob.get("/v1/status").json()["tenant"]["bytes"].as_u64().unwrap() > 12 * 12 * 4);
    assert_eq!(used(), before);
}

#[test]
fn what_was_stored_before_there_were_tenants_belongs_to_the_default_one() {
    let folder = tempfile::tempdir().unwrap();
    let ids = {
        let mut open = Server::start_over(&folder.path().join("store"));
        let map = created(&open.post_json("/v1/maps", &map(0.0)));
        let robot = created(&open.post_json("/v1/robots", &robot("old")));
        let recording = created(&open.post("/v1/recordings", "text/csv", drive_csv(2, 300).as_bytes()));
        let body = json!({ "robot": robot, "recordings": [recording] });
        let job = open.post_json("/v1/calibrate", &body).json()["id"].as_str().unwrap().to_owned();
        assert!(open.events(&format!("/v1/jobs/{job}/events"), None).last().is_some());
        open.terminate();
        Ids { map, robot, recording, job }
    };
    let server = start(folder.path(), &[]);
    let [alice, bob, admin, old] = Client::all(&server);
    for (path, kind) in ids.paths() {
        assert_eq!(old.get(&path).status, 200, "{path}");
        assert_eq!(admin.get(&path).status, 200, "{path}");
        for other in [alice, bob] {
            other.get(&path).problem(404, kind);
        }
    }
    assert_eq!(old.ids("/v1/jobs", "jobs"), std::slice::from_ref(&ids.job));
    // A map that both have stays when one of them drops it, whoever was first.
    created(&alice.post("/v1/maps", &map(0.0)));
    let path = format!("/v1/maps/{}", ids.map);
    assert_eq!(old.delete(&path).status, 204);
    assert_eq!(alice.get(&path).status, 200);
    assert_eq!(admin.delete(&path).status, 204);
    assert_eq!(alice.get(&path).status, 404);
}

#[test]
fn token_files_that_cannot_be_right_are_refused_in_one_line_without_the_token() {
    let folder = tempfile::tempdir().unwrap();
    for (text, said) in [
        (format!("a/b:{ALICE}\n"), "tenant's name"),
        (format!("alice:{ALICE}\nbob:{ALICE}\n"), "another name"),
        ("alice:short\n".to_owned(), "token 1"),
    ] {
        let file = folder.path().join("tokens");
        fs::write(&file, text).unwrap();
        let output = std::process::Command::new(joulepath_tests::program())
            .args(["serve", "--bind", "127.0.0.1:0", "--token-file", &file.display().to_string()])
            .output()
            .unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.lines().count() == 1 && error.contains(said) && !error.contains(ALICE), "{error}");
    }
}
