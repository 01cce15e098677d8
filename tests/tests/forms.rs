//! Forms of input: which are accepted, and how the others are answered, over HTTP and on the command line.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{f64::consts::TAU, process::Command};

use joulepath_tests::{Server, file, program};
use serde_json::{Value, json};

fn level_map() -> Value {
    json!({ "cell_size_m": 1.0, "rows": 8, "columns": 8, "elevation_m": vec![vec![0.0; 8]; 8], "origin_m": [0, 0] })
}

fn pose() -> Value {
    json!({ "x_m": 1.5, "y_m": 1.5 })
}

fn plan() -> Value {
    json!({ "map": level_map(), "robot": "husky-a200", "start": pose(), "goal": { "x_m": 6.5, "y_m": 6.5 } })
}

/// The document with one value replaced or added.
fn with(mut document: Value, pointer: &str, value: Value) -> Value {
    let (parent, field) = pointer.rsplit_once('/').unwrap();
    match document.pointer_mut(parent).unwrap() {
        Value::Array(elements) => elements[field.parse::<usize>().unwrap()] = value,
        parent => parent[field] = value,
    }
    document
}

/// Every object of every kind of request, written as an array of its fields.
#[test]
fn an_array_never_stands_for_an_object() {
    let server = Server::start();
    let husky = server.get("/v1/robots/husky-a200").json();
    let robot = with(plan(), "/robot", husky.clone());
    let matrix =
        json!({ "map": level_map(), "robot": "husky-a200", "sources": [pose()], "targets": [pose()] });
    let mission = json!({
        "map": level_map(), "robot": "husky-a200", "start": pose(),
        "waypoints": [{ "x_m": 6.5, "y_m": 6.5, "recharge": { "power_w": 100 } }],
        "chargers": [{ "x_m": 3.5, "y_m": 3.5, "power_w": 100 }]
    });
    let reachable =
        json!({ "map": level_map(), "robot": "husky-a200", "start": pose(), "energies_j": [100] });
    let job = json!({ "robot": husky, "recordings": ["0"] });
    let columns = json!({ "robot": "husky-a200", "recordings": ["0".repeat(32)], "map": { "name": "m", "sources": [] } });
    for (path, request, pointer, array) in [
        ("/v1/plan", &plan(), "/start", json!([1.5, 1.5, null])),
        ("/v1/compare", &plan(), "/goal", json!([6.5, 6.5, null, 0])),
        ("/v1/plan", &plan(), "/map", json!([1.0, [0, 0], 1, 1, [[1]]])),
        ("/v1/alternatives", &plan(), "/goal", json!([6.5, 6.5, null, 0])),
        ("/v1/range", &plan(), "/goal", json!([6.5, 6.5, null, 0])),
        ("/v1/reachable", &reachable, "/start", json!([1.5, 1.5, null])),
        ("/v1/matrix", &matrix, "/sources/0", json!([1.5, 1.5, 0])),
        ("/v1/matrix", &matrix, "/targets/0", json!([1.5, 1.5, 0])),
        ("/v1/mission", &mission, "/waypoints/0", json!([6.5, 6.5, null, 0, 0, null])),
        ("/v1/mission", &mission, "/waypoints/0/recharge", json!([100, 0.8])),
        ("/v1/mission", &mission, "/chargers/0", json!([3.5, 3.5, null, 100, 0.8])),
        ("/v1/plan", &robot, "/robot/motors", json!([[0.0023, 1.7], [0.0016, 1.7]])),
        ("/v1/plan", &robot, "/robot/motors/left", json!([0.0023, 1.7])),
        ("/v1/plan", &robot, "/robot/center_of_mass", json!([0.1])),
        ("/v1/plan", &robot, "/robot/limits", json!([600, 0.5, 0.5])),
        ("/v1/plan", &robot, "/robot/battery", json!([480, 24, 0.2])),
        ("/v1/plan", &robot, "/robot/uncertainty", json!([0.1])),
        ("/v1/plan", &robot, "/robot/surfaces", json!([])),
        ("/v1/plan", &robot, "/robot/surfaces/marble", json!([0.06, 0.29])),
        ("/v1/calibrate", &job, "/robot/motors", json!([[0.0023, 1.7], [0.0016, 1.7]])),
        ("/v1/diagnose", &job, "/robot/motors", json!([[0.0023, 1.7], [0.0016, 1.7]])),
        ("/v1/robots", &husky, "/motors", json!([[0.0023, 1.7], [0.0016, 1.7]])),
    ] {
        let problem =
            server.post_json(path, &with(request.clone(), pointer, array)).problem(400, "invalid-request");
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{path}: {problem}");
        assert!(problem["detail"].as_str().unwrap().contains("but found an array"), "{problem}");
    }
    let id = "0".repeat(32);
    let stored = server.post_json("/v1/diagnose", &with(columns, "/recordings", json!([id])));
    assert_eq!(stored.status, 404, "{}", stored.text);
}

