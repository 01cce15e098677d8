//! The area that the robot's outline sweeps along a piece, covered by rectangles and by the cells that these overlap.
//!
//! The cover is conservative: every point of the outline lies in one of the rectangles at every moment. Nothing is sampled.
//! On a straight the outline sweeps a rectangle. On an arc and on the spot the piece is cut into parts, and of each part the
//! bounding rectangle is taken in the frame of the outline half way:
//!
//! ```text
//! |x| ≤ l + (R + w) sin h,   −w − l sin h ≤ y ≤ w + l sin h + R (1 − cos h)
//! ```
//!
//! l, w half length and width of the outline [m]; R radius of the path, 0 on the spot [m]; h half the part's turn, at most π/2
//! [rad]; x forwards, y towards the centre of turning. A point (a, b) of the outline that turns by φ about (0, R) comes to
//! (a cos φ + (R − b) sin φ, b cos φ + a sin φ + R (1 − cos φ)), from which the bounds follow with |a| ≤ l, |b| ≤ w, |φ| ≤ h.

use crate::{
    ground::{
        footprint::Footprint,
        spans::{Span, SpanUnion},
    },
    lattice::primitive::Piece,
    patience::{Pacer, work},
};

/// Clearance that the cover of a turn may give away, in cells.
const SLACK_CELLS: f64 = 0.25;
/// Largest half turn of a part [rad]: its square is small against 1, as [`half_turn_rad`] supposes.
const LARGEST_HALF_TURN_RAD: f64 = 0.25;
/// Overlaps of rectangle and cell that are rounding, in cells.
const ROUNDING_CELLS: f64 = 1e-9;

/// Work of one row of a cover: its ends and a run.
const ROW: u64 = 8 * work::CELL;

/// Every cell that the outline may touch along pieces; `None` when patience ends first.
pub(crate) fn sweep(
    pieces: &[Piece],
    outline: &Footprint,
    cell_size_m: f64,
    pacer: &mut Pacer<'_>,
) -> Option<Vec<Span>> {
    let mut union = SpanUnion::default();
    for piece in pieces {
        let swept = SweptPiece::new(piece, outline, cell_size_m);
        for part in 0..swept.parts() {
            let spans = swept.cover(part).spans(cell_size_m);
            pacer.after(spans.size_hint().1.unwrap_or(0) as u64 * ROW)?;
            spans.for_each(|span| union.add(span));
        }
    }
    Some(union.finish())
}

/// A rectangle under any heading.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Rectangle {
    /// Centre, x and y [m].
    pub(crate) center_m: [f64; 2],
    /// Cosine and sine of the heading.
    pub(crate) direction: [f64; 2],
    /// Half the extents along and across the heading [m].
    pub(crate) half_m: [f64; 2],
}

impl Rectangle {
    /// The outline of a robot in a pose.
    pub(crate) fn of(outline: &Footprint, [x_m, y_m, heading_rad]: [f64; 3]) -> Self {
        let (sin, cos) = heading_rad.sin_cos();
        let half_m = [outline.length_m / 2.0, outline.width_m / 2.0];
        Rectangle { center_m: [x_m, y_m], direction: [cos, sin], half_m }
    }

    /// The cells that it overlaps, a span for each row; cell (0, 0) has its centre at the origin.
    pub(crate) fn spans(&self, cell_size_m: f64) -> impl Iterator<Item = Span> + use<> {
        let corners = self.corners(cell_size_m);
        let norths = corners.map(|[_, north]| north);
        let rows = overlapped(extent(norths));
        (rows.0..=rows.1).filter_map(move |row| {
            let strip = (f64::from(row) - 0.5, f64::from(row) + 0.5);
            let (first, last) = overlapped(extent_within(&corners, strip)?);
            (first <= last).then_some(Span { row, first, last })
        })
    }

    /// Its corners in order round it, in cells.
    pub(crate) fn corners(&self, cell_size_m: f64) -> [[f64; 2]; 4] {
        let [cos, sin] = self.direction;
        [[1.0, 1.0], [-1.0, 1.0], [-1.0, -1.0], [1.0, -1.0]].map(|[along, across]| {
            let (along_m, across_m) = (along * self.half_m[0], across * self.half_m[1]);
            [
                (self.center_m[0] + along_m * cos - across_m * sin) / cell_size_m,
                (self.center_m[1] + along_m * sin + across_m * cos) / cell_size_m,
            ]
        })
    }
}

