//! Arc, straight, arc: the curves from one pose to another, with any two radii.

use std::f64::consts::{PI, TAU};

use crate::{
    grid::heading::{turn_rad, within_full_turn},
    lattice::primitive::Piece,
};

/// A pose anywhere on the map, in metres from the centre of cell (0, 0).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Waypoint {
    /// East [m].
    pub(crate) x_m: f64,
    /// North [m].
    pub(crate) y_m: f64,
    /// Where the robot faces, counter-clockwise from east [rad].
    pub(crate) heading_rad: f64,
}

/// Which way an arc bends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Left,
    Right,
}

/// The four ways in which two arcs can bend.
pub(crate) const WORDS: [[Side; 2]; 4] = [
    [Side::Left, Side::Left],
    [Side::Right, Side::Right],
    [Side::Left, Side::Right],
    [Side::Right, Side::Left],
];

/// How to get from one pose to another: an arc, the straight that touches both, an arc (Dubins 1957, with two radii).
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Connection {
    /// Radii of the arcs; 0 turns on the spot, by the shorter way [m].
    pub(crate) radii_m: [f64; 2],
    /// Which way the arcs bend.
    pub(crate) sides: [Side; 2],
    /// Whether the robot backs along it.
    pub(crate) reverse: bool,
}

/// What a connection comes to between two given poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shape {
    /// Turns of both arcs, positive to the left [rad].
    pub(crate) turns_rad: [f64; 2],
    /// Length of the straight [m].
    pub(crate) straight_m: f64,
    /// Direction of travel at the start and on the straight [rad].
    travel_rad: [f64; 2],
}

/// Turns that fall short of a full circle by no more are rounding, and none [rad].
const ROUNDING_RAD: f64 = 1e-9;
/// Ends that lie closer are the same place [m].
const ROUNDING_M: f64 = 1e-9;

/// Two poses as all connections of one direction between them need them.
#[derive(Clone, Copy)]
pub(crate) struct Ends {
    /// From the first to the last [m].
    apart_m: [f64; 2],
    /// Directions of travel [rad].
    travel_rad: [f64; 2],
    /// Unit vectors to the left of travel.
    left: [[f64; 2]; 2],
}

impl Ends {
    pub(crate) fn new(from: &Waypoint, to: &Waypoint, reverse: bool) -> Self {
        let facing_rad = if reverse { PI } else { 0.0 };
        let travel_rad = [from.heading_rad + facing_rad, to.heading_rad + facing_rad];
        let left = travel_rad.map(|travel_rad| {
            let (sin, cos) = travel_rad.sin_cos();
            [-sin, cos]
        });
        Ends { apart_m: [to.x_m - from.x_m, to.y_m - from.y_m], travel_rad, left }
    }
}

impl Side {
    fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }

    /// The turn from one direction to another on this side, 0 to 2π to the left or 0 to −2π to the right [rad].
    fn turn_rad(self, from_rad: f64, to_rad: f64) -> f64 {
        let turn = within_full_turn(self.sign() * (to_rad - from_rad));
        if turn > TAU - ROUNDING_RAD { 0.0 } else { self.sign() * turn }
    }
}

impl Connection {
    /// The same with radii changed by powers of two; turns on the spot stay so, arcs get no tighter than `tightest_m`.
    pub(crate) fn bent(&self, doublings: [f64; 2], tightest_m: f64) -> Self {
        let radius_m = |i: usize| match self.radii_m[i] {
            0.0 => 0.0,
            radius_m => (radius_m * doublings[i].exp2()).max(tightest_m),
        };
        Connection { radii_m: [radius_m(0), radius_m(1)], ..*self }
    }

    /// Turns and straight between two poses; `None` where no straight touches both circles.
    pub(crate) fn shape(&self, from: &Waypoint, to: &Waypoint) -> Option<Shape> {
        self.shape_between(&Ends::new(from, to, self.reverse))
    }

