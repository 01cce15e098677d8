//! Drives of a real robot over several grounds, without the names of these.

#![allow(clippy::unwrap_used, clippy::panic, clippy::print_stderr)]

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use diagnosis::{Diagnosis, Question, Verdict, diagnose, report::Finding};
use model::Robot;
use recording::{Channel, Recording, Run, read_paths};

fn said(robot: &Robot, suspect: &Recording, healthy: &Recording) -> Diagnosis {
    diagnose(&Question::new(robot, suspect, Some(healthy)), &|_, _| {}).unwrap()
}

fn names(found: &Diagnosis) -> Vec<&str> {
    found.findings.iter().map(|finding| finding.mechanism.as_str()).collect()
}

fn value(finding: &Finding, name: &str) -> f64 {
    let of = |finding: &Finding| finding.parameters.iter().find(|p| p.name == name).map(|p| p.value);
    of(finding).unwrap_or_else(|| panic!("no {name}: {}", finding.statement))
}

/// The real recordings: beside the workspace, or where `JOULEPATH_RECORDINGS` says.
fn real_recordings() -> Option<PathBuf> {
    let beside = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../shared/recordings");
    let folder = std::env::var_os("JOULEPATH_RECORDINGS").map_or(beside, PathBuf::from);
    if folder.join("husky-flooring.csv").exists() {
        return Some(folder);
    }
    eprintln!("SKIPPED: the real recordings are not in {}", folder.display());
    None
}

/// Some drives of a real recording, without the name of the ground.
fn unlabelled(folder: &Path, ground: &str, wanted: impl Fn(usize) -> bool) -> Recording {
    let mut whole = read_paths(&[folder.join(format!("husky-{ground}.csv"))], None).unwrap().0;
    whole.surface = None;
    let runs: Vec<_> =
        whole.runs.iter().enumerate().filter(|(i, _)| wanted(*i)).map(|(_, r)| r.clone()).collect();
    let pick = |values: &[f64]| -> Vec<f64> {
        runs.iter().flat_map(|run| values[run.rows.clone()].iter().copied()).collect()
    };
    let mut at = 0;
    let moved = runs.iter().map(|run| {
        let rows = at..at + run.rows.len();
        at = rows.end;
        Run { rows, ..run.clone() }
    });
    let channels: BTreeMap<_, _> = whole.channels.iter().map(|(c, values)| (*c, pick(values))).collect();
    Recording { t_s: pick(&whole.t_s), channels, runs: moved.collect(), ..Recording::default() }
}

/// The built-in robot as its drives over flooring show it.
fn on_flooring(folder: &Path) -> Robot {
    let labelled = read_paths(&[folder.join("husky-flooring.csv")], None).unwrap().0;
    let options = calibration::Options::default();
    let mut robot = calibration::calibrate(&model::builtin::husky_a200(), &labelled, &options).unwrap().robot;
    robot.default_surface = "flooring".into();
    robot
}

/// The robot of flooring, some drives on another ground, and those over flooring that are healthy.
fn on_other_ground(ground: &str) -> Option<Diagnosis> {
    let folder = real_recordings()?;
    let found = said(
        &on_flooring(&folder),
        &unlabelled(&folder, ground, |_| true),
        &unlabelled(&folder, "flooring", |_| true),
    );
    say(ground, &found);
    Some(found)
}

/// Every other drive over flooring, to be held against those between.
fn halves_of_flooring(folder: &Path) -> [Recording; 2] {
    [0, 1].map(|rest| unlabelled(folder, "flooring", move |i| i % 2 == rest))
}

#[test]
fn on_the_floor_that_it_is_known_on_a_real_husky_lacks_nothing() {
    let Some(folder) = real_recordings() else { return };
    let [even, odd] = halves_of_flooring(&folder);
    let found = said(&on_flooring(&folder), &odd, &even);
    say("flooring", &found);
    assert_eq!((found.verdict, names(&found)), (Verdict::Consistent, vec![]), "{}", found.sentence);
}

