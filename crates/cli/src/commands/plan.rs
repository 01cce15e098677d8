//! `joulepath plan`.

use clap::{Args, ValueEnum};
use service::routes::plan::{ObjectiveName, answer};

use crate::{
    arguments::{PathLimits, Question, patience, warn_of_answer},
    failure::Refused,
    output, table,
};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    question: Question,
    /// What the path is to have least of
    #[arg(long, value_enum, default_value = "energy")]
    objective: Objective,
    #[command(flatten)]
    limits: PathLimits,
}

#[derive(Clone, Copy, ValueEnum)]
enum Objective {
    Energy,
    Distance,
    Time,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let objective = match arguments.objective {
        Objective::Energy => ObjectiveName::Energy,
        Objective::Distance => ObjectiveName::Distance,
        Objective::Time => ObjectiveName::Time,
    };
    let (terrain, request) = arguments.question.read(objective)?;
    let request = arguments.limits.on(request);
    let patience = request.patience(&patience()).map_err(Refused)?;
    let planner = request.planner(&terrain, &patience).map_err(Refused)?;
    let found = answer(&planner, &request, &patience).map_err(Refused)?;
    warn_of_answer(&found.warnings, &terrain);
    if arguments.question.driving.json {
        output::json(&found)?;
    } else {
        output::line(table::plan(&found, objective))?;
    }
    Ok(())
}