/// Smallest and largest of some numbers.
fn extent(values: [f64; 4]) -> (f64, f64) {
    values.into_iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
}

/// First and last cell of a row or column that an interval overlaps by more than rounding.
fn overlapped((low, high): (f64, f64)) -> (i32, i32) {
    let first = (low - 0.5 + ROUNDING_CELLS).floor() as i32 + 1;
    let last = (high + 0.5 - ROUNDING_CELLS).ceil() as i32 - 1;
    (first, last)
}

/// West and east end of the part of a convex polygon that lies between two norths; `None` where there is none.
fn extent_within(corners: &[[f64; 2]; 4], (south, north): (f64, f64)) -> Option<(f64, f64)> {
    let (mut west, mut east) = (f64::INFINITY, f64::NEG_INFINITY);
    for (i, &[x, y]) in corners.iter().enumerate() {
        let [next_x, next_y] = corners[(i + 1) % corners.len()];
        if y.max(next_y) < south || y.min(next_y) > north {
            continue;
        }
        let per_y = if next_y == y { 0.0 } else { (next_x - x) / (next_y - y) };
        for (end_x, end_y) in [(x, y), (next_x, next_y)] {
            let at = end_x + (end_y.clamp(south, north) - end_y) * per_y;
            (west, east) = (west.min(at), east.max(at));
        }
    }
    (west <= east).then_some((west, east))
}

/// A piece cut into parts of equal length and turn, each covered by one rectangle.
pub(crate) struct SweptPiece<'p> {
    piece: &'p Piece,
    half_m: [f64; 2],
    /// Half the turn of a part [rad].
    half_turn_rad: f64,
    parts: usize,
}

impl<'p> SweptPiece<'p> {
    /// The cover of a piece by an outline with as few rectangles as the slack allows.
    pub(crate) fn new(piece: &'p Piece, outline: &Footprint, cell_size_m: f64) -> Self {
        Self::with_parts(piece, outline, cell_size_m, f64::INFINITY)
    }

    /// The same with parts no longer than `longest_m`.
    pub(crate) fn with_parts(
        piece: &'p Piece,
        outline: &Footprint,
        cell_size_m: f64,
        longest_m: f64,
    ) -> Self {
        Self::with_slack(piece, outline, SLACK_CELLS * cell_size_m, longest_m)
    }

    /// The same with covers that reach no more than `slack_m` beyond what the outline sweeps.
    pub(crate) fn with_slack(piece: &'p Piece, outline: &Footprint, slack_m: f64, longest_m: f64) -> Self {
        let half_m = [outline.length_m / 2.0, outline.width_m / 2.0];
        let turn_rad = piece.turn_rad.abs();
        let by_turn = if turn_rad > 0.0 {
            let radius_m = piece.length_m / turn_rad;
            turn_rad / (2.0 * half_turn_rad(half_m, radius_m, slack_m))
        } else {
            0.0
        };
        let parts = by_turn.max(piece.length_m / longest_m).ceil().max(1.0);
        SweptPiece { piece, half_m, half_turn_rad: turn_rad / parts / 2.0, parts: parts as usize }
    }

    /// Number of parts.
    pub(crate) fn parts(&self) -> usize {
        self.parts
    }

    /// Length of a part [m].
    pub(crate) fn part_m(&self) -> f64 {
        self.piece.length_m / self.parts as f64
    }

    /// Where the robot's middle is half way along a part [m].
    pub(crate) fn middle_m(&self, part: usize) -> [f64; 2] {
        let [x_m, y_m, _] = self.middle(part);
        [x_m, y_m]
    }

    fn middle(&self, part: usize) -> [f64; 3] {
        self.piece.pose_at((part as f64 + 0.5) / self.parts as f64)
    }

