//! The drawings of the report's page.

use std::fmt::Write as _;

use crate::report::{Diagnosis, Place, Trace};

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 52.0;
const RIGHT: f64 = 10.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 30.0;
/// Points of a line: more would overlap on its 840 pixels.
const MOST_POINTS: usize = 420;

/// Recorded, predicted and corrected power over the time driven, drives behind one another, with the shaded times that differ.
pub(crate) fn power(found: &Diagnosis) -> String {
    let trace = &found.trace;
    let every = trace.t_s.len().div_ceil(MOST_POINTS).max(1);
    let lines = [
        ("recorded", "--recorded", thinned(&trace.recorded_w, every)),
        ("the robot’s file", "--filed", thinned(&trace.filed_w, every)),
        ("corrected model", "--corrected", thinned(&trace.corrected_w, every)),
    ];
    let all = || lines.iter().flat_map(|(_, _, line)| line.iter().copied());
    let (low, high) = (all().fold(0.0, f64::min), all().fold(1.0, f64::max));
    let px = |second: f64| LEFT + second / trace.t_s.len().max(1) as f64 * (WIDTH - LEFT - RIGHT);
    let py = |w: f64| HEIGHT - BOTTOM - (w - low) / (high - low) * (HEIGHT - TOP - BOTTOM);
    let mut inside = String::new();
    for [from, to] in shaded(trace, &found.places) {
        let _ = write!(
            inside,
            "<rect x={:.1} y={TOP} width={:.1} height={:.1} fill='var(--shade)'/>",
            px(from),
            px(to) - px(from),
            HEIGHT - TOP - BOTTOM
        );
    }
    inside += &axes(trace, [low, high], &px, &py);
    for (i, (name, color, line)) in lines.iter().enumerate() {
        let mut path = String::new();
        for (j, w) in line.iter().enumerate() {
            let second = (j * every) as f64 + every as f64 / 2.0;
            let _ = write!(path, "{}{:.1} {:.1}", if j == 0 { 'M' } else { 'L' }, px(second), py(*w));
        }
        let width = if i == 0 { 3.0 } else { 1.4 };
        let _ = write!(inside, "<path d='{path}' fill=none stroke='var({color})' stroke-width={width} />");
        let x = LEFT + 150.0 * i as f64;
        let _ = write!(
            inside,
            "<path d='M{x} 12h22' stroke='var({color})' stroke-width=4 /><text x={} y=16>{name}</text>",
            x + 28.0
        );
    }
    if !shaded(trace, &found.places).is_empty() {
        let x = LEFT + 460.0;
        let _ = write!(
            inside,
            "<rect x={x} y=5 width=22 height=14 fill='var(--shade)'/><text x={} y=16>where they differ most</text>",
            x + 28.0
        );
    }
    let label = "Recorded, predicted and corrected power over time";
    format!("<svg viewBox='0 0 {WIDTH} {HEIGHT}' role=img aria-label='{label}'>{inside}</svg>")
}

/// Means over so many seconds each.
fn thinned(values: &[f64], every: usize) -> Vec<f64> {
    values.chunks(every).map(|part| part.iter().sum::<f64>() / part.len() as f64).collect()
}

/// Ranges of seconds driven in which a place of time lies.
fn shaded(trace: &Trace, places: &[Place]) -> Vec<[f64; 2]> {
    let mut ranges: Vec<[f64; 2]> = Vec::new();
    for place in places.iter().filter(|place| place.kind == "time" && place.share_of_excess < 1.0) {
        let range = &place.range;
        let is_inside = |i: usize| {
            let t_s = trace.t_s[i];
            let own = range.name.as_ref().is_none_or(|name| trace.runs.get(trace.run[i]) == Some(name));
            own && range.from.is_none_or(|from| t_s >= from) && range.to.is_none_or(|to| t_s < to)
        };
        let inside: Vec<usize> = (0..trace.t_s.len()).filter(|i| is_inside(*i)).collect();
        if let [first, .., last] = inside[..] {
            ranges.push([first as f64, last as f64 + 1.0]);
        }
    }
    ranges
}

