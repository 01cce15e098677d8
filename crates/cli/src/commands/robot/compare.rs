//! `joulepath robot compare`.

use clap::Args;
use model::{Robot, worth::Moment};
use serde_json::json;

use crate::{failure::BadInput, output, recorded::robot, table::aligned};

#[derive(Args)]
pub(crate) struct Arguments {
    /// Name of a built-in robot, or a robot file
    one: String,
    /// Another
    other: String,
    /// Print the answer as a JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let robots = [robot(&arguments.one)?, robot(&arguments.other)?];
    let parameters = [parameters(&robots[0]), parameters(&robots[1])];
    let mut powers = Vec::new();
    for moment in Moment::ALL {
        let of = |robot: &Robot| moment.worth(robot).map_err(|error| BadInput(error.to_string()));
        powers.push((moment, [of(&robots[0])?, of(&robots[1])?]));
    }
    if arguments.json {
        let moments: Vec<_> = powers
            .iter()
            .map(|(moment, worths)| {
                json!({
                    "moment": moment.name(),
                    "power_w": [worths[0].power_w, worths[1].power_w],
                    "interval_w": [worths[0].interval_w, worths[1].interval_w],
                })
            })
            .collect();
        return output::json(&json!({ "robots": robots, "moments": moments }));
    }
    let mut rows = vec![["".to_owned(), robots[0].name.clone(), robots[1].name.clone()]];
    let pairs = parameters[0].iter().zip(&parameters[1]);
    rows.extend(pairs.map(|((name, one), (_, other))| [name.clone(), one.clone(), other.clone()]));
    rows.extend(powers.iter().map(|(moment, worths)| {
        let cell = |i: usize| {
            let [low_w, high_w] = worths[i].interval_w;
            format!("{:.1} W ({low_w:.1} to {high_w:.1})", worths[i].power_w)
        };
        [moment.words().to_owned(), cell(0), cell(1)]
    }));
    output::text(aligned(&rows))
}

/// What robots differ by, in the order of the file.
fn parameters(robot: &Robot) -> Vec<(String, String)> {
    let motors = &robot.motors;
    let battery = robot.battery.as_ref();
    let surface = robot.surfaces.get(&robot.default_surface);
    let friction = |value: Option<f64>| value.map_or("-".to_owned(), |value| value.to_string());
    [
        ("mass", format!("{} kg", robot.mass_kg)),
        ("wheelbase", format!("{} m", robot.wheelbase_m)),
        ("track", format!("{} m", robot.track_m)),
        ("slip track", format!("{:.3} m", robot.slip_track_m)),
        ("wheel radius", format!("{} m", robot.wheel_radius_m)),
        ("top speed", format!("{} m/s", robot.max_wheel_speed_mps)),
        (
            "k1, left and right",
            format!("{:.4}, {:.4} W/N²", motors.left.k1_w_per_n2, motors.right.k1_w_per_n2),
        ),
        ("k2, left and right", format!("{:.3}, {:.3}", motors.left.k2, motors.right.k2)),
        ("regeneration", motors.regeneration.to_string()),
        ("hotel power", format!("{} W", robot.hotel_power_w)),
        ("battery", battery.map_or("none".to_owned(), |battery| format!("{} Wh", battery.capacity_wh))),
        ("default ground", robot.default_surface.clone()),
        ("mu_roll there", friction(surface.map(|surface| surface.mu_roll))),
        ("mu_skid there", friction(surface.map(|surface| surface.mu_skid))),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .to_vec()
}
