//! Areas over a map and the ways to steer a path, asked of the service and of the command line.

#![allow(clippy::unwrap_used, clippy::panic, clippy::needless_pass_by_value)]

use std::{fs, process::Command};

use joulepath_tests::{Answer, Server, form::form, program};
use serde_json::{Value, json};

fn field() -> Value {
    json!({ "cell_size_m": 0.5, "rows": 40, "columns": 60, "elevation_m": vec![vec![0.0; 60]; 40] })
}

fn rectangle([west, south, east, north]: [f64; 4], properties: Value) -> Value {
    json!({"type": "Feature", "properties": properties, "geometry": {"type": "Polygon", "coordinates":
        [[[west, south], [east, south], [east, north], [west, north], [west, south]]]}})
}

fn collection(features: Value) -> Value {
    json!({ "type": "FeatureCollection", "features": features })
}

/// A wall across the field but for its northern end.
fn wall() -> Value {
    collection(json!([rectangle([14.0, 0.0, 15.0, 16.0], json!({ "keep_out": true }))]))
}

/// A question across the field, with more to it.
fn across(more: Value) -> Value {
    let mut request = json!({
        "map": field(), "robot": "husky-a200", "start": {"x_m": 3.1, "y_m": 5.2, "heading_rad": 0.1},
        "goal": {"x_m": 26.3, "y_m": 5.4}
    });
    request.as_object_mut().unwrap().extend(more.as_object().unwrap().clone());
    request
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is no number"))
}

fn refused(answer: &Answer, pointer: &str) -> String {
    let problem = answer.json();
    assert_eq!(problem["errors"][0]["pointer"], pointer, "{problem}");
    assert!((400..500).contains(&answer.status), "{problem}");
    problem["detail"].as_str().unwrap().to_owned()
}

#[test]
fn areas_of_a_request_of_a_map_and_of_a_patch_give_one_path() {
    let server = Server::start();
    let plan = |request: &Value| {
        let answer = server.post_json("/v1/plan", request);
        assert_eq!(answer.status, 200, "{}", answer.text);
        answer.json()
    };
    let free = plan(&across(json!({})));
    let of_request = plan(&across(json!({ "areas": wall() })));
    assert!(number(&of_request["distance_m"]) > number(&free["distance_m"]) + 10.0);
    assert!(number(&of_request["clearance_m"]) < number(&free["clearance_m"]));
    let mut map = field();
    map["areas"] = wall();
    let of_map = plan(&across(json!({ "map": map })));
    assert_eq!(of_map["poses"], of_request["poses"]);
    let stored = server.post_json("/v1/maps", &field()).json();
    let id = stored["id"].as_str().unwrap();
    let patched = server.patch_json(&format!("/v1/maps/{id}"), &json!({ "areas": wall() }));
    assert_eq!(patched.status, 201, "{}", patched.text);
    let patched = patched.json();
    assert_eq!((&stored["areas"], &patched["areas"]), (&json!(0), &json!(1)));
    let patched_id = patched["id"].as_str().unwrap();
    let by_id = |id: &str, more: Value| {
        let mut request = across(more);
        request.as_object_mut().unwrap().remove("map");
        request["map_id"] = id.into();
        plan(&request)
    };
    // Asked in turn: planners that are kept must not be taken for each other's.
    assert_eq!(by_id(patched_id, json!({}))["poses"], of_request["poses"]);
    assert_eq!(by_id(id, json!({}))["poses"], free["poses"]);
    assert_eq!(by_id(id, json!({ "areas": wall() }))["poses"], of_request["poses"]);
    assert_eq!(by_id(id, json!({}))["poses"], free["poses"]);
    assert_eq!(by_id(patched_id, json!({ "areas": collection(json!([])) }))["poses"], free["poses"]);
    let kept = server.get(&format!("/v1/maps/{patched_id}/areas")).json();
    assert_eq!(kept, wall());
    assert_eq!(server.get(&format!("/v1/maps/{patched_id}")).json()["areas"], wall());
    assert_eq!(server.get(&format!("/v1/maps/{id}/areas")).json()["features"], json!([]));
}

