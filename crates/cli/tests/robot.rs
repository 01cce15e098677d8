//! Robots at hand and described anew: `joulepath robot` and `joulepath schema`, and what plans with borrowed constants say.

#![allow(clippy::unwrap_used)]

use std::{
    path::Path,
    process::{Command, Output},
};

use serde_json::{Value, json};

const ROOT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

fn joulepath(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_joulepath")).args(arguments).current_dir(ROOT).output().unwrap()
}

fn succeed(arguments: &[&str]) -> Output {
    let output = joulepath(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    output
}

fn document(arguments: &[&str]) -> Value {
    serde_json::from_slice(&succeed(arguments).stdout).unwrap()
}

fn refusal(arguments: &[&str]) -> String {
    let output = joulepath(arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}");
    String::from_utf8(output.stderr).unwrap()
}

/// The robot of `tests/robots/small.json` as its data sheet has it, 1.2 kg too light, and whatever else is told.
fn describe(folder: &Path, more: &[&str]) -> String {
    let out = folder.join("mule.json").display().to_string();
    let mut arguments = vec!["robot", "new", "--out", &out, "--mass-kg", "15.8", "--wheelbase-m", "0.262"];
    arguments.extend(["--track-m", "0.376", "--wheel-radius-m", "0.098", "--max-speed-mps", "2"]);
    arguments.extend(["--battery-wh", "270", "--battery-v", "29.6", "--surface", "grass"]);
    arguments.extend(more);
    succeed(&arguments);
    out
}

/// Ground of gentle waves that names no surface.
fn hills(folder: &Path) -> String {
    let height_m =
        |row: usize, column: usize| 0.1 * (row as f64 / 5.0).sin() + 0.1 * (column as f64 / 8.0).cos();
    let row = |row: usize| -> Vec<f64> { (0..40).map(|column| height_m(row, column)).collect() };
    let map = json!({ "cell_size_m": 0.5, "rows": 40, "columns": 40, "elevation_m": (0..40).map(row).collect::<Vec<_>>() });
    let path = folder.join("hills.json");
    std::fs::write(&path, map.to_string()).unwrap();
    path.display().to_string()
}

fn plan(map: &str, robot: &str) -> Value {
    document(&[
        "plan",
        "--map",
        map,
        "--start",
        "@0.2,0.2,0",
        "--goal",
        "@0.8,0.3",
        "--robot",
        robot,
        "--json",
    ])
}

#[test]
fn intervals_of_a_robot_from_its_data_sheet_hold_the_true_one_and_are_narrow_enough_to_plan_with() {
    let folder = tempfile::tempdir().unwrap();
    let map = hills(folder.path());
    let truth_j = plan(&map, "tests/robots/small.json")["energy_j"].as_f64().unwrap();
    let motor =
        ["--torque-constant-nm-per-a", "0.05", "--motor-resistance-ohm", "0.35", "--gear-ratio", "25"];
    for more in [
        &["--rated-power-w", "250"][..],
        &[&motor[..], &["--gear-efficiency", "0.75"]].concat(),
        &["--stall-torque-nm", "65", "--stall-current-a", "80", "--no-load-rpm", "230"],
        &[],
    ] {
        let found = plan(&map, &describe(folder.path(), more));
        let energy_j = found["energy_j"].as_f64().unwrap();
        let [low_j, high_j] = [0, 1].map(|end| found["energy_interval_j"][end].as_f64().unwrap());
        assert!(low_j <= truth_j && truth_j <= high_j, "{more:?}: {low_j} to {high_j} J for {truth_j} J");
        assert!(
            low_j > 0.5 * energy_j && high_j < 1.55 * energy_j,
            "{more:?}: {low_j} to {high_j} J about {energy_j} J"
        );
    }
}

#[test]
fn a_written_file_has_its_reasons_and_is_read_as_any_other() {
    let folder = tempfile::tempdir().unwrap();
    let out = describe(folder.path(), &["--rated-power-w", "250", "--json"]);
    let robot: Value = serde_json::from_str(&std::fs::read_to_string(&out).unwrap()).unwrap();
    assert_eq!(robot["name"], "mule");
    assert_eq!(robot["provenance"]["motors.left.k1_w_per_n2"], "borrowed");
    assert_eq!(robot["provenance"]["mass_kg"], "data-sheet");
    assert!(robot["source"].as_str().unwrap().contains("P = 250 W"), "{}", robot["source"]);
    assert_eq!(document(&["robot", "show", &out, "--json"]), robot);
    let plain = succeed(&[
        "robot",
        "new",
        "--out",
        &out,
        "--mass-kg",
        "15",
        "--wheelbase-m",
        "0.3",
        "--track-m",
        "0.4",
        "--wheel-radius-m",
        "0.1",
        "--max-speed-mps",
        "1",
        "--surface",
        "lawn=0.09,0.4",
    ]);
    let said = String::from_utf8(plain.stdout).unwrap();
    for words in ["k1 =", "k2 =", "(borrowed)", "straight on level ground", "joulepath calibrate"] {
        assert!(said.contains(words), "{said}");
    }
}

#[test]
fn what_is_missing_or_wrong_in_a_data_sheet_is_told_by_its_flag() {
    let missing = refusal(&["robot", "new", "--out", "none.json", "--mass-kg", "17"]);
    for flag in
        ["--wheelbase-m", "--track-m", "--wheel-radius-m", "--max-speed-mps", "--surface", "sandy_loam"]
    {
        assert!(missing.contains(flag), "{missing}");
    }
    assert!(!missing.contains("--mass-kg"), "{missing}");
    let body = [
        "robot",
        "new",
        "--out",
        "none.json",
        "--mass-kg",
        "17",
        "--wheelbase-m",
        "0.26",
        "--track-m",
        "0.4",
        "--wheel-radius-m",
        "0.1",
        "--max-speed-mps",
        "2",
        "--surface",
    ];
    for (more, said) in [
        (&["lava"][..], "sandy_loam"),
        (&["grass", "--torque-constant-nm-per-a", "0.05"], "--motor-resistance-ohm"),
        (
            &[
                "grass",
                "--torque-constant-nm-per-a",
                "300",
                "--motor-resistance-ohm",
                "1",
                "--gear-ratio",
                "9",
            ],
            "N m/A",
        ),
        (&["grass", "--stall-torque-nm", "5", "--stall-current-a", "8"], "--motor-voltage-v"),
        (&["grass", "--gear-efficiency", "75"], "0.75 for 75 %"),
        (&["lawn=0.1"], "MU_ROLL,MU_SKID"),
    ] {
        let refused = refusal(&[&body[..], more].concat());
        assert!(refused.contains(said), "{more:?}: {refused}");
    }
    assert!(!Path::new(ROOT).join("none.json").exists());
}

#[test]
fn a_check_says_what_intervals_a_file_gives_and_what_is_doubtful_about_it() {
    let found = document(&["robot", "check", "jackal", "--json"]);
    for name in ["k1", "k2", "mu_roll", "mu_skid"] {
        assert!(found["borrowed"].as_array().unwrap().contains(&json!(name)), "{found}");
    }
    let moments = found["moments"].as_array().unwrap();
    for moment in moments {
        let [power_w, low_w, high_w] =
            [&moment["power_w"], &moment["interval_w"][0], &moment["interval_w"][1]]
                .map(|w| w.as_f64().unwrap());
        assert!(low_w < power_w && power_w < high_w, "{moment}");
    }
    assert_eq!(moments.len(), 5);
    assert!(found["next_drive"].is_string());
    let husky = document(&["robot", "check", "husky-a200", "--json"]);
    assert_eq!((&husky["borrowed"], &husky["next_drive"]), (&json!([]), &Value::Null));
    // A robot of another size with a Husky's motors and no word on where they come from.
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("mule.json").display().to_string();
    let mut copied = document(&["robot", "show", "husky-a200", "--json"]);
    (copied["mass_kg"], copied["wheel_radius_m"]) = (json!(17), json!(0.098));
    copied.as_object_mut().unwrap().remove("uncertainty");
    std::fs::write(&path, copied.to_string()).unwrap();
    let said = String::from_utf8(succeed(&["robot", "check", &path]).stdout).unwrap();
    for doubt in ["doubt: provenance:", "doubt: uncertainty:", "doubt: motors:", "doubt: hotel_power_w:"] {
        assert_eq!(said.lines().filter(|line| line.starts_with(doubt)).count(), 1, "{said}");
    }
}

#[test]
fn robots_are_listed_and_compared() {
    let list = document(&["robot", "list", "--json"]);
    let names: Vec<&str> =
        list["robots"].as_array().unwrap().iter().map(|r| r["name"].as_str().unwrap()).collect();
    for name in [
        "husky-a200",
        "husky-a200-field",
        "husky-a300",
        "jackal",
        "warthog",
        "scout-2",
        "bunker",
        "leo-rover",
    ] {
        assert!(names.contains(&name), "{names:?}");
    }
    let plain = String::from_utf8(succeed(&["robot", "list"]).stdout).unwrap();
    assert_eq!(plain.lines().count(), names.len() + 1);
    assert!(plain.lines().all(|line| line.chars().count() <= 100), "{plain}");
    let compared = document(&["robot", "compare", "husky-a200", "husky-a200-field", "--json"]);
    let level = &compared["moments"][0];
    assert_eq!(level["moment"], "level");
    let [paper_w, field_w] = [0, 1].map(|i| level["power_w"][i].as_f64().unwrap());
    assert!(field_w > paper_w + 60.0, "electronics and loam: {paper_w} W, {field_w} W");
    refusal(&["robot", "compare", "husky-a200", "r2d2"]);
}

#[test]
fn answers_that_lean_on_borrowed_constants_name_them_and_the_cure() {
    let question = ["--map", "maps/yard.json", "--start", "4,8,0", "--goal", "20,12"];
    for command in ["plan", "compare", "range"] {
        let of = |robot: &'static str| [&[command][..], &question, &["--robot", robot]].concat();
        let said = |robot| String::from_utf8(joulepath(&of(robot)).stderr).unwrap();
        let jackal = said("jackal");
        let warnings: Vec<&str> = jackal.lines().filter(|line| line.contains("borrowed")).collect();
        assert_eq!(warnings.len(), 1, "{command}: {jackal}");
        for words in ["mu_roll", "k1", "`jackal`", "joulepath calibrate"] {
            assert!(warnings[0].contains(words), "{command}: {jackal}");
        }
        assert!(!said("husky-a200").contains("borrowed"), "{command}");
    }
    // What is borrowed for ground that the map does not have is in no answer over it.
    let folder = tempfile::tempdir().unwrap();
    let map = hills(folder.path());
    let mut measured = document(&["robot", "show", "husky-a200"]);
    measured["provenance"] = serde_json::json!({ "surfaces.sandy_loam.mu_roll": "borrowed" });
    let file = folder.path().join("measured.json").display().to_string();
    std::fs::write(&file, measured.to_string()).unwrap();
    for (surface, is_named) in [("marble", false), ("sandy_loam", true)] {
        let ends = ["--start", "@0.3,0.3", "--goal", "@0.6,0.6", "--surface", surface];
        let output = joulepath(&[&["plan", "--map", &map, "--robot", &file][..], &ends].concat());
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success() && said.contains("mu_roll") == is_named, "{surface}: {said}");
    }
    // The documents are those of the HTTP API.
    let kinds = |command: &str, robot: &str, at: &str| -> Vec<Value> {
        let output = joulepath(&[&[command][..], &question, &["--robot", robot, "--json"]].concat());
        let answer: Value = serde_json::from_slice(&output.stdout).unwrap();
        let warnings = answer.pointer(at).unwrap().as_array().unwrap();
        warnings.iter().map(|warning| warning["kind"].clone()).collect()
    };
    for (command, at) in [("plan", "/warnings"), ("compare", "/energy/warnings"), ("range", "/warnings")] {
        assert_eq!(kinds(command, "jackal", at), ["borrowed-constants"], "{command}");
        assert!(kinds(command, "husky-a200", at).is_empty(), "{command}");
    }
}

