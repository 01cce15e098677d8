//! Dots over two axes.

use maud::{Markup, html};

use crate::axis::{Scale, extent, tick_text};

const WIDTH: f64 = 540.0;
const HEIGHT: f64 = 230.0;
const LEFT: f64 = 62.0;
const RIGHT: f64 = 20.0;
const TOP: f64 = 10.0;
const BOTTOM: f64 = 24.0;
/// Points of a plot: more would only overlap.
const MOST_POINTS: usize = 1500;
/// Colours that the colour-blind tell apart: M. Okabe & K. Ito (2008), *Color Universal Design*, darkened for white paper or
/// lightened for dark screens.
const COLORS: [&str; 6] = [
    "light-dark(#0072b2,#56a8e0)",
    "light-dark(#c24f00,#ff8a3d)",
    "light-dark(#007a5a,#2ec79a)",
    "light-dark(#a8558a,#e39cc6)",
    "light-dark(#806600,#d9b93b)",
    "light-dark(#2f7fae,#8accf5)",
];

/// The colour of a group.
pub(super) fn color(group: usize) -> &'static str {
    COLORS[group % COLORS.len()]
}

/// A plot of power over a quantity, coloured by group.
pub(super) struct Scatter<'a> {
    /// What x is.
    pub(super) label: &'a str,
    pub(super) x: &'a [f64],
    pub(super) y_w: &'a [f64],
    pub(super) group: &'a [usize],
}

impl Scatter<'_> {
    /// A figure with its caption.
    pub(super) fn figure(&self) -> Markup {
        let x = Scale { values: extent(self.x.iter().copied()), pixels: [LEFT, WIDTH - RIGHT] };
        let y = Scale { values: extent(self.y_w.iter().copied()), pixels: [HEIGHT - BOTTOM, TOP] };
        html! {
            figure {
                figcaption { (self.label) }
                svg viewBox={ "0 0 " (WIDTH) " " (HEIGHT) } role="img" aria-label={ "Residuals over " (self.label) } {
                    (axes(&x, &y))
                    g.dots {
                        @for (group, path) in self.dots(&x, &y).iter().enumerate() {
                            path style={ "stroke:" (color(group)) } d=(path) {}
                        }
                    }
                }
            }
        }
    }

    /// The dots of each group, as one path of strokes without length.
    fn dots(&self, x: &Scale, y: &Scale) -> Vec<String> {
        let every = self.x.len().div_ceil(MOST_POINTS).max(1);
        let mut dots = vec![String::new(); self.group.iter().max().map_or(0, |greatest| greatest + 1)];
        for ((value, w), group) in self.x.iter().zip(self.y_w).zip(self.group).step_by(every) {
            dots[*group] += &format!("M{:.1} {:.1}h0", x.pixel(*value), y.pixel(*w));
        }
        dots
    }
}

fn axes(x: &Scale, y: &Scale) -> Markup {
    html! {
        @for w in y.ticks(5.0) {
            @let at = y.pixel(w);
            path.grid.zero[w == 0.0] d=(format!("M{LEFT} {at:.1}H{WIDTH}")) {}
            text x=(LEFT - 6.0) y=(format!("{:.1}", at + 4.0)) text-anchor="end" { (tick_text(w)) " W" }
        }
        @for value in x.ticks(5.0) {
            text x=(format!("{:.1}", x.pixel(value))) y=(HEIGHT - 6.0) text-anchor="middle" { (tick_text(value)) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_recorded_draws_an_empty_plot() {
        let svg = Scatter { label: "none", x: &[], y_w: &[], group: &[] }.figure().into_string();
        assert!(svg.contains("none") && !svg.contains("NaN") && !svg.contains("inf"), "{svg}");
    }
}
