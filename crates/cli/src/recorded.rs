//! The robot and the recordings that `predict`, `calibrate` and `diagnose` are given.

use std::{fs, ops::ControlFlow, path::PathBuf, sync::Arc};

use clap::Args;
use model::{Robot, builtin};
use recording::{Map, ReadingReport, Recording, Watch, read_paths_watched};

use crate::{failure::BadInput, output, progress};

/// What `predict`, `calibrate` and `diagnose` share.
#[derive(Args)]
pub(crate) struct Recorded {
    /// Name of a built-in robot, or a robot file
    #[arg(long, default_value = "husky-a200")]
    robot: String,
    /// Recordings: .csv (.gz, .zst), .parquet, .mcap or .bag; wheels.csv+power.csv joins tables of one drive on time
    #[arg(long, required = true, num_args = 1..)]
    recording: Vec<PathBuf>,
    /// Map file that names columns or topics and their units, or the built-in husky or borealtc
    #[arg(long)]
    map: Option<String>,
    /// Print the answer as a JSON document
    #[arg(long)]
    pub(crate) json: bool,
}

impl Recorded {
    /// Reads the robot and all recordings; doubts about them go to stderr.
    pub(crate) fn read(&self) -> anyhow::Result<(Robot, Recording)> {
        Ok((robot(&self.robot)?, self.read_files(&self.recording)?))
    }

    /// Reads other recordings in the same way.
    pub(crate) fn read_files(&self, files: &[PathBuf]) -> anyhow::Result<Recording> {
        let map = self.map.as_deref().map(map).transpose()?;
        let bar = progress::reading(files);
        let told = bar.clone();
        let watch: Watch = Arc::new(move |bytes| {
            told.inc(bytes);
            ControlFlow::Continue(())
        });
        let read = read_paths_watched(files, map.as_ref(), &watch);
        bar.finish_and_clear();
        let (recording, reports) = read.map_err(|error| BadInput(error.to_string()))?;
        reports.iter().for_each(warn);
        Ok(recording)
    }

    /// An error of a fit or a diagnosis, with the files it is about.
    pub(crate) fn refuse(&self, error: &dyn std::error::Error) -> BadInput {
        let files: Vec<String> = self.recording.iter().map(|path| path.display().to_string()).collect();
        BadInput(format!("{}: {error}", files.join(", ")))
    }
}

/// Says what of a file was not used, what was mended and what is doubtful.
fn warn(report: &ReadingReport) {
    let source = &report.source;
    if !report.aside.is_empty() {
        output::note(format_args!("{source}: kept aside: {}", report.aside.join(", ")));
    }
    if !report.ignored.is_empty() {
        let ignored: Vec<String> =
            report.ignored.iter().map(|i| format!("{} ({})", i.name, i.reason)).collect();
        output::note(format_args!("{source}: not used: {}", ignored.join("; ")));
    }
    for repair in &report.repairs {
        output::note(format_args!("{source}: {}: {}", repair.place, repair.what));
    }
    for doubt in &report.suspicions {
        let run = doubt.run.as_deref().map_or(String::new(), |run| format!(", run {run}"));
        output::note(format_args!("{source}{run}: {}: {}", doubt.channel, doubt.statement));
    }
}

/// A built-in map by its name, or a map file.
fn map(name: &str) -> Result<Map, BadInput> {
    if let Some(map) = Map::built_in(name) {
        return Ok(map);
    }
    let known = Map::BUILT_IN.join(" or ");
    let text = text(name)
        .map_err(|error| BadInput(format!("--map {error}; give a map file, or the built-in {known}")))?;
    Map::from_json(&text).map_err(|error| BadInput(format!("{name}: {error}")))
}

/// A built-in robot, or one from a file.
pub(crate) fn robot(name: &str) -> anyhow::Result<Robot> {
    let is_file = name.ends_with(".json") || name.contains(std::path::MAIN_SEPARATOR);
    let robot = if is_file {
        Robot::from_json(&text(name)?).map_err(|error| BadInput(format!("{name}: {error}")))?
    } else {
        builtin::by_name(name).map_err(|error| BadInput(error.to_string()))?
    };
    Ok(robot)
}

/// A text file that the user named.
pub(crate) fn text(path: &str) -> Result<String, BadInput> {
    fs::read_to_string(path).map_err(|error| BadInput(format!("{path}: {error}")))
}
