//! Places in degrees, where the map says where on earth it lies.

#![allow(clippy::unwrap_used, clippy::panic)]

use joulepath_tests::Server;
use serde_json::{Value, json};

/// A level field of 40 m in UTM zone 32 north: (512008.5, 5422976.5) is 9.164046814 E, 48.959589321 N by pyproj.
fn field(crs: Option<&str>) -> Value {
    let mut map = json!({
        "cell_size_m": 1.0, "rows": 40, "columns": 40, "elevation_m": vec![vec![0.0; 40]; 40],
        "origin_m": [512_000.0, 5_422_970.0]
    });
    if let Some(crs) = crs {
        map["crs"] = crs.into();
    }
    map
}

const START: [f64; 2] = [9.164_046_814, 48.959_589_321];

fn plan(crs: Option<&str>) -> Value {
    json!({
        "map": field(crs), "robot": "husky-a200",
        "start": { "lon_deg": START[0], "lat_deg": START[1] },
        "goal": { "x_m": 512_030.5, "y_m": 5_422_994.5 }
    })
}

fn near(value: &Value, wanted: f64, by: f64) -> bool {
    value.as_f64().is_some_and(|value| (value - wanted).abs() <= by)
}

#[test]
fn a_start_in_degrees_is_the_place_in_metres_and_answers_carry_both() {
    let server = Server::start();
    let answer = server.post_json("/v1/plan", &plan(Some("EPSG:32632"))).json();
    let first = &answer["poses"][0];
    // Nine decimals of a degree are a tenth of a millimetre.
    assert!(near(&first["x_m"], 512_008.5, 1e-3) && near(&first["y_m"], 5_422_976.5, 1e-3), "{first}");
    assert!(near(&first["lon_deg"], START[0], 2e-9) && near(&first["lat_deg"], START[1], 2e-9), "{first}");
    assert_eq!(answer["crs"], "EPSG:32632");
    let poses =
        answer["poses"].as_array().unwrap().iter().chain(answer["refined"]["poses"].as_array().unwrap());
    assert!(poses.clone().count() > 2 && poses.into_iter().all(|pose| pose["lat_deg"].is_f64()));
}

#[test]
fn geojson_and_gpx_are_degrees_where_the_map_says_where_it_lies_and_say_so_where_not() {
    let server = Server::start();
    let asked = |crs, form: &str| {
        let mut request = plan(crs);
        request["start"] = json!({ "x_m": 512_008.5, "y_m": 5_422_976.5 });
        let headers = [("content-type", "application/json"), ("accept", form)];
        server.ask("POST", "/v1/plan", &headers, request.to_string().as_bytes())
    };
    let placed = asked(Some("EPSG:32632"), "application/geo+json").json();
    assert!(placed.get("crs").is_none(), "RFC 7946 knows WGS 84 alone");
    let first = &placed["features"][0]["geometry"]["coordinates"][0];
    assert!(near(&first[0], START[0], 2e-9) && near(&first[1], START[1], 2e-9), "{first}");
    let british = asked(Some("EPSG:27700"), "application/geo+json").json();
    assert_eq!(british["crs"]["properties"]["name"], "EPSG:27700", "metres of a system that is named");
    let nowhere = asked(None, "application/geo+json").json();
    assert!(nowhere.get("crs").is_some_and(Value::is_null), "metres of nothing that is known");
    let track = asked(Some("EPSG:32632"), "application/gpx+xml").text;
    assert!(track.contains("<trkpt lat=\"48.959589321\" lon=\"9.164046814\">"), "{}", &track[..400]);
}

#[test]
fn a_mission_comes_in_the_form_that_accept_asks_for() {
    let server = Server::start();
    let asked = |crs: Option<&str>, form: &str| {
        let place = |x_m: f64, y_m: f64| json!({ "x_m": 512_000.0 + x_m, "y_m": 5_422_970.0 + y_m });
        let request = json!({
            "map": field(crs), "robot": "husky-a200", "start": place(8.5, 6.5),
            "waypoints": [place(30.5, 24.5), place(20.5, 12.5)], "samples": 10
        });
        let headers = [("content-type", "application/json"), ("accept", form)];
        server.ask("POST", "/v1/mission", &headers, request.to_string().as_bytes())
    };
    let crs = Some("EPSG:32632");
    assert!(asked(crs, "*/*").json()["feasible"].is_boolean());
    let kinds = |document: Value| -> Vec<String> {
        let features = document["features"].as_array().unwrap().clone();
        features.iter().map(|one| one["geometry"]["type"].as_str().unwrap().to_owned()).collect()
    };
    let placed = asked(crs, "application/geo+json");
    assert_eq!(placed.content_type, "application/geo+json");
    assert_eq!(kinds(placed.json()), ["LineString", "LineString", "Point", "Point", "Point"]);
    let track = asked(crs, "application/gpx+xml").text;
    assert!(track.contains("<trkpt lat=\"48.95") && track.contains("<name>to waypoint 0</name>"), "{track}");
    assert!(asked(crs, "application/vnd.google-earth.kml+xml").text.contains("<coordinates>9.164"));
    assert!(asked(None, "text/csv").text.starts_with("path,x_m,y_m"));
    let refused = asked(None, "application/vnd.google-earth.kml+xml");
    assert_eq!(refused.status, 400, "{}", refused.text);
    assert!(refused.json()["detail"].as_str().unwrap().contains("EPSG:32632"), "{}", refused.text);
}

