//! The running service, from outside: maps and goals in, paths and problem documents out.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    io::{Read, Write},
    net::TcpStream,
};

use joulepath_tests::{Answer, Server, file, slope_map};
use serde_json::{Value, json};

fn question() -> Value {
    json!({
        "map": slope_map(12, 20), "robot": "husky-a200",
        "start": { "x_m": 2.5, "y_m": 2.5, "heading_rad": 0.0 }, "goal": { "x_m": 16.5, "y_m": 9.5 }
    })
}

/// The question with one value replaced or, where the value is null, one field removed.
fn question_with(pointer: &str, value: Value) -> Value {
    let mut question = question();
    let (parent, field) = pointer.rsplit_once('/').unwrap();
    let parent = question.pointer_mut(parent).unwrap().as_object_mut().unwrap();
    match value {
        Value::Null => parent.remove(field),
        value => parent.insert(field.to_owned(), value),
    };
    question
}

fn assert_problem(answer: &Answer, status: u16, kind: &str) -> Value {
    answer.problem(status, kind)
}

#[test]
fn a_map_and_a_goal_give_a_path_with_every_field_of_the_contract() {
    let server = Server::start();
    let answer = server.post_json("/v1/plan", &question());
    assert_eq!(answer.status, 200, "{}", answer.text);
    assert!(answer.request_id.is_some());
    let plan = answer.json();
    for field in ["energy_j", "duration_s", "distance_m", "climb_m", "descent_m", "recovered_j"] {
        assert!(plan[field].is_f64(), "{field} is {}", plan[field]);
    }
    let (low, high) =
        (plan["energy_interval_j"][0].as_f64().unwrap(), plan["energy_interval_j"][1].as_f64().unwrap());
    assert!(low < plan["energy_j"].as_f64().unwrap() && plan["energy_j"].as_f64().unwrap() < high);
    assert_eq!(plan["search"]["optimal"], true);
    let poses = plan["poses"].as_array().unwrap();
    let (first, last) = (poses.first().unwrap(), poses.last().unwrap());
    for field in [
        "x_m",
        "y_m",
        "z_m",
        "heading_rad",
        "t_s",
        "distance_m",
        "energy_j",
        "power_w",
        "pitch_rad",
        "radius_m",
    ] {
        assert!(last.get(field).is_some(), "poses have no {field}");
    }
    assert_eq!((first["x_m"].as_f64(), first["y_m"].as_f64()), (Some(2.5), Some(2.5)));
    assert_eq!((last["x_m"].as_f64(), last["y_m"].as_f64()), (Some(16.5), Some(9.5)));
    assert_eq!(last["energy_j"], plan["energy_j"]);
}

#[test]
fn a_stored_map_plans_like_the_same_map_inline_and_is_forgotten_when_deleted() {
    let server = Server::start();
    let stored = server.post_json("/v1/maps", &slope_map(12, 20));
    assert_eq!(stored.status, 201, "{}", stored.text);
    let id = stored.json()["id"].as_str().unwrap().to_owned();
    assert_eq!(
        server.post_json("/v1/maps", &slope_map(12, 20)).status,
        200,
        "the same map is at hand already"
    );
    assert_eq!(server.get("/v1/maps").json()["maps"][0]["id"], id.as_str());
    assert_eq!(server.get(&format!("/v1/maps/{id}")).json()["columns"], 20);

    let inline = server.post_json("/v1/plan", &question()).json();
    let mut by_id = question_with("/map", Value::Null);
    by_id["map_id"] = json!(id);
    let by_id = server.post_json("/v1/plan", &by_id).json();
    assert_eq!(by_id["energy_j"], inline["energy_j"]);
    assert_eq!(by_id["poses"], inline["poses"]);

    assert_eq!(server.delete(&format!("/v1/maps/{id}")).status, 204);
    assert_problem(&server.get(&format!("/v1/maps/{id}")), 404, "unknown-map");
}

