//! A quantity along paths.

use plotters::prelude::*;
use service::routes::plan::PoseAnswer;

use super::{Area, Drawn, FONT, Scene, draw_line, whole};

/// Length over which a profile is averaged [m].
const STRETCH_M: f64 = 10.0;

/// Draws a quantity against the distance along each path, as means over stretches.
pub(super) fn draw<DB: DrawingBackend>(
    area: &Area<DB>,
    caption: &str,
    scene: &Scene<'_>,
    value: impl Fn(&PoseAnswer) -> f64,
) -> Drawn<(), DB> {
    let profiles: Vec<Vec<(f64, f64)>> =
        scene.lines.iter().map(|line| stretches(&line.poses, &value)).collect();
    let caption = match scene.lines.iter().any(|line| is_long(&line.poses)) {
        true => format!("{caption}, averaged over {STRETCH_M} m"),
        false => caption.to_owned(),
    };
    let points = || profiles.iter().flatten();
    let longest_m = points().map(|p| p.0).fold(1.0, f64::max);
    let (low, high) = points().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p.1), h.max(p.1)));
    let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
    let room = (high - low).max(1e-3) * 0.06;
    let mut chart = ChartBuilder::on(area)
        .margin(12)
        .margin_right(30)
        .x_label_area_size(34)
        .y_label_area_size(54)
        .caption(caption, (FONT, 15))
        .build_cartesian_2d(0.0..longest_m, low - room..high + room)?;
    chart
        .configure_mesh()
        .light_line_style(TRANSPARENT)
        .bold_line_style(BLACK.mix(0.12))
        .x_label_formatter(&whole)
        .y_label_formatter(&|value| label(*value, high - low))
        .y_labels(6)
        .x_desc("metres along the path")
        .draw()?;
    if low < 0.0 && high > 0.0 {
        chart.draw_series(LineSeries::new([(0.0, 0.0), (longest_m, 0.0)], BLACK.mix(0.6)))?;
    }
    for (line, profile) in scene.lines.iter().zip(profiles) {
        draw_line(&mut chart, profile, line.entry.color().stroke_width(2), line.is_dashed)?;
    }
    Ok(())
}

/// A label of an axis that spans so much: with a decimal where whole numbers would repeat.
fn label(value: f64, span: f64) -> String {
    if span >= 6.0 { whole(&value) } else { format!("{value:.1}") }
}

/// Time-weighted means over stretches of the path, at their middle; values at the poses of a path that is too short for them.
fn stretches(poses: &[PoseAnswer], value: &impl Fn(&PoseAnswer) -> f64) -> Vec<(f64, f64)> {
    if !is_long(poses) {
        return poses.iter().skip(1).map(|pose| (pose.distance_m, value(pose))).collect();
    }
    let mut line = Vec::new();
    let (mut from_m, mut sum, mut time_s) = (0.0, 0.0, 0.0);
    for [before, now] in poses.array_windows() {
        let dt = now.t_s - before.t_s;
        sum += value(now) * dt;
        time_s += dt;
        if now.distance_m - from_m >= STRETCH_M && time_s > 0.0 {
            line.push(((from_m + now.distance_m) / 2.0, sum / time_s));
            (from_m, sum, time_s) = (now.distance_m, 0.0, 0.0);
        }
    }
    line
}

/// Whether a path has stretches enough to show how a quantity goes along it.
fn is_long(poses: &[PoseAnswer]) -> bool {
    const LEAST_STRETCHES: f64 = 5.0;
    poses.last().is_some_and(|last| last.distance_m >= LEAST_STRETCHES * STRETCH_M)
}
