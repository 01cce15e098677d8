//! The path from above, coloured by the error of the robot file.

use diagnosis::{
    Diagnosis,
    report::{Range, Trace},
};
use maud::{Markup, html};

/// Width and height of the ground drawn, at most.
const SIDE: f64 = 360.0;
const MARGIN: f64 = 10.0;
/// Dots of a map: more would overlap.
const MOST_DOTS: usize = 1500;

/// Ground onto pixels, north up.
struct Projection {
    low_m: [f64; 2],
    high_m: [f64; 2],
    pixels_per_m: f64,
}

impl Projection {
    /// Of all positions; none where there is no extent.
    fn of(positions_m: &[[f64; 2]]) -> Option<Self> {
        let end = |axis: usize, pick: fn(f64, f64) -> f64, start: f64| {
            positions_m.iter().map(|at| at[axis]).fold(start, pick)
        };
        let low_m = [0, 1].map(|axis| end(axis, f64::min, f64::INFINITY));
        let high_m = [0, 1].map(|axis| end(axis, f64::max, f64::NEG_INFINITY));
        let extent_m = (high_m[0] - low_m[0]).max(high_m[1] - low_m[1]);
        (extent_m.is_finite() && extent_m > 0.0).then(|| Projection {
            low_m,
            high_m,
            pixels_per_m: (SIDE - 2.0 * MARGIN) / extent_m,
        })
    }

    fn pixel(&self, [x_m, y_m]: [f64; 2]) -> [f64; 2] {
        let Projection { low_m, high_m, pixels_per_m } = self;
        [MARGIN + (x_m - low_m[0]) * pixels_per_m, MARGIN + (high_m[1] - y_m) * pixels_per_m]
    }

    fn height(&self) -> f64 {
        2.0 * MARGIN + (self.high_m[1] - self.low_m[1]) * self.pixels_per_m
    }

    fn extent_m(&self) -> f64 {
        (SIDE - 2.0 * MARGIN) / self.pixels_per_m
    }
}

/// The map; none where no position was recorded.
pub(super) fn path_map(found: &Diagnosis) -> Option<Markup> {
    let trace = &found.trace;
    let points = points(trace);
    let positions_m: Vec<[f64; 2]> = points.iter().map(|(at, _)| *at).collect();
    let projection = Projection::of(&positions_m)?;
    let full_w = upper_error(&points);
    let every = points.len().div_ceil(MOST_DOTS).max(1);
    let caption = format!(
        "The path, north up, {:.0} m across. Full colour: the robot file is off by {full_w:.0} W or more.",
        projection.extent_m()
    );
    Some(html! {
        figure.map {
            svg viewBox={ "0 0 " (SIDE) " " (format!("{:.0}", projection.height())) } role="img"
                aria-label="The path from above, coloured by the error of the robot file" {
                @for region in found.places.iter().filter_map(|place| ground(&place.range, &projection)) { (region) }
                @for (position_m, error_w) in points.iter().step_by(every) {
                    @let [x, y] = projection.pixel(*position_m);
                    circle.dot cx=(format!("{x:.1}")) cy=(format!("{y:.1}")) r="2.4"
                        fill-opacity=(format!("{:.2}", 0.08 + 0.92 * (error_w / full_w).min(1.0))) {}
                }
            }
            figcaption.quiet { (caption) }
        }
    })
}

/// Positions with the size of the file's error there [W].
fn points(trace: &Trace) -> Vec<([f64; 2], f64)> {
    let errors_w = trace.recorded_w.iter().zip(&trace.filed_w).map(|(r, p)| (r - p).abs());
    trace.position_m.iter().zip(errors_w).filter_map(|(at, error_w)| Some(((*at)?, error_w))).collect()
}

/// The error that nineteen of twenty stay below [W].
fn upper_error(points: &[([f64; 2], f64)]) -> f64 {
    let mut errors_w: Vec<f64> = points.iter().map(|(_, error_w)| *error_w).collect();
    errors_w.sort_by(f64::total_cmp);
    errors_w.get(errors_w.len() * 95 / 100).map_or(1.0, |error_w| error_w.max(1e-9))
}

/// A rectangle over a part of the ground.
fn ground(range: &Range, projection: &Projection) -> Option<Markup> {
    let (x_m, y_m) = (range.x_m?, range.y_m?);
    let Projection { low_m, high_m, .. } = projection;
    let [left, top] = projection.pixel([x_m[0].unwrap_or(low_m[0]), y_m[1].unwrap_or(high_m[1])]);
    let [right, bottom] = projection.pixel([x_m[1].unwrap_or(high_m[0]), y_m[0].unwrap_or(low_m[1])]);
    Some(html! {
        rect.shade x=(format!("{left:.1}")) y=(format!("{top:.1}")) width=(format!("{:.1}", right - left))
            height=(format!("{:.1}", bottom - top)) {}
    })
}
