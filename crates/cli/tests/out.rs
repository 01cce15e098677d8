//! `--out FILE`: the form by the ending, files whole or absent, and flags for ground and load.

#![allow(clippy::unwrap_used)]

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use serde_json::{Value, json};

const ENDINGS: [&str; 8] = ["geojson", "gpx", "kml", "csv", "png", "svg", "html", "json"];

fn joulepath(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_joulepath")).args(arguments).current_dir(folder).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// A gentle hill near Innsbruck, once placed on earth and once not.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let row = |y: i32| -> Vec<f64> {
        (0..24_i32).map(|x| 2.0 * (-f64::from((x - 12).pow(2) + (y - 10).pow(2)) / 40.0).exp()).collect()
    };
    let mut map = json!({
        "cell_size_m": 1.0, "origin_m": [680_000.0, 5_237_000.0], "rows": 20, "columns": 24,
        "elevation_m": (0..20).map(row).collect::<Vec<_>>(),
    });
    fs::write(folder.path().join("local.json"), map.to_string()).unwrap();
    map["crs"] = json!("EPSG:32632");
    fs::write(folder.path().join("placed.json"), map.to_string()).unwrap();
    // The datum of Switzerland takes a grid of corrections.
    map["crs"] = json!("EPSG:2056");
    map["origin_m"] = json!([2_600_000.0, 1_200_000.0]);
    fs::write(folder.path().join("swiss.json"), map.to_string()).unwrap();
    folder
}

/// A question for each command that writes files, over `placed.json`.
const QUESTIONS: [&[&str]; 4] = [
    &["plan", "--map", "placed.json", "--start", "@0.1,0.5", "--goal", "@0.9,0.5"],
    &["compare", "--map", "placed.json", "--start", "@0.1,0.5", "--goal", "@0.9,0.5"],
    &["reachable", "--map", "placed.json", "--start", "@0.5,0.2", "--energy-j", "500", "--energy-j", "1000"],
    &[
        "mission",
        "--map",
        "placed.json",
        "--start",
        "@0.1,0.5",
        "--waypoint",
        "@0.9,0.5",
        "--waypoint",
        "@0.5,0.9",
    ],
];

/// Refuses a file that is not of its form, and returns its text where it has one.
fn checked(ending: &str, bytes: &[u8]) -> String {
    if ending == "png" {
        let picture = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        assert_eq!(picture.info().width, 1180);
        return String::new();
    }
    let text = text(bytes);
    match ending {
        "json" | "geojson" => drop(serde_json::from_str::<Value>(&text).unwrap()),
        "csv" => assert!(text.lines().count() > 2 && text.starts_with(['x', 'p']), "{text}"),
        "gpx" => assert!(text.contains("<trkpt lat=\"47.") && text.ends_with("</gpx>\n"), "{text}"),
        "kml" => assert!(text.contains("<coordinates>11.") && text.ends_with("</kml>\n"), "{text}"),
        "svg" => assert!(text.starts_with("<svg") && text.ends_with("</svg>\n"), "{text}"),
        _ => assert!(text.contains("data:image/svg+xml;base64,") && text.contains("<table"), "{text}"),
    }
    text
}

#[test]
fn every_command_writes_every_form_and_prints_its_table_all_the_same() {
    let folder = folder();
    for question in QUESTIONS {
        for ending in ENDINGS {
            let file = format!("{}.{ending}", question[0]);
            let output = joulepath(folder.path(), &[question, &["--out", &file]].concat());
            let said = text(&output.stderr);
            assert!(output.status.success() && said.contains(&format!("wrote {file}")), "{file}: {said}");
            assert!(text(&output.stdout).contains("kJ"), "{file}: {}", text(&output.stdout));
            checked(ending, &fs::read(folder.path().join(&file)).unwrap());
        }
    }
    let read = |file: &str| fs::read_to_string(folder.path().join(file)).unwrap();
    let features = |file: &str| -> Vec<String> {
        let document: Value = serde_json::from_str(&read(file)).unwrap();
        let features = document["features"].as_array().unwrap();
        features.iter().map(|f| f["geometry"]["type"].as_str().unwrap().to_owned()).collect()
    };
    assert_eq!(features("plan.geojson"), ["LineString"]);
    assert_eq!(features("compare.geojson"), ["LineString"; 3]);
    assert_eq!(features("reachable.geojson"), ["MultiPolygon"; 2]);
    assert_eq!(features("mission.geojson"), ["LineString", "LineString", "Point", "Point", "Point"]);
    let compared = read("compare.csv");
    assert!(compared.starts_with("path,x_m,") && compared.contains("\nenergy-minimal,"), "{compared}");
    assert!(
        read("mission.gpx").contains("<wpt ") && read("mission.gpx").contains("<name>to waypoint 1</name>")
    );
    let (file, plan): (Value, Output) = (
        serde_json::from_str(&read("plan.json")).unwrap(),
        joulepath(folder.path(), &[QUESTIONS[0], &["--json"]].concat()),
    );
    let printed: Value = serde_json::from_slice(&plan.stdout).unwrap();
    assert_eq!((&file["energy_j"], &file["poses"]), (&printed["energy_j"], &printed["poses"]));
}

