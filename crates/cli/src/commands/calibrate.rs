//! `joulepath calibrate`.

use std::path::{Path, PathBuf};

use calibration::{Calibration, Method, Options, lift};
use clap::{Args, ValueEnum};
use diagnosis::taught;
use recording::unwatched;

use crate::{
    failure::BadInput,
    files, output, progress,
    recorded::{Recorded, text},
};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    recorded: Recorded,
    /// Lifting test: a table of side, force_n, rim_speed_mps, power_w, which gives k1 and k2
    #[arg(long)]
    lift: Option<PathBuf>,
    /// Which procedure: a fit of everything, or the paper's own
    #[arg(long, value_enum, default_value = "fit")]
    method: MethodName,
    /// For motor currents: the surface that what belongs to the robot is fitted on
    #[arg(long)]
    reference_surface: Option<String>,
    /// Names of doubts about the recording that are overruled, such as `power_sign`
    #[arg(long, num_args = 1..)]
    despite: Vec<String>,
    /// Where to write the fitted robot
    #[arg(long)]
    out: PathBuf,
}

#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum MethodName {
    Fit,
    DogruMarques,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    refuse_unwritable(&arguments.out)?;
    let (mut robot, recording) = arguments.recorded.read()?;
    if let Some(path) = &arguments.lift {
        let name = path.display().to_string();
        let lifts = lift::read(&text(&name)?).map_err(|error| BadInput(format!("{name}: {error}")))?;
        robot = lift::apply(&robot, &lifts).map_err(|error| BadInput(format!("{name}: {error}")))?;
    }
    let method = match arguments.method {
        MethodName::Fit => Method::Fit,
        MethodName::DogruMarques => Method::DogruMarques,
    };
    let options = Options {
        reference_surface: arguments.reference_surface.clone(),
        despite: arguments.despite.clone(),
    };
    let sign = progress::working("fitting");
    let found = method
        .calibrate(&robot, &recording, &options)
        .and_then(|found| taught(&robot, found, &recording, &unwatched()));
    sign.finish_and_clear();
    let found = found.map_err(|error| arguments.recorded.refuse(&error))?;
    let file = serde_json::to_string_pretty(&found.robot)?;
    let out = &arguments.out;
    files::write(out, file + "\n")?;
    found.coverage.words_by_run().iter().for_each(output::note);
    if arguments.recorded.json {
        output::json(&found)?;
    } else {
        output::line(summary(&found))?;
    }
    Ok(())
}

/// Refuses a place that cannot be written to before long work is done for it.
fn refuse_unwritable(out: &Path) -> Result<(), BadInput> {
    let folder = out.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if folder.is_dir() && !out.is_dir() {
        return Ok(());
    }
    let fault = if out.is_dir() { "it is a folder" } else { "its folder does not exist" };
    Err(BadInput(format!("--out {}: {fault}; name a file in a folder that does", out.display())))
}

fn summary(found: &Calibration) -> String {
    let mut text = String::new();
    for parameter in &found.parameters {
        // Motor constants are thousandths of their units.
        let digits = if parameter.value.abs() < 0.01 { 6 } else { 4 };
        let interval = match parameter.interval_95 {
            Some([low, high]) if parameter.determined => {
                format!("{low:.digits$} to {high:.digits$}")
            }
            _ => "not determined, held".to_owned(),
        };
        let unit = if parameter.unit == "1" { "" } else { &parameter.unit };
        text += &format!("{:<42} {:>10.digits$} {unit:<7} {interval}\n", parameter.name, parameter.value);
    }
    if let Some(held_out) = &found.held_out {
        text += &format!(
            "\nheld-out runs: R² {:.3}, RMSE {:.1} W, energy within {:.1} % (median)",
            held_out.r2, held_out.rmse_w, held_out.median_energy_error_percent
        );
        if let (Some(r2), Some(rmse_a)) = (held_out.r2_a, held_out.rmse_a) {
            text += &format!("; side current R² {r2:.3}, RMSE {rmse_a:.2} A");
        }
    }
    if let Some(skill) = &found.as_written {
        let r2 = skill.r2.map_or("-".to_owned(), |r2| format!("{r2:.3}"));
        text += &format!("\nthe file on the runs that it was fitted to: R² {r2}, RMSE {:.1} W", skill.rmse_w);
        if let (Some(r2), Some(rmse_a)) = (skill.r2_a, skill.rmse_a) {
            text += &format!("; side current R² {r2:.3}, RMSE {rmse_a:.2} A");
        }
    }
    for note in &found.notes {
        text += &format!("\n{note}");
    }
    text
}
