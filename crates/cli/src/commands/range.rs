//! `joulepath range`.

use clap::Args;
use mission::Doubt;
use service::routes::{
    plan::GoalPose,
    range::{RangeAnswer, RangeRequest, answer},
};

use crate::{
    arguments::{MapArguments, Place, patience, warn_of_answer},
    failure::{OutOfCharge, Refused},
    output, progress,
    robot_arguments::RobotArguments,
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
    /// The same; without it the farthest place that the charge reaches
    #[arg(long, allow_hyphen_values = true)]
    goal: Option<Place>,
    /// Count the way back to the start too
    #[arg(long = "return")]
    back: bool,
    /// Charge when it sets out, 0 to 1
    #[arg(long, default_value_t = 1.0, allow_hyphen_values = true)]
    charge: f64,
    /// Temperature of the air and the motors when it sets out [°C]; default the motors' reference temperature
    #[arg(long, allow_hyphen_values = true)]
    ambient_c: Option<f64>,
    /// Draws of the robot, its battery and the ground as they may be
    #[arg(long, default_value_t = 1000)]
    samples: usize,
    /// So many of them get a path of their own
    #[arg(long, default_value_t = 0)]
    replanned: usize,
    /// Which draws
    #[arg(long, default_value_t = 0)]
    seed: u64,
    /// One-sigma error of the map's elevation [m]
    #[arg(long, default_value_t = Doubt::default().elevation_sigma_m)]
    elevation_sigma_m: f64,
    /// Forward speed [m/s]; default half the wheels' top speed
    #[arg(long)]
    speed_mps: Option<f64>,
    /// Let the robot back up
    #[arg(long)]
    reverse: bool,
    /// How far a start or goal may be moved to free ground [m]; default one cell
    #[arg(long)]
    snap_radius_m: Option<f64>,
    /// Time for all of it [s] [default: 600]
    #[arg(long)]
    timeout_s: Option<f64>,
    /// Print the answer as the JSON document that the HTTP API returns
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let terrain = arguments.map.read()?;
    let goal = |goal: Place| anyhow::Ok(GoalPose::in_metres(goal.on(&terrain)?, goal.heading_rad()));
    let mut request = RangeRequest {
        areas: None,
        unknown_ground: None,
        map: None,
        map_id: None,
        robot: arguments.robot.read()?,
        start: arguments.start.pose_on(&terrain)?,
        goal: arguments.goal.map(goal).transpose()?,
        back: arguments.back,
        charge: arguments.charge,
        ambient_c: arguments.ambient_c,
        samples: arguments.samples,
        replanned: arguments.replanned,
        seed: arguments.seed,
        elevation_sigma_m: arguments.elevation_sigma_m,
        elevation_scale_m: Doubt::default().elevation_scale_m,
        speed_mps: arguments.speed_mps,
        reverse: arguments.reverse,
        snap_radius_m: arguments.snap_radius_m,
        timeout_s: arguments.timeout_s,
    };
    let plan = request.plan();
    let patience = plan.patience(&patience()).map_err(Refused)?;
    let sign = progress::working("planning");
    let planner = plan.planner(&terrain, &patience).map_err(Refused)?;
    let found = answer(&planner, &request, &plan, &patience).map_err(Refused)?;
    sign.finish_and_clear();
    warn_of_answer(&found.warnings, &terrain);
    if arguments.json {
        output::json(&found)?;
    } else {
        output::line(summary(&found, arguments.back))?;
    }
    if found.reachable {
        return Ok(());
    }
    let why = match &found.heated.stalled {
        Some(stalled) if found.missing_j == 0.0 => format!("the voltage sags too far ({stalled})"),
        _ => format!("{} are missing", energy(found.missing_j)),
    };
    Err(OutOfCharge(format!("out of charge: {why}; charge the battery or choose a nearer goal")).into())
}

fn summary(found: &RangeAnswer, back: bool) -> String {
    let per_cent = |charge: f64| 100.0 * charge;
    let (e, c) = (&found.energy_j, &found.arrival_charge);
    let mut text = format!(
        "energy     {}  ({} to {})\narrival    {:.1} % of charge  ({:.1} to {:.1} %), reserve {:.0} %\nsuccess    {:.1} % of {} draws\nway        {:.1} m in {}{}\nplanned    {} without heat, {} with motors up to {:.0} °C",
        energy(e.p50),
        energy(e.p05),
        energy(e.p95),
        per_cent(c.p50),
        per_cent(c.p05),
        per_cent(c.p95),
        per_cent(found.reserve_fraction),
        per_cent(found.success_probability),
        found.samples,
        found.distance_m,
        time(found.duration_s),
        if back { ", there and back" } else { "" },
        energy(found.planned_energy_j),
        energy(found.heated.energy_j),
        found.heated.hottest_winding_c,
    );
    text += &match &found.turning_point {
        Some(t) => format!(
            "\nturn back  at {:.1} m at the latest, with {:.1} % of charge",
            t.distance_m,
            per_cent(t.charge)
        ),
        None => "\nturn back  never leaves the reserve".to_owned(),
    };
    let best = &found.best_speed;
    text += &format!("\nspeed      {:.2} m/s takes least, {} less", best.speed_mps, energy(best.saving_j));
    if let Some(replanned) = &found.replanned {
        let (count, saving) = (replanned.samples, energy(replanned.saving_j));
        text += &format!("\nreplanned  {count} draws on paths of their own save {saving}");
    }
    if let Some(carries) = &found.carries {
        let level = match &carries.level_m {
            Some(level) => {
                format!("{:.0} m on level ground  ({:.0} to {:.0} m)", level.p50, level.p05, level.p95)
            }
            None => "without end on level ground, which takes nothing".to_owned(),
        };
        let reach = if carries.whole_map { ", all of the map is in reach" } else { "" };
        text += &format!("\nlevel      {level}{reach}");
    }
    text
}
