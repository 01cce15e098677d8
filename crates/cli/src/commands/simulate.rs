//! `joulepath simulate`.

use std::path::{Path, PathBuf};

use clap::Args;
use world::{Drive, Key, RobotFile, World, simulate};

use crate::{
    failure::BadInput,
    files, output, progress,
    recorded::{robot, text},
};

#[derive(Args)]
pub(crate) struct Arguments {
    /// Name of a built-in robot, or a robot file: the robot when it is healthy
    #[arg(long, default_value = "husky-a200")]
    robot: String,
    /// World file: terrain, sensors, and what is concealed
    #[arg(long)]
    world: PathBuf,
    /// Drive file, or the answer of `joulepath plan --json`
    #[arg(long)]
    drive: PathBuf,
    /// Where to write the recording (CSV)
    #[arg(long)]
    out: PathBuf,
    /// Where to write what is true of it (JSON)
    #[arg(long)]
    key: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let robot = healthy(&arguments.robot)?;
    let world = read(&arguments.world, World::from_json)?;
    let world = match arguments.world.parent() {
        Some(folder) => world.beside(folder),
        None => world,
    };
    let drive = read(&arguments.drive, Drive::from_json)?;
    [Some(&arguments.out), arguments.key.as_ref()]
        .into_iter()
        .flatten()
        .try_for_each(|path| files::check(path))?;
    let sign = progress::working("driving");
    let log = simulate(&world, &robot, &drive).map_err(|error| BadInput(error.to_string()))?;
    sign.finish_and_clear();
    files::write_with(&arguments.out, |out| Ok(log.write_csv(out)?))?;
    if let Some(path) = &arguments.key {
        let key = Key::of(&world, &robot, &drive).map_err(|error| BadInput(error.to_string()))?;
        let file = serde_json::to_string_pretty(&key)? + "\n";
        files::write(path, file)?;
    }
    output::line(format_args!("{}: {} rows", arguments.out.display(), log.rows.len()))?;
    Ok(())
}

/// The robot as the world reads it; a built-in one goes through its file.
fn healthy(name: &str) -> anyhow::Result<RobotFile> {
    let file = serde_json::to_string(&robot(name)?)?;
    Ok(RobotFile::from_json(&file).map_err(|error| BadInput(format!("{name}: {error}")))?)
}

fn read<T>(path: &Path, parse: impl Fn(&str) -> Result<T, world::Error>) -> Result<T, BadInput> {
    let name = path.display().to_string();
    parse(&text(&name)?).map_err(|error| BadInput(format!("{name}: {error}")))
}