#[test]
fn an_inline_map_is_known_again_by_its_content() {
    let server = Server::start();
    let ask = |question: &Value| server.post_json("/v1/plan", question).json();
    let (first, again) = (ask(&question()), ask(&question()));
    for field in ["energy_j", "poses", "refined", "warnings"] {
        assert_eq!(first[field], again[field], "{field}");
    }
    let outcomes = |outcome: &str| {
        server.metric(&format!("joulepath_planner_cache_requests_total{{outcome=\"{outcome}\"}}"))
    };
    assert_eq!((outcomes("miss"), outcomes("hit")), (1.0, 1.0));
    let mut other = question();
    other["map"]["elevation_m"][5][5] = json!(0.9);
    let higher = ask(&other);
    assert_ne!(higher["energy_j"], Value::Null);
    assert_eq!(outcomes("miss"), 2.0, "other ground, by a single cell");
    assert!(server.metric("joulepath_kept_memory_bytes") > 2.0 * 12.0 * 20.0 * 13.0, "their ground counts");
}

#[test]
fn a_map_in_bytes_is_the_same_map_as_in_json() {
    let server = Server::start();
    let (rows, columns) = (3u64, 4u64);
    // From 100 m on, one cell unknown and one an obstacle.
    let above_m: Vec<f32> =
        (0..rows * columns).map(|i| if i == 6 { f32::NAN } else { 0.25 * i as f32 }).collect();
    let mut bytes = b"JPT1".to_vec();
    bytes.extend([rows, columns].iter().flat_map(|count| count.to_le_bytes()));
    bytes.extend([0.5f64, 10.0, 20.0, 100.0].iter().flat_map(|number| number.to_le_bytes()));
    bytes.push(2);
    bytes.extend(above_m.iter().flat_map(|z| z.to_le_bytes()));
    bytes.extend((0..rows * columns).map(|i| u8::from(i == 1)));
    let row = |row: u64| (0..columns).map(move |column| (row * columns + column) as usize);
    let elevation_m: Vec<Vec<Value>> = (0..rows)
        .map(|r| row(r).map(|i| if i == 6 { Value::Null } else { json!(100.0 + 0.25 * i as f64) }).collect())
        .collect();
    let obstacle: Vec<Vec<bool>> = (0..rows).map(|r| row(r).map(|i| i == 1).collect()).collect();
    let map = json!({
        "cell_size_m": 0.5, "origin_m": [10.0, 20.0], "rows": rows, "columns": columns,
        "elevation_m": elevation_m, "obstacle": obstacle
    });
    let sent = server.post("/v1/maps", "application/octet-stream", &bytes);
    assert_eq!(sent.status, 201, "{}", sent.text);
    let named = server.post_json("/v1/maps", &map);
    assert_eq!((named.status, &named.json()["id"]), (200, &sent.json()["id"]), "it is at hand already");
    let cut = assert_problem(
        &server.post("/v1/maps", "application/octet-stream", &bytes[..80]),
        400,
        "invalid-map",
    );
    assert!(cut["detail"].as_str().unwrap().contains("byte 80"), "{cut}");
    let other = server.post("/v1/maps", "application/octet-stream", b"JPC1");
    let detail = assert_problem(&other, 400, "invalid-map");
    assert!(detail["detail"].as_str().unwrap().contains("JPT1"), "{detail}");
    // Rows and columns whose product is beyond any map.
    let mut vast = bytes.clone();
    vast[4..20].fill(0xff);
    let answer = server.post("/v1/maps", "application/octet-stream", &vast);
    assert!((400..500).contains(&answer.status), "{}", answer.text);
}

#[test]
fn the_same_ground_as_json_ascii_and_geotiff_has_a_path() {
    let server = Server::start();
    let ascii = "ncols 12\nnrows 8\nxllcorner 0\nyllcorner 0\ncellsize 1\n".to_owned() + &"1.5 ".repeat(96);
    assert_eq!(server.post("/v1/maps", "text/plain", ascii.as_bytes()).status, 201);
    let tiff = std::fs::read(file("maps/minnesota.tif")).unwrap();
    let stored = server.post("/v1/maps", "image/tiff", &tiff).json();
    assert_eq!((&stored["rows"], &stored["columns"]), (&json!(400), &json!(400)));
    let yard = std::fs::read(file("maps/yard.json")).unwrap();
    let yard = server.post("/v1/maps", "application/json", &yard).json();
    assert_eq!(yard["surfaces"], json!(["sandy_loam", "marble"]));
    let across = json!({
        "map_id": yard["id"], "robot": "husky-a200",
        "start": { "x_m": 4.0, "y_m": 8.0 }, "goal": { "x_m": 20.0, "y_m": 12.0, "tolerance_m": 0.5 }
    });
    assert_eq!(server.post_json("/v1/plan", &across).status, 200);
}

