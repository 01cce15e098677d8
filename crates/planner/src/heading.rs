//! The sixteen headings whose straight lines run from cell centre to cell centre.

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
        let off = |h: &Heading| turn_rad(h.angle_rad(), angle_rad).abs();
        Heading::all().min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(Heading(0))
    }
}

/// The turn from one direction to another by the shorter way, −π to π [rad].
pub(crate) fn turn_rad(from_rad: f64, to_rad: f64) -> f64 {
    let turn = (to_rad - from_rad).rem_euclid(std::f64::consts::TAU);
    if turn > std::f64::consts::PI { turn - std::f64::consts::TAU } else { turn }
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
    fn every_heading_is_the_nearest_to_itself_and_to_a_small_turn_from_it() {
        for h in Heading::all() {
            assert_eq!(Heading::nearest(h.angle_rad() + 0.1 + std::f64::consts::TAU), h);
            assert_eq!(h.turned(5).turned(-5), h);
        }
    }
}
