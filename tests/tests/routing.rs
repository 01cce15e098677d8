//! Many paths at once, from outside: matrices, reachable ground, alternatives and limits.

#![allow(clippy::unwrap_used, clippy::panic)]

use joulepath_tests::{Server, program};
use serde_json::{Value, json};

fn slope_map() -> Value {
    let row = |r: usize| (0..24).map(|c| 0.05 * c as f64 + 0.3 * (r as f64 / 3.0).sin()).collect::<Vec<_>>();
    json!({ "cell_size_m": 1.0, "rows": 16, "columns": 24, "elevation_m": (0..16).map(row).collect::<Vec<_>>() })
}

fn question(extra: &Value) -> Value {
    let mut question = json!({ "map": slope_map(), "robot": "husky-a200" });
    question.as_object_mut().unwrap().extend(extra.as_object().unwrap().clone());
    question
}

fn start() -> Value {
    json!({ "x_m": 3.5, "y_m": 3.5, "heading_rad": 0.0 })
}

fn goal() -> Value {
    json!({ "x_m": 19.5, "y_m": 11.5 })
}

#[test]
fn a_matrix_holds_what_plans_hold() {
    let server = Server::start();
    let poses = json!([start(), goal(), { "x_m": 12.5, "y_m": 4.5 }]);
    let answer = server.post_json("/v1/matrix", &question(&json!({ "sources": poses })));
    assert_eq!(answer.status, 200, "{}", answer.text);
    let plan = server.post_json("/v1/plan", &question(&json!({ "start": start(), "goal": goal() }))).json();
    for field in ["energy_j", "duration_s", "distance_m"] {
        let (entry, own) = (answer.json()[field][0][1].as_f64().unwrap(), plan[field].as_f64().unwrap());
        assert!((entry - own).abs() <= 1e-9 * own, "{field}: {entry}, {own}");
    }
    assert_eq!(answer.json()["unreachable"], json!([]));
}

#[test]
fn contours_are_geojson_and_the_raster_is_a_map_again() {
    let server = Server::start();
    let body = question(&json!({ "start": start(), "kind": "out-and-back", "energies_j": [300.0, 1500.0] }));
    let answer = server.post_json("/v1/reachable", &body);
    assert_eq!(answer.status, 200, "{}", answer.text);
    let features = answer.json()["features"].as_array().unwrap().clone();
    let area = |i: usize| features[i]["properties"]["area_m2"].as_f64().unwrap();
    assert!(0.0 < area(0) && area(0) < area(1), "{} and {} m²", area(0), area(1));
    assert_eq!(features[0]["geometry"]["type"], "MultiPolygon");
    let ring = features[1]["geometry"]["coordinates"][0][0].as_array().unwrap();
    assert_eq!(ring.first(), ring.last());
}

#[test]
fn limits_hold_and_those_that_no_path_keeps_are_told_with_the_least() {
    let server = Server::start();
    let ends = json!({ "start": start(), "goal": goal() });
    let with = |field: &str, value: f64| {
        let mut ends = ends.clone();
        ends[field] = json!(value);
        server.post_json("/v1/plan", &question(&ends))
    };
    let free = server.post_json("/v1/plan", &question(&ends)).json();
    let most_s = 1.01 * free["duration_s"].as_f64().unwrap();
    assert!(with("max_time_s", most_s).json()["duration_s"].as_f64().unwrap() <= most_s);
    let problem = with("max_time_s", 1.0).problem(422, "limits-contradict");
    assert!(problem["detail"].as_str().unwrap().contains("least time"), "{problem}");
    let problem = with("max_time_s", -1.0).problem(400, "invalid-request");
    assert_eq!(problem["errors"][0]["pointer"], "/max_time_s");
}

#[test]
fn a_ridge_steeper_than_the_slope_limit_is_told_from_no_path() {
    let server = Server::start();
    let row: Vec<f64> = (0..24).map(|c| if c == 11 || c == 12 { 0.3 } else { 0.0 }).collect();
    let map = json!({ "cell_size_m": 1.0, "rows": 16, "columns": 24, "elevation_m": vec![row; 16] });
    let over = |most_rad: f64| {
        let body = json!({
            "map": map, "robot": "husky-a200", "start": start(), "goal": goal(), "max_slope_rad": most_rad
        });
        server.post_json("/v1/plan", &body)
    };
    assert_eq!(over(0.5).status, 200);
    let problem = over(0.1).problem(422, "limits-contradict");
    assert_eq!(problem["errors"][0]["pointer"], "/max_slope_rad");
}

