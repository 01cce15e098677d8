//! `joulepath predict`.

use std::path::PathBuf;

use calibration::{RunPrediction, predict};
use clap::Args;

use crate::{files, output, progress, recorded::Recorded};

#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    recorded: Recorded,
    /// Where to write a report with plots of what is left unexplained
    #[arg(long)]
    html: Option<PathBuf>,
}

pub(crate) fn run(arguments: &Arguments) -> anyhow::Result<()> {
    let (robot, recording) = arguments.recorded.read()?;
    let sign = progress::working("predicting");
    let found = predict(&robot, &recording);
    sign.finish_and_clear();
    let found = found.map_err(|error| arguments.recorded.refuse(&error))?;
    found.prediction.doubts.iter().for_each(|doubt| output::note(format_args!("doubt: {doubt}")));
    found.prediction.notes.iter().for_each(output::note);
    for run in &found.prediction.runs {
        if let Some(words) = run.coverage.words() {
            output::note(format_args!("run {}: {words}", run.run));
        }
    }
    if let Some(path) = &arguments.html {
        let page = report::prediction_page(&robot, &found);
        files::write(path, page)?;
    }
    if arguments.recorded.json {
        output::json(&found.prediction)?;
        return Ok(());
    }
    let currents = found.prediction.total.r2_a.is_some();
    output::line(format_args!(
        "{:<20} {:>8} {:>9} {:>9} {:>7} {:>11} {:>11} {:>8}{}",
        "run",
        "rows",
        "bias",
        "RMSE",
        "R²",
        "recorded",
        "predicted",
        "error",
        if currents { "   R² (A)" } else { "" }
    ))?;
    for run in found.prediction.runs.iter().chain([&found.prediction.total]) {
        output::line(line(run))?;
    }
    Ok(())
}

fn line(run: &RunPrediction) -> String {
    let number = |value: Option<f64>| value.map_or("-".to_owned(), |v| format!("{v:.3}"));
    // A run of one row has no energy.
    let error_percent = 100.0 * (run.predicted_j / run.recorded_j - 1.0);
    let error = if error_percent.is_finite() { format!("{error_percent:+.1} %") } else { "-".to_owned() };
    let current = run.r2_a.map_or(String::new(), |r2| format!(" {r2:>8.3}"));
    format!(
        "{:<20} {:>8} {:>7.1} W {:>7.1} W {:>7} {:>8.2} kJ {:>8.2} kJ {error:>8}{current}",
        run.run,
        run.rows,
        run.bias_w,
        run.rmse_w,
        number(run.r2),
        run.recorded_j / 1e3,
        run.predicted_j / 1e3
    )
}