#[test]
fn all_missing_fields_of_a_request_are_reported_at_once() {
    let server = Server::start();
    let problem =
        server.post_json("/v1/plan", &json!({ "robot": { "name": "x" } })).problem(400, "invalid-request");
    let pointers: Vec<&str> = problem["errors"]
        .as_array()
        .unwrap()
        .iter()
        .map(|error| error["pointer"].as_str().unwrap())
        .collect();
    for expected in ["/robot/mass_kg", "/robot/motors", "/robot/default_surface", "/start"] {
        assert!(pointers.contains(&expected), "{problem}");
    }
}

#[test]
fn the_id_of_a_map_in_the_place_of_a_map_is_answered_with_the_field_for_it() {
    let server = Server::start();
    let id = server.post_json("/v1/maps", &level_map()).json()["id"].clone();
    let problem = server.post_json("/v1/plan", &with(plan(), "/map", id)).problem(400, "invalid-request");
    assert_eq!(problem["errors"][0]["pointer"], "/map");
    assert!(problem["detail"].as_str().unwrap().contains("did you mean `map_id`?"), "{problem}");
}

#[test]
fn broken_json_is_located_in_requests_and_in_maps_of_columns() {
    let server = Server::start();
    let detail = |path: &str, kind: &str, body: &[u8]| {
        let problem = server.post(path, kind, body).problem(400, "invalid-request");
        problem["detail"].as_str().unwrap().to_owned()
    };
    let said = detail("/v1/plan", "application/json", b"{\n  \"robot\": \"husky-a200\",\n}");
    assert!(said.contains("trailing comma") && said.contains("line 3, column 1"), "{said}");
    let said = detail("/v1/recordings?map=%7B%22name%22:%22m%22,%7D", "text/csv", b"t_s\n1\n");
    assert!(said.contains("trailing comma"), "{said}");
    let said = detail(
        "/v1/recordings?map=%7B%22name%22:%22m%22,%22sources%22:%5B%5B%22power_w%22%5D%5D%7D",
        "text/csv",
        b"t_s\n1\n",
    );
    assert!(said.contains("sources[0]: expected an object"), "{said}");
    let said = detail("/v1/recordings?map=%7B%22name%22:%22m%22%7D", "text/csv", b"t_s\n1\n");
    assert!(said.contains("missing field `sources`"), "{said}");
}

#[test]
fn angles_in_degrees_are_refused_with_their_range() {
    let server = Server::start();
    let list =
        |poses: &str| json!({ "map": level_map(), "robot": "husky-a200", poses: [pose()], "start": pose() });
    let mut matrix = list("sources");
    matrix.as_object_mut().unwrap().remove("start");
    for (path, request, pointer, value) in [
        ("/v1/plan", plan(), "/max_slope_rad", 20.0),
        ("/v1/plan", plan(), "/max_slope_rad", 0.0),
        ("/v1/alternatives", plan(), "/max_slope_rad", 20.0),
        ("/v1/plan", plan(), "/start/heading_rad", 90.0),
        ("/v1/compare", plan(), "/goal/heading_rad", -90.0),
        ("/v1/range", plan(), "/start/heading_rad", 1e300),
        ("/v1/matrix", matrix, "/sources/0/heading_rad", 45.0),
        ("/v1/mission", list("waypoints"), "/waypoints/0/heading_rad", 45.0),
    ] {
        let problem =
            server.post_json(path, &with(request, pointer, json!(value))).problem(400, "invalid-request");
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{path}: {problem}");
        assert!(problem["detail"].as_str().unwrap().contains("give radians"), "{problem}");
    }
    for heading_rad in [-6.29, -1.0, TAU] {
        let answer = server.post_json("/v1/plan", &with(plan(), "/goal/heading_rad", json!(heading_rad)));
        assert_eq!(answer.status, 200, "{}", answer.text);
    }
    let answer = server.post_json("/v1/plan", &with(plan(), "/max_slope_rad", json!(1.571)));
    assert_eq!(answer.status, 200, "{}", answer.text);
}