#[test]
fn areas_in_degrees_lie_where_the_map_does() {
    let server = Server::start();
    let mut map = field();
    map["crs"] = "EPSG:32632".into();
    map["origin_m"] = json!([512_000.0, 5_422_970.0]);
    // By pyproj: (512014, 5422960) and (512015, 5422986) of EPSG:32632.
    let [west, south, east, north] = [9.164_121_616, 48.959_440_829, 9.164_135_914, 48.959_674_641];
    let request = json!({
        "map": map, "robot": "husky-a200", "start": {"x_m": 512_003.1, "y_m": 5_422_975.2},
        "goal": {"x_m": 512_026.3, "y_m": 5_422_975.4},
        "areas": collection(json!([rectangle([west, south, east, north], json!({ "keep_out": true }))]))
    });
    let answer = server.post_json("/v1/plan", &request).json();
    let crossed =
        answer["poses"].as_array().unwrap().iter().find(|pose| number(&pose["x_m"]) > 512_014.4).unwrap();
    assert!(number(&crossed["y_m"]) > 5_422_986.0, "{crossed}");
    let mut stored = request["map"].clone();
    stored["areas"] = request["areas"].clone();
    let stored = server.post_json("/v1/maps", &stored).json();
    let address = format!("/v1/maps/{}/areas", stored["id"].as_str().unwrap());
    assert_eq!(server.get(&address).json(), request["areas"]);
    let placed = server.get(&format!("{address}?frame=map")).json();
    assert_eq!(placed["crs"], Value::Null);
    let corner = &placed["features"][0]["geometry"]["coordinates"][0][2];
    assert!((number(&corner[0]) - 512_015.0).abs() < 0.01, "{corner}");
    assert!((number(&corner[1]) - 5_422_986.0).abs() < 0.01, "{corner}");
    let unknown = server.get(&format!("{address}?frame=moon"));
    assert!(unknown.status == 400 && unknown.text.contains("frame"), "{}", unknown.text);
}

#[test]
fn areas_that_cannot_be_are_refused_by_their_place() {
    let server = Server::start();
    let asked = |more: Value| server.post_json("/v1/plan", &across(more));
    let bow = json!({"type": "Feature", "properties": {"keep_out": true}, "geometry":
        {"type": "Polygon", "coordinates": [[[1, 1], [5, 5], [5, 1], [1, 5], [1, 1]]]}});
    let said = refused(&asked(json!({ "areas": collection(json!([bow])) })), "/areas/features/0/geometry");
    assert!(said.contains("crosses itself at 3.00, 3.00"), "{said}");
    let outside = rectangle([400.0, 0.0, 410.0, 5.0], json!({ "keep_out": true }));
    let said =
        refused(&asked(json!({ "areas": collection(json!([outside])) })), "/areas/features/0/geometry");
    assert!(said.contains("lies outside the map"), "{said}");
    let over_goal = rectangle([24.0, 3.0, 29.0, 8.0], json!({ "keep_out": true }));
    let answer = asked(json!({ "areas": collection(json!([over_goal])) }));
    assert_eq!(
        answer.json()["type"].as_str().unwrap().rsplit('/').next(),
        Some("goal-blocked"),
        "{}",
        answer.text
    );
    assert!(answer.text.contains("keep-out area"), "{}", answer.text);
    let unknown = rectangle([4.0, 3.0, 9.0, 8.0], json!({ "surface": "lava" }));
    let answer = asked(json!({ "areas": collection(json!([unknown])) }));
    assert!(answer.status == 422 && answer.text.contains("lava"), "{}", answer.text);
    let nothing = rectangle([4.0, 3.0, 9.0, 8.0], json!({ "note": "wet" }));
    refused(&asked(json!({ "areas": collection(json!([nothing])) })), "/areas/features/0/properties");
    let mut map = field();
    map["areas"] = json!({ "type": "Polygon" });
    refused(&server.post_json("/v1/maps", &map), "/areas/type");
}

