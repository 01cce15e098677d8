//! `joulepath diagnose` and `POST /v1/diagnose` on drives of an independent world, as a person and a program meet them.

#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    path::Path,
    process::{Command, Output},
};

use joulepath_tests::{Server, drive_csv, program};
use serde_json::{Value, json};

fn joulepath(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(program()).args(arguments).current_dir(folder).output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).unwrap()
}

/// Records a drive of ten minutes over gentle hills, by one robot whatever the seed.
fn record(folder: &Path, name: &str, seed: u64, effects: &Value) {
    record_on(folder, name, seed, effects, &json!({"kind": "rich", "duration_s": 600, "seed": seed}));
}

/// Records a drive over the hills of a seed.
fn record_on(folder: &Path, name: &str, seed: u64, effects: &Value, drive: &Value) {
    let world = json!({
        "terrain": {"rolling": {"grade": 0.04}}, "seed": seed, "robot_seed": 5, "effects": effects
    });
    std::fs::write(folder.join("world.json"), world.to_string()).unwrap();
    std::fs::write(folder.join("drive.json"), drive.to_string()).unwrap();
    let out = format!("{name}.csv");
    let made =
        joulepath(folder, &["simulate", "--world", "world.json", "--drive", "drive.json", "--out", &out]);
    assert!(made.status.success(), "{}", text(&made.stderr));
}

/// A folder with a healthy drive, and one of the same robot on which something acts.
fn folder(effects: &Value) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), "healthy", 21, &json!([]));
    record(folder.path(), "suspect", 22, effects);
    folder
}

fn report(folder: &Path) -> Value {
    serde_json::from_slice(&std::fs::read(folder.join("report.json")).unwrap()).unwrap()
}

fn assert_is_of_the_contract(report: &Value) {
    let verdicts = ["consistent", "explained", "ambiguous", "unexplained"];
    assert!(verdicts.contains(&report["verdict"].as_str().unwrap()), "{report}");
    for field in ["rmse_w", "bias_w", "held_out_rmse_w", "noise_floor_w"] {
        assert!(report["baseline"][field].is_f64(), "{field} in {report}");
    }
    for field in ["rmse_w", "held_out_rmse_w"] {
        assert!(report["corrected"][field].is_f64(), "{field} in {report}");
    }
    for place in report["where"].as_array().unwrap() {
        assert!(place["statement"].is_string() && place["range"].is_object(), "{place}");
        assert!((0.0..=1.0).contains(&place["share_of_excess"].as_f64().unwrap()), "{place}");
    }
    for finding in report["findings"].as_array().unwrap() {
        for field in ["p_value", "delta_bic", "held_out_gain"] {
            assert!(finding["evidence"][field].is_f64(), "{field} in {finding}");
        }
        for field in ["held_out_rmse_before_w", "held_out_rmse_after_w"] {
            assert!(finding["fit"][field].is_f64(), "{field} in {finding}");
        }
        assert!(finding["statement"].is_string() && finding["equation"].is_string(), "{finding}");
        assert!(finding["indistinguishable_from"].is_array(), "{finding}");
        for parameter in finding["parameters"].as_array().unwrap() {
            assert!(parameter["value"].is_f64() && parameter["unit"].is_string(), "{parameter}");
        }
    }
    assert!(report["next_drive"].is_null() || report["next_drive"].is_string(), "{report}");
}

