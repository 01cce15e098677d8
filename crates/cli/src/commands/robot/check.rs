//! `joulepath robot check`.

use clap::Args;
use model::{
    Robot, builtin,
    knowledge::Provenance,
    worth::{Moment, Worth, remedy},
};
use serde::Serialize;
use serde_json::{Value, json};

use crate::{failure::BadInput, output, recorded};

#[derive(Args)]
pub(crate) struct Arguments {
    /// A robot file, or the name of a built-in robot
    robot: String,
    /// Print the answer as a JSON document
    #[arg(long)]
    json: bool,
}

/// Something that makes predictions worth less.
#[derive(Serialize)]
struct Doubt {
    /// The field that it is about.
    field: String,
    /// What it is, and what mends it.
    detail: String,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let name = &arguments.robot;
    let robot = recorded::robot(name)?;
    let is_file = builtin::by_name(name).is_err();
    let written: Value = if is_file { serde_json::from_str(&recorded::text(name)?)? } else { Value::Null };
    report(&robot, &written, arguments.json)
}

/// Prints what predictions with a robot are worth; `written` is its file as it stands there, null for a built-in one.
fn report(robot: &Robot, written: &Value, is_json: bool) -> anyhow::Result<()> {
    let worths = worths(robot)?;
    let doubts = doubts(robot, written);
    if is_json {
        let moments: Vec<_> = worths.iter().map(moment).collect();
        return output::json(&json!({
            "name": robot.name,
            "borrowed": robot.borrowed(),
            "moments": moments,
            "worst_borrowed": robot.worst_borrowed(),
            "next_drive": robot.worst_borrowed().map(remedy),
            "doubts": doubts,
        }));
    }
    output::text(summary(robot, &worths))?;
    for doubt in doubts {
        output::line(format_args!("doubt: {}: {}", doubt.field, doubt.detail))?;
    }
    Ok(())
}

pub(super) fn worths(robot: &Robot) -> Result<Vec<Worth>, BadInput> {
    let of = |moment: Moment| moment.worth(robot).map_err(|error| BadInput(error.to_string()));
    Moment::ALL.into_iter().map(of).collect()
}

/// Power and its interval at each moment, and the drive that would narrow it most.
pub(super) fn summary(robot: &Robot, worths: &[Worth]) -> String {
    let speed_mps = robot.max_wheel_speed_mps / 2.0;
    let mut text =
        format!("{} on {}, wheels at {speed_mps} m/s, 95 % intervals:\n", robot.name, robot.default_surface);
    for worth in worths {
        let [low_w, high_w] = worth.interval_w;
        let relative = worth
            .relative()
            .map_or(String::new(), |[low, high]| format!(", {:.0} % to {:+.0} %", 100.0 * low, 100.0 * high));
        let open = worth.least_known().map_or(String::new(), |name| format!("; least known is {name}"));
        let words = worth.moment.words();
        text += &format!("  {words}: {:.1} W ({low_w:.1} to {high_w:.1} W{relative}){open}\n", worth.power_w);
    }
    if let Some(name) = robot.worst_borrowed() {
        text += &format!(
            "borrowed from other robots: {}\nmost would be gained by {name}: `joulepath calibrate` with {}\n",
            robot.borrowed().join(", "),
            remedy(name)
        );
    }
    text
}

fn moment(worth: &Worth) -> Value {
    json!({
        "moment": worth.moment.name(),
        "power_w": worth.power_w,
        "interval_w": worth.interval_w,
        "relative": worth.relative(),
        "least_known": worth.least_known(),
        "remedy": worth.least_known().map(remedy),
    })
}

/// Below this a borrowed constant is stated to be known as if it had been measured [-].
const MEASURED_SIGMA: f64 = 0.10;

fn doubts(robot: &Robot, written: &Value) -> Vec<Doubt> {
    let mut found = Vec::new();
    let mut add = |field: &str, detail: String| found.push(Doubt { field: field.to_owned(), detail });
    let husky = builtin::husky_a200();
    if written.is_object() && robot.provenance.is_empty() && robot.posterior.is_none() {
        add("provenance", "nothing says where the constants come from; give `measured`, `fitted`, `data-sheet` or `borrowed` for each".into());
    }
    if written.is_object() && written.get("uncertainty").is_none() && robot.posterior.is_none() {
        add("uncertainty", "absent, so intervals are those of a robot measured as well as the Husky A200 of the paper: give it".into());
    }
    let is_husky =
        (robot.mass_kg / husky.mass_kg - 1.0).abs() < 0.5 && robot.wheel_radius_m == husky.wheel_radius_m;
    if !is_husky && robot.motors.left == husky.motors.left && robot.motors.right == husky.motors.right {
        add(
            "motors",
            format!(
                "k1 and k2 are those of a Husky A200, of wheels and motors of another size: `joulepath robot new` derives those of a robot of {} kg",
                robot.mass_kg
            ),
        );
    }
    for parameter in robot.uncertain() {
        let is_borrowed = robot.borrowed().contains(&parameter.name);
        if is_borrowed && parameter.sigma < MEASURED_SIGMA {
            add(
                parameter.name,
                format!("borrowed, but `uncertainty` says that it is known to {} %", 100.0 * parameter.sigma),
            );
        }
    }
    if robot.hotel_power_w == 0.0 {
        add("hotel_power_w", "0: a computer and radios draw power whether the robot drives or not; read it off while it stands".into());
    }
    if robot.motors.regeneration > 0.9
        && robot.provenance_of("motors.regeneration") != Some(Provenance::Measured)
    {
        add(
            "motors.regeneration",
            format!(
                "{}: few drivers give so much of the braking power back; brake on a descent to see",
                robot.motors.regeneration
            ),
        );
    }
    for field in ["motors.regeneration", "slip_track_m"] {
        if robot.provenance_of(field) == Some(Provenance::Borrowed) {
            let name = field.rsplit('.').next().unwrap_or(field);
            add(field, format!("borrowed, and not in the intervals: it takes {}", remedy(name)));
        }
    }
    if robot.battery.is_none() {
        add("battery", "none: questions of range and missions are refused".into());
    }
    found
}
