//! Both engines on the cases of trials, three ways: by the robot's file alone, by a file calibrated on the healthy drives with nothing
//! beside it, and with the healthy drives beside.
//!
//! `cargo run --release -p joulepath-diagnosis --example engine_boards -- [--without=gates] TRIAL...`: folders that `joulepath prove` left.

use std::{
    error::Error,
    fs,
    path::{Path, PathBuf},
};

use calibration::{Options, calibrate};
use diagnosis::{Diagnosis, Engine, Question, diagnose, learn};
use model::Robot;
use recording::{Recording, read_paths, unwatched};
use serde_json::Value;

const ENGINES: [(&str, Engine); 2] = [("gates", Engine::Gates), ("posterior", Engine::Posterior)];
const WAYS: [&str; 3] = ["file alone", "calibrated file alone", "healthy drives beside"];

/// How an engine did one way.
#[derive(Clone, Copy, Default)]
struct Board {
    named: usize,
    in_three: usize,
    wrong: usize,
    abstained: usize,
    false_alarms: usize,
    twins: usize,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut boards = [[Board::default(); WAYS.len()]; ENGINES.len()];
    let words: Vec<String> = std::env::args().skip(1).collect();
    let is_asked =
        |(name, _): &&(&str, Engine)| !words.iter().any(|word| word == &format!("--without={name}"));
    let engines: Vec<(&str, Engine)> = ENGINES.iter().filter(is_asked).copied().collect();
    for trial in words.iter().filter(|word| !word.starts_with("--")).map(PathBuf::from) {
        for case in folders(&trial.join("cases"))? {
            let truth = truth(&trial, &case)?;
            each(&case, &engines, |engine, way, found| boards[engine][way].add(&case, found, &truth))?;
        }
        for twin in folders(&trial.join("twins"))? {
            each(&twin, &engines, |engine, way, found| boards[engine][way].add(&twin, found, &[]))?;
        }
    }
    println!("{:<10} {:<22} named  in three  wrong  abstained  false alarms", "engine", "");
    for ((engine, _), boards) in engines.iter().zip(&boards) {
        for (way, board) in WAYS.iter().zip(boards) {
            let Board { named, in_three, wrong, abstained, false_alarms, twins } = board;
            println!(
                "{engine:<10} {way:<22} {named:>5}  {in_three:>8}  {wrong:>5}  {abstained:>9}  {false_alarms:>5} of {twins}"
            );
        }
    }
    Ok(())
}

impl Board {
    /// The true set is the first explanation or the second, one of three, none that was given, or nothing was.
    fn add(&mut self, case: &Path, found: &Diagnosis, truth: &[String]) {
        let said: Vec<String> = found
            .explanations
            .iter()
            .map(|one| format!("{}: {:.2}", one.mechanisms.join("+"), one.probability))
            .collect();
        println!(
            "{} {:?} {}; truth {}; {}",
            case.display(),
            found.verdict,
            names(found).join(", "),
            truth.join(", "),
            said.join(", ")
        );
        if truth.is_empty() {
            self.twins += 1;
            self.false_alarms += usize::from(!names(found).is_empty());
            return;
        }
        let sets = explanations(found);
        match sets.iter().position(|set| set == truth) {
            Some(0 | 1) => self.named += 1,
            Some(2) => self.in_three += 1,
            _ if names(found).is_empty() || sets.len() > 3 => self.abstained += 1,
            _ => self.wrong += 1,
        }
    }
}

/// Names that a report gives, sorted.
fn names(found: &Diagnosis) -> Vec<String> {
    let known = found.findings.iter().map(|one| one.mechanism.clone()).filter(|name| name != "unknown");
    let mut names: Vec<String> = known.collect();
    names.sort();
    names
}

/// Sets of names that a report gives, likeliest first; none where it gives no name.
fn explanations(found: &Diagnosis) -> Vec<Vec<String>> {
    let first = names(found);
    if first.is_empty() {
        return Vec::new();
    }
    if !found.explanations.is_empty() {
        let set = |one: &diagnosis::report::ExplanationFigures| {
            let mut set = one.mechanisms.clone();
            set.sort();
            set
        };
        return found.explanations.iter().map(set).collect();
    }
    let mut sets = vec![first.clone()];
    for finding in &found.findings {
        for other in &finding.indistinguishable_from {
            let mut set: Vec<String> =
                first.iter().filter(|name| **name != finding.mechanism).cloned().collect();
            set.push(other.clone());
            set.sort();
            sets.push(set);
        }
    }
    sets
}

/// Diagnoses the folder of a case by both engines in three ways.
fn each(
    case: &Path,
    engines: &[(&str, Engine)],
    mut told: impl FnMut(usize, usize, &Diagnosis),
) -> Result<(), Box<dyn Error>> {
    let robot = Robot::from_json(&fs::read_to_string(case.join("robot.json"))?)?;
    let read =
        |name: &str| -> Result<Recording, Box<dyn Error>> { Ok(read_paths(&[case.join(name)], None)?.0) };
    let (suspect, healthy) = (read("recording.csv")?, read("reference.csv")?);
    let calibrated = calibrate(&robot, &healthy, &Options::default())?.robot;
    let calibrated = learn(&robot, &calibrated, &healthy, &unwatched())?.robot;
    for (way, (robot, beside)) in
        [(&robot, None), (&calibrated, None), (&robot, Some(&healthy))].iter().enumerate()
    {
        for (which, (_, engine)) in engines.iter().enumerate() {
            let question = Question { engine: *engine, ..Question::new(robot, &suspect, *beside) };
            told(which, way, &diagnose(&question, &|_, _| {})?);
        }
    }
    Ok(())
}

fn folders(path: &Path) -> Result<Vec<PathBuf>, Box<dyn Error>> {
    if !path.is_dir() {
        return Ok(Vec::new());
    }
    let mut folders: Vec<PathBuf> =
        fs::read_dir(path)?.map(|entry| Ok(entry?.path())).collect::<Result<_, std::io::Error>>()?;
    folders.sort();
    Ok(folders)
}

/// Effects of a case, sorted.
fn truth(trial: &Path, case: &Path) -> Result<Vec<String>, Box<dyn Error>> {
    let name = case.file_name().and_then(|name| name.to_str()).unwrap_or_default();
    let key: Value =
        serde_json::from_str(&fs::read_to_string(trial.join("keys").join(format!("{name}.json")))?)?;
    let effects = key["truths"].as_array().into_iter().flatten();
    let mut names: Vec<String> =
        effects.filter_map(|truth| truth["effect"].as_str()).map(str::to_owned).collect();
    names.sort();
    Ok(names)
}