#[test]
fn meters_of_current_at_the_other_motors_of_a_real_husky_are_told() {
    let Some(folder) = real_recordings() else { return };
    let [even, mut swapped] = halves_of_flooring(&folder);
    let currents = [Channel::LeftMotorCurrent, Channel::RightMotorCurrent];
    let [left_a, right_a] = currents.map(|side| swapped.channels.remove(&side).unwrap());
    swapped.channels.extend(currents.into_iter().zip([right_a, left_a]));
    let found = said(&on_flooring(&folder), &swapped, &even);
    say("flooring, swapped", &found);
    assert!(
        found.sentence.contains("motor currents of the left and the right side seem swapped"),
        "{}",
        found.sentence
    );
    assert_eq!(names(&found), [""; 0], "{}", found.sentence);
}

/// Spinning on ice takes 7 A instead of 19: skid friction is a fifth.
#[test]
fn a_real_husky_on_ice_is_on_ground_that_skids_far_less_all_the_time() {
    let Some(found) = on_other_ground("ice") else { return };
    // Wheels that slip as they drive are told beside it, as wheels that turn faster than the robot moves.
    let (first, others) = (names(&found)[0], &names(&found)[1..]);
    assert_eq!(first, "surface_change", "{}", found.sentence);
    assert!(others.is_empty() || others == ["wheel_radius"], "{}", found.sentence);
    assert!((-0.9..-0.6).contains(&value(&found.findings[0], "skid_change")), "{}", found.sentence);
    let from_s = found.findings[0].parameters.iter().find(|p| p.name == "from_s");
    assert!(from_s.is_none(), "it was on ice all the time: {}", found.sentence);
    let [before_w, after_w] = [found.baseline.held_out_rmse_w, found.corrected.held_out_rmse_w];
    assert!(after_w < 0.6 * before_w, "held out {before_w} W before, {after_w} W after");
}

/// On snow the wheels often turn and the robot does not.
#[test]
fn of_a_real_husky_that_is_stuck_in_snow_it_is_said_where() {
    let Some(found) = on_other_ground("snow") else { return };
    assert_ne!(found.verdict, Verdict::Consistent);
    let stuck = found.notes.iter().find(|note| note.contains("the robot does not")).unwrap();
    assert!(stuck.contains("100 % of snow-02") && stuck.contains("100 % of snow-04"), "{stuck}");
}

/// Wheels sink in loam, or it is other ground.
#[test]
#[ignore = "engine fault: unexplained without a name, though held-out errors are 1.2 times the noise and nothing missing has 6 %"]
fn a_real_husky_in_sandy_loam_sinks_or_is_on_other_ground() {
    let Some(found) = on_other_ground("sandy-loam") else { return };
    assert!(matches!(names(&found)[..], ["soft_soil"] | ["surface_change"]), "{}", found.sentence);
}

fn say(ground: &str, found: &Diagnosis) {
    let [before_w, after_w] = [found.baseline.held_out_rmse_w, found.corrected.held_out_rmse_w];
    let floor_w = found.baseline.noise_floor_w;
    eprintln!(
        "{ground}: {:?} {:?} {:?}: {} Held out {before_w:.1} W before, {after_w:.1} W after, {floor_w:.1} W is noise. {}",
        found.verdict,
        found.probability,
        found.explanations,
        found.sentence,
        found.notes.join("; ")
    );
}

/// Some recordings' drives, one behind the other.
fn behind(parts: &[&Recording]) -> Recording {
    let mut whole = Recording::default();
    for part in parts {
        let at = whole.rows();
        whole.t_s.extend(&part.t_s);
        for (channel, values) in &part.channels {
            whole.channels.entry(*channel).or_default().extend(values);
        }
        let moved =
            part.runs.iter().map(|run| Run { rows: run.rows.start + at..run.rows.end + at, ..run.clone() });
        whole.runs.extend(moved);
    }
    whole
}