#[test]
fn the_comparison_of_the_real_map_saves_energy_and_stays_under_300_mb() {
    let server = Server::start();
    let tiff = std::fs::read(file("maps/minnesota.tif")).unwrap();
    let id = server.post("/v1/maps", "image/tiff", &tiff).json()["id"].clone();
    let question = json!({
        "map_id": id, "robot": "husky-a200",
        "start": { "x_m": 429290.0, "y_m": 5150530.0 }, "goal": { "x_m": 429600.0, "y_m": 5150830.0 }
    });
    let answer = server.post_json("/v1/compare", &question).json();
    let energy = |path: &str| answer[path]["energy_j"].as_f64().unwrap();
    assert!(energy("energy") < energy("distance") && energy("energy") < energy("time"));
    let saving = answer["saving_fraction"].as_f64().unwrap();
    assert!((saving - (1.0 - energy("energy") / energy("distance"))).abs() < 1e-12);
    let length = |path: &str| answer[path]["distance_m"].as_f64().unwrap();
    assert!(length("distance") <= length("energy") && length("distance") <= length("time") + 0.1);
    if let Some(bytes) = server.peak_memory_bytes() {
        assert!(bytes < 300_000_000, "{bytes} bytes");
    }
}

#[test]
fn a_path_comes_as_geojson_when_asked_for() {
    let server = Server::start();
    let agent = ureq::Agent::new_with_defaults();
    let mut response = agent
        .post(format!("{}/v1/plan", server.url))
        .header("accept", "application/geo+json")
        .send_json(question())
        .unwrap();
    assert_eq!(response.headers()["content-type"], "application/geo+json");
    let geojson: Value = response.body_mut().read_json().unwrap();
    assert_eq!(geojson["features"][0]["geometry"]["type"], "LineString");
    assert_eq!(geojson["features"][0]["geometry"]["coordinates"][0][0], 2.5);
}

#[test]
fn robots_are_listed_and_read_by_name_and_one_of_them_may_be_posted_back() {
    let server = Server::start();
    let robots = server.get("/v1/robots").json();
    let names: Vec<&str> =
        robots["robots"].as_array().unwrap().iter().map(|r| r["name"].as_str().unwrap()).collect();
    let built_in = [
        "bunker",
        "husky-a200",
        "husky-a200-a",
        "husky-a200-b",
        "husky-a200-c",
        "husky-a200-d",
        "husky-a200-field",
        "husky-a300",
        "jackal",
        "leo-rover",
        "rover-pro",
        "scout-2",
        "scout-mini",
        "warthog",
    ];
    assert_eq!(names, built_in);
    let husky = server.get("/v1/robots/husky-a200").json();
    let by_name = server.post_json("/v1/plan", &question()).json();
    let in_full = server.post_json("/v1/plan", &question_with("/robot", husky)).json();
    assert_eq!(in_full["energy_j"], by_name["energy_j"]);
    assert_problem(&server.get("/v1/robots/r2d2"), 404, "unknown-robot");
}

#[test]
fn a_mechanism_within_its_stated_range_is_taken_and_beyond_it_refused_on_small_robots_and_large_ones() {
    let server = Server::start();
    for name in ["husky-a200", "warthog"] {
        let robot = server.get(&format!("/v1/robots/{name}")).json();
        let answer = server.get(&format!("/v1/robots/{name}/mechanisms")).json();
        let drag =
            answer["mechanisms"].as_array().unwrap().iter().find(|one| one["mechanism"] == "drivetrain_drag");
        let parameters = &drag.unwrap()["parameters"];
        assert_eq!((&parameters[0]["name"], &parameters[0]["unit"]), (&json!("left_n"), &json!("N")));
        let greatest_n = parameters[0]["greatest"].as_f64().unwrap();
        // 300 N on a Husky of 90 kg, and more on a heavier robot.
        let expected_n = 300.0 * robot["mass_kg"].as_f64().unwrap() / 90.0;
        assert!((greatest_n - expected_n).abs() < 1e-6 * expected_n, "{greatest_n}");
        let with_drag_n = |left_n: f64| {
            let mut robot = robot.clone();
            robot["mechanisms"] =
                json!([{"mechanism": "drivetrain_drag", "parameters": {"left_n": left_n, "right_n": 0.0}}]);
            server.post_json("/v1/robots", &robot)
        };
        assert_eq!(with_drag_n(greatest_n).status, 201);
        with_drag_n(1.01 * greatest_n).problem(400, "invalid-robot");
    }
    assert_problem(&server.get("/v1/robots/r2d2/mechanisms"), 404, "unknown-robot");
}

