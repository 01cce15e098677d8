//! Power over the time driven, drives one after another.

use diagnosis::{Diagnosis, report::Trace};
use maud::{Markup, html};

use super::shaded::shaded;
use crate::axis::{Scale, extent, tick_text};

/// Width and height of the drawing, which is stretched to whatever room it has; labels stand beside it and keep their size.
const WIDTH: f64 = 1000.0;
const HEIGHT: f64 = 300.0;
/// Points of a line: more would overlap on its pixels.
const MOST_POINTS: usize = 420;

/// A line of a chart: its name, the class of its colour, and a value for every point of the trace [W].
struct Line<'a> {
    name: &'a str,
    class: &'a str,
    values_w: Vec<f64>,
}

/// Recorded power and what the robot file predicts.
pub(super) fn recorded_and_file(found: &Diagnosis) -> Markup {
    let trace = &found.trace;
    let lines = [
        Line { name: "recorded", class: "recorded", values_w: trace.recorded_w.clone() },
        Line { name: "predicted by the robot file", class: "file", values_w: trace.filed_w.clone() },
    ];
    chart(found, "Recorded power and prediction of the robot file over time", &lines)
}

/// Recorded less predicted power, of the robot file and of the corrected model.
pub(super) fn errors(found: &Diagnosis) -> Markup {
    let trace = &found.trace;
    let fitted = if found.findings.is_empty() { "refitted robot" } else { "corrected model" };
    let error_w =
        |predicted_w: &[f64]| trace.recorded_w.iter().zip(predicted_w).map(|(r, p)| r - p).collect();
    let lines = [
        Line { name: "robot file", class: "file", values_w: error_w(&trace.filed_w) },
        Line { name: fitted, class: "corrected", values_w: error_w(&trace.corrected_w) },
    ];
    chart(found, "Recorded less predicted power over time", &lines)
}

fn chart(found: &Diagnosis, label: &str, lines: &[Line<'_>]) -> Markup {
    let trace = &found.trace;
    if trace.t_s.is_empty() {
        return html! {};
    }
    let every = trace.t_s.len().div_ceil(MOST_POINTS).max(1);
    let thin: Vec<Vec<f64>> = lines.iter().map(|line| means(&line.values_w, every)).collect();
    let time = Scale { values: [0.0, trace.t_s.len() as f64], pixels: [0.0, WIDTH] };
    let [low_w, high_w] = extent(thin.iter().flatten().copied().chain([0.0]));
    let margin_w = 0.04 * (high_w - low_w);
    let power = Scale { values: [low_w - margin_w, high_w + margin_w], pixels: [HEIGHT, 0.0] };
    let shades = shaded(found);
    html! {
        figure {
            figcaption {
                b { (label) }
                span.key {
                    @for line in lines { span { i class={ "stroke " (line.class) } {} (line.name) } }
                    @if !shades.is_empty() { span { i.shade {} "where they differ" } }
                }
            }
            div.plot {
                svg viewBox={ "0 0 " (WIDTH) " " (HEIGHT) } preserveAspectRatio="none" role="img" aria-label=(label) {
                    @for [from, to] in &shades {
                        rect.shade x=(one(time.pixel(*from))) width=(one(time.pixel(*to) - time.pixel(*from))) height=(HEIGHT) {}
                    }
                    (grid(trace, &time, &power))
                    @for (line, values_w) in lines.iter().zip(&thin) {
                        path class={ "line " (line.class) } d=(path(values_w, every, &time, &power)) {}
                    }
                }
                (tick_labels(&time, &power))
            }
        }
    }
}

/// Lines at round powers, and borders of drives.
fn grid(trace: &Trace, time: &Scale, power: &Scale) -> Markup {
    let borders = (1..trace.run.len()).filter(|i| trace.run[*i] != trace.run[i - 1]);
    html! {
        @for w in power.ticks(4.0) {
            path.grid.zero[w == 0.0] d={ "M0 " (one(power.pixel(w))) "H" (WIDTH) } {}
        }
        @for i in borders { path.border d={ "M" (one(time.pixel(i as f64))) " 0V" (HEIGHT) } {} }
    }
}

/// Round powers at the left and round times below.
fn tick_labels(time: &Scale, power: &Scale) -> Markup {
    html! {
        @for w in power.ticks(4.0) {
            span.tick-y aria-hidden="true" style={ "top:" (one(100.0 * power.pixel(w) / HEIGHT)) "%" } { (tick_text(w)) " W" }
        }
        @for s in time.ticks(5.0) {
            span.tick-x aria-hidden="true" style={ "left:" (one(100.0 * time.pixel(s) / WIDTH)) "%" } { (tick_text(s)) " s" }
        }
    }
}

fn path(values_w: &[f64], every: usize, time: &Scale, power: &Scale) -> String {
    let point = |(j, w): (usize, &f64)| {
        let second = (j * every) as f64 + every as f64 / 2.0;
        let letter = if j == 0 { 'M' } else { 'L' };
        format!("{letter}{:.1} {:.1}", time.pixel(second), power.pixel(*w))
    };
    values_w.iter().enumerate().map(point).collect()
}

/// Means over so many points each.
fn means(values: &[f64], every: usize) -> Vec<f64> {
    values.chunks(every).map(|part| part.iter().sum::<f64>() / part.len() as f64).collect()
}

/// A pixel with one decimal.
fn one(pixel: f64) -> String {
    format!("{pixel:.1}")
}
