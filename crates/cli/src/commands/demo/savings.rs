//! What the energy-minimal path saves on several grounds and under several standing loads.

use anyhow::Context;
use model::{
    Robot,
    data_sheet::{GROUNDS, Ground},
    robot::Surface,
};
use serde_json::json;
use service::routes::plan::PlanAnswer;

use super::Question;
use crate::table::aligned;

/// Grounds that a Husky A200 was measured on, from the easiest to roll on.
const NAMES: [&str; 3] = ["marble", "asphalt", "sandy_loam"];

/// A row for each ground and a column for each standing load: none, and that of the robot.
pub(super) fn table(question: &Question, robot: &Robot) -> anyhow::Result<String> {
    let loads_w = [0.0, robot.hotel_power_w];
    let head = ["", "0 W", &format!("{} W", robot.hotel_power_w)].map(str::to_owned);
    let mut rows = vec![head];
    for name in NAMES {
        let ground = GROUNDS.iter().find(|ground| ground.name == name).context("no such ground")?;
        let [without, with] = loads_w.map(|load_w| saving(question, &changed(robot, ground, load_w)));
        rows.push([name.replace('_', " "), per_cent(without?), per_cent(with?)]);
    }
    Ok(format!(
        "Share of the shortest path's energy that the energy-minimal path saves, by ground and standing load\n(robot otherwise the same; frictions as measured under a Husky A200):\n\n{}",
        aligned(&rows)
    ))
}

fn per_cent(share: f64) -> String {
    format!("{:.1} %", 100.0 * share)
}

/// The robot on another ground, under another standing load.
fn changed(robot: &Robot, ground: &Ground, hotel_power_w: f64) -> Robot {
    let mut robot = robot.clone();
    robot.hotel_power_w = hotel_power_w;
    robot.default_surface = ground.name.to_owned();
    robot.surfaces.entry(ground.name.to_owned()).or_insert(Surface {
        mu_roll: ground.mu_roll,
        mu_skid: ground.mu_skid,
        slip_angle_scale_rad: ground.slip_angle_scale_rad,
        dogru_marques: None,
        mechanisms: Vec::new(),
    });
    robot
}

fn saving(question: &Question, robot: &Robot) -> anyhow::Result<f64> {
    let energy_j = |objective: &str| -> anyhow::Result<f64> {
        let more = json!({ "objective": objective });
        Ok(question.ask::<PlanAnswer>("plan", robot, more)?.followed_path().energy_j)
    };
    let (least_j, shortest_j) = (energy_j("energy")?, energy_j("distance")?);
    Ok((shortest_j - least_j) / shortest_j)
}
