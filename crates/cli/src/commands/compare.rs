//! `joulepath compare`.

use clap::Args;
use model::Robot;
use service::{
    Tracks,
    routes::{
        compare::{CompareAnswer, answer},
        plan::ObjectiveName,
    },
};
use terrain::Terrain;

use crate::{
    arguments::{Question, patience, warn_of_answer},
    failure::Refused,
    out_file::{Answer, OutFile, details},
    output, progress, scenes, table,
};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    question: Question,
    /// Write the answer to this file, in the form of its ending: .geojson, .gpx, .kml, .csv, .png, .svg, .html or .json
    #[arg(long, value_name = "FILE")]
    out: Option<OutFile>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (terrain, request) = arguments.question.read(ObjectiveName::Energy)?;
    arguments.out.as_ref().map_or(Ok(()), |out| out.check(&terrain))?;
    let patience = request.patience(&patience()).map_err(Refused)?;
    let sign = progress::working("comparing");
    let planner = request.planner(&terrain, &patience).map_err(Refused)?;
    let found = answer(&planner, &request, &patience).map_err(Refused)?;
    sign.finish_and_clear();
    warn_of_answer(&found.energy.warnings, &terrain);
    let robot = &planner.lattice().robot;
    if let Some(out) = &arguments.out {
        write(out, &terrain, robot, &found)?;
    }
    if arguments.question.driving.json {
        output::json(&found)?;
    } else {
        output::line(table::compare(&found))?;
        output::line(format_args!("\n{}", scenes::conditions(&terrain, robot)))?;
    }
    Ok(())
}

fn write(out: &OutFile, terrain: &Terrain, robot: &Robot, found: &CompareAnswer) -> anyhow::Result<()> {
    out.write(Answer {
        document: found,
        tracks: &|form, out| Ok(Tracks::from(found).write(form, out)?),
        scene: scenes::compare(terrain, robot, found),
        table: table::path_rows(&table::compared(found)),
        warnings: details(&found.energy.warnings),
    })
}