/// Lines at round powers and times, and borders of drives.
fn axes(trace: &Trace, [low, high]: [f64; 2], px: &dyn Fn(f64) -> f64, py: &dyn Fn(f64) -> f64) -> String {
    let mut text = String::new();
    let step_w = round_step((high - low) / 4.0);
    let mut w = (low / step_w).ceil() * step_w;
    while w <= high {
        let y = py(w);
        let _ = write!(
            text,
            "<path d='M{LEFT} {y:.1}H{:.0}' stroke='var(--line)'/><text x={} y={:.1} text-anchor=end>{w:.0} W</text>",
            WIDTH - RIGHT,
            LEFT - 6.0,
            y + 4.0
        );
        w += step_w;
    }
    let seconds = trace.t_s.len() as f64;
    let step_s = round_step(seconds / 8.0);
    let drives = trace.runs.len();
    for i in 1..trace.run.len() {
        if trace.run[i] != trace.run[i - 1] {
            let x = px(i as f64);
            let _ = write!(
                text,
                "<path d='M{x:.1} {TOP}V{:.0}' stroke='var(--quiet)' stroke-dasharray=4 />",
                HEIGHT - BOTTOM
            );
        }
    }
    let mut s = 0.0;
    while s <= seconds {
        let _ = write!(
            text,
            "<text x={:.1} y={:.0} text-anchor=middle>{s:.0} s</text>",
            px(s).min(WIDTH - 24.0),
            HEIGHT - 10.0
        );
        s += step_s;
    }
    if drives > 1 {
        let _ = write!(
            text,
            "<text x={:.0} y=16 text-anchor=end>{drives} drives behind one another</text>",
            WIDTH - RIGHT
        );
    }
    text
}

/// 1, 2 or 5 times a power of ten.
fn round_step(about: f64) -> f64 {
    let power = 10f64.powf(about.max(1e-9).log10().floor());
    let times = about / power;
    power
        * if times < 1.5 {
            1.0
        } else if times < 3.5 {
            2.0
        } else if times < 7.5 {
            5.0
        } else {
            10.0
        }
}

/// Errors as bars: the robot's file, refitted, corrected, and the noise floor.
pub(crate) fn fits(found: &Diagnosis) -> String {
    let mut bars = vec![
        ("the robot’s file as it is", found.baseline.rmse_w, "--filed"),
        ("refitted, held out", found.baseline.held_out_rmse_w, "--filed"),
    ];
    if !found.findings.is_empty() {
        bars.push(("with what was found, held out", found.corrected.held_out_rmse_w, "--corrected"));
    }
    bars.push(("noise floor", found.baseline.noise_floor_w, "--recorded"));
    let most = bars.iter().map(|bar| bar.1).fold(1e-9, f64::max);
    let (from, room) = (210.0, 600.0);
    let mut inside = String::new();
    for (i, (name, w, color)) in bars.iter().enumerate() {
        let y = 28.0 * i as f64;
        let length = w / most * room;
        let _ = write!(
            inside,
            "<text x={} y={:.0} text-anchor=end>{name}</text><rect x={from} y={:.0} width={length:.1} height=18 rx=3 fill='var({color})'/>\
             <text x={:.1} y={:.0}>{w:.1} W</text>",
            from - 8.0,
            y + 17.0,
            y + 4.0,
            from + length + 8.0,
            y + 17.0
        );
    }
    let height = 28.0 * bars.len() as f64;
    format!(
        "<svg viewBox='0 0 {WIDTH} {height}' role=img aria-label='Errors before and after'>{inside}</svg>"
    )
}

/// Text that is safe between tags and in quoted attributes.
pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('\'', "&#39;")
}
