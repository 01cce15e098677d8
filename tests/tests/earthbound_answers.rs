//! Answers about maps that lie on earth: KML, rasters in the map's system, lattices of places; and the doubts and names of maps.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::process::Command;

use joulepath_tests::{Server, program};
use serde_json::{Value, json};

/// Level ground of 40 m, whose cells of 1 m are placed by a system or not.
fn field(crs: Option<&str>, origin_m: [f64; 2]) -> Value {
    let mut map = json!({
        "cell_size_m": 1.0, "rows": 40, "columns": 40, "elevation_m": vec![vec![0.0; 40]; 40], "origin_m": origin_m
    });
    if let Some(crs) = crs {
        map["crs"] = crs.into();
    }
    map
}

const ORIGIN_M: [f64; 2] = [512_000.0, 5_422_970.0];

fn question(crs: Option<&str>) -> Value {
    json!({
        "map": field(crs, ORIGIN_M), "robot": "husky-a200",
        "start": { "x_m": 512_008.5, "y_m": 5_422_976.5 }, "goal": { "x_m": 512_030.5, "y_m": 5_422_994.5 }
    })
}

fn with(mut document: Value, field: &str, value: Value) -> Value {
    document[field] = value;
    document
}

#[test]
fn kml_is_a_line_in_degrees_and_is_refused_where_nothing_says_where_the_map_lies() {
    let server = Server::start();
    let asked = |request: &Value| {
        let headers =
            [("content-type", "application/json"), ("accept", "application/vnd.google-earth.kml+xml")];
        server.ask("POST", "/v1/plan", &headers, request.to_string().as_bytes())
    };
    let placed = asked(&question(Some("EPSG:32632")));
    assert_eq!(placed.header("content-type"), "application/vnd.google-earth.kml+xml");
    // pyproj: (512008.5, 5422976.5) is 9.164046814 E, 48.959589321 N.
    assert!(placed.text.contains("<coordinates>9.164046814,48.959589321,0.000\n"), "{}", placed.text);
    assert!(placed.text.contains("<LineString>") && placed.text.contains("<Data name=\"energy_j\">"));
    let doubts = json!([{ "kind": "interpolated", "detail": "heights < 255 & more" }]);
    let doubtful = with(
        question(Some("EPSG:32632")),
        "map",
        with(field(Some("EPSG:32632"), ORIGIN_M), "warnings", doubts),
    );
    assert!(asked(&doubtful).text.contains("heights &lt; 255 &amp; more"), "doubts go with the path");
    for (crs, says) in [(None, "no crs"), (Some("EPSG:27700"), "datum")] {
        let problem = asked(&question(crs)).problem(400, "invalid-map");
        let detail = problem["detail"].as_str().unwrap();
        assert!(detail.contains(says) && detail.contains("EPSG:32632"), "{detail}");
    }
}

#[test]
fn a_map_says_where_on_earth_it_lies() {
    let server = Server::start();
    let id = |map: &Value| server.post_json("/v1/maps", map).json()["id"].as_str().unwrap().to_owned();
    let earth = server.get(&format!("/v1/maps/{}/earth", id(&field(Some("EPSG:32632"), ORIGIN_M)))).json();
    assert_eq!(earth["crs"], "EPSG:32632");
    // pyproj: the south-west corner, and the convergence of meridians at the middle, 0.124°.
    let corner = &earth["degrees"]["places_deg"][0];
    assert!((corner[0].as_f64().unwrap() - 9.163_930_526).abs() < 1e-6, "{corner}");
    assert!((corner[1].as_f64().unwrap() - 48.959_531_008).abs() < 1e-6, "{corner}");
    let turned_deg = earth["true_north_rad"].as_f64().unwrap().to_degrees() - 90.0;
    assert!((turned_deg - 0.1239).abs() < 1e-3, "{turned_deg}");
    let nowhere = server.get(&format!("/v1/maps/{}/earth", id(&field(None, ORIGIN_M))));
    assert!(nowhere.problem(400, "invalid-map")["detail"].as_str().unwrap().contains("no crs"));
    assert_eq!(server.get(&format!("/v1/maps/{}/earth", "0".repeat(32))).status, 404);
}

#[test]
fn the_raster_of_what_is_reached_is_in_the_system_of_the_map() {
    let server = Server::start();
    let raster = |crs: Option<&str>| {
        let mut request = question(crs);
        request.as_object_mut().unwrap().remove("goal");
        let request = with(request, "energies_j", json!([500]));
        let headers = [("content-type", "application/json"), ("accept", "image/tiff")];
        let answer = server.ask("POST", "/v1/reachable", &headers, request.to_string().as_bytes());
        assert_eq!(answer.status, 200, "{}", answer.text);
        server.post("/v1/maps", "image/tiff", &answer.body).json()
    };
    let placed = raster(Some("EPSG:32632"));
    assert_eq!((placed["crs"].as_str(), &placed["origin_m"]), (Some("EPSG:32632"), &json!(ORIGIN_M)));
    assert!(raster(None).get("crs").is_none());
}