#[test]
fn alternatives_trade_energy_for_time() {
    let server = Server::start();
    let ends = json!({ "start": start(), "goal": goal(), "count": 5, "epsilon": 0.0 });
    let answer = server.post_json("/v1/alternatives", &question(&ends));
    assert_eq!(answer.status, 200, "{}", answer.text);
    let found = answer.json()["alternatives"].as_array().unwrap().clone();
    assert!(!found.is_empty());
    for pair in found.windows(2) {
        let of = |field: &str| [0, 1].map(|i| pair[i][field].as_f64().unwrap());
        let ([less_j, more_j], [more_s, less_s]) = (of("energy_j"), of("duration_s"));
        assert!(less_j < more_j && less_s < more_s);
    }
}

#[test]
fn what_cannot_be_asked_is_named_by_its_place() {
    let server = Server::start();
    let away = json!({ "x_m": 900.0, "y_m": 4.5 });
    let refused = |path: &str, body: &Value, status: u16, kind: &str, pointer: &str| {
        let problem = server.post_json(path, &question(body)).problem(status, kind);
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{problem}");
    };
    refused("/v1/matrix", &json!({ "sources": [start(), away] }), 422, "waypoint-outside-map", "/sources/1");
    refused("/v1/matrix", &json!({ "sources": [] }), 400, "invalid-request", "/sources");
    let many: Vec<Value> = vec![start(); 60];
    refused("/v1/matrix", &json!({ "sources": many }), 413, "too-large", "/sources");
    let reach = |extra: Value| {
        let mut body = json!({ "start": start() });
        body.as_object_mut().unwrap().extend(extra.as_object().unwrap().clone());
        body
    };
    refused("/v1/reachable", &reach(json!({})), 400, "invalid-request", "/energies_j");
    let wrong = reach(json!({ "energies_j": [10.0, -1.0] }));
    refused("/v1/reachable", &wrong, 400, "invalid-request", "/energies_j/1");
    refused("/v1/reachable", &reach(json!({ "charges": [1.5] })), 400, "invalid-request", "/charges/0");
    let outside = json!({ "start": away, "energies_j": [10.0] });
    refused("/v1/reachable", &outside, 422, "start-outside-map", "/start");
    let ends = json!({ "start": start(), "goal": goal(), "count": 1 });
    refused("/v1/alternatives", &ends, 400, "invalid-request", "/count");
    assert!(server.get("/v1/status").json()["limits"]["matrix_entries"].is_u64());
}

#[test]
fn the_command_line_answers_as_the_service_does() {
    let folder = std::env::temp_dir().join(format!("joulepath-routing-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let map = folder.join("map.json");
    std::fs::write(&map, slope_map().to_string()).unwrap();
    let run = |arguments: &[&str]| {
        let output =
            std::process::Command::new(program()).args(arguments).arg("--map").arg(&map).output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        (output.status.code(), text, String::from_utf8(output.stderr).unwrap())
    };
    let (code, text, _) = run(&["matrix", "--source", "3.5,3.5,0", "--source", "19.5,11.5", "--json"]);
    let entry = serde_json::from_str::<Value>(&text).unwrap()["energy_j"][0][1].as_f64().unwrap();
    let plan = Server::start()
        .post_json("/v1/plan", &question(&json!({ "start": start(), "goal": goal() })))
        .json()["energy_j"]
        .as_f64()
        .unwrap();
    assert!(code == Some(0) && (entry - plan).abs() <= 1e-9 * plan, "{entry}, {plan}");
    let picture = folder.join("reach.png");
    let (code, text, error) = run(&[
        "reachable",
        "--start",
        "3.5,3.5",
        "--charge",
        "0.25",
        "--charge",
        "0.9",
        "--png",
        picture.to_str().unwrap(),
    ]);
    assert!(code == Some(0) && text.contains("charge 0.25"), "{text}{error}");
    assert!(std::fs::read(&picture).unwrap().starts_with(b"\x89PNG"));
    let (code, _, error) = run(&["plan", "--start", "3.5,3.5", "--goal", "19.5,11.5", "--max-time-s", "1"]);
    assert!(code == Some(3) && error.contains("least time"), "{code:?} {error}");
    std::fs::remove_dir_all(&folder).unwrap();
}
