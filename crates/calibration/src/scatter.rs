//! Dots over two axes, as SVG.

use std::fmt::Write as _;

const WIDTH: f64 = 540.0;
const HEIGHT: f64 = 230.0;
/// Space for the numbers at the left, and below.
const MARGIN: f64 = 56.0;
const FOOT: f64 = 22.0;
/// Points of a plot: more would only overlap on its 480 pixels.
const MOST_POINTS: usize = 1500;
/// Colours that the colour-blind tell apart: M. Okabe & K. Ito (2008), *Color Universal Design*; the yellow is darkened for white paper.
const COLOURS: [&str; 6] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#a08000", "#56b4e9"];

/// A plot of y over x, coloured by group.
pub(crate) struct Scatter<'a> {
    /// What x is.
    pub(crate) label: &'a str,
    pub(crate) x: &'a [f64],
    /// Watts.
    pub(crate) y: &'a [f64],
    pub(crate) group: &'a [usize],
}

impl Scatter<'_> {
    /// The colour of a group.
    pub(crate) fn colour(group: usize) -> &'static str {
        COLOURS[group % COLOURS.len()]
    }

    /// A figure with its caption.
    pub(crate) fn svg(&self) -> String {
        let ([x0, x1], [y0, y1]) = (span(self.x), span(self.y));
        let px = |v: f64| MARGIN + (v - x0) / (x1 - x0) * (WIDTH - MARGIN - 20.0);
        let py = |v: f64| HEIGHT - FOOT - (v - y0) / (y1 - y0) * (HEIGHT - FOOT - 10.0);
        let mut axes = String::new();
        for y in ticks(y0, y1) {
            let (at, shade) = (py(y), if y == 0.0 { "#666" } else { "#ddd" });
            let _ = write!(
                axes,
                "<path d='M{MARGIN} {at:.1}H{WIDTH}' stroke='{shade}'/><text x={:.0} y={:.1} text-anchor=end>{y} W</text>",
                MARGIN - 4.0,
                at + 4.0
            );
        }
        for x in ticks(x0, x1) {
            let _ = write!(
                axes,
                "<text x={:.1} y={:.0} text-anchor=middle>{}</text>",
                px(x),
                HEIGHT - 6.0,
                (x * 1e6).round() / 1e6
            );
        }
        let every = self.x.len().div_ceil(MOST_POINTS).max(1);
        let mut dots = vec![String::new(); self.group.iter().max().map_or(0, |g| g + 1)];
        for i in (0..self.x.len()).step_by(every) {
            let _ = write!(dots[self.group[i]], "M{:.1} {:.1}h0", px(self.x[i]), py(self.y[i]));
        }
        let dots: String = dots
            .iter()
            .enumerate()
            .map(|(group, path)| format!("<path d='{path}' stroke='{}'/>", Self::colour(group)))
            .collect();
        format!(
            "<figure><figcaption>{}</figcaption><svg width={WIDTH} height={HEIGHT} font-size=11>{axes}<g stroke-width=3 stroke-linecap=round \
             stroke-opacity=.45 fill=none>{dots}</g></svg></figure>",
            self.label
        )
    }
}

fn span(values: &[f64]) -> [f64; 2] {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    match high - low {
        wide if wide > 0.0 => [low, high],
        0.0 => [low - 1.0, low + 1.0],
        _ => [-1.0, 1.0],
    }
}

/// Round numbers, three to seven of them, within a span.
fn ticks(low: f64, high: f64) -> Vec<f64> {
    let rough = (high - low) / 5.0;
    let power = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0].map(|m| m * power).into_iter().find(|s| *s >= rough).unwrap_or(rough);
    let first = (low / step).ceil() as i64;
    let last = (high / step).floor() as i64;
    (first..=last).map(|i| i as f64 * step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_inside() {
        assert_eq!(ticks(-185.0, 248.0), [-100.0, 0.0, 100.0, 200.0]);
        assert_eq!(ticks(0.0, 10.0), [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]);
    }

    #[test]
    fn nothing_recorded_draws_an_empty_plot() {
        let svg = Scatter { label: "none", x: &[], y: &[], group: &[] }.svg();
        assert!(svg.contains("none") && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}
