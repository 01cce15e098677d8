//! `joulepath prove` with few cases: what it leaves, and that anyone can check what it committed to.

#![allow(clippy::unwrap_used)]

use std::{
    collections::BTreeSet,
    path::Path,
    process::{Command, Output},
};

use joulepath_tests::program;
use serde_json::Value;

fn prove(out: &Path, more: &[&str]) -> Output {
    Command::new(program()).arg("prove").args(more).arg("--out").arg(out).output().unwrap()
}

#[test]
fn a_case_of_each_kind_is_proven_and_the_published_hash_is_that_of_the_keys() {
    let room = tempfile::tempdir().unwrap();
    let out = room.path().join("proof");
    let output = prove(&out, &["--cases", "5", "--seed", "2", "--way", "healthy-drives"]);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(
        output.status.success() && output.stderr.is_empty(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let board: Value = serde_json::from_slice(&std::fs::read(out.join("scoreboard.json")).unwrap()).unwrap();
    assert_eq!(board["cases"], 5);
    let kinds: BTreeSet<&str> =
        board["scores"].as_array().unwrap().iter().map(|case| case["kind"].as_str().unwrap()).collect();
    assert_eq!(kinds.len(), 5, "{kinds:?}");
    assert_eq!(board["errors"]["hits"], 0, "{:#}", board["scores"]);
    assert_eq!(board["peers"].as_array().unwrap().len(), 2);
    assert!(said.contains(board["commitment"].as_str().unwrap()), "{said}");
    let ratio = board["rmse_ratio_listed_median"].as_f64().unwrap();
    let line = said.lines().find(|line| line.starts_with("held-out error over that without")).unwrap();
    assert!(line.ends_with(&format!(" {ratio:.3}")), "{said}");
    let checked = Command::new("sha256sum")
        .args(["--check", "--strict", "SHA256SUMS"])
        .current_dir(out.join("keys"))
        .output()
        .unwrap();
    assert!(checked.status.success(), "{checked:?}");
    let html = std::fs::read_to_string(out.join("scoreboard.html")).unwrap();
    assert!(html.contains("concealed effects were named"), "{html}");
}

#[test]
fn a_case_is_diagnosed_by_its_file_by_a_calibrated_one_and_with_healthy_drives() {
    let room = tempfile::tempdir().unwrap();
    let out = room.path().join("proof");
    let asked = ["--cases", "2", "--seed", "5", "--only", "one", "--share", "0.12"];
    let output = prove(&out, &asked);
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let board: Value = serde_json::from_slice(&std::fs::read(out.join("scoreboard.json")).unwrap()).unwrap();
    let ways: Vec<&str> =
        board["ways"].as_array().unwrap().iter().map(|one| one["way"].as_str().unwrap()).collect();
    assert_eq!(ways, ["file-alone", "calibrated-file-alone", "healthy-drives"]);
    for one in board["ways"].as_array().unwrap() {
        assert_eq!(one["board"]["errors"]["hits"], 0, "{:#}", one["board"]["scores"]);
        assert_eq!(one["board"]["set_named"]["of"], 2);
        assert_eq!(one["board"]["false_names"]["of"], 2, "both are driven again without the effect");
    }
    let calibrated = std::fs::read_to_string(out.join("cases/case-0001/calibrated.json")).unwrap();
    let robot = model::Robot::from_json(&calibrated).unwrap();
    assert!(robot.posterior.is_some() && robot.model_error.is_some() && robot.noise.is_some());
    let heads = said.lines().find(|line| line.contains("calibrated file alone"));
    assert!(heads.is_some_and(|line| line.contains("healthy drives beside")), "{said}");
}

#[test]
fn trials_of_before_are_added_up_and_what_is_no_trial_is_said() {
    let room = tempfile::tempdir().unwrap();
    let [first, second] = [3, 4].map(|seed| {
        let out = room.path().join(format!("seed-{seed}"));
        let seed = seed.to_string();
        let asked = ["--cases", "1", "--seed", &seed, "--only", "healthy", "--way", "healthy-drives"];
        assert!(prove(&out, &asked).status.success());
        out
    });
    let together = |folders: &[&Path]| {
        Command::new(program()).args(["prove", "--together"]).args(folders).output().unwrap()
    };
    let said = String::from_utf8(together(&[&first, &second]).stdout).unwrap();
    assert!(said.contains("false alarms, healthy drives       0 of 2 (0 to 84 %)\n"), "{said}");
    assert!(!said.contains("effects"), "what there is no case of is not said: {said}");
    std::fs::write(room.path().join("scoreboard.json"), r#"{"seed": 1}"#).unwrap();
    for (folder, fault) in [
        (room.path(), "missing field"),
        (&room.path().join("none"), "none/scoreboard.json"),
        (&first, "name each once"),
    ] {
        let output = together(&[&first, folder]);
        let message = String::from_utf8(output.stderr).unwrap();
        assert!(!output.status.success() && output.stdout.is_empty(), "{message}");
        assert!(message.contains(fault) && message.lines().count() == 1, "{message}");
    }
}

#[test]
fn wrong_arguments_are_refused_before_anything_is_drawn() {
    let room = tempfile::tempdir().unwrap();
    std::fs::write(room.path().join("mine.txt"), "").unwrap();
    let fresh = room.path().join("proof");
    for (out, more, said) in [
        (room.path(), ["--cases", "6"], "empty folder"),
        (&fresh, ["--cases", "0"], "--cases 0"),
        (&fresh, ["--cases", "99999999"], "--cases"),
        (&fresh, ["--share", "2"], "--share 2"),
        (&fresh, ["--share", "NaN"], "--share NaN"),
    ] {
        let output = prove(out, &more);
        let message = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(said) && message.lines().count() == 1, "{message}");
    }
}
