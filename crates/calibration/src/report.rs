//! The report of a prediction: one page with its plots in it.

use std::fmt::Write as _;

use model::Robot;

use crate::PredictedDrives;

const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 200.0;
const MARGIN: f64 = 46.0;
/// Points of a plot: more would only overlap on its 430 pixels.
const MOST_POINTS: usize = 1500;

/// A self-contained HTML page: a table of the runs, and what is left unexplained over time and against speed, yaw rate, radius, pitch
/// and surface. Residuals are one-second averages of recorded less predicted power.
pub fn html(robot: &Robot, found: &PredictedDrives) -> String {
    let drives = &found.drives;
    let mean = |f: &(dyn Fn(usize) -> f64 + Sync)| drives.averaged_by(f);
    let residual_w = mean(&|i| found.recorded_w[i] - found.predicted_w[i]);
    let speed_mps = mean(&|i| drives.rows[i].speed_mps());
    let yaw_radps = mean(&|i| drives.rows[i].difference_mps() / robot.slip_track_m);
    // Beyond 10 m an arc is as good as straight for a robot of half a metre; the axis ends there.
    let widest_m = 20.0 * robot.track_m;
    let radius_m: Vec<f64> = speed_mps
        .iter()
        .zip(&yaw_radps)
        .map(|(v, w)| (v / w).abs().min(widest_m))
        .map(|r| if r.is_nan() { 0.0 } else { r })
        .collect();
    let pitch_rad = mean(&|i| drives.rows[i].pitch_rad);
    let surface: Vec<f64> = drives.averages.iter().map(|a| a.surface as f64).collect();
    let mut elapsed_s = 0.0;
    let time_s: Vec<f64> = drives
        .averages
        .iter()
        .map(|a| {
            elapsed_s += a.duration_s;
            elapsed_s
        })
        .collect();
    let surfaces: Vec<String> =
        drives.surfaces.iter().enumerate().map(|(i, name)| format!("{i} {}", escaped(name))).collect();
    let plots = [
        ("time driven [s], runs behind one another", &time_s),
        ("speed v [m/s]", &speed_mps),
        ("yaw rate ω of the wheels [rad/s]", &yaw_radps),
        ("turning radius R [m], widest at the right", &radius_m),
        ("pitch [rad]", &pitch_rad),
        (&*format!("surface: {}", surfaces.join(", ")), &surface),
    ];
    let figures: String = plots.iter().map(|(label, x)| scatter(label, x, &residual_w)).collect();
    format!(
        "<!doctype html><meta charset=utf-8><title>Predicted against recorded power</title><style>body{{font:14px \
         sans-serif;max-width:70em;margin:2em auto}}td,th{{text-align:right;padding:.2em .7em}}th:first-child,td:first-child{{text-align:left}}</style>\
         <h1>{}: predicted against recorded power</h1><table><tr><th>run<th>rows<th>stuck<th>bias W<th>RMSE W<th>R²<th>recorded kJ<th>predicted \
         kJ<th>eq. 17 %{}</table><p>Below: recorded less predicted power, averages over one second [W].</p>{figures}",
        escaped(&robot.name),
        table(found),
    )
}

fn table(found: &PredictedDrives) -> String {
    let mut rows = String::new();
    for run in found.prediction.runs.iter().chain([&found.prediction.total]) {
        let number =
            |value: Option<f64>, digits: usize| value.map_or("–".to_owned(), |v| format!("{v:.digits$}"));
        let _ = write!(
            rows,
            "<tr><td>{}<td>{}<td>{}<td>{:.1}<td>{:.1}<td>{}<td>{:.2}<td>{:.2}<td>{}",
            escaped(&run.run),
            run.rows,
            run.stuck_rows,
            run.bias_w,
            run.rmse_w,
            number(run.r2, 3),
            run.recorded_j / 1e3,
            run.predicted_j / 1e3,
            number(run.normalized_error_percent, 1)
        );
    }
    rows
}

/// Residuals as dots, with the zero line and the ends of both axes.
fn scatter(label: &str, x: &[f64], y: &[f64]) -> String {
    let span = |values: &[f64]| {
        let low = values.iter().copied().fold(f64::INFINITY, f64::min);
        let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        if high > low { [low, high] } else { [low - 1.0, low + 1.0] }
    };
    let ([x0, x1], [y0, y1]) = (span(x), span(y));
    let px = |v: f64| MARGIN + (v - x0) / (x1 - x0) * (WIDTH - 2.0 * MARGIN);
    let py = |v: f64| HEIGHT - MARGIN / 2.0 - (v - y0) / (y1 - y0) * (HEIGHT - MARGIN);
    let every = x.len().div_ceil(MOST_POINTS).max(1);
    let mut dots = String::new();
    for (x, y) in x.iter().zip(y).step_by(every) {
        let _ = write!(dots, "M{:.1} {:.1}h0", px(*x), py(*y));
    }
    let zero = py(0f64.clamp(y0, y1));
    let (right, bottom) = (WIDTH - MARGIN, HEIGHT - 4.0);
    format!(
        "<figure style='display:inline-block;margin:.5em'><figcaption>{label}</figcaption><svg width={WIDTH} height={HEIGHT} \
         font-size=11><path d='M{MARGIN} {zero:.1}H{right}' stroke='#999'/><path d='{dots}' stroke='#06c' stroke-width=3 \
         stroke-linecap=round stroke-opacity=.4 fill=none /><text x=2 y=16>{y1:.0} W</text><text x=2 y={bottom}>{y0:.0} W</text><text x={MARGIN} \
         y={bottom}>{x0:.2}</text><text x={right} y={bottom} text-anchor=end>{x1:.2}</text></svg></figure>"
    )
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
