//! `joulepath reachable`.

use std::{path::PathBuf, time::Instant};

use clap::{Args, ValueEnum};
use service::routes::reachable::{Found, KindName, ReachableAnswer, ReachableRequest};
use terrain::Terrain;

use crate::{
    arguments::{Driving, Place, patience, warn_of_answer},
    failure::Refused,
    files,
    out_file::{Answer, OutFile, details},
    output, progress,
    reach_picture::draw,
    scenes,
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
    /// Write the contours to this file, in the form of its ending: .geojson, .gpx, .kml, .csv, .png, .svg, .html or .json
    #[arg(long, value_name = "FILE")]
    out: Option<OutFile>,
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
    arguments.out.as_ref().map_or(Ok(()), |out| out.check_contours(&terrain))?;
    for path in [&arguments.tiff, &arguments.png].into_iter().flatten() {
        files::check(path)?;
    }
    let plan = request.plan();
    let patience = plan.patience(&patience()).map_err(Refused)?;
    let sign = progress::working("searching");
    let planner = plan.planner(&terrain, &patience).map_err(Refused)?;
    let began = Instant::now();
    let found = Found::of(&planner, &request, &patience).map_err(Refused)?;
    let contours = found.contours(&patience).map_err(Refused)?;
    let taken_s = began.elapsed().as_secs_f64();
    sign.finish_and_clear();
    warn_of_answer(&contours.warnings, &terrain);
    if let Some(path) = &arguments.tiff {
        let raster = found.raster().map_err(Refused)?;
        files::write(path, raster)?;
    }
    if let Some(path) = &arguments.png {
        let levels_j: Vec<f64> = contours.features.iter().map(|f| f.properties.energy_j).collect();
        let picture = draw(&terrain, &found.reach, &levels_j, [start.x_m, start.y_m])?;
        files::write(path, picture)?;
    }
    let start_m = [start.x_m, start.y_m];
    if let Some(out) = &arguments.out {
        out.write(Answer {
            document: &contours,
            tracks: &|form, out| Ok(found.write(form, &contours, out)?),
            scene: scenes::reachable(&terrain, &planner.lattice().robot, &contours, &found.reach, start_m),
            table: rows(&contours, &terrain),
            warnings: details(&contours.warnings),
        })?;
    }
    if driving.json {
        output::json(&contours)?;
        return Ok(());
    }
    for row in rows(&contours, &terrain).iter().skip(1) {
        let [energy, area, share, charge] = &row[..] else { continue };
        let charge = if charge.is_empty() { String::new() } else { format!("charge {charge:<5} ") };
        output::line(format_args!("{charge}{energy:>12}  {area:>13}  {share:>5} of the map"))?;
    }
    output::line(format_args!("in {:.0} ms", 1e3 * taken_s))?;
    Ok(())
}

/// Figures of contours, a heading first.
fn rows(contours: &ReachableAnswer, terrain: &Terrain) -> Vec<Vec<String>> {
    let whole_m2 = terrain.grid.cells() as f64 * terrain.grid.cell_size_m.powi(2);
    let head = ["within", "area", "share of the map", "charge"].map(str::to_owned).to_vec();
    let row = |feature: &service::routes::reachable::ContourFeature| {
        let properties = &feature.properties;
        vec![
            energy(properties.energy_j),
            format!("{:.0} m²", properties.area_m2),
            format!("{:.1} %", 100.0 * properties.area_m2 / whole_m2),
            properties.charge.map_or(String::new(), |charge| charge.to_string()),
        ]
    };
    std::iter::once(head).chain(contours.features.iter().map(row)).collect()
}
