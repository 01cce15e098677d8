//! `joulepath robot show`.

use clap::Args;

use crate::{output, recorded::robot};

#[derive(Args)]
pub(crate) struct Arguments {
    /// Name of a built-in robot, or a robot file
    robot: String,
    /// Print the file on one line
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let robot = robot(&arguments.robot)?;
    if arguments.json {
        return output::json(&robot);
    }
    output::line(serde_json::to_string_pretty(&robot)?)
}