#[test]
fn a_healthy_drive_is_consistent_and_the_report_says_what_would_have_been_seen() {
    let folder = folder(&json!([]));
    let arguments =
        ["diagnose", "--recording", "suspect.csv", "--reference", "healthy.csv", "--out", "new/found"];
    let output = joulepath(folder.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    assert!(output.stderr.is_empty(), "a pipe shows no progress: {}", text(&output.stderr));
    assert!(text(&output.stdout).starts_with("consistent: "), "{}", text(&output.stdout));
    let found = folder.path().join("new/found");
    let report = report(&found);
    assert_is_of_the_contract(&report);
    assert_eq!(report["findings"], json!([]));
    let sizes = report["detectable"].as_array().unwrap();
    let payload = sizes.iter().find(|size| size["mechanism"] == "payload").unwrap();
    assert!((0.1..60.0).contains(&payload["value"].as_f64().unwrap()), "{payload}");
    let page = std::fs::read_to_string(found.join("report.html")).unwrap();
    assert!(
        page.contains("Within its uncertainty nothing is missing") && !page.contains("<script"),
        "{page}"
    );
    let robot = found.join("corrected-robot.json").display().to_string();
    let after = joulepath(folder.path(), &["predict", "--robot", &robot, "--recording", "suspect.csv"]);
    assert!(after.status.success(), "the corrected robot is a robot: {}", text(&after.stderr));
}

#[test]
fn drag_on_one_side_is_named_or_in_the_set_and_where_it_acts_is_said() {
    let effects = json!([{"effect": "drivetrain_drag", "strength": 30, "side": "left", "onset_s": 300}]);
    let folder = folder(&effects);
    let arguments =
        ["diagnose", "--recording", "suspect.csv", "--reference", "healthy.csv", "--out", "found", "--json"];
    let output = joulepath(folder.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let printed: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(printed, report(&folder.path().join("found")), "what is printed is what is written");
    assert_is_of_the_contract(&printed);
    assert_ne!(printed["verdict"], "consistent");
    let finding = &printed["findings"][0];
    let others = finding["indistinguishable_from"].as_array().unwrap();
    let is_named = finding["mechanism"] == "drivetrain_drag" || others.contains(&json!("drivetrain_drag"));
    assert!(is_named, "{finding}");
    let [before, after] = [&printed["baseline"], &printed["corrected"]];
    let rmse = |fit: &Value| fit["held_out_rmse_w"].as_f64().unwrap();
    assert!(rmse(after) < 0.8 * rmse(before), "{before} {after}");
    let places = printed["where"].as_array().unwrap();
    let time = places.iter().find(|place| place["kind"] == "time").unwrap();
    let from_s = time["range"]["from"].as_f64().unwrap();
    assert!((200.0..=400.0).contains(&from_s), "it began at 300 s: {time}");
    let side = places.iter().find(|place| place["kind"] == "channel").unwrap();
    assert_eq!(side["range"]["name"], "left", "{side}");
}

#[test]
fn a_load_lowers_the_held_out_error_once_it_is_found() {
    let folder = folder(&json!([{"effect": "payload", "strength": 25, "onset_s": 200}]));
    let arguments =
        ["diagnose", "--recording", "suspect.csv", "--reference", "healthy.csv", "--out", "found", "--json"];
    let output = joulepath(folder.path(), &arguments);
    assert!(output.status.success(), "{}", text(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_ne!(report["verdict"], "consistent", "{report}");
    let rmse = |part: &str| report[part]["held_out_rmse_w"].as_f64().unwrap();
    assert!(rmse("corrected") < 0.8 * rmse("baseline"), "{report}");
}

#[test]
fn a_healthy_drive_is_consistent_without_healthy_drives_beside_it_too() {
    let folder = folder(&json!([]));
    let made =
        joulepath(folder.path(), &["diagnose", "--recording", "suspect.csv", "--out", "out", "--json"]);
    assert!(made.status.success(), "{}", text(&made.stderr));
    let report: Value = serde_json::from_slice(&made.stdout).unwrap();
    assert_eq!(report["verdict"], "consistent", "{report}");
    let notes = report["notes"].to_string();
    assert!(notes.contains("by where its constants come from"), "it says what it assumed: {notes}");
}

#[test]
fn a_payload_that_is_taken_up_on_the_way_is_named_with_its_mass_and_time() {
    let folder = folder(&json!([{"effect": "payload", "strength": 12, "onset_s": 300}]));
    let arguments =
        ["diagnose", "--recording", "suspect.csv", "--reference", "healthy.csv", "--out", "out", "--json"];
    let made = joulepath(folder.path(), &arguments);
    assert!(made.status.success(), "{}", text(&made.stderr));
    let report: Value = serde_json::from_slice(&made.stdout).unwrap();
    let finding = &report["findings"][0];
    let alternatives = finding["indistinguishable_from"].as_array().unwrap();
    let is_named = finding["mechanism"] == "payload" || alternatives.iter().any(|name| name == "payload");
    assert!(is_named && alternatives.len() <= 2, "{finding}");
    let value = |name: &str| {
        let parameters = finding["parameters"].as_array().unwrap();
        parameters.iter().find(|p| p["name"] == name).and_then(|p| p["value"].as_f64())
    };
    let from_s = value("from_s").unwrap();
    assert!((from_s - 300.0).abs() < 60.0, "onset at {from_s} s");
    if let Some(mass_kg) = value("mass_kg") {
        assert!((mass_kg - 12.0).abs() < 3.0, "{mass_kg} kg");
    }
}

#[test]
fn a_strong_load_is_told_with_its_time_and_makes_no_second_mechanism_by_setting_in_between_two_looks() {
    let folder = tempfile::tempdir().unwrap();
    let drive = |seed: u64| json!({"kind": "rich", "duration_s": 900, "seed": seed});
    record_on(folder.path(), "healthy", 1, &json!([]), &drive(7));
    let load = json!([{"effect": "payload", "strength": 25, "onset_s": 400}]);
    record_on(folder.path(), "suspect", 2, &load, &drive(8));
    let arguments =
        ["diagnose", "--recording", "suspect.csv", "--reference", "healthy.csv", "--out", "out", "--json"];
    let made = joulepath(folder.path(), &arguments);
    assert!(made.status.success(), "{}", text(&made.stderr));
    let report: Value = serde_json::from_slice(&made.stdout).unwrap();
    let found: Vec<&Value> = report["findings"].as_array().unwrap().iter().map(|f| &f["mechanism"]).collect();
    assert_eq!(found, ["payload"], "{}", report["sentence"]);
    let parameters = report["findings"][0]["parameters"].as_array().unwrap();
    let from_s = parameters.iter().find(|p| p["name"] == "from_s").unwrap();
    // Times are looked at by fifteenths of the drive, and refits move them by quarters of these: 15 s.
    assert!((from_s["value"].as_f64().unwrap() - 400.0).abs() < 15.0, "{from_s}");
}

#[test]
fn drag_that_another_simulation_of_the_same_drive_left_out_is_named_with_its_force() {
    // The simulation is the recording's own world without the drag.
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), "suspect", 22, &json!([{"effect": "drivetrain_drag", "strength": 20}]));
    record(folder.path(), "simulated", 22, &json!([]));
    let beside_simulation = |recording: &str| -> Value {
        let all =
            ["diagnose", "--recording", recording, "--simulated", "simulated.csv", "--out", "out", "--json"];
        let made = joulepath(folder.path(), &all);
        assert!(made.status.success(), "{}", text(&made.stderr));
        serde_json::from_slice(&made.stdout).unwrap()
    };
    let report = beside_simulation("suspect.csv");
    assert_is_of_the_contract(&report);
    let sentence = report["sentence"].as_str().unwrap();
    assert!(sentence.starts_with("The simulation predicts these drives"), "{sentence}");
    assert_ne!(report["verdict"], "consistent", "{sentence}");
    let finding = &report["findings"][0];
    assert_eq!(finding["mechanism"], "drivetrain_drag", "{sentence}");
    let left_n = finding["parameters"][0]["value"].as_f64().unwrap();
    assert!((left_n - 20.0).abs() < 3.0, "{sentence}");
    // Where it left out nothing, nothing is found.
    let report = beside_simulation("simulated.csv");
    assert_eq!(report["verdict"], "consistent", "{}", report["sentence"]);
}

#[test]
fn a_simulation_of_another_length_and_one_beside_healthy_drives_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), "suspect", 22, &json!([]));
    let shorter = json!({"kind": "rich", "duration_s": 400, "seed": 22});
    record_on(folder.path(), "shorter", 22, &json!([]), &shorter);
    let arguments = ["diagnose", "--recording", "suspect.csv", "--simulated", "shorter.csv", "--out", "out"];
    let refused = joulepath(folder.path(), &arguments);
    let said = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.lines().count() == 1 && said.contains("the simulation cannot stand beside"), "{said}");
    assert!(said.contains("lasts 399.9 s in it and 599.9 s in the recording"), "{said}");
    assert!(!folder.path().join("out").exists());
    let beside = [&arguments[..], &["--reference", "shorter.csv"]].concat();
    let refused = joulepath(folder.path(), &beside);
    let said = text(&refused.stderr);
    assert_eq!(refused.status.code(), Some(2), "{said}");
    assert!(said.contains("--simulated") && said.contains("--reference"), "{said}");
}

