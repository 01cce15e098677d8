//! `joulepath compare`.

use clap::Args;
use service::routes::{compare::answer, plan::ObjectiveName};

use crate::{
    arguments::{Question, patience},
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
    let planner = request.planner(&terrain).map_err(Refused)?;
    let found =
        request.patience(&patience()).and_then(|p| answer(&planner, &request, &p)).map_err(Refused)?;
    if arguments.question.driving.json {
        output::json(&found)?;
    } else {
        output::line(table::compare(&found))?;
    }
    Ok(())
}