    /// The same with the ends prepared; they must be those of the connection's direction.
    pub(crate) fn shape_between(&self, ends: &Ends) -> Option<Shape> {
        let [start_rad, end_rad] = ends.travel_rad;
        let [first_m, last_m] =
            [0, 1].map(|i| if self.radii_m[i] == 0.0 { 0.0 } else { self.sides[i].sign() * self.radii_m[i] });
        // From centre to centre.
        let [[nx_0, ny_0], [nx_1, ny_1]] = ends.left;
        let dx = ends.apart_m[0] + last_m * nx_1 - first_m * nx_0;
        let dy = ends.apart_m[1] + last_m * ny_1 - first_m * ny_0;
        let offset_m = last_m - first_m;
        let squared = dx * dx + dy * dy - offset_m * offset_m;
        if squared < -ROUNDING_M {
            return None;
        }
        let straight_m = squared.max(0.0).sqrt();
        let apart = dx.abs().max(dy.abs()) > ROUNDING_M;
        // The direction from centre to centre less that of the offset beside the straight, as one quotient of complex numbers.
        let along = dx * straight_m + dy * offset_m;
        let straight_rad = if apart { (dy * straight_m - dx * offset_m).atan2(along) } else { start_rad };
        let turn = |i: usize, from_rad, to_rad| {
            if self.radii_m[i] == 0.0 {
                turn_rad(from_rad, to_rad)
            } else {
                self.sides[i].turn_rad(from_rad, to_rad)
            }
        };
        Some(Shape {
            turns_rad: [turn(0, start_rad, straight_rad), turn(1, straight_rad, end_rad)],
            straight_m,
            travel_rad: [start_rad, straight_rad],
        })
    }

    /// The pieces between two poses, those of no length and turn included.
    pub(crate) fn pieces(&self, from: &Waypoint, to: &Waypoint) -> Option<[Piece; 3]> {
        let shape = self.shape(from, to)?;
        let [first_rad, last_rad] = shape.turns_rad;
        let first = Piece {
            start_m: [from.x_m, from.y_m],
            heading_rad: shape.travel_rad[0],
            length_m: self.radii_m[0] * first_rad.abs(),
            turn_rad: first_rad,
        };
        let [x_m, y_m, _] = first.pose_at(1.0);
        let straight = Piece {
            start_m: [x_m, y_m],
            heading_rad: shape.travel_rad[1],
            length_m: shape.straight_m,
            turn_rad: 0.0,
        };
        let [x_m, y_m, heading_rad] = straight.pose_at(1.0);
        let length_m = self.radii_m[1] * last_rad.abs();
        Some([first, straight, Piece { start_m: [x_m, y_m], heading_rad, length_m, turn_rad: last_rad }])
    }
}

/// Whether a piece goes nowhere and turns nowhere.
pub(crate) fn is_nothing(piece: &Piece) -> bool {
    piece.length_m <= ROUNDING_M && piece.turn_rad.abs() <= ROUNDING_RAD
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn every_connection_ends_where_it_is_meant_to_end(
            x in -20.0f64..20.0, y in -20.0f64..20.0, start in -4.0f64..4.0, end in -4.0f64..4.0,
            first in 0.0f64..6.0, last in 0.0f64..6.0, word in 0usize..4, spins in 0u8..4, reverse: bool,
        ) {
            let from = Waypoint { x_m: 3.0, y_m: -2.0, heading_rad: start };
            let to = Waypoint { x_m: x, y_m: y, heading_rad: end };
            let radii_m = [if spins & 1 > 0 { 0.0 } else { first }, if spins & 2 > 0 { 0.0 } else { last }];
            let connection = Connection { radii_m, sides: WORDS[word], reverse };
            if let Some(pieces) = connection.pieces(&from, &to) {
                let facing_rad = if reverse { PI } else { 0.0 };
                let [ex, ey, travel] = pieces[2].pose_at(1.0);
                prop_assert!((ex - x).hypot(ey - y) < 1e-8, "{ex} {ey} for {x} {y}");
                prop_assert!(turn_rad(travel, end + facing_rad).abs() < 1e-8);
                for pair in pieces.windows(2) {
                    prop_assert!(turn_rad(pair[0].pose_at(1.0)[2], pair[1].heading_rad).abs() < 1e-9, "no kink");
                }
            } else {
                prop_assert!(first + last > 0.0, "points can always be connected");
            }
        }
    }

    #[test]
    fn a_pose_straight_ahead_needs_no_turn_and_a_turn_on_the_spot_no_straight() {
        let from = Waypoint { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
        for sides in WORDS {
            let ahead = Connection { radii_m: [1.0, 2.0], sides, reverse: false };
            let shape = ahead.shape(&from, &Waypoint { x_m: 5.0, ..from }).unwrap();
            assert_eq!((shape.turns_rad, shape.straight_m), ([0.0, 0.0], 5.0));
            let spin = Connection { radii_m: [0.0, 0.0], sides, reverse: false };
            let shape = spin.shape(&from, &Waypoint { heading_rad: -1.0, ..from }).unwrap();
            assert!((shape.turns_rad[0] + shape.turns_rad[1] + 1.0).abs() < 1e-12 && shape.straight_m == 0.0);
        }
    }
}
