//! Windows in which an effect may act, on a grid of times and places.

use model::{KnownMechanism, mechanism::Mechanism};

use crate::{Region, Span, observe::observations::Observations};

/// Pieces of the time driven; windows begin and end between them, and refits move their edges within a piece.
pub(crate) const PIECES: usize = 15;
/// Parts that what was driven is cut into, in both directions; places are rectangles of them.
pub(crate) const PARTS: usize = 4;
/// Share of positions that may be strays, which must not stretch the grid of places.
const STRAY: f64 = 0.01;
/// Drives that went less far have no places \[m\]: a part is then shorter than a robot.
const SHORTEST_M: f64 = 4.0;

/// A window on the grid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Window {
    /// All the time.
    Always,
    /// From a piece on.
    From(usize),
    /// Before a piece.
    Until(usize),
    /// In a rectangle of parts: first and end of columns and rows.
    Within([usize; 4]),
}

/// Windows that are looked at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Windows {
    /// All of them.
    All,
    /// All the time only: for what drives have in common.
    AlwaysOnly,
}

/// The grid of a set of drives.
pub(crate) struct Grid {
    /// Windows that are looked at.
    looked_at: Windows,
    /// Time driven at which each piece begins, and the end of the last [s].
    pub(crate) borders_s: Vec<f64>,
    /// When each drive begins [s].
    begins_s: Vec<f64>,
    /// What was driven, from west to east and south to north [m].
    extent_m: Option<[[f64; 2]; 2]>,
}

impl Grid {
    /// The grid of test drives: even pieces, and the beginnings of drives where they are few.
    pub(crate) fn new(observed: &Observations<'_>, looked_at: Windows) -> Self {
        let total_s = observed.total_s();
        let mut borders_s: Vec<f64> = (0..=PIECES).map(|i| total_s * i as f64 / PIECES as f64).collect();
        let drives = observed.begins_s.len() - 1;
        if (2..=PIECES).contains(&drives) {
            borders_s.extend(&observed.begins_s[1..drives]);
            borders_s.sort_by(f64::total_cmp);
            borders_s.dedup_by(|a, b| (*a - *b).abs() < 1.0);
        }
        Grid { looked_at, borders_s, begins_s: observed.begins_s.clone(), extent_m: extent_m(observed) }
    }

    /// Number of pieces.
    pub(crate) fn pieces(&self) -> usize {
        self.borders_s.len() - 1
    }

    /// Piece of a time driven.
    pub(crate) fn piece(&self, driven_s: f64) -> usize {
        let after = self.borders_s.partition_point(|border_s| *border_s <= driven_s);
        after.saturating_sub(1).min(self.pieces() - 1)
    }

    /// Part of a position, by column and row; none where it is unknown.
    pub(crate) fn part(&self, position_m: [f64; 2]) -> Option<[usize; 2]> {
        let extent_m = self.extent_m?;
        if position_m.iter().any(|m| !m.is_finite()) {
            return None;
        }
        Some(std::array::from_fn(|axis| {
            let [low, high] = extent_m[axis];
            let share = (position_m[axis] - low) / (high - low);
            ((share * PARTS as f64).max(0.0) as usize).min(PARTS - 1)
        }))
    }

    /// Windows of a mechanism, each with its log prior: half for all the time, half shared by the others.
    pub(crate) fn windows(&self, mechanism: &dyn Mechanism) -> Vec<(Window, f64)> {
        if !mechanism.is_windowed() || self.looked_at == Windows::AlwaysOnly {
            return vec![(Window::Always, 0.0)];
        }
        let inner = 1..self.pieces();
        let from: Vec<Window> = inner.clone().map(Window::From).collect();
        // Ground is left behind, and come back to.
        let is_of_ground = KnownMechanism::is_of_ground(mechanism);
        let until: Vec<Window> = inner.filter(|_| is_of_ground).map(Window::Until).collect();
        let places: Vec<Window> = self.places().filter(|_| is_of_ground).collect();
        let mut kinds = vec![vec![Window::Always], from];
        kinds.extend([until, places].into_iter().filter(|kind| !kind.is_empty()));
        // Half always, the other half shared by the kinds of windows.
        let others = (kinds.len() - 1) as f64;
        let share =
            |k: usize, count: usize| 0.5_f64.ln() - if k == 0 { 0.0 } else { (others * count as f64).ln() };
        let of_kind = |(k, kind): (usize, Vec<Window>)| {
            let each = share(k, kind.len());
            kind.into_iter().map(move |window| (window, each))
        };
        kinds.into_iter().enumerate().flat_map(of_kind).collect()
    }

    /// Rectangles of parts, all of them not among them.
    fn places(&self) -> impl Iterator<Item = Window> {
        let parts = if self.extent_m.is_some() { PARTS } else { 0 };
        let ranges = move || (0..parts).flat_map(move |from| (from + 1..=parts).map(move |to| [from, to]));
        let pairs = ranges().flat_map(move |x| ranges().map(move |y| [x[0], x[1], y[0], y[1]]));
        pairs.filter(move |window| *window != [0, parts, 0, parts]).map(Window::Within)
    }

