//! `joulepath reachable`.

use std::{fs, path::PathBuf, time::Instant};

use anyhow::Context;
use clap::{Args, ValueEnum};
use service::routes::reachable::{Found, KindName, ReachableRequest};

use crate::{
    arguments::{Driving, Place, patience, warn_of_answer},
    failure::Refused,
    output,
    reach_picture::draw,
    table::energy,
};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    driving: Driving,
    /// X,Y[,HEADING_DEG] in metres of the map, @FX,FY[,HEADING_DEG] in fractions of it, or 46.5046N,93.9217W[,HEADING_DEG]
    #[arg(long, allow_hyphen_values = true)]
    start: Place,
    /// From the place, to it, or there and back
    #[arg(long, value_enum, default_value = "outward")]
    kind: Kind,
    /// An energy to draw a contour at [J]; give it once for each
    #[arg(long, allow_hyphen_values = true, conflicts_with = "charge", required_unless_present = "charge")]
    energy_j: Vec<f64>,
    /// A state of charge to draw a contour for, 0 to 1; give it once for each
    #[arg(long, allow_hyphen_values = true)]
    charge: Vec<f64>,
    /// Write the least energy of every cell as a GeoTIFF [J]
    #[arg(long)]
    tiff: Option<PathBuf>,
    /// Write the contours over shaded relief as a picture
    #[arg(long)]
    png: Option<PathBuf>,
}

#[derive(Clone, Copy, ValueEnum)]
enum Kind {
    Outward,
    Homeward,
    OutAndBack,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let driving = &arguments.driving;
    let (terrain, robot) = driving.read()?;
    let start = arguments.start.pose_on(&terrain)?;
    let some = |list: &[f64]| (!list.is_empty()).then(|| list.to_vec());
    let mut request = ReachableRequest {
        areas: None,
        unknown_ground: None,
        map: None,
        map_id: None,
        robot,
        start,
        kind: match arguments.kind {
            Kind::Outward => KindName::Outward,
            Kind::Homeward => KindName::Homeward,
            Kind::OutAndBack => KindName::OutAndBack,
        },
        energies_j: some(&arguments.energy_j),
        charges: some(&arguments.charge),
        speed_mps: driving.speed_mps,
        power_model: driving.power_model,
        reverse: driving.reverse,
        snap_radius_m: driving.snap_radius_m,
        timeout_s: driving.timeout_s,
    };
    let plan = request.plan();
    let patience = plan.patience(&patience()).map_err(Refused)?;
    let planner = plan.planner(&terrain, &patience).map_err(Refused)?;
    let began = Instant::now();
    let found = Found::of(&planner, &request, &patience).map_err(Refused)?;
    let contours = found.contours(&patience).map_err(Refused)?;
    warn_of_answer(&contours.warnings, &terrain);
    let taken_s = began.elapsed().as_secs_f64();
    if let Some(path) = &arguments.tiff {
        let raster = found.raster().map_err(Refused)?;
        fs::write(path, raster).with_context(|| path.display().to_string())?;
    }
    if let Some(path) = &arguments.png {
        let levels_j: Vec<f64> = contours.features.iter().map(|f| f.properties.energy_j).collect();
        let picture = draw(&terrain, &found.reach, &levels_j, [start.x_m, start.y_m])?;
        fs::write(path, picture).with_context(|| path.display().to_string())?;
    }
    if driving.json {
        output::json(&contours)?;
        return Ok(());
    }
    let whole_m2 = terrain.grid.cells() as f64 * terrain.grid.cell_size_m.powi(2);
    for feature in &contours.features {
        let properties = &feature.properties;
        let charge = properties.charge.map_or(String::new(), |charge| format!("charge {charge:<5} "));
        output::line(format_args!(
            "{charge}{:>12}  {:>10.0} m²  {:>5.1} % of the map",
            energy(properties.energy_j),
            properties.area_m2,
            100.0 * properties.area_m2 / whole_m2
        ))?;
    }
    output::line(format_args!("in {:.0} ms", 1e3 * taken_s))?;
    Ok(())
}