#[test]
fn wrong_requests_are_refused_with_the_pointer_to_the_field() {
    let server = Server::start();
    let husky = server.get("/v1/robots/husky-a200").json();
    let husky_with = |pointer: &str, value: Value| {
        let mut robot = husky.clone();
        *robot.pointer_mut(pointer).unwrap() = value;
        robot
    };
    let ragged = json!({ "cell_size_m": 1, "rows": 2, "columns": 2, "elevation_m": [[0, 1], [2]] });
    let with_surface = json!({ "cell_size_m": 1, "rows": 1, "columns": 2, "elevation_m": [[0, 1]], "surface": [["lava", "lava"]] });
    for (pointer, value, status, kind, at) in [
        ("/colour", json!("red"), 400, "invalid-request", "/colour"),
        ("/start/x", json!(1), 400, "invalid-request", "/start/x"),
        ("/start/x_m", json!("far"), 400, "invalid-request", "/start/x_m"),
        ("/start/x_m", Value::Null, 400, "invalid-request", "/start/x_m"),
        ("/objective", json!("beauty"), 400, "invalid-request", "/objective"),
        ("/map/elevation_m", json!([["high"]]), 400, "invalid-request", "/map/elevation_m/0/0"),
        ("/map", ragged, 400, "invalid-map", "/map/elevation_m/1"),
        ("/map/cell_size_m", json!(-1), 400, "invalid-map", "/map/cell_size_m"),
        ("/map/rows", json!(0), 400, "invalid-map", "/map/rows"),
        ("/map/elevation_m/0/3", json!(123_456), 400, "invalid-map", "/map/elevation_m/0/3"),
        ("/map/rows", json!(4_000_000_000u64), 413, "too-large", "/map/rows"),
        ("/map", Value::Null, 400, "invalid-request", "/map"),
        ("/map_id", json!("abc"), 400, "invalid-request", "/map_id"),
        ("/robot", json!("r2d2"), 404, "unknown-robot", "/robot"),
        ("/robot", json!(7), 400, "invalid-request", "/robot"),
        ("/robot", husky_with("/wheelbase_m", json!(5400)), 400, "invalid-robot", "/robot/wheelbase_m"),
        (
            "/robot",
            husky_with("/motors/left/k2", json!("x")),
            400,
            "invalid-request",
            "/robot/motors/left/k2",
        ),
        (
            "/robot",
            husky_with("/default_surface", json!("ice")),
            400,
            "invalid-robot",
            "/robot/default_surface",
        ),
        ("/map", with_surface, 422, "unknown-surface", "/robot"),
        ("/start", json!([1.5, 4.5, 0]), 400, "invalid-request", "/start"),
        ("/map", json!([1.0, [0, 0], 1, 1, [[1]]]), 400, "invalid-request", "/map"),
        ("/start/x_m", json!(-5), 422, "start-outside-map", "/start"),
        ("/goal/y_m", json!(500), 422, "goal-outside-map", "/goal"),
        ("/start/x_m", json!(0.2), 422, "start-blocked", "/start"),
        ("/speed_mps", json!(40), 400, "invalid-request", "/speed_mps"),
        ("/goal/tolerance_m", json!(-1), 400, "invalid-request", "/goal/tolerance_m"),
        ("/snap_radius_m", json!(-1), 400, "invalid-request", "/snap_radius_m"),
    ] {
        let mut body = if pointer.matches('/').count() > 2 {
            let mut body = question();
            *body.pointer_mut(pointer).unwrap() = value;
            body
        } else {
            question_with(pointer, value)
        };
        if kind == "start-blocked" {
            body["snap_radius_m"] = json!(0);
            body["start"]["y_m"] = json!(0.2);
            body["start"]["heading_rad"] = json!(0.785);
        }
        let problem = assert_problem(&server.post_json("/v1/plan", &body), status, kind);
        assert_eq!(problem["errors"][0]["pointer"], at, "{problem}");
    }
}

