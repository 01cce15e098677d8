//! The page that the program carries, and what it alone asks of the service.

#![allow(clippy::unwrap_used)]

use joulepath_tests::{Server, file};
use serde_json::{Value, json};

/// An answer with its headers, asked with more headers.
fn ask(url: &str, headers: &[(&str, &str)]) -> ureq::http::Response<ureq::Body> {
    let agent: ureq::Agent = ureq::Agent::config_builder().http_status_as_error(false).build().into();
    headers
        .iter()
        .fold(agent.get(url), |request, (name, value)| request.header(*name, *value))
        .call()
        .unwrap()
}

fn plan_as(server: &Server, accept: &str) -> ureq::http::Response<ureq::Body> {
    let question = json!({
        "map": { "cell_size_m": 1.0, "rows": 6, "columns": 8, "elevation_m": vec![vec![0.0; 8]; 6] },
        "robot": "husky-a200", "start": { "x_m": 1.5, "y_m": 2.5 }, "goal": { "x_m": 6.5, "y_m": 2.5 }
    });
    ureq::post(format!("{}/v1/plan", server.url)).header("accept", accept).send_json(question).unwrap()
}

#[test]
fn the_page_loads_nothing_from_elsewhere_and_is_kept_by_the_browser() {
    let server = Server::start();
    let mut first = ask(&server.url, &[]);
    let policy = first.headers()["content-security-policy"].to_str().unwrap().to_owned();
    assert!(policy.starts_with("default-src 'self';") && !policy.contains("unsafe"), "{policy}");
    assert_eq!(first.headers()["cache-control"], "no-cache");
    let tag = first.headers()["etag"].to_str().unwrap().to_owned();
    let html = first.body_mut().read_to_string().unwrap();
    assert!(!html.contains("http://") && !html.contains("https://"), "{html}");

    let named: Vec<&str> = html.split('"').filter(|part| part.starts_with("/page/")).collect();
    assert!(named.len() >= 2, "the page names its script and its style: {html}");
    for name in named {
        let answer = ask(&format!("{}{name}", server.url), &[]);
        assert_eq!(answer.status(), 200, "{name}");
        assert!(answer.headers()["cache-control"].to_str().unwrap().contains("immutable"), "{name}");
    }
    assert_eq!(ask(&server.url, &[("if-none-match", &tag)]).status(), 304);
    server.get("/page/no-such-file.js").problem(404, "not-found");
    server.get("/page/..%2findex.html").problem(404, "not-found");
}

#[test]
fn without_the_third_dimension_the_page_takes_less_than_300_kb() {
    let server = Server::start();
    let html = server.get("/").text;
    let bytes: usize = html
        .split('"')
        .filter(|part| part.starts_with("/page/"))
        .map(|name| {
            let mut answer = ask(&format!("{}{name}", server.url), &[("accept-encoding", "br")]);
            assert_eq!(answer.headers()["content-encoding"], "br", "{name}");
            answer.body_mut().with_config().limit(1 << 20).read_to_vec().unwrap().len()
        })
        .sum();
    assert!((10_000..300_000).contains(&bytes), "{bytes} bytes");
}

#[test]
fn cells_come_as_bytes_with_the_elevations_of_the_map() {
    let server = Server::start();
    let map =
        server.post("/v1/maps", "application/json", &std::fs::read(file("maps/yard.json")).unwrap()).json();
    let url = format!("{}/v1/maps/{}", server.url, map["id"].as_str().unwrap());
    let accept = [("accept", "application/octet-stream")];
    let bytes = ask(&url, &accept).body_mut().read_to_vec().unwrap();
    let cells = usize::try_from(map["rows"].as_u64().unwrap() * map["columns"].as_u64().unwrap()).unwrap();
    assert_eq!((&bytes[..4], bytes.len()), (&b"JPC1"[..], 48 + 6 * cells));
    let grid = server.get(&format!("/v1/maps/{}", map["id"].as_str().unwrap())).json();
    let base_m = f64::from_le_bytes(bytes[40..48].try_into().unwrap());
    let first_m = base_m + f64::from(f32::from_le_bytes(bytes[48..52].try_into().unwrap()));
    assert!((first_m - grid["elevation_m"][0][0].as_f64().unwrap()).abs() < 1e-6);

    let few = ask(&format!("{url}?max_cells=100"), &accept).body_mut().read_to_vec().unwrap();
    assert!(few.len() <= 48 + 600, "{}", few.len());
    server
        .get(&format!("/v1/maps/{}?max_cells=0", map["id"].as_str().unwrap()))
        .problem(400, "invalid-request");
    server.get(&format!("/v1/maps/{}?cells=9", map["id"].as_str().unwrap())).problem(400, "invalid-request");
}

#[test]
fn a_stored_robot_is_planned_with_by_its_id_and_outlives_the_service() {
    let store = tempfile::tempdir().unwrap();
    let folder = store.path().to_str().unwrap();
    let server = Server::start_with(&["--store", folder]);
    let mut robot = server.get("/v1/robots/husky-a200").json();
    robot["mass_kg"] = json!(120.0);
    let stored = server.post_json("/v1/robots", &robot);
    assert_eq!(stored.status, 201, "{}", stored.text);
    assert_eq!(server.post_json("/v1/robots", &robot).status, 200, "the same robot twice is one");
    let id = stored.json()["id"].as_str().unwrap().to_owned();

    let energy_j = |server: &Server, robot: &Value| {
        let question = json!({
            "map": { "cell_size_m": 1.0, "rows": 6, "columns": 8, "elevation_m": vec![vec![0.0; 8]; 6] },
            "robot": robot, "start": { "x_m": 1.5, "y_m": 2.5 }, "goal": { "x_m": 6.5, "y_m": 2.5 }
        });
        server.post_json("/v1/plan", &question).json()["energy_j"].as_f64().unwrap()
    };
    assert_eq!(energy_j(&server, &json!(id)), energy_j(&server, &robot));
    drop(server);

    let again = Server::start_with(&["--store", folder]);
    assert_eq!(again.get(&format!("/v1/robots/{id}")).json()["mass_kg"], 120.0);
    assert_eq!(again.get("/v1/robots").json()["stored"][0]["id"], json!(id));

    robot["motors"]["left"]["k2"] = json!(0.5);
    let problem = again.post_json("/v1/robots", &robot).problem(400, "invalid-robot");
    assert_eq!(problem["errors"][0]["pointer"], "/motors/left/k2");
}

#[test]
fn a_path_comes_as_a_table_and_as_a_track() {
    let server = Server::start();
    let mut table = plan_as(&server, "text/csv");
    assert_eq!(table.headers()["content-type"], "text/csv");
    let table = table.body_mut().read_to_string().unwrap();
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    assert_eq!(names[..3], ["x_m", "y_m", "z_m"]);
    assert!(lines.clone().count() > 3 && lines.all(|line| line.split(',').count() == names.len()), "{table}");

    let mut track = plan_as(&server, "application/gpx+xml");
    assert_eq!(track.headers()["content-type"], "application/gpx+xml");
    let track = track.body_mut().read_to_string().unwrap();
    assert!(track.contains("<trkpt lat=\"0.000000000\" lon=\"0.000000000\">"), "{track}");
    // Five metres east of the start, at 111 319.49 m for a degree.
    assert!(track.contains("lon=\"0.000044916\""), "{track}");
}
