//! The report of a prediction: one page with its plots in it.

use std::fmt::Write as _;

use model::Robot;

use crate::{PredictedDrives, RunPrediction, scatter::Scatter};

/// What the columns of the table mean, for a reader who has never seen one.
const LEGEND: &str = "<p class=small><b>bias</b>: mean of predicted less recorded power. <b>RMSE</b>: typical size of the difference, row by \
    row. <b>R²</b>: share of the recorded ups and downs that the model explains; 1 is all, 0 or less means that the run's own mean would have \
    done as well, as it does for runs at one steady power. <b>eq. 17</b>: normalised error of one-second averages, as in Table IV of Dogru &amp; \
    Marques (2018). <b>stuck</b>: rows in which the wheels turned against each other and the robot did not turn; no model of \
    wheel speeds predicts those.</p>";

const STYLE: &str = "body{font:14px sans-serif;max-width:82em;margin:2em auto;padding:0 1em}td,th{text-align:right;padding:.2em \
    .7em}th:first-child,td:first-child{text-align:left}tr:last-child td{border-top:1px solid #999;font-weight:bold}.small{color:#444;max-width:60em}\
    figure{margin:0}.plots{display:grid;grid-template-columns:repeat(auto-fit,minmax(520px,1fr));gap:1em}";

/// A self-contained HTML page: the answer in a sentence, a table of the runs, and what is left unexplained over time and against
/// speed, yaw rate, radius, pitch and surface. Residuals are one-second averages of recorded less predicted power.
pub fn html(robot: &Robot, found: &PredictedDrives) -> String {
    let plots = plots(robot, found);
    format!(
        "<!doctype html><html lang=en><meta charset=utf-8><title>Predicted against recorded power</title><style>{STYLE}</style>\
         <h1>{}: predicted against recorded power</h1><p>{}</p><table><tr><th>run<th>rows<th>recorded [kJ]<th>predicted [kJ]<th>energy \
         error<th>bias [W]<th>RMSE [W]<th>R²<th>eq. 17<th>stuck rows{}</table>{LEGEND}<h2>What is left unexplained</h2><p \
         class=small>Each dot is one second: recorded less predicted power. Above the line the robot drew more than the model says, below it \
         less. A cloud about the line is noise; a slope or a step is physics that the model or its parameters miss.{}</p><div \
         class=plots>{plots}</div></html>",
        escaped(&robot.name),
        summary(&found.prediction.total, found.prediction.runs.len()),
        table(found),
        surface_key(found),
    )
}

/// The answer in a sentence.
fn summary(total: &RunPrediction, runs: usize) -> String {
    let explained = total.r2.map_or(String::new(), |r2| {
        format!(
            " Row by row the model explains {:.0} % of the ups and downs of power (R² {r2:.2}).",
            100.0 * r2.max(0.0)
        )
    });
    let current = total.r2_a.map_or(String::new(), |r2| {
        format!(
            " Power was recorded as motor currents, and is what the robot's motor constants make of them; of side current, averaged \
             over one second, {:.0} % is explained (R² {r2:.2}).",
            100.0 * r2.max(0.0)
        )
    });
    format!(
        "Over {runs} run{} the robot drew <b>{:.1} kJ</b>; the model says <b>{:.1} kJ</b> ({:+.1} %).{explained}{current}",
        if runs == 1 { "" } else { "s" },
        total.recorded_j / 1e3,
        total.predicted_j / 1e3,
        energy_error_percent(total)
    )
}

fn energy_error_percent(run: &RunPrediction) -> f64 {
    100.0 * (run.predicted_j / run.recorded_j - 1.0)
}

fn table(found: &PredictedDrives) -> String {
    let mut rows = String::new();
    for run in found.prediction.runs.iter().chain([&found.prediction.total]) {
        let number =
            |value: Option<f64>, digits: usize| value.map_or("–".to_owned(), |v| format!("{v:.digits$}"));
        let _ = write!(
            rows,
            "<tr><td>{}<td>{}<td>{:.2}<td>{:.2}<td>{:+.1} %<td>{:.1}<td>{:.1}<td>{}<td>{} %<td>{}",
            escaped(&run.run),
            run.rows,
            run.recorded_j / 1e3,
            run.predicted_j / 1e3,
            energy_error_percent(run),
            run.bias_w,
            run.rmse_w,
            number(run.r2, 2),
            number(run.normalized_error_percent, 1),
            run.stuck_rows
        );
    }
    rows
}

/// Which surface has which colour.
fn surface_key(found: &PredictedDrives) -> String {
    let one = |(i, name): (usize, &String)| {
        format!(" <span style='color:{}'>● {}</span>", Scatter::colour(i), escaped(name))
    };
    found.drives.surfaces.iter().enumerate().map(one).collect()
}

fn plots(robot: &Robot, found: &PredictedDrives) -> String {
    let drives = &found.drives;
    let mean = |f: &(dyn Fn(usize) -> f64 + Sync)| drives.averaged_by(f);
    let residual_w = mean(&|i| found.recorded_w[i] - found.predicted_w[i]);
    let speed_mps = mean(&|i| drives.rows[i].speed_mps());
    let yaw_radps = mean(&|i| drives.rows[i].difference_mps() / robot.slip_track_m);
    // Beyond 20 tracks an arc is as good as straight; the axis ends there.
    let widest_m = 20.0 * robot.track_m;
    let radius = |(v, w): (&f64, &f64)| if *w == 0.0 { widest_m } else { (v / w).abs().min(widest_m) };
    let radius_m: Vec<f64> = speed_mps.iter().zip(&yaw_radps).map(radius).collect();
    let pitch_rad = mean(&|i| drives.rows[i].pitch_rad);
    let surface: Vec<f64> = drives.averages.iter().map(|a| a.surface as f64).collect();
    let mut elapsed_s = 0.0;
    let time = |seconds: f64| {
        elapsed_s += seconds;
        elapsed_s
    };
    let time_s: Vec<f64> = drives.averages.iter().map(|a| a.duration_s).map(time).collect();
    let group: Vec<usize> = drives.averages.iter().map(|a| a.surface).collect();
    let radius_label = format!("turning radius [m]; in place at the left, straight at {widest_m:.1}");
    let plots: [(&str, &[f64]); 6] = [
        ("time driven [s], runs one after another", &time_s),
        ("speed [m/s], forwards positive", &speed_mps),
        ("yaw rate by the wheels [rad/s], left positive", &yaw_radps),
        (&radius_label, &radius_m),
        ("pitch [rad], uphill positive", &pitch_rad),
        ("surface, in the order of the key", &surface),
    ];
    plots.iter().map(|(label, x)| Scatter { label, x, y: &residual_w, group: &group }.svg()).collect()
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
