//! The sixteen headings whose straight lines run from cell centre to cell centre.

use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// Number of headings.
pub const HEADINGS: usize = 16;

/// Largest heading of a question: a full turn, 2π rounded up, either way [rad]. Degrees are nearly always beyond it.
pub(crate) const MAX_HEADING_RAD: f64 = 6.3;

/// Columns and rows to the next cell centre straight ahead, counter-clockwise from east.
const STEPS: [(i32, i32); HEADINGS] = [
    (1, 0),
    (2, 1),
    (1, 1),
    (1, 2),
    (0, 1),
    (-1, 2),
    (-1, 1),
    (-2, 1),
    (-1, 0),
    (-2, -1),
    (-1, -1),
    (-1, -2),
    (0, -1),
    (1, -2),
    (1, -1),
    (2, -1),
];

/// One of the sixteen headings, 0 east, counted counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Heading(u8);

impl Heading {
    /// All headings in order.
    pub fn all() -> impl Iterator<Item = Heading> {
        (0..HEADINGS as u8).map(Heading)
    }

    /// The heading of an index, taken round the circle.
    pub fn new(index: usize) -> Self {
        Heading((index % HEADINGS) as u8)
    }

    /// Position in the order of [`Heading::all`].
    pub fn index(self) -> usize {
        usize::from(self.0)
    }

    /// Columns and rows to the next cell centre straight ahead.
    pub fn step(self) -> (i32, i32) {
        STEPS[self.index()]
    }

    /// Direction, counter-clockwise from east, −π to π [rad].
    pub fn angle_rad(self) -> f64 {
        let (columns, rows) = self.step();
        f64::from(rows).atan2(f64::from(columns))
    }

    /// The heading `turns` places further to the left.
    pub fn turned(self, turns: i32) -> Self {
        Heading((i32::from(self.0) + turns).rem_euclid(HEADINGS as i32) as u8)
    }

    /// The heading closest to a direction.
    pub fn nearest(angle_rad: f64) -> Self {
        let turned_rad = turn_rad(0.0, angle_rad);
        let beyond =
            |angle_rad: f64| HALF_WAY_RAD.iter().filter(|half_way_rad| angle_rad > **half_way_rad).count();
        let off_rad = turned_rad.abs();
        let index = if off_rad > FRAC_PI_2 { HEADINGS / 2 - beyond(PI - off_rad) } else { beyond(off_rad) };
        Heading::new(if turned_rad < 0.0 { HEADINGS - index } else { index })
    }
}

/// Directions half way between neighbouring headings of the first quadrant [rad]; arctan ½ is the second heading.
const HALF_WAY_RAD: [f64; 4] = {
    const ARCTAN_HALF: f64 = 0.463_647_609_000_806_1;
    [
        ARCTAN_HALF / 2.0,
        (ARCTAN_HALF + FRAC_PI_4) / 2.0,
        (FRAC_PI_4 + FRAC_PI_2 - ARCTAN_HALF) / 2.0,
        FRAC_PI_2 - ARCTAN_HALF / 2.0,
    ]
};

/// The turn from one direction to another by the shorter way, −π to π [rad].
pub(crate) fn turn_rad(from_rad: f64, to_rad: f64) -> f64 {
    let turn = within_full_turn(to_rad - from_rad);
    if turn > PI { turn - TAU } else { turn }
}

/// The same direction, 0 to 2π [rad].
#[inline]
pub(crate) fn within_full_turn(angle_rad: f64) -> f64 {
    // By far the most are less than a full turn either way, and a division takes its time.
    match angle_rad {
        0.0..TAU => angle_rad,
        _ if -TAU < angle_rad && angle_rad < 0.0 => angle_rad + TAU,
        _ => angle_rad.rem_euclid(TAU),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn headings_go_once_round_counter_clockwise() {
        let turns: Vec<f64> =
            Heading::all().map(|h| turn_rad(h.angle_rad(), h.turned(1).angle_rad())).collect();
        assert!(turns.iter().all(|t| (0.3..0.5).contains(t)), "{turns:?}");
        assert!((turns.iter().sum::<f64>() - std::f64::consts::TAU).abs() < 1e-12);
    }

    #[test]
    fn the_nearest_heading_is_that_of_the_least_turn() {
        for i in -5000..5000 {
            let angle_rad = f64::from(i) * 0.004_1;
            let off_rad = |h: Heading| turn_rad(h.angle_rad(), angle_rad).abs();
            let least_rad = Heading::all().map(off_rad).fold(f64::INFINITY, f64::min);
            assert!(off_rad(Heading::nearest(angle_rad)) <= least_rad + 1e-12, "{angle_rad}");
        }
    }

    #[test]
    fn every_heading_is_the_nearest_to_itself_and_to_a_small_turn_from_it() {
        for h in Heading::all() {
            assert_eq!(Heading::nearest(h.angle_rad() + 0.1 + std::f64::consts::TAU), h);
            assert_eq!(h.turned(5).turned(-5), h);
        }
    }
}
