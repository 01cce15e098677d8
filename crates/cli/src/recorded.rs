//! The robot and the recordings that `predict`, `calibrate` and `diagnose` are given.

use std::{fs, ops::ControlFlow, path::PathBuf, sync::Arc};

use clap::Args;
use model::{Robot, builtin};
use recording::{Labels, Map, ReadingReport, Recording, Watch, read_paths_watched};

use crate::{failure::BadInput, output, progress};

/// What `predict`, `calibrate` and `diagnose` share.
#[derive(Args)]
pub(crate) struct Recorded {
    /// Name of a built-in robot, or a robot file
    #[arg(long, default_value = "husky-a200")]
    robot: String,
    /// Recordings: .csv (.gz, .zst), .parquet, .mcap, .db3, .bag or .ulg, or folders of `ros2 bag record`; wheels.csv+power.csv joins tables of one
    /// drive on time
    #[arg(long, required = true, num_args = 1..)]
    recording: Vec<PathBuf>,
    /// File that names columns or topics and their units (a log map), or a built-in one: husky, clearpath-a200, clearpath-j100, jackal, scout, px4, borealtc
    #[arg(long, visible_alias = "map", value_name = "FILE")]
    columns: Option<String>,
    /// The surface of ground that the recordings do not label, instead of the robot's default one
    #[arg(long)]
    surface: Option<String>,
    /// Names of the runs that are used, instead of all
    #[arg(long, num_args = 1..)]
    runs: Vec<String>,
    /// Print the answer as a JSON document
    #[arg(long)]
    pub(crate) json: bool,
}

impl Recorded {
    /// Reads the robot and all recordings; doubts about them go to stderr.
    pub(crate) fn read(&self) -> anyhow::Result<(Robot, Recording)> {
        let robot = robot(&self.robot)?;
        let recording = self.read_files(&self.recording, &robot)?;
        Ok((robot, recording))
    }

    /// Reads other recordings in the same way.
    pub(crate) fn read_files(&self, files: &[PathBuf], robot: &Robot) -> anyhow::Result<Recording> {
        // Topics are a Husky's where nothing else is said, on the wheels of the robot at hand.
        let map = match self.columns.as_deref() {
            Some(name) => Some(map(name, robot)?),
            None => {
                let is_px4 = |path: &PathBuf| path.extension().is_some_and(|ending| ending == "ulg");
                let name = if files.iter().all(is_px4) { "px4" } else { "husky" };
                Map::built_in_for(name, robot.wheel_radius_m, robot.slip_track_m)
            }
        };
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
        let mut recording = self.chosen(recording)?;
        self.label(&mut recording);
        Ok(recording)
    }

    /// The runs that were asked for.
    fn chosen(&self, recording: Recording) -> Result<Recording, BadInput> {
        if self.runs.is_empty() {
            return Ok(recording);
        }
        let known: Vec<String> = recording.runs.iter().map(|run| run.name.clone()).collect();
        if let Some(name) = self.runs.iter().find(|name| !known.contains(name)) {
            return Err(BadInput(format!(
                "--runs {name}: there is no such run; there are {}",
                known.join(", ")
            )));
        }
        Ok(recording.of_runs(|run| self.runs.contains(&run.name)))
    }

    /// Ground without a label is what was asked for, else the robot's default.
    fn label(&self, recording: &mut Recording) {
        let Some(name) = &self.surface else { return };
        match &mut recording.surface {
            None => recording.surface = Some(Labels::constant(name, recording.rows())),
            Some(labels) => labels.name_the_rest(name),
        }
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
fn map(name: &str, robot: &Robot) -> Result<Map, BadInput> {
    if let Some(map) = Map::built_in_for(name, robot.wheel_radius_m, robot.slip_track_m) {
        return Ok(map);
    }
    let known = Map::BUILT_IN.join(", ");
    let text = text(name).map_err(|error| {
        BadInput(format!("--columns {error}; give a log map, or one of the built-in {known}"))
    })?;
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
