//! `joulepath compare`.

use clap::Args;
use model::Robot;
use service::routes::{compare::answer, plan::ObjectiveName};
use terrain::Terrain;

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
        output::line(conditions(&terrain, &planner.lattice().robot))?;
    }
    Ok(())
}

/// What the energies hold for.
fn conditions(terrain: &Terrain, robot: &Robot) -> String {
    let named = terrain.surfaces().map_or(&[][..], |surfaces| &surfaces.names);
    let ground = match named {
        [] => format!("{} (the robot's default ground)", robot.default_surface),
        names => format!("{}, and {} where the map names none", names.join(", "), robot.default_surface),
    };
    format!(
        "\nOn {ground}, with a standing load of {} W (hotel_power_w), and {} % of what braking gives back recovered.",
        robot.hotel_power_w,
        100.0 * robot.motors.regeneration
    )
}