/// The same as if it were a single drive.
fn in_one(drives: &Recording) -> Recording {
    let mut whole = drives.clone();
    let mut from_s = 0.0;
    for run in &drives.runs {
        let times = &mut whole.t_s[run.rows.clone()];
        let began_s = times[0];
        times.iter_mut().for_each(|t_s| *t_s += from_s - began_s);
        from_s = times[times.len() - 1] + ROW_S;
    }
    let all = Run { name: "whole".into(), rows: 0..whole.rows(), ..drives.runs[0].clone() };
    Recording { runs: vec![all], ..whole }
}

/// Time between rows [s].
const ROW_S: f64 = 1.0 / 6.5;

/// A real Husky on some grounds one behind the other, known by other drives on flooring.
fn across(folder: &Path, what: &str, drives: &Recording) -> Diagnosis {
    let healthy = unlabelled(folder, "flooring", |i| [1, 3, 4].contains(&i));
    let found = said(&on_flooring(folder), drives, &healthy);
    say(what, &found);
    found
}

/// Drives over flooring, on ice and in loam.
fn grounds(folder: &Path) -> [Recording; 3] {
    [
        unlabelled(folder, "flooring", |i| [0, 2].contains(&i)),
        unlabelled(folder, "ice", |i| [0, 2, 3].contains(&i)),
        unlabelled(folder, "sandy-loam", |i| i > 0),
    ]
}

/// That ice is found, and from when on: after 285 s of driving.
fn came_onto_ice(found: &Diagnosis, expected: &str) {
    assert_eq!(
        (found.verdict, names(found)),
        (Verdict::Explained, vec!["surface_change"]),
        "{}",
        found.sentence
    );
    assert!(found.sentence.contains(expected), "{}", found.sentence);
    let finding = &found.findings[0];
    assert!((-0.9..-0.6).contains(&value(finding, "skid_change")), "{}", found.sentence);
    let [before_w, after_w] = [found.baseline.held_out_rmse_w, found.corrected.held_out_rmse_w];
    assert!(after_w < 0.7 * before_w, "held out {before_w} W before, {after_w} W after");
}

#[test]
#[ignore = "engine fault: called a centre of mass farther back"]
fn a_real_husky_that_comes_onto_ice_is_told_from_which_drive_on() {
    let Some(folder) = real_recordings() else { return };
    let [flooring, ice, _] = grounds(&folder);
    let found = across(&folder, "flooring, then ice", &behind(&[&flooring, &ice]));
    came_onto_ice(&found, "from drive ice-00 on");
}

#[test]
#[ignore = "engine fault: called a centre of mass farther back"]
fn a_real_husky_that_comes_onto_ice_in_a_drive_is_told_at_what_time() {
    let Some(folder) = real_recordings() else { return };
    let [flooring, ice, _] = grounds(&folder);
    let found = across(&folder, "flooring, then ice, in one", &in_one(&behind(&[&flooring, &ice])));
    came_onto_ice(&found, "from about 2");
    let from_s = value(&found.findings[0], "from_s");
    assert!((from_s - 285.0).abs() < 20.0, "{from_s}");
}

#[test]
fn a_real_husky_that_leaves_the_ice_is_told_until_which_drive_it_was_on_it() {
    let Some(folder) = real_recordings() else { return };
    let [flooring, ice, _] = grounds(&folder);
    let found = across(&folder, "ice, then flooring", &behind(&[&ice, &flooring]));
    assert!(found.sentence.ends_with("until drive flooring-00."), "{}", found.sentence);
}

/// Neither ground is the one that the robot is known on.
#[test]
fn a_real_husky_that_goes_from_ice_into_loam_is_told_both() {
    let Some(folder) = real_recordings() else { return };
    let [_, ice, loam] = grounds(&folder);
    let found = across(&folder, "ice, then sandy loam", &in_one(&behind(&[&ice, &loam])));
    let is_ice = |f: &&Finding| f.mechanism == "surface_change" && value(f, "skid_change") < -0.4;
    let until_s = value(found.findings.iter().find(is_ice).unwrap(), "until_s");
    assert!((until_s - 398.0).abs() < 60.0, "until {until_s} s");
    let soft = ["soft_soil", "surface_change"];
    assert!(found.explanations.iter().any(|one| one.mechanisms == soft), "{:?}", found.explanations);
}
