//! The drawings of the report's page.

use std::fmt::Write as _;

use crate::{
    report::{Diagnosis, Place, Range, Trace},
    span::{Span, Timeline},
};

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 300.0;
const LEFT: f64 = 64.0;
const RIGHT: f64 = 10.0;
const TOP: f64 = 30.0;
const BOTTOM: f64 = 30.0;
/// Points of a line: more would overlap on its 830 pixels.
const MOST_POINTS: usize = 420;

/// A line of a drawing: its name, colour, width and values by second.
struct Line<'a> {
    name: &'a str,
    color: &'a str,
    width: f64,
    values: Vec<f64>,
}

/// Recorded, predicted and corrected power over the time driven, drives behind one another, with the shaded times that differ.
pub(crate) fn power(found: &Diagnosis) -> String {
    let trace = &found.trace;
    let line = |name, color, width, values: &[f64]| Line { name, color, width, values: values.to_vec() };
    let lines = [
        line("recorded", "--recorded", 3.0, &trace.recorded_w),
        line("predicted from the robot’s file", "--filed", 1.4, &trace.filed_w),
        line("corrected model", "--corrected", 1.4, &trace.corrected_w),
    ];
    over_time(found, "Recorded, predicted and corrected power over time", HEIGHT, &lines)
}

/// What the robot's file and the corrected model leave of the recorded power.
pub(crate) fn differences(found: &Diagnosis) -> String {
    let trace = &found.trace;
    let left = |predicted: &[f64]| trace.recorded_w.iter().zip(predicted).map(|(r, p)| r - p).collect();
    let lines = [
        Line {
            name: "the robot’s file is off by",
            color: "--filed",
            width: 1.6,
            values: left(&trace.filed_w),
        },
        Line {
            name: "corrected model is off by",
            color: "--corrected",
            width: 1.6,
            values: left(&trace.corrected_w),
        },
    ];
    over_time(found, "What the robot’s file and the corrected model are off by", 0.65 * HEIGHT, &lines)
}

