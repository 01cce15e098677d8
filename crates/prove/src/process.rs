//! A diagnosis as a separate process, which sees the files of one case and nothing else.

use std::{
    ffi::OsString,
    path::{Path, PathBuf},
    process::{Command, Stdio},
};

use crate::{
    Error, Report, Way,
    files::{self, CALIBRATED, RECORDING, REFERENCE, ROBOT},
};

/// Folder of a diagnosis' results where it runs.
const RESULT: &str = "diagnosis";
/// Characters of an error message that a scoreboard shows.
const MOST_CHARACTERS: usize = 300;

/// How to diagnose.
#[derive(Clone, Debug)]
pub struct Diagnosis {
    /// The program, and words that stand before all others; it is called with `diagnose --robot .. --recording .. [--reference ..] --out ..`,
    /// and, for a calibrated file, with `calibrate --robot .. --recording .. --out ..` before.
    pub program: (PathBuf, Vec<OsString>),
    /// Threads that each process may use.
    pub threads: usize,
    /// Which of the robot's files stands beside the healthy drives.
    pub beside: FileBeside,
}

/// Which of the robot's files stands beside the healthy drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileBeside {
    /// The file as it is.
    Raw,
    /// The file that was calibrated on these drives, as whoever has them would.
    Calibrated,
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
    /// Diagnoses the case in a folder by what a way gives, and leaves the results beside it.
    ///
    /// The process runs in a fresh folder elsewhere that holds copies of the files it is given, with their names as its only
    /// arguments and an empty environment: neither the case's name nor a way to the keys reaches it.
    ///
    /// # Errors
    /// Folders that cannot be made or copied. A process that fails is an outcome.
    pub fn run(&self, case: &Path, way: Way) -> Result<Outcome, Error> {
        let is_calibrated = match way {
            Way::FileAlone => false,
            Way::CalibratedFileAlone => true,
            Way::HealthyDrives => self.beside == FileBeside::Calibrated,
        };
        let robot = match is_calibrated.then(|| self.calibrated(case)).transpose()? {
            Some(Ok(robot)) => robot,
            Some(Err(why)) => return Ok(Outcome::Failed(why)),
            None => case.join(ROBOT),
        };
        let mut given = vec![(robot, ROBOT), (case.join(RECORDING), RECORDING)];
        let mut words = vec!["diagnose", "--robot", ROBOT, "--recording", RECORDING, "--out", RESULT];
        if way == Way::HealthyDrives {
            given.push((case.join(REFERENCE), REFERENCE));
            words.extend(["--reference", REFERENCE]);
        }
        let results = case.join(way.folder());
        if let Err(why) = self.call(&given, &words, |room| keep(&room.join(RESULT), &results))? {
            return Ok(Outcome::Failed(why));
        }
        Ok(read_report(&results.join("report.json")))
    }

    /// The robot's file calibrated on the healthy drives, made once for a case; or why it could not be.
    fn calibrated(&self, case: &Path) -> Result<Result<PathBuf, String>, Error> {
        let made = case.join(CALIBRATED);
        if made.is_file() {
            return Ok(Ok(made));
        }
        let given = [(case.join(ROBOT), ROBOT), (case.join(REFERENCE), REFERENCE)];
        let words = ["calibrate", "--robot", ROBOT, "--recording", REFERENCE, "--out", CALIBRATED];
        let keep = |room: &Path| match room.join(CALIBRATED) {
            file if file.is_file() => files::copy(&file, &made),
            _ => Ok(()),
        };
        Ok(self.call(&given, &words, keep)?.map(|()| made.clone()))
    }

    /// Calls the program in a folder of its own with copies of files; what it left is kept before the folder goes. Why it failed, if it did.
    fn call(
        &self,
        given: &[(PathBuf, &str)],
        words: &[&str],
        keep: impl Fn(&Path) -> Result<(), Error>,
    ) -> Result<Result<(), String>, Error> {
        let room = tempfile::tempdir().map_err(Error::file(std::env::temp_dir()))?;
        for (file, name) in given {
            files::copy(file, &room.path().join(name))?;
        }
        let (program, first) = &self.program;
        let mut command = Command::new(program);
        command
            .args(first)
            .args(words)
            .env_clear()
            .env("RAYON_NUM_THREADS", self.threads.to_string())
            .current_dir(room.path())
            .stdin(Stdio::null());
        let output = match command.output() {
            Ok(output) => output,
            Err(error) => return Ok(Err(format!("it did not start: {error}"))),
        };
        keep(room.path())?;
        match output.status.success() {
            true => Ok(Ok(())),
            false => Ok(Err(format!("{}: {}", output.status, last_line(&output.stderr)))),
        }
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