#[test]
fn every_built_in_robot_plans_and_is_simulated() {
    let list = document(&["robot", "list", "--json"]);
    let folder = tempfile::tempdir().unwrap();
    let map = hills(folder.path());
    let at = |name: &str| folder.path().join(name).display().to_string();
    std::fs::write(at("world.json"), r#"{"terrain": "level"}"#).unwrap();
    std::fs::write(at("drive.json"), r#"{"kind": "rich", "duration_s": 20, "seed": 1}"#).unwrap();
    for robot in list["robots"].as_array().unwrap() {
        let name = robot["name"].as_str().unwrap();
        assert!(plan(&map, name)["energy_j"].as_f64().unwrap() > 0.0, "{name}");
        succeed(&[
            "simulate",
            "--robot",
            name,
            "--world",
            &at("world.json"),
            "--drive",
            &at("drive.json"),
            "--out",
            &at("log.csv"),
        ]);
    }
}

#[test]
fn schemas_are_listed_and_take_no_unknown_field() {
    let list = String::from_utf8(succeed(&["schema"]).stdout).unwrap();
    for name in ["robot", "map", "recording-map", "world"] {
        assert!(list.lines().any(|line| line.starts_with(name)), "{list}");
        let printed = document(&["schema", name]);
        assert_eq!(printed["$schema"], "https://json-schema.org/draft/2020-12/schema");
        assert_eq!(printed["additionalProperties"], false, "{name}");
    }
    assert!(refusal(&["schema", "robots"]).contains("recording-map"));
}