#[test]
fn a_place_that_is_not_given_or_cannot_be_placed_is_refused_by_its_field() {
    let server = Server::start();
    let crs = Some("EPSG:32632");
    for (map, start, pointer, says) in [
        (None, json!({ "lon_deg": 9.0, "lat_deg": 48.0 }), "/start/lon_deg", "no crs"),
        (Some("EPSG:27700"), json!({ "lon_deg": 9.0, "lat_deg": 48.0 }), "/start/lon_deg", "datum"),
        (crs, json!({ "lon_deg": 9.0 }), "/start/lat_deg", "give both"),
        (crs, json!({ "lat_deg": 9.0 }), "/start/lon_deg", "give both"),
        (crs, json!({ "x_m": 512_008.5 }), "/start/y_m", "missing field `y_m`"),
        (crs, json!({}), "/start/x_m", "lon_deg"),
        (
            crs,
            json!({ "x_m": 512_008.5, "y_m": 5_422_976.5, "lon_deg": 9.0, "lat_deg": 48.0 }),
            "/start/lon_deg",
            "one of them",
        ),
        (crs, json!({ "lon_deg": 9.0, "lat_deg": 148.0 }), "/start/lon_deg", "beyond"),
    ] {
        let mut request = plan(map);
        request["start"] = start.clone();
        let answer = server.post_json("/v1/plan", &request);
        assert_eq!(answer.status, 400, "{start}");
        let problem = answer.json();
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{problem}");
        assert!(problem["detail"].as_str().unwrap().contains(says), "{problem}");
    }
}

#[test]
fn every_question_takes_degrees() {
    let server = Server::start();
    let place = json!({ "lon_deg": START[0], "lat_deg": START[1] });
    let with = |more: Value| {
        let mut request = json!({ "map": field(Some("EPSG:32632")), "robot": "husky-a200" });
        request.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
        request
    };
    let goal = json!({ "x_m": 512_030.5, "y_m": 5_422_994.5 });
    let one = |name: &str, request: Value| {
        let answer = server.post_json(&format!("/v1/{name}"), &request);
        assert_eq!(answer.status, 200, "{name}: {}", answer.text);
        answer.json()
    };
    one("compare", with(json!({ "start": place, "goal": goal })));
    one("alternatives", with(json!({ "start": place, "goal": goal })));
    let range = one("range", with(json!({ "start": place, "goal": goal })));
    assert!(range["legs"][0]["poses"][0]["lon_deg"].is_f64(), "{range}");
    let reach = one("reachable", with(json!({ "start": place, "energies_j": [2000] })));
    let corner = &reach["features"][0]["geometry"]["coordinates"][0][0][0];
    assert!(near(&corner[0], START[0], 0.01) && near(&corner[1], START[1], 0.01), "{corner}");
    let headers = [("accept", "application/json"), ("content-type", "application/json")];
    let body = with(json!({ "start": place, "energies_j": [2000] })).to_string();
    let in_metres = server.ask("POST", "/v1/reachable", &headers, body.as_bytes()).json();
    assert_eq!(in_metres["crs"]["properties"]["name"], "EPSG:32632", "metres say of which system they are");
    let corner = &in_metres["features"][0]["geometry"]["coordinates"][0][0][0];
    assert!(near(&corner[0], 512_015.0, 100.0) && near(&corner[1], 5_422_985.0, 100.0), "{corner}");
    one("matrix", with(json!({ "sources": [place, goal] })));
    let mission = one("mission", with(json!({ "start": place, "waypoints": [goal] })));
    assert!(mission["stops"][0]["lat_deg"].is_f64(), "{mission}");
}
