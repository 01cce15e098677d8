//! `joulepath mission`.

use clap::Args;
use model::Robot;
use service::{
    Tracks,
    routes::mission::{
        ChargerRequest, MissionAnswer, MissionRequest, OrderName, StopAnswer, WaypointRequest, answer,
    },
};
use terrain::Terrain;

use crate::{
    arguments::{MapArguments, Place, patience, warn_of_answer},
    failure::{OutOfCharge, Refused},
    out_file::{Answer, OutFile, details},
    output, progress,
    robot_arguments::RobotArguments,
    scenes,
    table::{energy, time},
};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    map: MapArguments,
    #[command(flatten)]
    robot: RobotArguments,
    /// X,Y[,HEADING_DEG] in metres of the map, @FX,FY[,HEADING_DEG] in fractions of it, or 46.5046N,93.9217W[,HEADING_DEG]
    #[arg(long, allow_hyphen_values = true)]
    start: Place,
    /// A place to visit, written as the start; give as many as there are
    #[arg(long, required = true, allow_hyphen_values = true)]
    waypoint: Vec<Place>,
    /// Visit them in the order given
    #[arg(long)]
    in_order: bool,
    /// End where it began
    #[arg(long = "return")]
    back: bool,
    /// Charge when it sets out, 0 to 1
    #[arg(long, default_value_t = 1.0, allow_hyphen_values = true)]
    charge: f64,
    /// When it has to be over [s]
    #[arg(long, allow_hyphen_values = true)]
    deadline_s: Option<f64>,
    /// How long the robot works at each waypoint [s]
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    service_s: f64,
    /// What it draws for that [W]
    #[arg(long, default_value_t = 0.0, allow_hyphen_values = true)]
    service_power_w: f64,
    /// A charger that may be driven to, written as the start; give as many as there are
    #[arg(long, allow_hyphen_values = true)]
    charger: Vec<Place>,
    /// Power of the chargers [W]
    #[arg(long, default_value_t = 150.0)]
    charger_power_w: f64,
    /// Charge that they charge to, 0 to 1
    #[arg(long, default_value_t = 0.8)]
    charger_level: f64,
    /// Forward speed [m/s]; default half the wheels' top speed
    #[arg(long)]
    speed_mps: Option<f64>,
    /// Let the robot back up
    #[arg(long)]
    reverse: bool,
    /// How far a place may be moved to free ground [m]; default one cell
    #[arg(long)]
    snap_radius_m: Option<f64>,
    /// Time for all of it [s] [default: 600]
    #[arg(long)]
    timeout_s: Option<f64>,
    /// Print the answer as the JSON document that the HTTP API returns
    #[arg(long)]
    json: bool,
    /// Write the answer to this file, in the form of its ending: .geojson, .gpx, .kml, .csv, .png, .svg, .html or .json
    #[arg(long, value_name = "FILE")]
    out: Option<OutFile>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let terrain = arguments.map.read()?;
    let waypoint = |place: &Place| {
        let [x_m, y_m] = place.on(&terrain)?;
        anyhow::Ok(WaypointRequest {
            x_m,
            y_m,
            lon_deg: None,
            lat_deg: None,
            heading_rad: place.heading_rad(),
            service_s: arguments.service_s,
            service_power_w: arguments.service_power_w,
            recharge: None,
        })
    };
    let charger = |place: &Place| {
        let [x_m, y_m] = place.on(&terrain)?;
        let (power_w, level) = (arguments.charger_power_w, arguments.charger_level);
        let heading_rad = place.heading_rad();
        anyhow::Ok(ChargerRequest { x_m, y_m, lon_deg: None, lat_deg: None, heading_rad, power_w, level })
    };
    let mut request = MissionRequest {
        areas: None,
        unknown_ground: None,
        map: None,
        map_id: None,
        robot: arguments.robot.read()?,
        start: arguments.start.pose_on(&terrain)?,
        waypoints: arguments.waypoint.iter().map(waypoint).collect::<anyhow::Result<_>>()?,
        chargers: arguments.charger.iter().map(charger).collect::<anyhow::Result<_>>()?,
        order: if arguments.in_order { OrderName::Given } else { OrderName::Best },
        back: arguments.back,
        deadline_s: arguments.deadline_s,
        charge: arguments.charge,
        ambient_c: None,
        samples: 1000,
        seed: 0,
        speed_mps: arguments.speed_mps,
        reverse: arguments.reverse,
        snap_radius_m: arguments.snap_radius_m,
        timeout_s: arguments.timeout_s,
    };
    arguments.out.as_ref().map_or(Ok(()), |out| out.check(&terrain))?;
    let plan = request.plan();
    let patience = plan.patience(&patience()).map_err(Refused)?;
    let sign = progress::working("planning");
    let planner = plan.planner(&terrain, &patience).map_err(Refused)?;
    let found = answer(&planner, &request, &plan, &patience).map_err(Refused)?;
    sign.finish_and_clear();
    warn_of_answer(&found.warnings, &terrain);
    if let Some(out) = &arguments.out {
        write(out, &terrain, &planner.lattice().robot, &found)?;
    }
    if arguments.json {
        output::json(&found)?;
    } else {
        output::line(summary(&found))?;
    }
    if found.feasible {
        return Ok(());
    }
    let why = match (found.missing_j > 0.0, &found.stalled) {
        (true, _) => format!("out of charge: {} are missing", energy(found.missing_j)),
        (false, Some(stalled)) => format!("the battery stops the robot ({stalled})"),
        (false, None) => format!("the deadline passes: the plan found takes {}", time(found.duration_s)),
    };
    Err(OutOfCharge(format!("{why}; add chargers, charge or time, or drop waypoints")).into())
}

fn write(out: &OutFile, terrain: &Terrain, robot: &Robot, found: &MissionAnswer) -> anyhow::Result<()> {
    let head = ["stop", "arrival", "energy so far", "charge on arrival"].map(str::to_owned).to_vec();
    let row = |stop: &StopAnswer| {
        let charge = format!("{:.1} %", 100.0 * stop.arrival_charge);
        vec![stop.name(), time(stop.arrival_s), energy(stop.energy_j), charge]
    };
    out.write(Answer {
        document: found,
        tracks: &|form, out| Ok(Tracks::of_mission(found, terrain.crs.as_deref()).write(form, out)?),
        scene: scenes::mission(terrain, robot, found),
        table: std::iter::once(head).chain(found.stops.iter().map(row)).collect(),
        warnings: details(&found.warnings),
    })
}

fn summary(found: &MissionAnswer) -> String {
    let mut text = String::new();
    for stop in &found.stops {
        let name = stop.name();
        text += &format!(
            "{name:<12} at {:>10}  {:>10}  {:5.1} % of charge\n",
            time(stop.arrival_s),
            energy(stop.energy_j),
            100.0 * stop.arrival_charge
        );
    }
    let (e, weakest) = (&found.energy_j, &found.weakest_leg);
    let search = &found.search;
    text += &format!(
        "energy       {}  ({} to {}) over {:.1} m in {}\nsuccess      {:.1} % of the draws\nweakest leg  to stop {}, {:.1} % of charge above the reserve\norder        at most {} above the best",
        energy(e.p50),
        energy(e.p05),
        energy(e.p95),
        found.distance_m,
        time(found.duration_s),
        100.0 * found.success_probability,
        weakest.to_stop,
        100.0 * weakest.margin,
        energy(search.excess_at_most_j),
    );
    text
}
