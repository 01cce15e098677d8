//! A diagnosis as a separate process, which sees the files of one case and nothing else.

use std::{
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use crate::{
    Error, Report,
    files::{self, RECORDING, REFERENCE, ROBOT},
};

/// Folder of a diagnosis' results beside the case's files.
const RESULT: &str = "diagnosis";
/// Characters of an error message that a scoreboard shows.
const MOST_CHARACTERS: usize = 300;

/// How to diagnose.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The program; it is called with `diagnose --robot .. --recording .. --reference .. --out .. --engine ..`.
    pub program: PathBuf,
    /// Threads that each process may use.
    pub threads: usize,
    /// What `--engine` is given.
    pub engine: &'static str,
}

/// What came of a diagnosis.
#[derive(Clone, Debug, PartialEq)]
pub enum Outcome {
    /// A report.
    Report(Report),
    /// No report, and why.
    Failed(String),
}

impl Diagnosis {
    /// Diagnoses the case in a folder and leaves the results beside it.
    ///
    /// The process runs in a fresh folder elsewhere that holds copies of the three files, with their names as its only
    /// arguments and an empty environment: neither the case's name nor a way to the keys reaches it.
    ///
    /// # Errors
    /// Folders that cannot be made or copied. A process that fails is an outcome.
    pub fn run(&self, case: &Path) -> Result<Outcome, Error> {
        let room = tempfile::tempdir().map_err(Error::file(std::env::temp_dir()))?;
        for name in files::ALL {
            files::copy(&case.join(name), &room.path().join(name))?;
        }
        let mut command = Command::new(&self.program);
        command
            .args(["diagnose", "--robot", ROBOT, "--recording", RECORDING])
            .args(["--reference", REFERENCE, "--out", RESULT, "--engine", self.engine])
            .env_clear()
            .env("RAYON_NUM_THREADS", self.threads.to_string())
            .current_dir(room.path())
            .stdin(Stdio::null());
        let output = match command.output() {
            Ok(output) => output,
            Err(error) => return Ok(Outcome::Failed(format!("it did not start: {error}"))),
        };
        keep(&room.path().join(RESULT), &case.join(RESULT))?;
        if !output.status.success() {
            return Ok(Outcome::Failed(format!("{}: {}", output.status, last_line(&output.stderr))));
        }
        Ok(read_report(&case.join(RESULT).join("report.json")))
    }
}

fn read_report(path: &Path) -> Outcome {
    let text = match std::fs::read_to_string(path) {
        Ok(text) => text,
        Err(error) => return Outcome::Failed(format!("it left no report.json: {error}")),
    };
    match serde_json::from_str(&text) {
        Ok(report) => Outcome::Report(report),
        Err(error) => Outcome::Failed(format!("report.json is not a report: {error}")),
    }
}

/// Copies what was left in a folder; a diagnosis that failed may have left none.
fn keep(from: &Path, to: &Path) -> Result<(), Error> {
    if !from.is_dir() {
        return Ok(());
    }
    files::folder(to)?;
    for entry in std::fs::read_dir(from).map_err(Error::file(from))? {
        let path = entry.map_err(Error::file(from))?.path();
        if let (true, Some(name)) = (path.is_file(), path.file_name()) {
            files::copy(&path, &to.join(name))?;
        }
    }
    Ok(())
}

fn last_line(stderr: &[u8]) -> String {
    let text = String::from_utf8_lossy(stderr);
    text.trim().lines().next_back().unwrap_or("no message").chars().take(MOST_CHARACTERS).collect()
}