#[test]
fn what_cannot_be_written_is_refused_before_the_work_and_leaves_no_file() {
    let folder = folder();
    let local = |command: &[&'static str]| -> Vec<&'static str> {
        command.iter().map(|word| if *word == "placed.json" { "local.json" } else { word }).collect()
    };
    let swiss = |command: &[&'static str]| -> Vec<&'static str> {
        command.iter().map(|word| if *word == "placed.json" { "swiss.json" } else { word }).collect()
    };
    for (question, file, said) in [
        (QUESTIONS[0].to_vec(), "path.pdf", ".geojson, .gpx, .kml, .csv, .png, .svg, .html, .json"),
        (QUESTIONS[0].to_vec(), "none/path.svg", "there is no folder none"),
        (local(QUESTIONS[0]), "path.kml", "crs"),
        (local(QUESTIONS[2]), "reach.gpx", "crs"),
        (swiss(QUESTIONS[0]), "path.kml", "EPSG:2056"),
        (swiss(QUESTIONS[0]), "path.gpx", "EPSG:2056"),
        (swiss(QUESTIONS[1]), "paths.gpx", "EPSG:2056"),
        (swiss(QUESTIONS[3]), "mission.gpx", "EPSG:2056"),
    ] {
        let output = joulepath(folder.path(), &[&question[..], &["--out", file]].concat());
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{file}: {error}");
        assert!(error.contains(said), "{file}: {error}");
    }
    fs::write(folder.path().join("kept.svg"), "before").unwrap();
    let outside =
        ["plan", "--map", "local.json", "--start", "0,0", "--goal", "@0.9,0.5", "--out", "kept.svg"];
    assert_eq!(joulepath(folder.path(), &outside).status.code(), Some(2));
    assert_eq!(fs::read_to_string(folder.path().join("kept.svg")).unwrap(), "before");
    let names: Vec<_> = fs::read_dir(folder.path()).unwrap().map(|file| file.unwrap().file_name()).collect();
    assert_eq!(names.len(), 4, "{names:?}");
}

/// Nobody takes 0° N 0° E for a place of a map that says nothing of where it lies.
#[test]
fn a_track_of_a_map_without_a_crs_counts_metres_from_nought() {
    let folder = folder();
    let local: Vec<&str> =
        QUESTIONS[0].iter().map(|word| if *word == "placed.json" { "local.json" } else { word }).collect();
    let output = joulepath(folder.path(), &[&local[..], &["--out", "path.gpx"]].concat());
    assert!(output.status.success(), "{}", text(&output.stderr));
    let track = fs::read_to_string(folder.path().join("path.gpx")).unwrap();
    assert!(track.contains("<trkpt lat=\"0.000000000\" lon=\"0.000000000\">") && track.contains("0 N 0 E"));
}

#[test]
fn load_and_ground_change_the_energy_and_are_refused_by_name() {
    let folder = folder();
    let energy_j = |more: &[&str]| -> f64 {
        let output = joulepath(folder.path(), &[QUESTIONS[0], &["--json"], more].concat());
        assert!(output.status.success(), "{more:?}: {}", text(&output.stderr));
        serde_json::from_slice::<Value>(&output.stdout).unwrap()["energy_j"].as_f64().unwrap()
    };
    let plain_j = energy_j(&[]);
    assert!(energy_j(&["--payload-kg", "45"]) > 1.3 * plain_j, "half its mass again");
    assert!(energy_j(&["--surface", "sandy_loam"]) > 1.5 * plain_j, "more than twice the rolling resistance");
    assert_eq!(energy_j(&["--surface", "marble", "--payload-kg", "0"]), plain_j);
    for (more, said) in [
        (["--surface", "lava"], "marble, sandy_loam"),
        (["--payload-kg", "-3"], "--payload-kg is -3"),
        (["--payload-kg", "nan"], "0 or more"),
    ] {
        let output = joulepath(folder.path(), &[QUESTIONS[0], &more].concat());
        let error = text(&output.stderr);
        assert_eq!((output.status.code(), error.lines().count()), (Some(2), 1), "{error}");
        assert!(error.contains(said), "{error}");
    }
}

/// The robot that drives the case takes 4.1 kJ; a stranger knows its data sheet alone.
#[test]
fn a_jackal_from_its_data_sheet_is_predicted_within_half_and_holds_what_the_true_robot_takes() {
    let case = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/cases/newcomer");
    if !case.exists() {
        return println!("skipped: {} is not here", case.display());
    }
    let folder = tempfile::tempdir().unwrap();
    let described = joulepath(
        folder.path(),
        &[
            "robot",
            "new",
            "--out",
            "jackal.json",
            "--mass-kg",
            "17",
            "--wheelbase-m",
            "0.262",
            "--track-m",
            "0.43",
            "--wheel-radius-m",
            "0.098",
            "--max-speed-mps",
            "2",
            "--rated-power-w",
            "250",
            "--surface",
            "grass",
        ],
    );
    assert!(described.status.success(), "{}", text(&described.stderr));
    let map = case.join("farm_utm32.tif").display().to_string();
    let plan = |robot: &str| -> Value {
        let ends = ["--start", "@0.1,0.3", "--goal", "@0.8,0.7", "--json"];
        let output =
            joulepath(folder.path(), &[&["plan", "--map", &map, "--robot", robot], &ends[..]].concat());
        serde_json::from_slice(&output.stdout).unwrap()
    };
    let (known, truth) = (plan("jackal.json"), plan(&case.join("truth.json").display().to_string()));
    let [energy_j, low_j, high_j] =
        [&known["energy_j"], &known["energy_interval_j"][0], &known["energy_interval_j"][1]]
            .map(|number| number.as_f64().unwrap());
    assert!(low_j > 0.5 * energy_j && high_j < 1.5 * energy_j, "{low_j} to {high_j} about {energy_j}");
    let true_j = truth["energy_j"].as_f64().unwrap();
    assert!(low_j < true_j && true_j < high_j, "{true_j} is not in {low_j} to {high_j}");
}