    /// The span of a window, for the forward model.
    pub(crate) fn span(&self, window: Window) -> Span {
        match window {
            Window::Always => Span::ALL,
            Window::From(piece) => self.onward(self.borders_s[piece]),
            Window::Until(piece) => match self.onward(self.borders_s[piece]) {
                Span::From { run, t_s } => Span::Until { run, t_s },
                other => other,
            },
            Window::Within([west, east, south, north]) => {
                let edges = |axis: usize, from: usize, to: usize| {
                    let [low, high] = self.extent_m.map_or([0.0; 2], |extent_m| extent_m[axis]);
                    let at = |part: usize| low + (high - low) * part as f64 / PARTS as f64;
                    [
                        if from == 0 { f64::NEG_INFINITY } else { at(from) },
                        if to == PARTS { f64::INFINITY } else { at(to) },
                    ]
                };
                Span::Within(Region { x_m: edges(0, west, east), y_m: edges(1, south, north) })
            }
        }
    }

    /// From a time driven on.
    pub(crate) fn onward(&self, driven_s: f64) -> Span {
        let last = self.begins_s.len() - 2;
        let run = self.begins_s.partition_point(|begin_s| *begin_s <= driven_s).saturating_sub(1).min(last);
        Span::From { run, t_s: driven_s - self.begins_s[run] }
    }
}

impl Window {
    /// Whether it holds a piece and a part.
    pub(crate) fn holds(self, piece: usize, part: Option<[usize; 2]>) -> bool {
        match self {
            Window::Always => true,
            Window::From(first) => piece >= first,
            Window::Until(end) => piece < end,
            Window::Within([west, east, south, north]) => {
                part.is_some_and(|[x, y]| (west..east).contains(&x) && (south..north).contains(&y))
            }
        }
    }
}

/// What the test drives went through but for strays; none where half of the positions are unknown or it hardly moved.
fn extent_m(observed: &Observations<'_>) -> Option<[[f64; 2]; 2]> {
    let rows = || (0..observed.test_rows).filter(|i| observed.averages()[*i].channel == 0);
    let known: Vec<[f64; 2]> = rows()
        .map(|i| observed.averages()[i].input.position_m)
        .filter(|at| at.iter().all(|m| m.is_finite()))
        .collect();
    if known.is_empty() || 2 * known.len() < rows().count() {
        return None;
    }
    let extent_m = [0, 1].map(|axis| {
        let mut values: Vec<f64> = known.iter().map(|at| at[axis]).collect();
        values.sort_by(f64::total_cmp);
        let at = |share: f64| values[(share * (values.len() - 1) as f64).round() as usize];
        [at(STRAY), at(1.0 - STRAY)]
    });
    extent_m.iter().all(|[low, high]| high - low > SHORTEST_M).then_some(extent_m)
}

#[cfg(test)]
mod tests {
    use model::mechanism;

    use super::*;

    fn grid(extent_m: Option<[[f64; 2]; 2]>) -> Grid {
        let borders_s = (0..=PIECES).map(|i| 20.0 * i as f64).collect();
        Grid { looked_at: Windows::All, borders_s, begins_s: vec![0.0, 130.0, 300.0], extent_m }
    }

    #[test]
    fn windows_share_one_prior_half_of_which_is_for_all_the_time() {
        for extent_m in [None, Some([[0.0, 8.0], [0.0, 8.0]])] {
            for mechanism in mechanism::ALL {
                let windows = grid(extent_m).windows(mechanism);
                let total: f64 = windows.iter().map(|(_, log)| log.exp()).sum();
                assert!((total - 1.0).abs() < 1e-9, "{} {total}", mechanism.name());
                let expected = if mechanism.is_windowed() { 0.5 } else { 1.0 };
                assert!((windows[0].1.exp() - expected).abs() < 1e-9 && windows[0].0 == Window::Always);
            }
        }
    }

    #[test]
    fn a_span_acts_where_its_window_holds() {
        let grid = grid(Some([[0.0, 8.0], [0.0, 8.0]]));
        let soil = mechanism::by_name("soft_soil").unwrap();
        for (window, _) in grid.windows(soil) {
            let span = grid.span(window);
            for driven_s in [5.0, 95.0, 131.0, 175.0, 290.0] {
                for at_m in [[1.0, 1.0], [5.0, 7.5], [-3.0, 20.0]] {
                    let run = usize::from(driven_s > 130.0);
                    let t_s = driven_s - grid.begins_s[run];
                    let holds = window.holds(grid.piece(driven_s), grid.part(at_m));
                    assert_eq!(span.acts(run, t_s, at_m), holds, "{window:?} {driven_s} s {at_m:?}");
                }
            }
        }
    }
}
