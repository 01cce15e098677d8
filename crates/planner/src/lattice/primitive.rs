//! Motions from one lattice pose to another, built from the robot.

use model::Robot;

use crate::{
    error::Error,
    grid::heading::{HEADINGS, Heading, turn_rad},
    lattice::graph::Settings,
};

/// What a motion looks like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// Straight to the next cell centre along the heading.
    Straight,
    /// A straight, a left or right turn by `turns` headings, a straight.
    Arc {
        /// Headings turned, positive to the left.
        turns: i32,
    },
    /// A turn on the spot by one heading, positive to the left.
    PointTurn {
        /// Headings turned, positive to the left.
        turns: i32,
    },
}

/// A piece of constant curvature, in the direction of travel; a reversed robot faces the other way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Start, relative to the centre of the start cell [m].
    pub start_m: [f64; 2],
    /// Direction of travel at the start [rad].
    pub heading_rad: f64,
    /// Horizontal length; 0 on the spot [m].
    pub length_m: f64,
    /// Change of heading, positive to the left; 0 on a straight [rad].
    pub turn_rad: f64,
}

/// A motion from one heading at a cell centre to another heading at another cell centre.
#[derive(Clone, Debug, PartialEq)]
pub struct Motion {
    /// Heading at the start.
    pub from: Heading,
    /// Heading at the end.
    pub to: Heading,
    /// Columns to the east.
    pub columns: i32,
    /// Rows to the north.
    pub rows: i32,
    /// Its shape.
    pub kind: Kind,
    /// Whether the robot backs along it.
    pub reverse: bool,
    /// Ways to drive it, each a chain of pieces: arcs of different radii share their ends, and the cheapest counts.
    pub variants: Vec<Vec<Piece>>,
}

/// Headings by which arcs turn.
const ARC_TURNS: [i32; 4] = [1, -1, 2, -2];
/// Headings in half a turn.
const HALF_CIRCLE: i32 = HEADINGS as i32 / 2;
/// Longest lead-in, in lattice steps, that an arc may need to fit its radius.
pub(crate) const LONGEST_LEAD: i32 = 64;

impl Piece {
    /// Signed turning radius, positive with the centre on the left; `None` on a straight, 0 on the spot [m].
    pub fn radius_m(&self) -> Option<f64> {
        (self.turn_rad != 0.0).then(|| self.length_m / self.turn_rad)
    }

    /// Pose at a fraction of the piece: x, y relative to the start cell's centre [m], heading [rad].
    pub fn pose_at(&self, fraction: f64) -> [f64; 3] {
        let (turn, length_m) = (self.turn_rad * fraction, self.length_m * fraction);
        // The chord of an arc points half way through its turn and is shorter by sinc of that half.
        let half = turn / 2.0;
        let chord_m = if half.abs() < 1e-9 { length_m } else { length_m * half.sin() / half };
        let direction = self.heading_rad + half;
        [
            self.start_m[0] + chord_m * direction.cos(),
            self.start_m[1] + chord_m * direction.sin(),
            self.heading_rad + turn,
        ]
    }
}

/// All motions that start at each heading, in a fixed order.
///
/// One straight, arcs by one and two headings to either side, a point turn to either side; with `reverse` also the
/// straight and the arcs backwards. Arcs are driven at R' (half the slip track), or the least radius asked for if that is wider, or at the widest radius that fits their
/// corner, whichever costs less where they are.
///
/// # Errors
/// A least radius so wide that no arc fits the cells.
pub fn motions(
    robot: &Robot,
    cell_size_m: f64,
    settings: &Settings,
) -> Result<[Vec<Motion>; HEADINGS], Error> {
    check_radius(robot, cell_size_m, settings)?;
    let tightest_m = settings.tightest_m(robot);
    Ok(std::array::from_fn(|index| {
        let from = Heading::new(index);
        let mut list = forward(tightest_m, from, cell_size_m);
        if settings.reverse {
            list.extend(forward(tightest_m, from.turned(HALF_CIRCLE), cell_size_m).into_iter().map(backed));
        }
        if settings.spins() {
            list.extend([1, -1].map(|turns| point_turn(from, turns)));
        }
        list
    }))
}

