//! Maps as numpy arrays, whose cell size, place and system come with the request.

#![allow(clippy::unwrap_used, clippy::panic)]

use joulepath_tests::{Server, slope_map};
use serde_json::{Value, json};

/// A numpy array of 12 × 20 elevations in single precision, or a part of it.
fn slope_array() -> Vec<u8> {
    let text = "{'descr': '<f4', 'fortran_order': False, 'shape': (12, 20), }\n";
    let map = slope_map(12, 20);
    let rows = map["elevation_m"].as_array().unwrap().iter().map(|row| row.as_array().unwrap());
    let elements = rows.flatten().flat_map(|z| (z.as_f64().unwrap() as f32).to_le_bytes());
    let head = [&b"\x93NUMPY\x01\x00"[..], &(text.len() as u16).to_le_bytes(), text.as_bytes()].concat();
    head.into_iter().chain(elements).collect()
}

#[test]
fn a_numpy_array_is_the_same_map_as_in_json() {
    let server = Server::start();
    let array = slope_array();
    let mut map = slope_map(12, 20);
    for z in map["elevation_m"].as_array_mut().unwrap().iter_mut().flat_map(|row| row.as_array_mut().unwrap())
    {
        // What single precision holds.
        *z = json!(f64::from(z.as_f64().unwrap() as f32));
    }
    map["crs"] = json!("EPSG:26915");
    map["origin_m"] = json!([-2.0, 1.0]);
    let path = "/v1/maps?cell_size_m=1&origin_m=-2,1&crs=EPSG:26915";
    let sent = server.post(path, "application/x-npy", &array);
    assert_eq!(sent.status, 201, "{}", sent.text);
    let in_json = server.post_json("/v1/maps", &map);
    assert_eq!((in_json.status, &in_json.json()["id"]), (200, &sent.json()["id"]), "it is at hand already");
    for kind in ["application/octet-stream", "application/x-www-form-urlencoded", "text/plain", ""] {
        let again = server.post(path, kind, &array);
        assert_eq!(
            (again.status, &again.json()["id"]),
            (200, &sent.json()["id"]),
            "by its content: `{kind}`"
        );
    }

    let ask = |field: &str, map: &Value| {
        let start = json!({ "x_m": 2.5, "y_m": 2.5, "heading_rad": 0.0 });
        let goal = json!({ "x_m": 16.5, "y_m": 9.5 });
        server.post_json(
            "/v1/plan",
            &json!({ field: map, "robot": "husky-a200", "start": start, "goal": goal }),
        )
    };
    let (by_id, inline) = (ask("map_id", &sent.json()["id"]), ask("map", &map));
    assert!(inline.json()["energy_j"].is_number(), "{}", inline.text);
    assert_eq!(by_id.json()["energy_j"], inline.json()["energy_j"]);
}

#[test]
fn a_numpy_array_without_what_it_needs_is_refused_with_the_field() {
    let server = Server::start();
    let array = slope_array();
    let refused = |query: &str, kind: &str, bytes: &[u8]| {
        server.post(&format!("/v1/maps{query}"), kind, bytes).problem(400, "invalid-map")
    };
    for (query, pointer) in [
        ("", "/cell_size_m"),
        ("?cell_size_m=0", "/cell_size_m"),
        ("?cell_size_m=nan", "/cell_size_m"),
        ("?cell_size_m=0.5&origin_m=1e300,0", "/origin_m/0"),
        ("?cell_size_m=0.5&crs=EPSG:4326", "/crs"),
    ] {
        let problem = refused(query, "application/x-npy", &array);
        assert_eq!(problem["errors"][0]["pointer"], pointer, "{problem}");
    }
    let own = refused("?cell_size_m=0.5", "application/json", slope_map(12, 20).to_string().as_bytes());
    assert_eq!(own["errors"][0]["pointer"], "/cell_size_m", "a JSON grid has its own: {own}");
    let short = refused("?cell_size_m=0.5", "application/x-npy", &array[..array.len() - 1]);
    assert!(short["detail"].as_str().unwrap().contains("truncated"), "{short}");
    let other = refused("?cell_size_m=0.5", "application/x-npy", b"JPT1");
    assert!(other["detail"].as_str().unwrap().contains("no numpy array"), "{other}");
    for origin in ["7", "a,b", "1,2,3", ""] {
        let path = format!("/v1/maps?cell_size_m=0.5&origin_m={origin}");
        let answer = server.post(&path, "application/x-npy", &array);
        let problem = answer.problem(400, "invalid-request");
        assert!(problem["detail"].as_str().unwrap().contains("south-west corner"), "{problem}");
    }
}