fn over_time(found: &Diagnosis, label: &str, height: f64, lines: &[Line<'_>]) -> String {
    let trace = &found.trace;
    let every = trace.t_s.len().div_ceil(MOST_POINTS).max(1);
    let thin: Vec<Vec<f64>> = lines.iter().map(|line| thinned(&line.values, every)).collect();
    let all = || thin.iter().flatten().copied();
    let (low, high) = (all().fold(0.0, f64::min), all().fold(1.0, f64::max));
    let px = |second: f64| LEFT + second / trace.t_s.len().max(1) as f64 * (WIDTH - LEFT - RIGHT);
    let py = |w: f64| height - BOTTOM - (w - low) / (high - low) * (height - TOP - BOTTOM);
    let mut inside = String::new();
    for [from, to] in shaded(trace, &found.places) {
        let (x, width, room) = (px(from), px(to) - px(from), height - TOP - BOTTOM);
        let _ =
            write!(inside, "<rect x={x:.1} y={TOP} width={width:.1} height={room:.1} fill='var(--shade)'/>");
    }
    inside += &axes(trace, [low, high], height, &px, &py);
    let mut x = LEFT;
    for (line, values) in lines.iter().zip(&thin) {
        let mut path = String::new();
        for (j, w) in values.iter().enumerate() {
            let second = (j * every) as f64 + every as f64 / 2.0;
            let _ = write!(path, "{}{:.1} {:.1}", if j == 0 { 'M' } else { 'L' }, px(second), py(*w));
        }
        let Line { name, color, width, .. } = line;
        let _ = write!(
            inside,
            "<path d='{path}' fill=none stroke='var({color})' stroke-width={width} /><path d='M{x} 12h22' stroke='var({color})' \
             stroke-width=4 /><text x={} y=16>{name}</text>",
            x + 28.0
        );
        x += 60.0 + 7.0 * name.chars().count() as f64;
    }
    if !shaded(trace, &found.places).is_empty() {
        let _ = write!(
            inside,
            "<rect x={x} y=5 width=22 height=14 fill='var(--shade)'/><text x={} y=16>where they differ</text>",
            x + 28.0
        );
    }
    format!("<svg viewBox='0 0 {WIDTH} {height}' role=img aria-label='{label}'>{inside}</svg>")
}

/// The way driven, darker where the recording and the robot's file differ more, with shaded places; nothing where no position was
/// recorded.
pub(crate) fn way(found: &Diagnosis) -> String {
    const SIDE: f64 = 360.0;
    let trace = &found.trace;
    let off_w = |i: usize| (trace.recorded_w[i] - trace.filed_w[i]).abs();
    let points: Vec<([f64; 2], f64)> =
        (0..trace.t_s.len()).filter_map(|i| Some((trace.position_m[i]?, off_w(i)))).collect();
    let end = |axis: usize, pick: fn(f64, f64) -> f64, from: f64| {
        points.iter().map(|(at, _)| at[axis]).fold(from, pick)
    };
    let low = [0, 1].map(|axis| end(axis, f64::min, f64::INFINITY));
    let high = [0, 1].map(|axis| end(axis, f64::max, f64::NEG_INFINITY));
    let extent_m = (high[0] - low[0]).max(high[1] - low[1]);
    if points.is_empty() || !extent_m.is_finite() || extent_m <= 0.0 {
        return String::new();
    }
    let mut sizes: Vec<f64> = points.iter().map(|(_, w)| *w).collect();
    sizes.sort_by(f64::total_cmp);
    let most_w = sizes[sizes.len() * 95 / 100].max(1e-9);
    let scale = (SIDE - 20.0) / extent_m;
    let at = |[x, y]: [f64; 2]| [10.0 + (x - low[0]) * scale, 10.0 + (high[1] - y) * scale];
    let mut dots: String =
        found.places.iter().filter_map(|place| shaded_ground(&place.range, [low, high], &at)).collect();
    for (position_m, w) in &points {
        let [px, py] = at(*position_m);
        let share = (w / most_w).min(1.0);
        let _ = write!(
            dots,
            "<circle cx={px:.1} cy={py:.1} r=2.4 fill='var(--filed)' fill-opacity={:.2} />",
            0.08 + 0.92 * share
        );
    }
    let height = 20.0 + (high[1] - low[1]) * scale;
    format!(
        "<figure><svg viewBox='0 0 {SIDE} {height:.0}' style='max-width:{SIDE}px' role=img aria-label='The way driven'>{dots}</svg>\
         <figcaption class=quiet>The way driven, north up, {extent_m:.0} m across: the stronger the colour, the more recorded power and \
         the robot’s file differ there.</figcaption></figure>"
    )
}

/// A rectangle over a part of the ground.
fn shaded_ground(
    range: &Range,
    [low, high]: [[f64; 2]; 2],
    at: &dyn Fn([f64; 2]) -> [f64; 2],
) -> Option<String> {
    let (x_m, y_m) = (range.x_m?, range.y_m?);
    let [left, top] = at([x_m[0].unwrap_or(low[0]), y_m[1].unwrap_or(high[1])]);
    let [right, bottom] = at([x_m[1].unwrap_or(high[0]), y_m[0].unwrap_or(low[1])]);
    let (width, height) = (right - left, bottom - top);
    Some(format!("<rect x={left:.1} y={top:.1} width={width:.1} height={height:.1} fill='var(--shade)'/>"))
}

/// Means over so many seconds each.
fn thinned(values: &[f64], every: usize) -> Vec<f64> {
    values.chunks(every).map(|part| part.iter().sum::<f64>() / part.len() as f64).collect()
}

/// Ranges of seconds driven in which a place of time lies.
fn shaded(trace: &Trace, places: &[Place]) -> Vec<[f64; 2]> {
    let seconds = trace.run.iter().copied().zip(trace.t_s.iter().copied());
    let line = Timeline::of(trace.runs.len(), seconds);
    let mut ranges: Vec<[f64; 2]> = Vec::new();
    for place in places.iter().filter(|place| place.kind == "time") {
        let range = &place.range;
        let is_inside = |i: usize| {
            let t_s = if range.quantity == "driven_s" {
                line.driven_s(Span::From { run: trace.run[i], t_s: trace.t_s[i] })
            } else {
                trace.t_s[i]
            };
            let own = range.name.as_ref().is_none_or(|name| trace.runs.get(trace.run[i]) == Some(name));
            own && range.from.is_none_or(|from| t_s >= from) && range.to.is_none_or(|to| t_s < to)
        };
        let inside: Vec<usize> = (0..trace.t_s.len()).filter(|i| is_inside(*i)).collect();
        if inside.len() == trace.t_s.len() {
            continue;
        }
        if let [first, .., last] = inside[..] {
            ranges.push([first as f64, last as f64 + 1.0]);
        }
    }
    ranges
}

/// Lines at round powers and times, and borders of drives.
fn axes(
    trace: &Trace,
    [low, high]: [f64; 2],
    height: f64,
    px: &dyn Fn(f64) -> f64,
    py: &dyn Fn(f64) -> f64,
) -> String {
    let mut text = String::new();
    let step_w = round_step((high - low) / 4.0);
    for w in round_values(low, high, step_w) {
        let y = py(w);
        let _ = write!(
            text,
            "<path d='M{LEFT} {y:.1}H{:.0}' stroke='var(--line)'/><text x={} y={:.1} text-anchor=end>{w:.0} W</text>",
            WIDTH - RIGHT,
            LEFT - 6.0,
            y + 4.0
        );
    }
    let seconds = trace.t_s.len() as f64;
    let step_s = round_step(seconds / 8.0);
    for i in 1..trace.run.len() {
        if trace.run[i] != trace.run[i - 1] {
            let x = px(i as f64);
            let _ = write!(
                text,
                "<path d='M{x:.1} {TOP}V{:.0}' stroke='var(--quiet)' stroke-dasharray=4 />",
                height - BOTTOM
            );
        }
    }
    for s in round_values(0.0, seconds, step_s) {
        let _ = write!(
            text,
            "<text x={:.1} y={:.0} text-anchor=middle>{s:.0} s</text>",
            px(s).min(WIDTH - 24.0),
            height - 10.0
        );
    }
    text
}

/// Most lines of an axis: a quarter of its range needs six.
const MOST_LINES: u32 = 20;

/// Multiples of a step from the first at or above a low end up to a high end; counted, so that their number is bounded whatever the
/// ends are.
fn round_values(low: f64, high: f64, step: f64) -> impl Iterator<Item = f64> {
    let first = (low / step).ceil();
    (0..MOST_LINES)
        .map(move |number| (first + f64::from(number)) * step + 0.0)
        .take_while(move |x| *x <= high)
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
