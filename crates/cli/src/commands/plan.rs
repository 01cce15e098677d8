//! `joulepath plan`.

use clap::{Args, ValueEnum};
use model::Robot;
use service::{
    Tracks,
    routes::plan::{ObjectiveName, PlanAnswer, answer},
};
use terrain::Terrain;

use crate::{
    arguments::{PathLimits, Question, patience, warn_of_answer},
    failure::Refused,
    out_file::{Answer, OutFile, details},
    output, progress, scenes, table,
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
    /// Write the answer to this file, in the form of its ending: .geojson, .gpx, .kml, .csv, .png, .svg, .html or .json
    #[arg(long, value_name = "FILE")]
    out: Option<OutFile>,
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
    arguments.out.as_ref().map_or(Ok(()), |out| out.check(&terrain))?;
    let patience = request.patience(&patience()).map_err(Refused)?;
    let sign = progress::working("planning");
    let planner = request.planner(&terrain, &patience).map_err(Refused)?;
    let found = answer(&planner, &request, &patience).map_err(Refused)?;
    sign.finish_and_clear();
    warn_of_answer(&found.warnings, &terrain);
    if let Some(out) = &arguments.out {
        write(out, &terrain, &planner.lattice().robot, &found, objective)?;
    }
    if arguments.question.driving.json {
        output::json(&found)?;
    } else {
        output::line(table::plan(&found, objective))?;
    }
    Ok(())
}

fn write(
    out: &OutFile,
    terrain: &Terrain,
    robot: &Robot,
    found: &PlanAnswer,
    objective: ObjectiveName,
) -> anyhow::Result<()> {
    let name = table::path_name(objective);
    out.write(Answer {
        document: found,
        tracks: &|form, out| Ok(Tracks::from(found).write(form, out)?),
        scene: scenes::plan(terrain, robot, found, name),
        table: table::path_rows(&[(name, found)]),
        warnings: details(&found.warnings),
    })
}