/// Arcs by one heading must fit a corner of at most [`LONGEST_LEAD`] lattice steps.
fn check_radius(robot: &Robot, cell_size_m: f64, settings: &Settings) -> Result<(), Error> {
    // The sharpest corner between neighbouring headings: 26.6° between a step of one cell and another of √5.
    let sharpest = 0.5f64.atan() / 2.0;
    let max = f64::from(LONGEST_LEAD) * cell_size_m / sharpest.tan();
    let value = settings.least_radius_m;
    if (0.0..=max).contains(&value) && settings.tightest_m(robot) <= max {
        return Ok(());
    }
    Err(Error::OutOfRange { field: "least_radius_m", value, min: 0.0, max })
}

fn forward(tightest_m: f64, from: Heading, cell_size_m: f64) -> Vec<Motion> {
    let arcs = ARC_TURNS.iter().filter_map(|&turns| arc(tightest_m, from, turns, cell_size_m));
    std::iter::once(straight(from, cell_size_m)).chain(arcs).collect()
}

/// The same track with the robot facing the other way.
fn backed(motion: Motion) -> Motion {
    Motion {
        from: motion.from.turned(HALF_CIRCLE),
        to: motion.to.turned(HALF_CIRCLE),
        reverse: true,
        ..motion
    }
}

fn straight(from: Heading, cell_size_m: f64) -> Motion {
    let (columns, rows) = from.step();
    let length_m = f64::from(columns).hypot(f64::from(rows)) * cell_size_m;
    let piece = Piece { start_m: [0.0, 0.0], heading_rad: from.angle_rad(), length_m, turn_rad: 0.0 };
    Motion {
        from,
        to: from,
        columns,
        rows,
        kind: Kind::Straight,
        reverse: false,
        variants: vec![vec![piece]],
    }
}

fn point_turn(from: Heading, turns: i32) -> Motion {
    let to = from.turned(turns);
    let turn = turn_rad(from.angle_rad(), to.angle_rad());
    let piece = Piece { start_m: [0.0, 0.0], heading_rad: from.angle_rad(), length_m: 0.0, turn_rad: turn };
    let kind = Kind::PointTurn { turns };
    Motion { from, to, columns: 0, rows: 0, kind, reverse: false, variants: vec![vec![piece]] }
}

/// A turn round a corner of lattice lines: `lead` steps along the old heading, as many along the new.
fn arc(tightest_m: f64, from: Heading, turns: i32, cell_size_m: f64) -> Option<Motion> {
    let to = from.turned(turns);
    let turn = turn_rad(from.angle_rad(), to.angle_rad());
    let step_m = |h: Heading| {
        let (columns, rows) = h.step();
        f64::from(columns).hypot(f64::from(rows)) * cell_size_m
    };
    let widest_m = |lead: i32| f64::from(lead) * step_m(from).min(step_m(to)) / (turn.abs() / 2.0).tan();
    // Rounding must not cost an arc at the finest cells that the lattice accepts.
    let lead = (1..=LONGEST_LEAD).find(|lead| widest_m(*lead) >= tightest_m * (1.0 - 1e-9))?;
    let widest_m = widest_m(lead).max(tightest_m);
    let leads_m = [f64::from(lead) * step_m(from), f64::from(lead) * step_m(to)];
    let variants = [tightest_m, widest_m]
        .map(|radius_m| rounded_corner(from.angle_rad(), turn, leads_m, radius_m))
        .to_vec();
    let ((c0, r0), (c1, r1)) = (from.step(), to.step());
    Some(Motion {
        from,
        to,
        columns: lead * (c0 + c1),
        rows: lead * (r0 + r1),
        kind: Kind::Arc { turns },
        reverse: false,
        variants,
    })
}

