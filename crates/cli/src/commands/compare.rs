//! `joulepath compare`.

use clap::Args;
use service::routes::{compare::answer, plan::ObjectiveName};

use crate::{
    arguments::{Question, patience, warn_of_answer},
    failure::Refused,
    output, table,
};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    question: Question,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (terrain, request) = arguments.question.read(ObjectiveName::Energy)?;
    let patience = request.patience(&patience()).map_err(Refused)?;
    let planner = request.planner(&terrain, &patience).map_err(Refused)?;
    let found = answer(&planner, &request, &patience).map_err(Refused)?;
    warn_of_answer(&found.energy.warnings, &terrain);
    if arguments.question.driving.json {
        output::json(&found)?;
    } else {
        output::line(table::compare(&found))?;
    }
    Ok(())
}
