//! Predicted against recorded power of a robot's drives, as a page.

mod scatter;

use calibration::{PredictedDrives, RunPrediction};
use maud::{Markup, html};
use model::Robot;

use crate::{
    document::{document, section},
    figures::decimals,
};
use scatter::{Scatter, color};

/// Turning radius at which an arc is as good as straight, and where the axis ends [tracks].
const WIDEST_RADIUS_TRACKS: f64 = 20.0;

/// The page of a prediction: the answer in a sentence, a table of the runs, and residuals over time and against speed, yaw rate,
/// radius, pitch and surface. A residual is a one-second average of recorded less predicted power.
pub fn prediction_page(robot: &Robot, found: &PredictedDrives) -> String {
    let residuals = html! {
        p.quiet {
            "Each dot is one second: recorded less predicted power. Above zero the robot drew more than the model predicts, below zero less. \
             A cloud about zero is noise; a slope or a step is physics that the model or its parameters miss."
            (surface_key(found))
        }
        div.plots { (plots(robot, found)) }
    };
    let body = html! {
        h1 { (robot.name) ": predicted against recorded power" }
        (summary(&found.prediction.total, found.prediction.runs.len()))
        div.wide role="region" aria-label="Runs" tabindex="0" { (table(found)) }
        (legend())
        (section("Residuals", &residuals))
    };
    document("Predicted against recorded power", &body)
}

/// The answer in a sentence.
fn summary(total: &RunPrediction, runs: usize) -> Markup {
    let percent = |r2: f64| format!("{:.0}\u{a0}%", 100.0 * r2.max(0.0));
    html! {
        p.lead {
            "Over " (runs) @if runs == 1 { " run" } @else { " runs" } " the robot drew " b { (kilojoules(total.recorded_j)) "\u{a0}kJ" }
            "; the model predicts " b { (kilojoules(total.predicted_j)) "\u{a0}kJ" } " (" (energy_error(total)) ")."
            @if let Some(r2) = total.r2 {
                " Row by row the model explains " (percent(r2)) " of the variance of power (R² " (decimals(Some(r2), 2)) ")."
            }
            @if let Some(r2) = total.r2_a {
                " Power was recorded as motor currents and computed from these with the robot's motor constants; of side current, averaged \
                 over one second, " (percent(r2)) " of the variance is explained (R² " (decimals(Some(r2), 2)) ")."
            }
        }
    }
}

fn kilojoules(energy_j: f64) -> String {
    format!("{:.1}", energy_j / 1e3)
}

/// The relative error of a run's energy; a dash where it drew none.
fn energy_error(run: &RunPrediction) -> String {
    let percent = 100.0 * (run.predicted_j / run.recorded_j - 1.0);
    if percent.is_finite() { format!("{percent:+.1}\u{a0}%").replace('-', "−") } else { "–".into() }
}

fn table(found: &PredictedDrives) -> Markup {
    html! {
        table.board.runs {
            thead {
                tr {
                    th { "run" } th { "rows" } th { "recorded [kJ]" } th { "predicted [kJ]" } th { "energy error" } th { "bias [W]" }
                    th { "RMSE [W]" } th { "R²" } th { "eq. 17" } th { "stuck rows" }
                }
            }
            tbody { @for run in found.prediction.runs.iter().chain([&found.prediction.total]) { (row(run)) } }
        }
    }
}

fn row(run: &RunPrediction) -> Markup {
    html! {
        tr {
            th scope="row" { (run.run) }
            td { (run.rows) }
            td { (format!("{:.2}", run.recorded_j / 1e3)) }
            td { (format!("{:.2}", run.predicted_j / 1e3)) }
            td { (energy_error(run)) }
            td { (format!("{:.1}", run.bias_w)) }
            td { (format!("{:.1}", run.rmse_w)) }
            td { (decimals(run.r2, 2)) }
            td { (decimals(run.normalized_error_percent, 1)) "\u{a0}%" }
            td { (run.stuck_rows) }
        }
    }
}

/// What the columns of the table mean.
fn legend() -> Markup {
    html! {
        p.quiet {
            b { "bias" } ": mean of predicted less recorded power. " b { "RMSE" } ": root mean square of the difference, row by row. " b { "R²" }
            ": share of the variance of recorded power that the model explains; 1 is all, 0 or less means that the run's own mean would have \
             done as well, as it does for runs at one steady power. " b { "eq. 17" } ": normalised error of one-second averages, as in Table IV \
             of Dogru & Marques (2018). " b { "stuck" } ": rows in which the wheels turned against each other and the robot did not turn; no \
             model of wheel speeds predicts those."
        }
    }
}

/// Which surface has which colour.
fn surface_key(found: &PredictedDrives) -> Markup {
    html! {
        @for (i, name) in found.drives.surfaces.iter().enumerate() {
            " " span style={ "color:" (color(i)) } { "● " (name) }
        }
    }
}

fn plots(robot: &Robot, found: &PredictedDrives) -> Markup {
    let drives = &found.drives;
    let mean = |value: &(dyn Fn(usize) -> f64 + Sync)| drives.averaged_by(value);
    let residual_w = mean(&|i| found.recorded_w[i] - found.predicted_w[i]);
    let speed_mps = mean(&|i| drives.rows[i].speed_mps());
    let yaw_radps = mean(&|i| drives.rows[i].difference_mps() / robot.slip_track_m);
    let widest_m = WIDEST_RADIUS_TRACKS * robot.track_m;
    let radius_m: Vec<f64> =
        speed_mps.iter().zip(&yaw_radps).map(|(speed_mps, yaw)| radius(*speed_mps, *yaw, widest_m)).collect();
    let pitch_rad = mean(&|i| drives.rows[i].pitch_rad);
    let mut elapsed_s = 0.0;
    let mut driven = |seconds: f64| {
        elapsed_s += seconds;
        elapsed_s
    };
    let time_s: Vec<f64> = drives.averages.iter().map(|average| driven(average.duration_s)).collect();
    let group: Vec<usize> = drives.averages.iter().map(|average| average.surface).collect();
    let surface: Vec<f64> = group.iter().map(|surface| *surface as f64).collect();
    let radius_label = format!("turning radius [m]; in place at the left, straight at {widest_m:.1}");
    let plots: [(&str, &[f64]); 6] = [
        ("time driven [s], runs one after another", &time_s),
        ("speed [m/s], forwards positive", &speed_mps),
        ("yaw rate by the wheels [rad/s], left positive", &yaw_radps),
        (&radius_label, &radius_m),
        ("pitch [rad], uphill positive", &pitch_rad),
        ("surface, in the order of the key", &surface),
    ];
    html! { @for (label, x) in plots { (Scatter { label, x, y_w: &residual_w, group: &group }.figure()) } }
}

/// The size of the turning radius, up to the widest that is drawn [m].
fn radius(speed_mps: f64, yaw_radps: f64, widest_m: f64) -> f64 {
    if yaw_radps == 0.0 { widest_m } else { (speed_mps / yaw_radps).abs().min(widest_m) }
}
