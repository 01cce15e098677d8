//! The robot and the recordings that `predict` and `calibrate` are given.

use std::{fs, path::PathBuf};

use clap::Args;
use model::{Robot, builtin};
use recording::{Map, Recording, read_paths};

use crate::failure::BadInput;

/// What `predict` and `calibrate` share.
#[derive(Args)]
pub(crate) struct Recorded {
    /// Name of a built-in robot, or a robot file
    #[arg(long, default_value = "husky-a200")]
    robot: String,
    /// Recordings: .csv, .parquet, .mcap or .bag
    #[arg(long, required = true, num_args = 1..)]
    recording: Vec<PathBuf>,
    /// Map file that names columns or topics and their units
    #[arg(long)]
    map: Option<PathBuf>,
    /// Print the answer as a JSON document
    #[arg(long)]
    pub(crate) json: bool,
}

impl Recorded {
    /// Reads the robot and all recordings; doubts about them go to stderr.
    pub(crate) fn read(&self) -> anyhow::Result<(Robot, Recording)> {
        let robot = robot(&self.robot)?;
        let map = self.map.as_ref().map(|path| {
            let text = text(&path.display().to_string())?;
            Map::from_json(&text).map_err(|error| BadInput(format!("{}: {error}", path.display())))
        });
        let (recording, reports) = read_paths(&self.recording, map.transpose()?.as_ref())
            .map_err(|error| BadInput(error.to_string()))?;
        for report in reports {
            if !report.aside.is_empty() {
                eprintln!("{}: kept aside: {}", report.source, report.aside.join(", "));
            }
            for doubt in &report.suspicions {
                let run = doubt.run.as_deref().map_or(String::new(), |run| format!(", run {run}"));
                eprintln!("{}{run}: {}: {}", report.source, doubt.channel, doubt.statement);
            }
        }
        Ok((robot, recording))
    }

    /// An error of the calibration crate, with the files it is about.
    pub(crate) fn refuse(&self, error: &calibration::Error) -> BadInput {
        let files: Vec<String> = self.recording.iter().map(|path| path.display().to_string()).collect();
        BadInput(format!("{}: {error}", files.join(", ")))
    }
}

fn robot(name: &str) -> anyhow::Result<Robot> {
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