/// Straight, arc, straight along two legs that meet at a corner; straights of no length are left out.
fn rounded_corner(heading_rad: f64, turn: f64, legs_m: [f64; 2], radius_m: f64) -> Vec<Piece> {
    let tangent_m = radius_m * (turn.abs() / 2.0).tan();
    let lengths_m = [legs_m[0] - tangent_m, radius_m * turn.abs(), legs_m[1] - tangent_m];
    let turns = [0.0, turn, 0.0];
    let mut pieces = Vec::with_capacity(3);
    let mut pose = [0.0, 0.0, heading_rad];
    for (length_m, turn_rad) in lengths_m.into_iter().zip(turns) {
        if length_m <= 1e-9 * legs_m[0] {
            continue;
        }
        let piece = Piece { start_m: [pose[0], pose[1]], heading_rad: pose[2], length_m, turn_rad };
        pose = piece.pose_at(1.0);
        pieces.push(piece);
    }
    pieces
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use model::builtin;

    use super::*;

    fn all(cell_size_m: f64) -> Vec<Motion> {
        let robot = builtin::husky_a200();
        let settings = Settings { reverse: true, ..Settings::of(&robot) };
        motions(&robot, cell_size_m, &settings).unwrap().into_iter().flatten().collect()
    }

    #[test]
    fn every_variant_of_every_motion_ends_exactly_in_its_lattice_pose() {
        for cell_size_m in [0.05, 0.2, 1.0, 5.0] {
            for motion in all(cell_size_m) {
                for chain in &motion.variants {
                    let [x, y, heading] = chain.last().unwrap().pose_at(1.0);
                    let facing = if motion.reverse { heading + std::f64::consts::PI } else { heading };
                    assert_relative_eq!(x, f64::from(motion.columns) * cell_size_m, epsilon = 1e-9);
                    assert_relative_eq!(y, f64::from(motion.rows) * cell_size_m, epsilon = 1e-9);
                    assert!(turn_rad(facing, motion.to.angle_rad()).abs() < 1e-9, "{motion:?}");
                }
            }
        }
    }

    #[test]
    fn pieces_join_without_a_gap_or_a_kink() {
        for motion in all(0.2) {
            for chain in &motion.variants {
                for pair in chain.windows(2) {
                    let [x, y, heading] = pair[0].pose_at(1.0);
                    assert_relative_eq!(x, pair[1].start_m[0], epsilon = 1e-12);
                    assert_relative_eq!(y, pair[1].start_m[1], epsilon = 1e-12);
                    assert_relative_eq!(heading, pair[1].heading_rad, epsilon = 1e-12);
                }
            }
        }
    }

    #[test]
    fn half_the_slip_track_is_among_the_radii_of_every_arc() {
        let robot = builtin::husky_a200();
        for cell_size_m in [0.1, 0.25, 1.0] {
            for motion in all(cell_size_m).iter().filter(|m| matches!(m.kind, Kind::Arc { .. })) {
                let tightest_m = motion
                    .variants
                    .iter()
                    .flatten()
                    .filter_map(Piece::radius_m)
                    .map(f64::abs)
                    .fold(f64::INFINITY, f64::min);
                assert_relative_eq!(tightest_m, robot.half_slip_track_m(), epsilon = 1e-9);
            }
        }
    }

    #[test]
    fn a_quarter_circle_has_its_length_and_ends_beside_its_centre() {
        let quarter = Piece {
            start_m: [0.0, 0.0],
            heading_rad: 0.0,
            length_m: std::f64::consts::FRAC_PI_2 * 2.0,
            turn_rad: std::f64::consts::FRAC_PI_2,
        };
        assert_relative_eq!(quarter.radius_m().unwrap(), 2.0, epsilon = 1e-12);
        let [x, y, _] = quarter.pose_at(1.0);
        assert_relative_eq!(x, 2.0, epsilon = 1e-12);
        assert_relative_eq!(y, 2.0, epsilon = 1e-12);
    }
}
