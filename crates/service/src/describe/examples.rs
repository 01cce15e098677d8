//! Examples of requests: each can be sent as it stands, and is answered.

use model::builtin;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use terrain::{MapFile, Terrain};

use crate::{robots::content_id, store::id_of};

/// Two drives of 90 s at 1 Hz, simulated with a healthy Husky A200 on level ground.
const DRIVE_CSV: &str = include_str!("drive.csv");

/// A level map of two rows as an ESRI ASCII grid.
const ASCII_MAP: &str = "ncols 3\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n0.1 0.1 0.2\n0.1 0.2 0.2\n";

/// South-west corner of the example of a map, in UTM zone 15 north.
const WEST_M: f64 = 429_250.0;
const SOUTH_M: f64 = 5_150_480.0;

const ROBOT: &str = "husky-a200";

/// Returns the example of a request's body; binary forms have none.
pub(super) fn body(operation_id: &str, media_type: &str) -> Option<Value> {
    let start = || json!({ "x_m": WEST_M + 1.5, "y_m": SOUTH_M + 1.5, "heading_rad": 0.0 });
    let goal = || json!({ "x_m": WEST_M + 8.5, "y_m": SOUTH_M + 6.5 });
    let job = || json!({ "robot": ROBOT, "recordings": [drive_id()] });
    Some(match (operation_id, media_type) {
        ("plan" | "compare", _) => json!({ "map": map(), "robot": ROBOT, "start": start(), "goal": goal() }),
        ("alternatives", _) => {
            json!({ "map": map(), "robot": ROBOT, "start": start(), "goal": goal(), "against": "time", "count": 3 })
        }
        ("matrix", _) => json!({ "map": map(), "robot": ROBOT, "sources": [start(), goal()] }),
        ("reachable", _) => {
            json!({ "map": map(), "robot": ROBOT, "start": start(), "energies_j": [200.0, 400.0] })
        }
        ("range", _) => {
            json!({ "map": map(), "robot": ROBOT, "start": start(), "goal": goal(), "charge": 0.9, "return": true })
        }
        ("mission", _) => {
            let work = json!({
                "x_m": WEST_M + 2.5, "y_m": SOUTH_M + 6.5, "service_s": 60.0, "service_power_w": 20.0
            });
            let waypoints = json!([goal(), work]);
            json!({ "map": map(), "robot": ROBOT, "start": start(), "waypoints": waypoints, "return": true })
        }
        ("createMap", "application/json") => map(),
        ("createMap", "text/plain") => ASCII_MAP.into(),
        ("updateMap", _) => json!({ "row": 3, "column": 4, "elevation_m": [[0.3, 0.35]] }),
        ("createRobot", _) => robot(),
        ("createRecording" | "recordingscolumns", "text/csv") => DRIVE_CSV.into(),
        ("calibrate" | "diagnose", _) => job(),
        _ => return None,
    })
}

/// Returns the example of a parameter. Ids are those of the examples of bodies.
pub(super) fn parameter(operation_id: &str, name: &str) -> Option<Value> {
    Some(match (operation_id, name) {
        ("readRobot" | "readRobotMechanisms", "id") => ROBOT.into(),
        (_, "id")
            if operation_id.ends_with("Map")
                || ["readMapEarth", "readMapAreas", "mapareas"].contains(&operation_id) =>
        {
            map_id()?.into()
        }
        (_, "id") if operation_id.ends_with("Robot") => robot_id()?.into(),
        (_, "id") if operation_id.ends_with("Recording") => drive_id().into(),
        (_, "id") => "5b7c1f0e9a3d4c2b8e6f7a1d0c9b8a7f".into(),
        (_, "max_cells") => 10_000.into(),
        (_, "frame") => "map".into(),
        (_, "fill_voids_m") => 0.5.into(),
        (_, "nodata_m") => (-9999.0).into(),
        (_, "cell_size_m") => 0.5.into(),
        (_, "origin_m") => format!("{WEST_M},{SOUTH_M}").into(),
        (_, "crs") => "EPSG:26915".into(),
        (_, "map") => columns().to_string().into(),
        (_, "name") => "yard".into(),
        (_, "if-none-match") => "\"5b7c1f0e9a3d4c2b\"".into(),
        (_, "x-request-id") => "drive-17".into(),
        (_, "last-event-id") => "1".into(),
        _ => return None,
    })
}

/// Ground of 8 by 10 cells that rises by 4 % to the east and 2 % to the north.
fn map() -> Value {
    const ROWS: u32 = 8;
    const COLUMNS: u32 = 10;
    let row = |row: u32| (0..COLUMNS).map(move |column| f64::from(4 * column + 2 * row) / 100.0).collect();
    let elevation_m: Vec<Vec<f64>> = (0..ROWS).map(row).collect();
    let origin_m = [WEST_M, SOUTH_M];
    json!({ "cell_size_m": 1.0, "origin_m": origin_m, "crs": "EPSG:26915", "rows": ROWS, "columns": COLUMNS, "elevation_m": elevation_m })
}

fn map_id() -> Option<String> {
    let file: MapFile = document::from_value(&map()).ok()?;
    Terrain::try_from(file).ok().map(|terrain| terrain.content_id())
}

/// The built-in robot under another name.
fn robot() -> Value {
    let mut robot = builtin::husky_a200();
    "my-husky".clone_into(&mut robot.name);
    serde_json::to_value(robot).unwrap_or_default()
}

fn robot_id() -> Option<String> {
    content_id(&document::from_value(&robot()).ok()?).ok()
}

fn drive_id() -> String {
    id_of(Sha256::new_with_prefix(DRIVE_CSV))
}

/// What the columns of the example of a recording are.
fn columns() -> Value {
    let sources = ["t_s", "v_left_mps", "v_right_mps", "power_w", "run"]
        .map(|column| json!({ "channel": column, "column": column }));
    json!({ "name": "my-robot", "sources": sources })
}