/// Swaps two columns of a table by renaming them.
fn swap_columns(folder: &Path, name: &str, out: &str, [a, b]: [&str; 2]) {
    let table = std::fs::read_to_string(folder.join(name)).unwrap();
    let (head, rows) = table.split_once('\n').unwrap();
    assert!(head.contains(a) && head.contains(b), "{head}");
    let head = head.replace(a, "\0").replace(b, a).replace('\0', b);
    std::fs::write(folder.join(out), format!("{head}\n{rows}")).unwrap();
}

/// A table of CSV with all its columns of power in kilowatts.
fn in_kilowatts(table: &str) -> String {
    let (head, rows) = table.split_once('\n').unwrap();
    let names: Vec<&str> = head.split(',').collect();
    let cell = |(name, value): (&&str, &str)| match value.parse::<f64>() {
        Ok(power_w) if name.starts_with("power_") => format!("{:.6}", power_w / 1000.0),
        _ => value.to_owned(),
    };
    let rows =
        rows.lines().map(|row| names.iter().zip(row.split(',')).map(cell).collect::<Vec<_>>().join(","));
    std::iter::once(head.to_owned()).chain(rows).collect::<Vec<_>>().join("\n")
}

#[test]
fn swapped_sides_and_another_robot_are_said() {
    let folder = folder(&json!([]));
    swap_columns(folder.path(), "suspect.csv", "swapped.csv", ["power_left_w", "power_right_w"]);
    let notes = |arguments: &[&str]| {
        let mut all = vec!["diagnose", "--out", "found", "--json"];
        all.extend(arguments);
        let output = joulepath(folder.path(), &all);
        assert!(output.status.success(), "{}", text(&output.stderr));
        report(&folder.path().join("found"))["notes"].to_string()
    };
    // What the fault of a recording looks like is not told for physics, by the sentence nor by a finding.
    let is_all_that_is_said = |why: &str| {
        let found = report(&folder.path().join("found"));
        let sentence = found["sentence"].as_str().unwrap();
        assert!(
            sentence.starts_with("The recording is not what it seems") && sentence.contains(why),
            "{sentence}"
        );
        for nothing in ["findings", "where"] {
            assert!(found[nothing].as_array().unwrap().is_empty(), "{}", found[nothing]);
        }
    };
    let swapped = "power of the left and the right side seem swapped";
    for alone in [true, false] {
        let healthy = ["--recording", "swapped.csv", "--reference", "healthy.csv"];
        let said = notes(if alone { &healthy[..2] } else { &healthy });
        assert!(said.contains(swapped), "{said}");
        is_all_that_is_said(swapped);
    }
    let kilowatts = in_kilowatts(&std::fs::read_to_string(folder.path().join("suspect.csv")).unwrap());
    std::fs::write(folder.path().join("kilowatts.csv"), kilowatts).unwrap();
    notes(&["--recording", "kilowatts.csv", "--reference", "healthy.csv"]);
    is_all_that_is_said("in kilowatts");
    // Speeds alone, and with power, which only the gyroscope tells.
    let speeds = ["v_left_mps", "v_right_mps"];
    swap_columns(folder.path(), "suspect.csv", "speeds.csv", speeds);
    notes(&["--recording", "speeds.csv", "--reference", "healthy.csv"]);
    is_all_that_is_said("`yaw_rate_radps`: it is opposed to the wheel speeds");
    swap_columns(folder.path(), "swapped.csv", "all.csv", speeds);
    notes(&["--recording", "all.csv", "--reference", "healthy.csv"]);
    is_all_that_is_said("`yaw_rate_radps`: it is opposed to the wheel speeds");
    let said = notes(&["--recording", "suspect.csv"]);
    assert!(!said.contains("swapped"), "{said}");
    let mut robot: Value =
        serde_json::from_slice(&std::fs::read(folder.path().join("found/corrected-robot.json")).unwrap())
            .unwrap();
    robot["mass_kg"] = json!(20.0);
    robot["limits"]["max_side_force_n"] = json!(600.0);
    std::fs::write(folder.path().join("small.json"), robot.to_string()).unwrap();
    let said = notes(&["--robot", "small.json", "--recording", "suspect.csv"]);
    assert!(said.contains("another robot's"), "{said}");
}

