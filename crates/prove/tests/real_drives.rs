//! A short trial on the real recordings, with a program in the diagnosis' place that finds nothing wrong.

#![allow(clippy::unwrap_used, clippy::print_stderr)]
#![cfg(unix)]

use std::{
    fs,
    os::unix::fs::PermissionsExt,
    path::{Path, PathBuf},
};

use model::builtin;
use prove::{
    Diagnosis, Error, FileBeside, PeerAnswer, Stage, Way,
    real::{Ground, RealBoards, RealKey, RealKind, RealTrial},
};
use recording::read_paths;

/// Calibrates a robot as it was and finds nothing wrong.
const QUIET: &str = r#"#!/bin/sh
if [ "$1" = calibrate ]; then exec cp robot.json calibrated.json; fi
mkdir -p "$7"
printf '{"verdict": "consistent", "baseline": {}, "findings": []}' > "$7/report.json"
"#;

/// The real recordings of some grounds: beside the workspace, or where `JOULEPATH_RECORDINGS` says.
fn grounds() -> Option<Vec<Ground>> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared/recordings");
    let folder = std::env::var_os("JOULEPATH_RECORDINGS").map_or(beside, PathBuf::from);
    if !folder.join("husky-flooring.csv").exists() {
        eprintln!("SKIPPED: the real recordings are not in {}", folder.display());
        return None;
    }
    let read = |name: &str| Ground::read(&folder.join(format!("husky-{name}.csv"))).unwrap();
    Some(["flooring", "ice", "sandy-loam"].map(read).into())
}

fn run(
    grounds: &[Ground],
    out: &Path,
    progress: &(dyn Fn(Stage, usize, usize) + Sync),
) -> Result<RealBoards, Error> {
    let program = out.with_extension("program");
    fs::write(&program, QUIET).unwrap();
    fs::set_permissions(&program, fs::Permissions::from_mode(0o755)).unwrap();
    let trial = RealTrial {
        grounds,
        cases: 8,
        seed: 5,
        strengths_z: &[16.0, 32.0],
        robot: &builtin::husky_a200(),
        out,
        diagnosis: Diagnosis { program: (program, Vec::new()), threads: 1, beside: FileBeside::Calibrated },
        ways: &Way::ALL,
        peers: &|_| vec![PeerAnswer { peer: "says payload", names: Ok(vec!["payload".into()]) }],
        at_once: 2,
        progress,
        published: &|_| {},
    };
    trial.run()
}

#[test]
fn a_trial_on_real_drives_repeats_and_healthy_rows_are_as_they_were_recorded() {
    let Some(grounds) = grounds() else { return };
    let room = tempfile::tempdir().unwrap();
    let [first, again] = ["first", "again"].map(|name| room.path().join(name));
    let boards = run(&grounds, &first, &|_, _, _| {}).unwrap();
    assert_eq!(run(&grounds, &again, &|_, _, _| {}).unwrap(), boards, "the same seed is the same trial");
    assert_eq!(boards.ways.len(), 3);
    let board = &boards.ways[2].board;
    assert_eq!((board.errors.hits, board.false_alarms.hits, board.strong_in_three.hits), (0, 0, 0));
    let peer = &boards.peers[0];
    assert_eq!(peer.false_alarms.hits, peer.false_alarms.of, "it says payload of healthy drives too");
    for entry in fs::read_dir(first.join("keys")).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_some_and(|ending| ending == "json") {
            let key: RealKey = serde_json::from_slice(&fs::read(&path).unwrap()).unwrap();
            holds(&key, &first.join("cases").join(&key.case), &grounds);
        }
    }
}

/// The files of a case are the runs that its key names, changed where and when it says.
fn holds(key: &RealKey, case: &Path, grounds: &[Ground]) {
    let ground = grounds.iter().find(|ground| ground.name == key.ground).unwrap();
    let places = |names: &[String]| -> Vec<usize> {
        names
            .iter()
            .map(|name| ground.recording.runs.iter().position(|run| run.name == *name).unwrap())
            .collect()
    };
    let read = |name: &str| read_paths(&[case.join(name)], None).unwrap().0;
    let (healthy, suspect) = (read(prove::REFERENCE), read(prove::RECORDING));
    let recorded = ground.part(&places(&key.healthy));
    assert_eq!((&healthy.t_s, &healthy.channels, healthy.surface), (&recorded.t_s, &recorded.channels, None));
    let recorded = ground.part(&places(&key.suspect));
    for run in &suspect.runs {
        let times_s = &suspect.t_s[run.rows.clone()];
        assert!(times_s.is_sorted_by(|before, after| before < after), "{}: {}", key.case, run.name);
    }
    match key.kind {
        RealKind::Healthy => assert_eq!(suspect.channels, recorded.channels),
        RealKind::Changed => {
            let acts = key.put.unwrap().act.onset.rows(&recorded);
            let is_same = |row: usize| {
                recorded
                    .channels
                    .iter()
                    .all(|(channel, values)| suspect.channel(*channel).unwrap()[row] == values[row])
            };
            assert!((0..recorded.rows()).filter(|row| !acts[*row]).all(is_same), "{}", key.case);
            assert!(!(0..recorded.rows()).all(is_same), "{}", key.case);
        }
        RealKind::Spliced => {
            let border = key.border.as_ref().unwrap();
            let last = suspect.runs.last().unwrap();
            assert_eq!(last.name, border.run);
            let before = |row: &usize| suspect.t_s[*row] - suspect.t_s[last.rows.start] < border.t_s;
            let kept = last.rows.start + last.rows.clone().filter(before).count();
            for (channel, values) in &recorded.channels {
                assert_eq!(suspect.channel(*channel).unwrap()[..kept], values[..kept], "{}", key.case);
            }
            assert!(kept < suspect.rows());
        }
    }
    // Neither ground nor day stands in what the diagnosis gets.
    for name in [prove::RECORDING, prove::REFERENCE] {
        let text = fs::read_to_string(case.join(name)).unwrap();
        assert!(grounds.iter().all(|ground| !text.contains(&ground.name)), "{}", key.case);
    }
}

#[test]
fn a_key_of_real_drives_that_changes_while_the_diagnosis_runs_ends_the_trial() {
    let Some(grounds) = grounds() else { return };
    let room = tempfile::tempdir().unwrap();
    let out = room.path().join("out");
    let tamper = |stage, done, _| {
        if stage == Stage::Scoring && done == 0 {
            let path = out.join("keys/case-0003.json");
            let text = fs::read_to_string(&path).unwrap();
            fs::write(&path, text.replacen("\"seed\": ", "\"seed\": 1", 1)).unwrap();
        }
    };
    assert!(matches!(run(&grounds, &out, &tamper), Err(Error::ChangedKey { .. })));
    assert!(!out.join("scoreboard.json").exists());
}