#[test]
fn preferences_are_said_and_amounts_stay_what_is_driven() {
    let server = Server::start();
    let asked = |more: Value| server.post_json("/v1/plan", &across(more));
    let dear = collection(json!([rectangle([12.0, 0.0, 18.0, 20.0], json!({ "cost_factor": 3 }))]));
    let (free, weighed) = (asked(json!({})).json(), asked(json!({ "areas": dear })).json());
    assert!(free.get("preferences").is_none());
    let added_j = number(&weighed["preferences"]);
    let inside_j = number(&weighed["energy_j"]) * 6.0 / 23.2;
    assert!((added_j - 2.0 * inside_j).abs() < 0.2 * added_j, "{added_j} for {inside_j} J inside");
    assert!(
        (number(&weighed["energy_j"]) - number(&free["energy_j"])).abs() < 0.01 * number(&free["energy_j"])
    );
    let said = refused(&asked(json!({ "areas": dear, "max_time_s": 500.0 })), "/max_time_s");
    assert!(said.contains("cost factors"), "{said}");
    let reach = |areas: Value| {
        let request = json!({"map": field(), "robot": "husky-a200", "start": {"x_m": 3.1, "y_m": 5.2},
            "energies_j": [300], "areas": areas});
        number(&server.post_json("/v1/reachable", &request).json()["features"][0]["properties"]["area_m2"])
    };
    assert_eq!(reach(dear), reach(collection(json!([]))), "what is reached is a matter of energy alone");
}

#[test]
fn a_path_is_steered_as_asked() {
    let server = Server::start();
    let plan = |more: Value| {
        let answer = server.post_json("/v1/plan", &across(more));
        assert_eq!(answer.status, 200, "{}", answer.text);
        answer.json()
    };
    let exact = plan(json!({}));
    let (first, last) = (&exact["poses"][0], exact["poses"].as_array().unwrap().last().unwrap());
    for (found, wanted) in [
        (&first["x_m"], 3.1),
        (&first["y_m"], 5.2),
        (&first["heading_rad"], 0.1),
        (&last["x_m"], 26.3),
        (&last["y_m"], 5.4),
    ] {
        assert!((number(found) - wanted).abs() < 1e-9, "{found} for {wanted}");
    }
    assert_eq!(exact["snapped"]["start"]["distance_m"], 0.0);
    let snapped = plan(json!({ "exact_ends": false }));
    assert_eq!(snapped["poses"][0]["x_m"], 3.25);
    let goals = json!([{"x_m": 26.3, "y_m": 5.4}, {"x_m": 9.2, "y_m": 9.1}, {"x_m": 26.3, "y_m": 18.1}]);
    let mut several = across(json!({ "goals": goals }));
    several.as_object_mut().unwrap().remove("goal");
    let several = server.post_json("/v1/plan", &several).json();
    assert_eq!(several["reached_goal"], 1);
    let closed = collection(json!([rectangle([14.0, 0.0, 15.0, 20.0], json!({ "keep_out": true }))]));
    let partial = plan(json!({ "areas": closed, "partial": true }));
    let end = partial["poses"].as_array().unwrap().last().unwrap();
    let away_m = (number(&end["x_m"]) - 26.3).hypot(number(&end["y_m"]) - 5.4);
    assert!((number(&partial["short_of_goal_m"]) - away_m).abs() < 1e-9 && number(&end["x_m"]) < 14.0);
    let wide = plan(json!({ "areas": wall(), "least_radius_m": 2.0, "forbid": ["spin"] }));
    for poses in [&wide["poses"], &wide["refined"]["poses"]] {
        let radii = poses.as_array().unwrap().iter().filter_map(|pose| pose["radius_m"].as_f64());
        assert!(radii.into_iter().all(|radius_m| radius_m.abs() > 2.0 - 1e-9));
    }
    let either = plan(json!({ "goal": {"x_m": 26.3, "y_m": 5.4, "heading_rad": 3.1, "heading": "either"} }));
    assert!(number(&either["energy_j"]) < 1.01 * number(&exact["energy_j"]) + 5.0);
}

