//! `joulepath alternatives`.

use clap::{Args, ValueEnum};
use service::routes::{
    alternatives::{AgainstName, AlternativesAnswer, AlternativesRequest, answer},
    plan::ObjectiveName,
};

use crate::{
    arguments::{PathLimits, Question, patience},
    failure::Refused,
    output, progress,
    table::{aligned, energy, time},
};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    question: Question,
    #[command(flatten)]
    limits: PathLimits,
    /// What energy is weighed against
    #[arg(long, value_enum, default_value = "time")]
    against: Against,
    /// How many paths
    #[arg(long, default_value_t = 7)]
    count: usize,
    /// How exact: no path that takes as little of the other has less than 1/(1 + epsilon) of the energy; 0 is the least itself
    #[arg(long, default_value_t = 0.01)]
    epsilon: f64,
}

#[derive(Clone, Copy, ValueEnum)]
enum Against {
    Time,
    Distance,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    arguments.question.refuse_steering("alternatives")?;
    let (terrain, plan) = arguments.question.read(ObjectiveName::Energy)?;
    let plan = arguments.limits.on(plan);
    let mut request = AlternativesRequest {
        map: None,
        map_id: None,
        robot: plan.robot,
        start: plan.start,
        goal: plan.goal,
        against: match arguments.against {
            Against::Time => AgainstName::Time,
            Against::Distance => AgainstName::Distance,
        },
        count: arguments.count,
        epsilon: arguments.epsilon,
        max_time_s: plan.max_time_s,
        max_energy_j: plan.max_energy_j,
        max_distance_m: plan.max_distance_m,
        max_slope_rad: plan.max_slope_rad,
        speed_mps: plan.speed_mps,
        reverse: plan.reverse,
        snap_radius_m: plan.snap_radius_m,
        timeout_s: plan.timeout_s,
        areas: None,
        unknown_ground: None,
    };
    let plan = request.plan().map_err(Refused)?;
    let patience = plan.patience(&patience()).map_err(Refused)?;
    let sign = progress::working("planning");
    let planner = plan.planner(&terrain, &patience).map_err(Refused)?;
    let found = answer(&planner, &request, &plan, &patience).map_err(Refused)?;
    sign.finish_and_clear();
    if arguments.question.driving.json {
        output::json(&found)?;
    } else {
        output::text(text(&found))?;
    }
    Ok(())
}

fn text(found: &AlternativesAnswer) -> String {
    let head = ["", "energy", "time", "distance", "proven within"].map(str::to_owned);
    let row = |(i, path): (usize, &service::routes::plan::PlanAnswer)| {
        let bound =
            path.search.bound.map_or("-".to_owned(), |bound| format!("{:.2} %", 100.0 * (bound - 1.0)));
        let distance = format!("{:.1} m", path.distance_m);
        [(i + 1).to_string(), energy(path.energy_j), time(path.duration_s), distance, bound]
    };
    let rows: Vec<[String; 5]> =
        std::iter::once(head).chain(found.alternatives.iter().enumerate().map(row)).collect();
    let mut text = aligned(&rows);
    if found.complete {
        text.push_str("there are no others\n");
    }
    if found.timed_out {
        text.push_str("time ran out before all were proven\n");
    }
    text
}