#[test]
fn a_drive_is_not_healthy_and_suspect_at_once_and_nothing_is_left_of_what_is_refused() {
    let folder = folder(&json!([]));
    let arguments =
        ["diagnose", "--recording", "suspect.csv", "--reference", "suspect.csv", "--out", "found"];
    let output = joulepath(folder.path(), &arguments);
    let said = text(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("among the healthy ones too"), "{said}");
    assert!(!folder.path().join("found").exists());
}

#[test]
fn too_little_and_wrong_input_get_one_clear_line_and_status_2() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("short.csv"), drive_csv(2, 300)).unwrap();
    std::fs::write(folder.path().join("taken"), "a file").unwrap();
    let refused = |arguments: &[&str], word: &str| {
        let mut all = vec!["diagnose"];
        all.extend(arguments);
        let output = joulepath(folder.path(), &all);
        let said = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{said}");
        assert!(said.lines().count() == 1 && said.contains(word), "{said}");
    };
    refused(&["--recording", "short.csv", "--out", "found"], "at least 120 s");
    refused(&["--recording", "short.csv", "--out", "taken"], "name a folder");
    refused(&["--recording", "absent.csv", "--out", "found"], "absent.csv");
    refused(&["--recording", "short.csv", "--reference", "absent.csv", "--out", "found"], "absent.csv");
}

