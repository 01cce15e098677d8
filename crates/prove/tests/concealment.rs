//! A whole trial with a program in the diagnosis' place that tries to see more than it should.

#![allow(clippy::unwrap_used)]
#![cfg(unix)]

use std::{
    fs,
    os::unix::fs::PermissionsExt,
    path::{Path, PathBuf},
    sync::Mutex,
};

use prove::{Boards, Diagnosis, Error, FileBeside, PeerAnswer, Stage, Trial, Way};

/// Calibrates a robot as it was, reports what it sees and finds nothing wrong.
const SPY: &str = r#"#!/bin/sh
if [ "$1" = calibrate ]; then
    [ "$*" = "calibrate --robot robot.json --recording reference.csv --out calibrated.json" ] || exit 2
    exec cp robot.json calibrated.json
fi
seen_environment=$(env | grep -v -e ^PWD= -e ^_= -e ^SHLVL= -e ^OLDPWD= | tr '\n' ' ')
[ "$1 $2 $3 $4 $5" = "diagnose --robot robot.json --recording recording.csv" ] || exit 2
seen=$(ls -a | grep -v '^\.*$' | sort | tr '\n' ' ')
mkdir -p "$7"
printf '%s|%s|%s|%s' "$seen" "$seen_environment" "$PWD" "$8 $9" > "$7/seen.txt"
printf '{"verdict": "consistent", "baseline": {"held_out_rmse_w": 1.5}, "findings": []}' > "$7/report.json"
"#;

fn script(folder: &Path, text: &str) -> PathBuf {
    let path = folder.join("program");
    fs::write(&path, text).unwrap();
    fs::set_permissions(&path, fs::Permissions::from_mode(0o755)).unwrap();
    path
}

fn robot_json() -> String {
    serde_json::to_string(&world::example_robot()).unwrap()
}

fn run(out: &Path, program: &Path, progress: &(dyn Fn(Stage, usize, usize) + Sync)) -> Result<Boards, Error> {
    let robot_json = robot_json();
    let trial = Trial {
        cases: 3,
        seed: 11,
        only: None,
        share: None,
        robot_json: &robot_json,
        out,
        diagnosis: Diagnosis {
            program: (program.to_owned(), Vec::new()),
            threads: 1,
            beside: FileBeside::Raw,
        },
        ways: &Way::ALL,
        peers: &|_| vec![PeerAnswer { peer: "says payload", names: Ok(vec!["payload".into()]) }],
        at_once: 2,
        progress,
        published: &|_| {},
    };
    trial.run()
}

#[test]
fn the_diagnosis_sees_what_a_way_gives_and_nothing_of_the_key_and_the_trial_repeats() {
    let room = tempfile::tempdir().unwrap();
    let program = script(room.path(), SPY);
    let [first, again] = ["first", "again"].map(|name| room.path().join(name));
    let boards = run(&first, &program, &|_, _, _| {}).unwrap();
    let ways: Vec<Way> = boards.ways.iter().map(|one| one.way).collect();
    assert_eq!(ways, Way::ALL);
    assert_eq!(boards.most, boards.ways[2].board, "healthy drives beside are the most to go by");
    let board = &boards.most;
    assert_eq!((board.cases, board.errors.hits), (3, 0));
    assert_eq!((board.abstained.hits, board.abstained.of), (2, 2));
    for case in fs::read_dir(first.join("cases")).unwrap().map(|entry| entry.unwrap().path()) {
        for (folder, expected, reference) in [
            ("diagnosis", "recording.csv reference.csv robot.json ", "--reference reference.csv"),
            ("diagnosis-file-alone", "recording.csv robot.json ", " "),
            ("diagnosis-calibrated-file-alone", "recording.csv robot.json ", " "),
        ] {
            let seen = fs::read_to_string(case.join(folder).join("seen.txt")).unwrap();
            let [files, environment, place, rest] = seen.split('|').collect::<Vec<_>>().try_into().unwrap();
            assert_eq!((files, rest), (expected, reference));
            assert_eq!(environment, "RAYON_NUM_THREADS=1 ");
            assert!(!place.contains("case-") && !Path::new(place).starts_with(&first), "{place}");
        }
        betrays_nothing(&case, &first.join("keys"));
    }
    assert_eq!(run(&again, &program, &|_, _, _| {}).unwrap(), boards, "the same seed is the same trial");
    assert!(first.join("scoreboard.json").exists());
}

/// Neither seed nor strength nor names of effects stand in the files of a case.
fn betrays_nothing(case: &Path, keys: &Path) {
    let name = case.file_name().unwrap().to_str().unwrap();
    let key: serde_json::Value =
        serde_json::from_slice(&fs::read(keys.join(format!("{name}.json"))).unwrap()).unwrap();
    let mut secrets: Vec<String> = world::EffectName::all().map(world::EffectName::name).collect();
    secrets.push(key["seed"].to_string());
    secrets.extend(
        key["truths"].as_array().unwrap().iter().map(|truth| truth["parameters"][0]["value"].to_string()),
    );
    secrets.retain(|secret| secret.len() > 6);
    for file in ["recording.csv", "reference.csv"] {
        let text = fs::read_to_string(case.join(file)).unwrap();
        let found = secrets.iter().find(|secret| text.contains(secret.as_str()));
        assert!(found.is_none(), "{file} holds {found:?}");
    }
    assert_eq!(fs::read_to_string(case.join("robot.json")).unwrap(), robot_json());
}

#[test]
fn a_key_that_changes_while_the_diagnosis_runs_ends_the_trial() {
    let room = tempfile::tempdir().unwrap();
    let program = script(room.path(), SPY);
    let out = room.path().join("out");
    let changed = Mutex::new(false);
    let tamper = |stage, done, _| {
        let mut changed = changed.lock().unwrap();
        if stage == Stage::Diagnosing && done == 1 && !*changed {
            let path = out.join("keys/case-0003.json");
            let text = fs::read_to_string(&path).unwrap();
            fs::write(&path, text.replacen("\"share\": ", "\"share\": 1", 1)).unwrap();
            *changed = true;
        }
    };
    assert!(matches!(run(&out, &program, &tamper), Err(Error::ChangedKey { .. })));
    assert!(!out.join("scoreboard.json").exists());
}

#[test]
fn failing_programs_and_reports_that_are_none_are_errors_on_the_board() {
    let room = tempfile::tempdir().unwrap();
    for (text, said) in [
        ("#!/bin/sh\necho 'no such robot' >&2\nexit 2\n", "no such robot"),
        ("#!/bin/sh\nexit 0\n", "report.json"),
        ("#!/bin/sh\nmkdir diagnosis\necho '{\"verdict\": \"maybe\"}' > diagnosis/report.json\n", "maybe"),
    ] {
        let program = script(room.path(), text);
        let case = room.path().join("case");
        fs::create_dir_all(&case).unwrap();
        for name in [prove::ROBOT, prove::RECORDING, prove::REFERENCE] {
            fs::write(case.join(name), "").unwrap();
        }
        let outcome = Diagnosis { program: (program, Vec::new()), threads: 1, beside: FileBeside::Raw }
            .run(&case, Way::HealthyDrives)
            .unwrap();
        assert!(matches!(&outcome, prove::Outcome::Failed(why) if why.contains(said)), "{outcome:?}");
    }
}