#[test]
fn steering_that_contradicts_itself_is_refused() {
    let server = Server::start();
    for (more, pointer) in [
        (json!({ "partial": true, "max_energy_j": 100.0 }), "/max_energy_j"),
        (json!({ "goals": [{"x_m": 1, "y_m": 1}] }), "/goals"),
        (json!({ "reverse": true, "forbid": ["reverse"] }), "/forbid"),
        (json!({ "goal": {"x_m": 9, "y_m": 9, "heading": "either"} }), "/goal/heading"),
        (json!({ "unknown_ground": {"risk_j_per_m": -1} }), "/unknown_ground/risk_j_per_m"),
    ] {
        refused(&server.post_json("/v1/plan", &across(more)), pointer);
    }
    let mut beyond = across(json!({ "goals": [{"x_m": 9, "y_m": 9}, {"x_m": 99, "y_m": 9}] }));
    beyond.as_object_mut().unwrap().remove("goal");
    let answer = server.post_json("/v1/plan", &beyond);
    assert!(refused(&answer, "/goals/1").contains("outside the map"));
    assert_eq!(answer.json()["type"].as_str().unwrap().rsplit('/').next(), Some("goal-outside-map"));
    let ten_times: Vec<Value> =
        (0..10).map(|_| rectangle([4.0, 3.0, 9.0, 8.0], json!({ "cost_factor": 10 }))).collect();
    let answer = server.post_json("/v1/plan", &across(json!({ "areas": collection(json!(ten_times)) })));
    assert!(refused(&answer, "/areas").contains("cost factors that lie over each other"), "{}", answer.text);
    let mut nowhere = across(json!({}));
    nowhere.as_object_mut().unwrap().remove("goal");
    assert!(refused(&server.post_json("/v1/plan", &nowhere), "/goal").contains("missing field `goal`"));
    let price = server.post_json("/v1/plan", &across(json!({ "prices": {"spin_j_per_rad": -3} })));
    assert!(price.status == 400 && price.text.contains("prices.spin_j_per_rad"), "{}", price.text);
    let unknown = server.post_json("/v1/plan", &across(json!({ "prices": {"spin": 3} })));
    assert!(unknown.status == 400 && unknown.text.contains("spin"), "{}", unknown.text);
}

#[test]
fn unknown_ground_is_opened_on_request_and_said() {
    let server = Server::start();
    let mut map = field();
    for row in map["elevation_m"].as_array_mut().unwrap() {
        for column in 28..32 {
            row[column] = Value::Null;
        }
    }
    let asked = |more: Value| {
        let mut request = across(more);
        request["map"] = map.clone();
        server.post_json("/v1/plan", &request)
    };
    assert_eq!(asked(json!({})).status, 422, "a gap from border to border");
    let answer = asked(json!({ "unknown_ground": {"surface": "sandy_loam", "risk_j_per_m": 50} }));
    assert_eq!(answer.status, 200, "{}", answer.text);
    let answer = answer.json();
    let kinds: Vec<&str> = answer["warnings"]
        .as_array()
        .unwrap()
        .iter()
        .map(|warning| warning["kind"].as_str().unwrap())
        .collect();
    assert!(kinds.contains(&"unknown-ground") && kinds.contains(&"filled-ground"), "{kinds:?}");
    assert!((number(&answer["preferences"]) - 2.0 * 50.0).abs() < 30.0, "{}", answer["preferences"]);
}