#[test]
fn a_wall_leaves_no_path_and_says_where() {
    let server = Server::start();
    let mut map = slope_map(12, 20);
    let wall = |_| (0..20).map(|c| c == 9).collect::<Vec<bool>>();
    map["obstacle"] = json!((0..12).map(wall).collect::<Vec<_>>());
    let answer = server.post_json("/v1/plan", &question_with("/map", map));
    let problem = assert_problem(&answer, 422, "no-path");
    assert!(problem["detail"].as_str().unwrap().contains("wall"), "{problem}");
}

#[test]
fn everything_else_that_fails_is_a_problem_document_too() {
    let server = Server::start();
    assert_problem(&server.get("/v2/nothing"), 404, "not-found");
    assert_problem(&server.get("/v1/plan"), 405, "method-not-allowed");
    assert_problem(&server.get("/v1/maps/%ff"), 404, "not-found");
    assert_problem(&server.post("/v1/plan", "application/json", b"[]"), 400, "invalid-request");
    assert_problem(&server.post("/v1/plan", "application/json", b""), 400, "invalid-request");
    assert_problem(&server.post("/v1/plan", "text/html", b"<p>"), 415, "unsupported-media-type");
    assert_problem(&server.post("/v1/maps", "image/png", b"x"), 415, "unsupported-media-type");
    assert_problem(&server.post("/v1/plan", "application/json", b"{\"map\": "), 400, "invalid-request");
    assert_problem(&server.post("/v1/plan", "application/json", b"\xff\xfe"), 400, "invalid-request");
    let whole = std::fs::read(file("maps/minnesota.tif")).unwrap();
    assert_problem(&server.post("/v1/maps", "image/tiff", &whole[..5000]), 400, "invalid-map");
    assert_problem(&server.post("/v1/maps", "text/plain", b"ncols 3\n"), 400, "invalid-map");
    assert_eq!(server.get("/v1/maps").json()["maps"], json!([]), "nothing half-done remains");
    assert_eq!(server.get("/healthz").json()["status"], "ok");
}

#[test]
fn comparing_a_place_with_itself_saves_nothing_and_a_descent_saves_what_it_does() {
    let server = Server::start();
    let here = json!({ "x_m": 2.5, "y_m": 2.5 });
    let nowhere = server.post_json("/v1/compare", &question_with("/goal", here)).json();
    assert_eq!(nowhere["saving_fraction"], 0.0);
    let steep = |r: usize| (0..20).map(|c| 6.0 - 0.3 * c as f64 + 0.1 * (r % 3) as f64).collect::<Vec<_>>();
    let mut map = slope_map(12, 20);
    map["elevation_m"] = json!((0..12).map(steep).collect::<Vec<_>>());
    let down = server.post_json("/v1/compare", &question_with("/map", map)).json();
    let energy = |path: &str| down[path]["energy_j"].as_f64().unwrap();
    assert!(energy("distance") < 0.0, "the descent returns energy");
    assert!(energy("energy") <= energy("distance"));
    assert!(down["saving_fraction"].as_f64().unwrap() >= 0.0, "returning more is a saving");
}

#[test]
fn a_robot_without_room_to_turn_is_told_so() {
    let server = Server::start();
    let lane =
        json!({ "cell_size_m": 1.0, "rows": 1, "columns": 8, "elevation_m": [[0, 0, 0, 0, 0, 0, 0, 0]] });
    let mut question = question_with("/map", lane);
    question["start"] = json!({ "x_m": 1.5, "y_m": 0.5, "heading_rad": 3.1 });
    question["goal"] = json!({ "x_m": 6.5, "y_m": 0.5 });
    let problem = assert_problem(&server.post_json("/v1/plan", &question), 422, "no-path");
    assert!(problem["detail"].as_str().unwrap().contains("room to turn"), "{problem}");
    question["reverse"] = json!(true);
    assert_eq!(server.post_json("/v1/plan", &question).status, 200);
}

#[test]
fn a_pointer_names_the_field_that_the_request_has() {
    let server = Server::start();
    let fine = json!({ "cell_size_m": 0.01, "rows": 1, "columns": 2, "elevation_m": [[0, 0]] });
    let id = server.post_json("/v1/maps", &fine).json()["id"].clone();
    let mut long = server.get("/v1/robots/husky-a200").json();
    long["wheelbase_m"] = json!(5.0);
    let mut question = question_with("/robot", long);
    question["map"] = Value::Null;
    question["map_id"] = id;
    let problem = assert_problem(&server.post_json("/v1/plan", &question), 400, "invalid-map");
    assert_eq!(problem["errors"][0]["pointer"], "/map_id", "{problem}");
}