#[test]
fn matrix_range_and_mission_repeat_the_doubts_about_their_map() {
    let server = Server::start();
    let doubts = json!([{ "kind": "interpolated", "detail": "pixels were turned" }]);
    let map = with(field(None, ORIGIN_M), "warnings", doubts.clone());
    let (start, goal) = (question(None)["start"].clone(), question(None)["goal"].clone());
    for (path, more) in [
        ("/v1/matrix", json!({ "sources": [start], "targets": [goal] })),
        ("/v1/range", json!({ "start": start, "goal": goal, "samples": 10 })),
        ("/v1/mission", json!({ "start": start, "waypoints": [goal], "samples": 10 })),
        ("/v1/reachable", json!({ "start": start, "energies_j": [500] })),
    ] {
        let mut request = more;
        request["robot"] = "husky-a200".into();
        let answer = server.post_json(path, &with(request, "map", map.clone()));
        assert_eq!(answer.status, 200, "{path}: {}", answer.text);
        assert_eq!(answer.json()["warnings"], doubts, "{path}");
    }
}

#[test]
fn a_map_keeps_its_last_name_and_one_content_under_two_names_is_one_map() {
    let server = Server::start();
    let body = field(None, [0.0; 2]).to_string();
    let sent = |query: &str, body: &str| {
        server.post(&format!("/v1/maps{query}"), "application/json", body.as_bytes())
    };
    let first = sent("?name=yard.json", &body);
    assert_eq!((first.status, &first.json()["name"]), (201, &json!("yard.json")));
    let path = format!("/v1/maps/{}", first.json()["id"].as_str().unwrap());
    let read = server.get(&path);
    assert_eq!(read.json()["name"], "yard.json");
    let unnamed = sent("", &body);
    assert_eq!(
        (unnamed.status, &unnamed.json()["name"]),
        (200, &json!("yard.json")),
        "no name takes none away"
    );
    let second = sent("?name=H%C3%B6fe%20%26%20Wege", &body).json();
    assert_eq!((&second["name"], &second["id"]), (&json!("Höfe & Wege"), &first.json()["id"]));
    let listed = server.get("/v1/maps").json();
    assert_eq!(listed["maps"].as_array().unwrap().len(), 1);
    assert_eq!(listed["maps"][0]["name"], "Höfe & Wege");
    let held = [("if-none-match", read.header("etag"))];
    let again = server.ask("GET", &path, &held, b"");
    assert_eq!(
        (again.status, &again.json()["name"]),
        (200, &json!("Höfe & Wege")),
        "the old name is no answer"
    );
    // What is read can be sent again, name and all.
    assert_eq!(sent("", &again.text).json()["name"], "Höfe & Wege");
    let patch = json!({ "row": 3, "column": 4, "elevation_m": [[0.3]] }).to_string();
    let headers = [("content-type", "application/json")];
    let changed = server.ask("PATCH", &path, &headers, patch.as_bytes()).json();
    assert_eq!(changed["name"], "Höfe & Wege");
    let long = "m".repeat(201);
    for query in ["?name=", "?name=a%0Ab", &format!("?name={long}")] {
        let problem = sent(query, &body).problem(400, "invalid-request");
        assert!(problem["detail"].as_str().unwrap().contains("1 to 200"), "{query}: {problem}");
    }
    let problem =
        sent("", &with(field(None, [0.0; 2]), "name", "".into()).to_string()).problem(400, "invalid-request");
    assert_eq!(problem["errors"][0]["pointer"], "/name");
}

#[test]
fn tiles_widen_the_policy_to_their_host_alone_and_what_is_no_template_ends_the_service() {
    let template = "https://tiles.example.org:8443/{z}/{x}/{y}.png?key=1";
    let server = Server::start_with(&["--tiles", template, "--tiles-attribution", "Somebody"]);
    let policy = server.get("/").header("content-security-policy").to_owned();
    assert!(policy.contains("; img-src 'self' https://tiles.example.org:8443;"), "{policy}");
    assert!(policy.starts_with("default-src 'self';"), "{policy}");
    let settings = server.get("/page/settings.json").json();
    assert_eq!(settings, json!({ "tiles": { "url": template, "attribution": "Somebody", "max_zoom": 19 } }));
    let plain = Server::start();
    assert!(!plain.get("/").header("content-security-policy").contains("img-src"));
    assert_eq!(plain.get("/page/settings.json").json(), json!({ "tiles": null }));
    let guarded = Server::start_in(
        "127.0.0.1:0",
        &["--tiles", template],
        &[("JOULEPATH_TOKENS", "0123456789abcdef0123456789abcdef")],
    );
    assert_eq!(guarded.get("/page/settings.json").status, 401, "a template may hold a key");
    let refused = Command::new(program())
        .args(["serve", "--bind", "127.0.0.1:0", "--tiles", "https://tiles.example.org/{z}/{x}.png"])
        .output()
        .unwrap();
    let said = String::from_utf8_lossy(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("--tiles") && said.contains("{y}") && said.lines().count() == 1, "{said}");
}
