//! `joulepath robot list`.

use clap::Args;
use model::{Robot, builtin};
use serde_json::json;

use crate::{output, table::aligned};

#[derive(Args)]
pub(crate) struct Arguments {
    /// Print the answer as a JSON document
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let robots = builtin::all();
    if arguments.json {
        let list: Vec<_> = robots.iter().map(entry).collect();
        return output::json(&json!({ "robots": list }));
    }
    let mut rows =
        vec![["name", "mass", "top speed", "ground", "borrowed", "of these matters most"].map(str::to_owned)];
    rows.extend(robots.iter().map(|robot| {
        [
            robot.name.clone(),
            format!("{} kg", robot.mass_kg),
            format!("{} m/s", robot.max_wheel_speed_mps),
            robot.default_surface.clone(),
            // `robot check` names them.
            match robot.borrowed().len() {
                0 => "nothing".to_owned(),
                1 => "1 constant".to_owned(),
                count => format!("{count} constants"),
            },
            robot.worst_borrowed().unwrap_or_default().to_owned(),
        ]
    }));
    output::text(aligned(&rows))
}

fn entry(robot: &Robot) -> serde_json::Value {
    json!({
        "name": robot.name,
        "mass_kg": robot.mass_kg,
        "max_wheel_speed_mps": robot.max_wheel_speed_mps,
        "default_surface": robot.default_surface,
        "borrowed": robot.borrowed(),
        "source": robot.source,
    })
}