#[test]
fn a_client_that_stalls_does_not_keep_the_service_from_ending() {
    let mut server = Server::start();
    let mut stalled = TcpStream::connect(server.url.trim_start_matches("http://")).unwrap();
    let head = "POST /v1/plan HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 100\r\n\r\n{";
    stalled.write_all(head.as_bytes()).unwrap();
    assert_eq!(server.get("/healthz").status, 200);
    assert!(server.terminate().success());
}

#[test]
fn a_body_over_the_limit_is_refused_before_it_is_sent() {
    let server = Server::start();
    let mut stream = TcpStream::connect(server.url.trim_start_matches("http://")).unwrap();
    let head = "POST /v1/maps HTTP/1.1\r\nhost: localhost\r\ncontent-type: application/json\r\ncontent-length: 99999999\r\nconnection: close\r\n\r\n";
    stream.write_all(head.as_bytes()).unwrap();
    let mut answer = String::new();
    stream.read_to_string(&mut answer).unwrap();
    assert!(answer.starts_with("HTTP/1.1 413"), "{answer}");
    assert!(answer.contains("application/problem+json") && answer.contains("too-large"), "{answer}");
}

#[test]
fn the_description_lists_what_the_service_does() {
    let server = Server::start();
    insta::assert_json_snapshot!("openapi", server.get("/openapi.json").json());
}

/// A question over a stored map, from near its south-west corner to the north-east.
fn question_between(map: &Value) -> Value {
    let origin = [map["origin_m"][0].as_f64().unwrap(), map["origin_m"][1].as_f64().unwrap()];
    json!({
        "map_id": map["id"], "robot": "husky-a200",
        "start": { "x_m": origin[0] + 60.0, "y_m": origin[1] + 70.0 },
        "goal": { "x_m": origin[0] + 240.0, "y_m": origin[1] + 210.0 }
    })
}

/// Totals of a path against sums over its poses.
fn totals_follow_from_poses(path: &Value) {
    let total = |field: &str| path[field].as_f64().unwrap();
    let poses = path["poses"].as_array().unwrap();
    let steps = |field: &str| -> Vec<f64> {
        poses.windows(2).map(|p| p[1][field].as_f64().unwrap() - p[0][field].as_f64().unwrap()).collect()
    };
    let (rises_m, energies_j) = (steps("z_m"), steps("energy_j"));
    let sum = |values: &[f64], sign: f64| values.iter().map(|v| (sign * v).max(0.0)).sum::<f64>();
    for (name, from_poses) in [
        ("climb_m", sum(&rises_m, 1.0)),
        ("descent_m", sum(&rises_m, -1.0)),
        ("recovered_j", sum(&energies_j, -1.0)),
        ("energy_j", energies_j.iter().sum()),
        ("distance_m", steps("distance_m").iter().sum()),
        ("duration_s", steps("t_s").iter().sum()),
    ] {
        assert!((total(name) - from_poses).abs() < 1e-6 * (1.0 + from_poses.abs()), "{name}: {from_poses}");
    }
    let [low_j, high_j] = [0, 1].map(|end| path["energy_interval_j"][end].as_f64().unwrap());
    assert!(low_j < total("energy_j") && total("energy_j") < high_j, "{low_j} to {high_j}");
    assert!(path["clearance_m"].as_f64().unwrap() > 0.0);
}