#[test]
fn over_http_a_diagnosis_is_a_job_with_the_same_report() {
    let folder = tempfile::tempdir().unwrap();
    record(folder.path(), "suspect", 22, &json!([]));
    let server = Server::start();
    let csv = std::fs::read(folder.path().join("suspect.csv")).unwrap();
    let stored = server.post("/v1/recordings", "text/csv", &csv);
    let id = stored.json()["id"].as_str().unwrap().to_owned();
    let started = server.post_json("/v1/diagnose", &json!({"robot": "husky-a200", "recordings": [id]}));
    assert_eq!(started.status, 202, "{}", started.text);
    let job = started.location.unwrap();
    let last = server.events(&format!("{job}/events"), None).last().unwrap();
    assert_eq!(last.name, "done", "{}", last.data);
    assert_is_of_the_contract(&last.data["result"]);
    assert!(last.data["result"]["robot"]["mass_kg"].is_number(), "{}", last.data);
    let body = json!({"robot": "husky-a200", "recordings": [id], "reference": ["0".repeat(32)]});
    let problem = server.post_json("/v1/diagnose", &body).problem(404, "unknown-recording");
    assert_eq!(problem["errors"][0]["pointer"], "/reference/0", "{problem}");
    server
        .post_json("/v1/diagnose", &json!({"robot": "husky-a200", "recordings": []}))
        .problem(400, "invalid-request");
    let body = json!({"robot": "husky-a200", "recordings": [id], "ruled_out": ["payload", "gremlins"]});
    let problem = server.post_json("/v1/diagnose", &body).problem(400, "invalid-request");
    assert_eq!(problem["errors"][0]["pointer"], "/ruled_out/1", "{problem}");
    assert!(problem["detail"].as_str().unwrap().contains("drivetrain_drag"), "{problem}");
}

#[test]
fn over_http_too_short_a_recording_fails_the_job_with_the_missing_number() {
    let server = Server::start();
    let stored = server.post("/v1/recordings", "text/csv", drive_csv(2, 300).as_bytes());
    let id = stored.json()["id"].as_str().unwrap().to_owned();
    let started = server.post_json("/v1/diagnose", &json!({"robot": "husky-a200", "recordings": [id]}));
    let job = started.location.unwrap();
    let last = server.events(&format!("{job}/events"), None).last().unwrap();
    assert_eq!(last.name, "failed", "{}", last.data);
    let detail = last.data["problem"]["detail"].as_str().unwrap();
    assert!(detail.contains("60 s") && detail.contains("at least 120 s"), "{detail}");
}
