//! Maps with holes, maps that are no elevation, and maps of robots, from outside: by the command line and over HTTP.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    path::{Path, PathBuf},
    process::{Command, Output},
};

use joulepath_tests::{Server, form::form, program};
use serde_json::{Value, json};

fn plan(map: &Path, arguments: &[&str]) -> Output {
    Command::new(program()).arg("plan").arg("--map").arg(map).args(arguments).output().unwrap()
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

/// An ESRI ASCII grid of 20 by 20 cells of 1 m; what a cell holds is written as it is given, rows from the north.
fn grid(cell: impl Fn(usize, usize) -> String) -> String {
    let row = |row| (0..20).map(|column| cell(row, column)).collect::<Vec<_>>().join(" ") + "\n";
    let rows: String = (0..20).map(row).collect();
    format!("ncols 20\nnrows 20\nxllcorner 500000\nyllcorner 5000000\ncellsize 1\nNODATA_value -9999\n{rows}")
}

fn ground(row: usize, column: usize) -> String {
    format!("{}", 300.0 + 0.02 * row as f64 + 0.01 * column as f64)
}

fn seam() -> String {
    grid(|row, column| if column == 9 { "-9999".into() } else { ground(row, column) })
}

fn collar() -> String {
    grid(|row, column| if row < 4 { "0".into() } else { ground(row, column) })
}

fn written(folder: &tempfile::TempDir, name: &str, text: impl AsRef<[u8]>) -> PathBuf {
    let path = folder.path().join(name);
    std::fs::write(&path, text).unwrap();
    path
}

const ACROSS: [&str; 4] = ["--start", "500004.5,5000010.5", "--goal", "500015.5,5000010.5"];

#[test]
fn a_refusal_for_a_seam_names_its_width_and_filling_it_gives_a_marked_path() {
    let folder = tempfile::tempdir().unwrap();
    let map = written(&folder, "seam.asc", seam());
    let refused = plan(&map, &ACROSS);
    assert_eq!(refused.status.code(), Some(3), "{}", said(&refused));
    assert!(said(&refused).contains("one cell (1 m) wide"), "{}", said(&refused));
    assert!(said(&refused).contains("--fill-voids-m 1 "), "{}", said(&refused));
    let filled = plan(&map, &[&ACROSS[..], &["--fill-voids", "1", "--json"]].concat());
    assert_eq!(filled.status.code(), Some(0), "{}", said(&filled));
    let answer: Value = serde_json::from_slice(&filled.stdout).unwrap();
    let kinds: Vec<&str> =
        answer["warnings"].as_array().unwrap().iter().map(|w| w["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds, ["filled-voids", "filled-ground"]);
    assert!(said(&filled).contains("warning: 20 cells of unknown ground in 1 hole"), "{}", said(&filled));
}

#[test]
fn a_collar_is_doubted_on_standard_error_and_mended_by_nodata() {
    let folder = tempfile::tempdir().unwrap();
    let map = written(&folder, "collar.asc", collar());
    let doubted = plan(&map, &ACROSS);
    assert_eq!(doubted.status.code(), Some(0), "{}", said(&doubted));
    assert!(said(&doubted).contains("warning: 80 cells hold exactly 0"), "{}", said(&doubted));
    let mended = plan(&map, &[&ACROSS[..], &["--nodata", "0"]].concat());
    assert!(!said(&mended).contains("fill value"), "{}", said(&mended));
    let lost =
        plan(&map, &["--nodata", "0", "--start", "500004.5,5000018.5", "--goal", "500015.5,5000010.5"]);
    assert_eq!(lost.status.code(), Some(2), "{}", said(&lost));
    assert!(
        said(&lost).contains("unknown ground") && said(&lost).contains("--fill-voids-m"),
        "{}",
        said(&lost)
    );
}

#[test]
fn both_ends_in_one_coarse_cell_are_said() {
    let folder = tempfile::tempdir().unwrap();
    let map = written(&folder, "coarse.asc", grid(ground).replace("cellsize 1", "cellsize 30"));
    let ends = ["--start", "500101,5000127", "--goal", "500101,5000143"];
    let exact = plan(&map, &ends);
    assert!(
        exact.status.success() && said(&exact).contains("both ends lie in one cell of 30 m"),
        "{}",
        said(&exact)
    );
    let found = plan(&map, &[&ends[..], &["--snapped-ends"]].concat());
    assert_eq!(found.status.code(), Some(0), "{}", said(&found));
    assert!(
        said(&found).contains("one cell of 30 m") && said(&found).contains("16.0 m between them"),
        "{}",
        said(&found)
    );
    assert!(said(&found).contains("far coarser than the robot"), "{}", said(&found));
}

#[test]
fn warnings_and_filled_cells_go_with_a_map_through_the_service() {
    let server = Server::start();
    let post =
        |query: &str, text: &str| server.post(&format!("/v1/maps{query}"), "text/plain", text.as_bytes());
    let stored = post("", &collar());
    assert_eq!(stored.status, 201, "{}", stored.text);
    assert_eq!(stored.json()["warnings"][0]["kind"], "fill-value");
    let read = server.get(&format!("/v1/maps/{}", stored.json()["id"].as_str().unwrap())).json();
    assert_eq!(read["warnings"], stored.json()["warnings"]);
    let again = server.post_json("/v1/maps", &read);
    assert_eq!(
        (again.status, again.json()["id"].clone()),
        (200, stored.json()["id"].clone()),
        "{}",
        again.text
    );

    let filled = post("?fill_voids_m=1", &seam());
    assert_eq!(filled.json()["warnings"][0]["kind"], "filled-voids", "{}", filled.text);
    assert_eq!(filled.json()["passable_fraction"], 1.0);
    let id = filled.json()["id"].clone();
    let read = server.get(&format!("/v1/maps/{}", id.as_str().unwrap())).json();
    let marked = read["filled"].as_array().unwrap().iter().flat_map(|row| row.as_array().unwrap());
    assert_eq!(marked.filter(|cell| **cell == json!(true)).count(), 20);
    let question = json!({ "map_id": id, "robot": "husky-a200",
        "start": { "x_m": 500_004.5, "y_m": 5_000_010.5 }, "goal": { "x_m": 500_015.5, "y_m": 5_000_010.5 } });
    let plan = server.post_json("/v1/plan", &question).json();
    assert_eq!(plan["warnings"][1]["kind"], "filled-ground", "{plan}");

    let mended = post("?nodata_m=0", &collar()).json();
    assert_eq!(mended["warnings"][0]["kind"], "given-nodata");
    for (query, word) in
        [("?fill_voids_m=-1", "fill_voids_m"), ("?fill=1", "nodata_m"), ("?nodata_m=nan", "nodata")]
    {
        let refused = post(query, &seam());
        assert_eq!(refused.status, 400, "{query}: {}", refused.text);
        assert!(refused.text.contains(word), "{query}: {}", refused.text);
    }
}

#[test]
fn a_service_may_fill_all_maps_and_a_request_still_says_otherwise() {
    let server = Server::start_with(&["--fill-voids-m", "1", "--nodata", "-5"]);
    let filled = server.post("/v1/maps", "text/plain", seam().as_bytes()).json();
    assert_eq!(filled["passable_fraction"], 1.0, "{filled}");
    let left = server.post("/v1/maps?fill_voids_m=0.5", "text/plain", seam().as_bytes()).json();
    assert_eq!(left["passable_fraction"], 0.95, "{left}");
}

const ROS_MAP: &str = "image: elsewhere/map.png\nresolution: 0.05\norigin: [0, 0, 0]\nnegate: false\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";

#[test]
fn a_map_of_a_robot_comes_as_a_form_of_its_two_files() {
    let server = Server::start();
    let post =
        |parts: &[(&str, &[u8])]| server.post("/v1/maps", "multipart/form-data; boundary=edge", &form(parts));
    let mut image = b"P5\n40 20\n255\n".to_vec();
    image.extend((0..800).map(|i| if i % 40 == 0 { 0 } else { 254u8 }));
    let stored = post(&[("yaml", ROS_MAP.as_bytes()), ("image", &image)]);
    assert_eq!(stored.status, 201, "{}", stored.text);
    let stored = stored.json();
    assert_eq!((&stored["rows"], &stored["columns"]), (&json!(20), &json!(40)));
    assert_eq!(stored["passable_fraction"], 0.975);
    for (parts, word) in [
        (vec![("yaml", ROS_MAP.as_bytes())], "no part `image`"),
        (vec![("yaml", ROS_MAP.as_bytes()), ("photo", &image[..])], "a part `photo`"),
        (vec![("yaml", b"image: [".as_slice()), ("image", &image)], "map_server YAML"),
        (vec![("yaml", ROS_MAP.as_bytes()), ("image", b"no image")], "elsewhere/map.png"),
    ] {
        let refused = post(&parts);
        assert_eq!(refused.status, 400, "{}", refused.text);
        assert!(refused.text.contains(word), "{word}: {}", refused.text);
    }
    let cut = server.post("/v1/maps", "multipart/form-data; boundary=edge", b"--edge\r\nContent-Dispo");
    assert_eq!(cut.status, 400, "{}", cut.text);
    let no_boundary = server.post("/v1/maps", "multipart/form-data", &form(&[]));
    assert_eq!(no_boundary.status, 400, "{}", no_boundary.text);
}
