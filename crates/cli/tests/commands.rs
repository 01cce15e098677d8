//! The command line as a person meets it: what it prints, and how it fails.

#![allow(clippy::unwrap_used)]

use std::process::{Command, Output};

fn joulepath(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_joulepath"))
        .args(arguments)
        .current_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/../.."))
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

const YARD: [&str; 6] = ["--map", "maps/yard.json", "--start", "4,8,0", "--goal", "20,12"];

fn with(command: &str, more: &[&str]) -> Output {
    let mut arguments = vec![command];
    arguments.extend(YARD);
    arguments.extend(more);
    joulepath(&arguments)
}

#[test]
fn plan_prints_a_short_summary_and_json_when_asked() {
    let summary = with("plan", &[]);
    assert!(summary.status.success(), "{}", text(&summary.stderr));
    assert!(text(&summary.stdout).contains("energy") && text(&summary.stdout).contains("kJ"));
    let json = with("plan", &["--json"]);
    let document: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    assert!(document["energy_j"].as_f64().unwrap() > 0.0);
    assert_eq!(document["search"]["optimal"], true);
}

#[test]
fn compare_names_the_saving() {
    let output = with("compare", &[]);
    let printed = text(&output.stdout);
    for word in ["energy-minimal", "shortest", "fastest", "saves"] {
        assert!(printed.contains(word), "{printed}");
    }
}

#[test]
fn fractions_of_the_map_and_reversing_are_taken() {
    let output = joulepath(&[
        "plan",
        "--map",
        "maps/yard.json",
        "--start",
        "@0.2,0.5",
        "--goal",
        "@0.3,0.3",
        "--reverse",
    ]);
    assert!(output.status.success(), "{}", text(&output.stderr));
}

#[test]
fn wrong_input_ends_with_2_and_one_line_that_says_what_and_where() {
    let folder = std::env::temp_dir().join(format!("joulepath-cli-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let robot = folder.join("robot.json");
    std::fs::write(&robot, "{\"name\": \"x\"}").unwrap();
    let robot = robot.display().to_string();
    for (arguments, said) in [
        (vec!["plan", "--map", "maps/none.json", "--start", "1,1", "--goal", "2,2"], "maps/none.json"),
        (vec!["plan", "--map", "README.md", "--start", "1,1", "--goal", "2,2"], ".tif"),
        (vec!["plan", "--map", "maps/yard.json", "--start", "-4,8", "--goal", "20,12"], "outside the map"),
        (vec!["plan", "--map", "maps/yard.json", "--start", "4;8", "--goal", "20,12"], "X,Y"),
        (
            vec!["plan", "--map", "maps/yard.json", "--start", "4,8", "--goal", "20,12", "--robot", "r2d2"],
            "husky-a200",
        ),
        (
            vec!["plan", "--map", "maps/yard.json", "--start", "4,8", "--goal", "20,12", "--robot", &robot],
            "mass_kg",
        ),
        (
            vec!["plan", "--map", "maps/yard.json", "--start", "4,8", "--goal", "20,12", "--speed-mps", "40"],
            "speed_mps",
        ),
        (vec!["serve", "--bind", "nowhere"], "--bind"),
    ] {
        let output = joulepath(&arguments);
        let error = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {error}");
        assert!(error.contains(said), "{arguments:?}: {error}");
        assert!(output.stdout.is_empty());
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn no_path_ends_with_3() {
    let folder = std::env::temp_dir().join(format!("joulepath-wall-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let map = folder.join("wall.json");
    let row = |value: &str| format!("[{}]", [value; 9].join(","));
    let walled = "[false,false,false,false,true,false,false,false,false]";
    let rows = |row: &str| [row; 9].join(",");
    let document = format!(
        r#"{{"cell_size_m": 1, "rows": 9, "columns": 9, "elevation_m": [{}], "obstacle": [{}]}}"#,
        rows(&row("0")),
        rows(walled)
    );
    std::fs::write(&map, document).unwrap();
    let map = map.display().to_string();
    let output = joulepath(&["plan", "--map", &map, "--start", "1.5,4.5", "--goal", "7.5,4.5"]);
    assert_eq!(output.status.code(), Some(3), "{}", text(&output.stderr));
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn the_demo_prints_its_table_and_draws_a_self_contained_picture() {
    let folder = std::env::temp_dir().join(format!("joulepath-demo-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let picture = folder.join("demo.svg");
    let output = joulepath(&["demo", "--out", &picture.display().to_string()]);
    let printed = text(&output.stdout);
    assert!(output.status.success(), "{}", text(&output.stderr));
    for word in ["energy-minimal", "shortest", "fastest", "recovered", "saves", "demo.svg"] {
        assert!(printed.contains(word), "{word} is missing in\n{printed}");
    }
    let svg = std::fs::read_to_string(&picture).unwrap();
    assert!(
        svg.contains("data:image/png;base64,") && svg.contains("energy-minimal") && svg.ends_with("</svg>\n")
    );
    assert!(
        !svg.replace("http://www.w3.org/2000/svg", "").contains("http"),
        "it must need nothing from elsewhere"
    );
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn simulate_records_what_predict_reads_and_keeps_a_key() {
    let folder = std::env::temp_dir().join(format!("joulepath-simulate-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let path = |name: &str| folder.join(name).display().to_string();
    let yard = concat!(env!("CARGO_MANIFEST_DIR"), "/../../maps/yard.json");
    let world = format!(
        r#"{{"terrain": {{"map": "{yard}"}}, "effects": [{{"effect": "payload", "strength": 15, "onset_s": 30}}]}}"#
    );
    std::fs::write(path("world.json"), world).unwrap();
    let plan = with("plan", &["--json"]);
    std::fs::write(path("drive.json"), plan.stdout).unwrap();
    let simulate = |world: &str| {
        let (drive, out, key) = (path("drive.json"), path("out.csv"), path("key.json"));
        joulepath(&["simulate", "--world", world, "--drive", &drive, "--out", &out, "--key", &key])
    };
    let output = simulate(&path("world.json"));
    assert!(output.status.success(), "{}", text(&output.stderr));
    let key: serde_json::Value = serde_json::from_slice(&std::fs::read(path("key.json")).unwrap()).unwrap();
    assert_eq!(key["truths"][0]["effect"], "payload");
    assert!(key["truths"][0]["power_share"].as_f64().unwrap() > 0.02, "{key}");
    let predicted = joulepath(&["predict", "--recording", &path("out.csv"), "--json"]);
    let predicted: serde_json::Value = serde_json::from_slice(&predicted.stdout).unwrap();
    assert!(predicted["total"]["r2"].as_f64().unwrap() > 0.8, "{predicted}");
    std::fs::write(
        path("bad.json"),
        r#"{"terrain": "level", "effects": [{"effect": "payload", "weight": 3}]}"#,
    )
    .unwrap();
    let refused = simulate(&path("bad.json"));
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        text(&refused.stderr).contains("effects[0].weight") && text(&refused.stderr).lines().count() == 1,
        "{}",
        text(&refused.stderr)
    );
    std::fs::remove_dir_all(folder).unwrap();
}