#[test]
fn the_command_line_takes_areas_and_steering() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    fs::write(path("map.json"), field().to_string()).unwrap();
    fs::write(path("wall.geojson"), wall().to_string()).unwrap();
    let plan = |more: &[&str]| {
        let map = path("map.json");
        let ends = ["plan", "--map", &map, "--start", "3.1,5.2", "--goal", "26.3,5.4", "--json"];
        Command::new(program()).args(ends).args(more).output().unwrap()
    };
    let found = |more: &[&str]| -> Value {
        let output = plan(more);
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let free = found(&[]);
    let walled = found(&["--areas", &path("wall.geojson"), "--forbid", "spin", "--price", "stops"]);
    assert!(number(&walled["distance_m"]) > number(&free["distance_m"]) + 10.0);
    assert_eq!(found(&["--goal", "5.1,6.2"])["reached_goal"], 1);
    let wrong = plan(&["--price", "speed=3"]);
    assert_eq!(wrong.status.code(), Some(2));
    fs::write(path("bad.geojson"), r#"{"type": "FeatureCollection", "features": [{"geometry": null}]}"#)
        .unwrap();
    let bad = plan(&["--areas", &path("bad.geojson")]);
    let said = String::from_utf8_lossy(&bad.stderr).into_owned();
    assert_eq!(bad.status.code(), Some(2), "{said}");
    assert!(said.contains("bad.geojson: areas.features[0].geometry.type is missing"), "{said}");
}

/// A GeoTIFF of classes, 5 m a pixel: a lake (80) over the middle of the field but for its north, meadow (30) around it.
fn land_cover() -> Vec<u8> {
    let mut file = std::io::Cursor::new(Vec::new());
    let mut encoder = tiff::encoder::TiffEncoder::new(&mut file).unwrap();
    let mut image = encoder.new_image::<tiff::encoder::colortype::Gray8>(6, 4).unwrap();
    image.encoder().write_tag(tiff::tags::Tag::ModelPixelScaleTag, &[5.0, 5.0, 0.0][..]).unwrap();
    image
        .encoder()
        .write_tag(tiff::tags::Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, 0.0, 20.0, 0.0][..])
        .unwrap();
    let classes: Vec<u8> =
        (0..24).map(|pixel| if pixel / 6 > 0 && (2..4).contains(&(pixel % 6)) { 80 } else { 30 }).collect();
    image.write_data(&classes).unwrap();
    file.into_inner()
}

#[test]
fn a_raster_of_classes_becomes_areas() {
    let (server, folder) = (Server::start(), tempfile::tempdir().unwrap());
    let id = server.post_json("/v1/maps", &field()).json()["id"].as_str().unwrap().to_owned();
    let path = format!("/v1/maps/{id}/areas");
    let post =
        |parts: &[(&str, &[u8])]| server.post(&path, "multipart/form-data; boundary=edge", &form(parts));
    let cover = land_cover();
    let table = br#"{"80": {"keep_out": true}}"#;
    let answer = post(&[("raster", &cover), ("classes", table)]);
    assert_eq!(answer.status, 200, "{}", answer.text);
    let areas = answer.json();
    assert_eq!(areas["notes"][0], "classes 30 lie over the map, but not in the table: they change nothing");
    assert_eq!(
        areas["features"][0]["geometry"]["coordinates"],
        json!([[[[10.0, 15.0], [10.0, 0.0], [20.0, 0.0], [20.0, 15.0], [10.0, 15.0]]]])
    );
    let plan = server.post_json("/v1/plan", &across(json!({ "areas": areas }))).json();
    let around = |poses: &Value| {
        let poses = poses.as_array().unwrap();
        let inside =
            |pose: &&Value| (10.0..20.0).contains(&number(&pose["x_m"])) && number(&pose["y_m"]) < 15.0;
        poses.iter().find(inside).is_none()
    };
    assert!(around(&plan["poses"]), "the path leads around the lake");
    let wrong = post(&[("raster", &cover), ("classes", br#"{"80": {"keep_out": 1}}"#)]);
    assert!(refused(&wrong, "/classes").contains("classes.80.keep_out is 1"), "{}", wrong.text);
    assert!(
        refused(&post(&[("raster", b"no TIFF"), ("classes", table)]), "/raster")
            .contains("raster of classes")
    );
    assert_eq!(server.post_json(&path, &areas).status, 415);

    let file = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, bytes).unwrap();
        path.display().to_string()
    };
    let (map, cover, table) = (
        file("map.json", field().to_string().as_bytes()),
        file("cover.tif", &cover),
        file("table.json", table),
    );
    let ask = |more: &[&str]| {
        let ends = ["plan", "--map", &map, "--start", "3.1,5.2", "--goal", "26.3,5.4", "--json"];
        Command::new(program()).args(ends).args(["--areas", &cover]).args(more).output().unwrap()
    };
    let output = ask(&["--area-classes", &table]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.contains("classes 30 lie over the map"), "{said}");
    let by_command: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(around(&by_command["poses"]));
    let bare = ask(&[]);
    let said = String::from_utf8_lossy(&bare.stderr);
    assert!(bare.status.code() == Some(2) && said.contains("--area-classes"), "{said}");
}
