//! `joulepath matrix`.

use clap::Args;
use service::routes::{
    matrix::{MatrixAnswer, MatrixRequest, answer},
    plan::ObjectiveName,
};

use crate::{
    arguments::{Driving, Place, patience, warn_of_answer},
    failure::Refused,
    output, progress,
    table::{energy, time},
};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    driving: Driving,
    /// Where paths start; give it once for each: X,Y[,HEADING_DEG], @FX,FY[,HEADING_DEG] in fractions of the map, or 46.5046N,93.9217W[,HEADING_DEG]
    #[arg(long, required = true, allow_hyphen_values = true)]
    source: Vec<Place>,
    /// Where paths end; give it once for each [default: the sources]
    #[arg(long, allow_hyphen_values = true)]
    target: Vec<Place>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let driving = &arguments.driving;
    let (terrain, robot) = driving.read()?;
    let poses = |places: &[Place]| {
        places.iter().map(|place| place.pose_on(&terrain)).collect::<anyhow::Result<Vec<_>>>()
    };
    let mut request = MatrixRequest {
        areas: None,
        unknown_ground: None,
        map: None,
        map_id: None,
        robot,
        sources: poses(&arguments.source)?,
        targets: (!arguments.target.is_empty()).then(|| poses(&arguments.target)).transpose()?,
        objective: ObjectiveName::Energy,
        speed_mps: driving.speed_mps,
        power_model: driving.power_model,
        reverse: driving.reverse,
        snap_radius_m: driving.snap_radius_m,
        timeout_s: driving.timeout_s,
    };
    let plan = request.plan().map_err(Refused)?;
    let patience = plan.patience(&patience()).map_err(Refused)?;
    let sign = progress::working("planning");
    let planner = plan.planner(&terrain, &patience).map_err(Refused)?;
    let found = answer(&planner, &request, &patience).map_err(Refused)?;
    sign.finish_and_clear();
    warn_of_answer(&found.warnings, &terrain);
    if driving.json {
        output::json(&found)?;
    } else {
        output::text(text(&found))?;
    }
    Ok(())
}

/// A line for each pair.
fn text(found: &MatrixAnswer) -> String {
    let mut text = String::new();
    let reason = |source: usize, target: usize| {
        let gap = found.unreachable.iter().find(|gap| (gap.source, gap.target) == (source, target));
        gap.map_or("", |gap| gap.reason.as_str())
    };
    for (source, row) in found.energy_j.iter().enumerate() {
        for (target, energy_j) in row.iter().enumerate() {
            let rest = (found.distance_m[source][target], found.duration_s[source][target]);
            let line = match (energy_j, rest) {
                (Some(energy_j), (Some(distance_m), Some(duration_s))) => {
                    format!("{:>10}  {distance_m:>8.1} m  {:>10}", energy(*energy_j), time(duration_s))
                }
                _ => reason(source, target).to_owned(),
            };
            text.push_str(&format!("{source:>3} to {target:<3} {line}\n"));
        }
    }
    text
}