    /// The rectangle that holds the outline all along a part.
    pub(crate) fn cover(&self, part: usize) -> Rectangle {
        let [x_m, y_m, heading_rad] = self.middle(part);
        let [half_length_m, half_width_m] = self.half_m;
        let (sin, cos) = heading_rad.sin_cos();
        let turn_rad = self.piece.turn_rad.abs();
        if turn_rad == 0.0 {
            let half_m = [half_length_m + self.part_m() / 2.0, half_width_m];
            return Rectangle { center_m: [x_m, y_m], direction: [cos, sin], half_m };
        }
        let radius_m = self.piece.length_m / turn_rad;
        let (sin_h, cos_h) = self.half_turn_rad.sin_cos();
        // The rectangle reaches further towards the centre of turning than away from it.
        let bulge_m = radius_m * (1.0 - cos_h);
        let inwards_m = self.piece.turn_rad.signum() * bulge_m / 2.0;
        Rectangle {
            center_m: [x_m - inwards_m * sin, y_m + inwards_m * cos],
            direction: [cos, sin],
            half_m: [
                half_length_m + (radius_m + half_width_m) * sin_h,
                half_width_m + half_length_m * sin_h + bulge_m / 2.0,
            ],
        }
    }
}

/// Half the turn of a part whose cover reaches no more than `slack_m` beyond what the outline sweeps [rad].
///
/// Sideways the excess is l sin h + R (1 − cos h), at the ends of the piece 2 w sin h + l (1 − cos h). With sin h ≤ h and
/// 1 − cos h ≤ h²/2 both are below e h + R h²/2, where e is the larger of l and 2 w + l h/2.
fn half_turn_rad([half_length_m, half_width_m]: [f64; 2], radius_m: f64, slack_m: f64) -> f64 {
    let at_ends_m = 2.0 * half_width_m + half_length_m * LARGEST_HALF_TURN_RAD / 2.0;
    let per_rad_m = half_length_m.max(at_ends_m);
    let root_m = (per_rad_m * per_rad_m + 2.0 * radius_m * slack_m).sqrt();
    (2.0 * slack_m / (per_rad_m + root_m)).min(LARGEST_HALF_TURN_RAD)
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;

    const HUSKY: Footprint = Footprint { length_m: 0.87, width_m: 0.705 };

    fn cells(rectangle: &Rectangle, cell_size_m: f64) -> Vec<(i32, i32)> {
        let spans = rectangle.spans(cell_size_m);
        spans.flat_map(|span| (span.first..=span.last).map(move |column| (column, span.row))).collect()
    }

    #[test]
    fn a_husky_across_its_own_cell_touches_that_cell_only_on_a_one_metre_grid() {
        for heading_rad in [0.0, std::f64::consts::FRAC_PI_2] {
            assert_eq!(cells(&Rectangle::of(&HUSKY, [0.0, 0.0, heading_rad]), 1.0), [(0, 0)]);
        }
    }

    #[test]
    fn an_outline_that_only_meets_the_edges_of_its_neighbours_does_not_overlap_them() {
        let square = Footprint { length_m: 3.0, width_m: 1.0 };
        let along = Rectangle::of(&square, [0.0, 0.0, 0.0]);
        assert_eq!(cells(&along, 1.0), [(-1, 0), (0, 0), (1, 0)]);
        let across = Rectangle::of(&square, [0.0, 0.0, std::f64::consts::FRAC_PI_2]);
        assert_eq!(cells(&across, 1.0), [(0, -1), (0, 0), (0, 1)]);
    }

    /// Whether an axis-aligned square overlaps a rectangle, by the directions of their edges (separating axes).
    fn overlaps(rectangle: &Rectangle, [x, y]: [f64; 2], side: f64) -> bool {
        let [cos, sin] = rectangle.direction;
        let [l, w] = rectangle.half_m;
        let (dx, dy) = (x - rectangle.center_m[0], y - rectangle.center_m[1]);
        let half = side / 2.0;
        let square = half * (sin.abs() + cos.abs());
        dx.abs() < l * cos.abs() + w * sin.abs() + half
            && dy.abs() < l * sin.abs() + w * cos.abs() + half
            && (dx * cos + dy * sin).abs() < l + square
            && (dy * cos - dx * sin).abs() < w + square
    }

    proptest! {
        #[test]
        fn a_rectangle_has_the_cells_that_no_direction_separates_from_it(
            x in -2.0f64..2.0, y in -2.0f64..2.0, heading in -4.0f64..4.0,
            length_m in 0.02f64..6.0, width_m in 0.02f64..6.0, cell_size_m in 0.1f64..3.0,
        ) {
            let rectangle = Rectangle::of(&Footprint { length_m, width_m }, [x, y, heading]);
            let found: BTreeSet<(i32, i32)> = cells(&rectangle, cell_size_m).into_iter().collect();
            let reach = ((length_m + width_m + 3.0) / cell_size_m).ceil() as i32 + 1;
            for column in -reach..=reach {
                for row in -reach..=reach {
                    let center = [f64::from(column) * cell_size_m, f64::from(row) * cell_size_m];
                    let margin = 1e-6 * cell_size_m;
                    let surely = overlaps(&rectangle, center, cell_size_m - margin);
                    let possibly = overlaps(&rectangle, center, cell_size_m + margin);
                    let held = found.contains(&(column, row));
                    prop_assert!(held >= surely && held <= possibly, "{column} {row}");
                }
            }
        }

        #[test]
        fn the_cover_holds_every_point_of_the_outline_and_little_more(
            length_m in 0.02f64..12.0, width_m in 0.02f64..12.0, cell_size_m in 0.02f64..30.0,
            path_m in 0.0f64..60.0, on_the_spot: bool, turn_rad in -7.0f64..7.0, straight: bool, heading_rad in -4.0f64..4.0,
            moment in 0.0f64..1.0, along in -0.5f64..0.5, across in -0.5f64..0.5,
        ) {
            prop_assume!(length_m.max(width_m) < 160.0 * cell_size_m);
            let outline = Footprint { length_m, width_m };
            let piece = Piece {
                start_m: [0.3, -0.2],
                heading_rad,
                length_m: if on_the_spot { 0.0 } else { path_m },
                turn_rad: if straight { 0.0 } else { turn_rad },
            };
            let swept = SweptPiece::new(&piece, &outline, cell_size_m);
            let part = ((moment * swept.parts() as f64) as usize).min(swept.parts() - 1);
            let cover = swept.cover(part);
            let [x, y, heading] = piece.pose_at(moment);
            let (a, b) = (along * length_m, across * width_m);
            let point = [x + a * heading.cos() - b * heading.sin(), y + a * heading.sin() + b * heading.cos()];
            let (dx, dy) = (point[0] - cover.center_m[0], point[1] - cover.center_m[1]);
            let [cos, sin] = cover.direction;
            prop_assert!((dx * cos + dy * sin).abs() <= cover.half_m[0] + 1e-9);
            prop_assert!((dy * cos - dx * sin).abs() <= cover.half_m[1] + 1e-9);
            // Sideways, the cover reaches beyond the outline by the slack on either side at most.
            let slack_m = SLACK_CELLS * cell_size_m;
            prop_assert!(2.0 * cover.half_m[1] <= width_m + 2.0 * slack_m + 1e-9);
        }
    }

    #[test]
    fn a_straight_is_covered_exactly_by_one_rectangle() {
        let piece = Piece { start_m: [0.0, 0.0], heading_rad: 0.0, length_m: 7.0, turn_rad: 0.0 };
        let swept = SweptPiece::new(&piece, &HUSKY, 0.1);
        assert_eq!(swept.parts(), 1);
        let cover = swept.cover(0);
        assert_eq!((cover.center_m, cover.half_m), ([3.5, 0.0], [3.935, 0.3525]));
    }

    #[test]
    fn a_turn_of_a_huge_robot_on_fine_cells_takes_hundreds_of_parts_and_no_more() {
        let outline = Footprint { length_m: 1.6, width_m: 1.6 };
        let piece = Piece { start_m: [0.0, 0.0], heading_rad: 0.0, length_m: 0.0, turn_rad: 0.4636 };
        let parts = SweptPiece::new(&piece, &outline, 0.01).parts();
        assert!((100..1000).contains(&parts), "{parts}");
    }
}