/// RFC 7946, 3.1.4: a line string has two positions or more.
#[test]
fn a_path_that_stays_in_its_place_is_a_point() {
    let server = Server::start();
    let stay = with(plan(), "/goal", pose());
    let headers = [("content-type", "application/json"), ("accept", "application/geo+json")];
    let answer = server.ask("POST", "/v1/plan", &headers, stay.to_string().as_bytes()).json();
    let geometry = &answer["features"][0]["geometry"];
    assert_eq!(geometry, &json!({ "type": "Point", "coordinates": [1.5, 1.5, 0.0] }));
    let answer = server.ask("POST", "/v1/plan", &headers, plan().to_string().as_bytes()).json();
    let geometry = &answer["features"][0]["geometry"];
    assert_eq!(geometry["type"], "LineString");
    assert!(geometry["coordinates"].as_array().unwrap().len() >= 2);
}

/// What the command line says of a question with these arguments, which it refuses.
fn refused(arguments: &[&str]) -> String {
    let yard = file("maps/yard.json");
    let common = ["plan", "--map", yard.to_str().unwrap(), "--start", "4,8", "--goal", "20,12"];
    let output = Command::new(program()).args(common).args(arguments).output().unwrap();
    let said = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    said
}

#[test]
fn the_command_line_words_mistakes_in_files_like_the_service() {
    let folder = tempfile::tempdir().unwrap();
    let robot = |text: &str| {
        let path = folder.path().join("robot.json");
        std::fs::write(&path, text).unwrap();
        let said = refused(&["--robot", path.to_str().unwrap()]);
        assert!(
            !said.contains(".:") && !said.contains("?:") && said.trim_end().lines().count() == 1,
            "{said}"
        );
        said
    };
    let said = robot(r#"{"name": "x"}"#);
    for field in ["motors", "mass_kg", "wheelbase_m", "surfaces", "default_surface"] {
        assert!(said.contains(&format!("`{field}`")), "{said}");
    }
    assert!(robot("{\"name\": \"x\",\n}").contains("trailing comma (line 2, column 1)"));
    assert!(
        robot(r#"{"name": "x", "mass": 17}"#).contains("mass: unknown field `mass`: did you mean `mass_kg`?")
    );
    assert!(robot("").contains("the document is empty"));
}

#[test]
fn worlds_and_drives_are_read_as_strictly_as_requests() {
    let folder = tempfile::tempdir().unwrap();
    let simulated = |world: &str, drive: &str| {
        let at = |name: &str| folder.path().join(name);
        std::fs::write(at("world.json"), world).unwrap();
        std::fs::write(at("drive.json"), drive).unwrap();
        let output = Command::new(program())
            .args(["simulate", "--world"])
            .arg(at("world.json"))
            .arg("--drive")
            .arg(at("drive.json"))
            .arg("--out")
            .arg(at("out.csv"))
            .output()
            .unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let (world, drive) = (r#"{"terrain": "level"}"#, r#"{"kind": "straight", "duration_s": 5}"#);
    for (world, drive, expected) in [
        (r#"{"terrain": "level", "wind": [3, 0]}"#, drive, "wind: expected an object"),
        (r#"{"terrain": {"level": null}}"#, drive, "expected a name as a string"),
        (r#"{"terrain": {"plane": [0.1, 0]}}"#, drive, "terrain.plane: expected an object"),
        (r#"{"terrain": {"plane": {"grade": 0.1, "uphill_rad": 90}}}"#, drive, "give radians"),
        (r#"{"terrain": "level", "effects": [["payload", 5]]}"#, drive, "effects[0]: expected an object"),
        (world, r#"{"kind": "straight", "duration_s": 5, "start": [1, 2]}"#, "start: expected an object"),
        (
            world,
            r#"{"kind": "straight", "duration_s": 5, "start": {"x_m": 1, "y_m": 2, "heading_rad": 90}}"#,
            "radians",
        ),
        (world, r#"["straight", 5]"#, "expected an object"),
        (world, "{}", "missing fields `kind`, `duration_s`"),
    ] {
        let (code, said) = simulated(world, drive);
        assert_eq!(code, Some(2), "{world} {drive}: {said}");
        assert!(said.contains(expected), "{world} {drive}: {said}");
    }
    assert_eq!(simulated(world, drive).0, Some(0));
}

#[test]
fn a_slope_limit_in_degrees_is_refused_on_the_command_line() {
    let said = refused(&["--max-slope-rad", "20"]);
    assert!(said.contains("radians") && said.contains("1.571"), "{said}");
}