#[test]
fn a_loose_bound_is_proven_and_the_refined_path_is_never_worse() {
    let server = Server::start();
    let map =
        server.post("/v1/maps", "image/tiff", &std::fs::read(file("maps/minnesota.tif")).unwrap()).json();
    let ask = |extra: Value| {
        let mut question = question_between(&map);
        question.as_object_mut().unwrap().extend(extra.as_object().unwrap().clone());
        let answer = server.post_json("/v1/plan", &question);
        assert_eq!(answer.status, 200, "{}", answer.text);
        answer.json()
    };
    let best = ask(json!({}));
    assert_eq!(best["search"]["optimal"], true);
    // The best of the lattice, to the rounding of costs: 1/2048 of each motion's, which here lift several times what they take.
    let proven = best["search"]["bound"].as_f64().unwrap();
    assert!((1.0..1.005).contains(&proven), "{proven}");
    let energy = |plan: &Value| plan["energy_j"].as_f64().unwrap();
    assert!(best["refined_energy_j"].as_f64().unwrap() <= energy(&best));
    let (lattice, refined) =
        (best["poses"].as_array().unwrap(), best["refined"]["poses"].as_array().unwrap());
    for field in ["x_m", "y_m", "heading_rad"] {
        assert_eq!(lattice[0][field], refined[0][field], "both begin in one pose");
    }
    totals_follow_from_poses(&best["refined"]);
    totals_follow_from_poses(&best);
    assert_eq!(best["refined"]["finished"], true);
    // What files hold is the refined path.
    let mut asked = question_between(&map);
    asked["map_id"] = map["id"].clone();
    let headers = [("content-type", "application/json"), ("accept", "application/geo+json")];
    let geojson = server.ask("POST", "/v1/plan", &headers, asked.to_string().as_bytes()).json();
    let feature = &geojson["features"][0];
    assert_eq!(feature["properties"]["energy_j"], best["refined_energy_j"]);
    assert_eq!(feature["properties"]["lattice_energy_j"], best["energy_j"]);
    assert_eq!(feature["geometry"]["coordinates"].as_array().map(Vec::len), Some(refined.len()));
    let loose = ask(json!({ "bound": 1.2, "refine": false }));
    let bound = loose["search"]["bound"].as_f64().unwrap();
    assert!((1.0..=1.2).contains(&bound) && energy(&loose) <= energy(&best) * bound * 1.001);
    assert!(loose.get("refined").is_none());
    let held = ask(json!({ "hold_goal": true, "refine": false }));
    assert_eq!(held["search"]["expanded"], 0, "a held goal needs no search");
    assert!((energy(&held) - energy(&best)).abs() < 1e-3 * energy(&best));
}

#[test]
fn unusable_bounds_times_and_tolerances_are_named() {
    let server = Server::start();
    for (pointer, value, at) in [
        ("/bound", json!(0.5), "/bound"),
        ("/timeout_s", json!(0), "/timeout_s"),
        ("/timeout_s", json!(-3), "/timeout_s"),
    ] {
        let problem = assert_problem(
            &server.post_json("/v1/plan", &question_with(pointer, value)),
            400,
            "invalid-request",
        );
        assert_eq!(problem["errors"][0]["pointer"], at, "{problem}");
    }
    let mut question = question_with("/snap_radius_m", json!(5.0));
    question["goal"]["tolerance_m"] = json!(1.0);
    let problem = assert_problem(&server.post_json("/v1/plan", &question), 400, "invalid-request");
    assert_eq!(problem["errors"][0]["pointer"], "/goal/tolerance_m");
}

#[test]
fn a_patch_makes_a_new_map_beside_the_old_one() {
    let server = Server::start();
    let map = server.post_json("/v1/maps", &slope_map(30, 30)).json();
    let path = format!("/v1/maps/{}", map["id"].as_str().unwrap());
    let wall = json!({ "row": 0, "column": 15, "obstacle": vec![vec![true]; 30] });
    let plan = |id: &Value| {
        let ends = (json!({ "x_m": 4.5, "y_m": 15.5 }), json!({ "x_m": 26.5, "y_m": 15.5 }));
        server.post_json(
            "/v1/plan",
            &json!({ "map_id": id, "robot": "husky-a200", "start": ends.0, "goal": ends.1 }),
        )
    };
    assert_eq!(plan(&map["id"]).status, 200);
    let answer = server.patch_json(&path, &wall);
    assert_eq!(answer.status, 201, "{}", answer.text);
    let changed = answer.json();
    assert_ne!(changed["id"], map["id"]);
    assert_problem(&plan(&changed["id"]), 422, "no-path");
    assert_eq!(plan(&map["id"]).status, 200, "the map before is still there");
    let beyond = json!({ "row": 29, "column": 0, "obstacle": [[true], [true]] });
    let problem = assert_problem(&server.patch_json(&path, &beyond), 400, "invalid-map");
    assert_eq!(problem["errors"][0]["pointer"], "/row");
    assert_problem(&server.patch_json("/v1/maps/0123456789abcdef", &wall), 404, "unknown-map");
}
