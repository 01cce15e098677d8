//! How the robot stands on the ground: which cells its height, its attitude and its clearance are read from.
//!
//! Everything is a weighted sum over cells about the robot's middle, prepared once per robot and cell size, and comes in
//! pairs of cells opposite to each other. Where one of a pair is unknown, the other is mirrored through the middle, so
//! a plane keeps its slope up to the edge of what is known.

use std::collections::BTreeMap;

use model::Robot;

use crate::{
    grid::heading::{HEADINGS, Heading},
    ground::footprint::Footprint,
};

/// Headings that differ by more than half a turn: the wheels stand on the same four places both ways round.
pub(crate) const ORIENTATIONS: usize = HEADINGS / 2;

/// Columns and rows from the cell under the robot's middle.
pub(crate) type Offset = (i32, i32);

/// Which of the prepared orientations a heading has.
pub(crate) fn orientation(heading: Heading) -> usize {
    heading.index() % ORIENTATIONS
}

/// Two opposite cells, and what their heights count for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Pair {
    /// One of the two; the other lies opposite.
    pub(crate) offset: Offset,
    /// Of their sum, in the height of the plane at the robot's middle [-].
    pub(crate) height: f32,
    /// Of their difference, in the plane's gradient east and north [1/m].
    pub(crate) gradient: [f32; 2],
}

/// The plane through the ground at the wheels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Plane {
    /// At the robot's middle [m].
    pub(crate) height_m: f32,
    /// Gradient, east and north [-].
    pub(crate) gradient: [f32; 2],
}

/// A weighted sum of heights about a cell.
#[derive(Clone, Debug, Default)]
pub(crate) struct Stencil {
    /// What the cell itself counts for in the height.
    pub(crate) centre: f32,
    pub(crate) pairs: Vec<Pair>,
}

/// The cells that the ground is read from.
pub(crate) struct Stance {
    /// The mean over the disc that the wheels' contacts go round in a turn on the spot: the robot's height.
    pub(crate) disc: Stencil,
    /// The least-squares plane through the four contacts, by orientation: its attitude.
    pub(crate) contacts: [Stencil; ORIENTATIONS],
    /// Cells under the body, where they are small enough to lie between the wheels.
    pub(crate) body: Option<Body>,
    /// Largest offset that anything is read from [cells].
    pub(crate) reach: usize,
    pub(crate) cell_size_m: f32,
}

/// Cells whose centres lie under the body, as offsets.
pub(crate) struct Body {
    /// By orientation.
    pub(crate) under: [Vec<Offset>; ORIENTATIONS],
    /// Under any heading, and those that planes are read from.
    pub(crate) under_any: Vec<Offset>,
    /// How far two planes may be apart under the body, over the largest distance of the ground from one of them [-].
    pub(crate) apart: f32,
    /// Half the diagonal of the outline [m].
    pub(crate) radius_m: f32,
}

impl Stance {
    pub(crate) fn new(robot: &Robot, cell_size_m: f64) -> Self {
        let disc = disc(robot.wheelbase_m.hypot(robot.track_m) / 2.0, cell_size_m);
        let contacts: [Stencil; ORIENTATIONS] =
            std::array::from_fn(|k| contacts(robot, Heading::new(k).angle_rad(), cell_size_m));
        let body = Body::new(robot, cell_size_m);
        let pairs = contacts.iter().chain([&disc]).flat_map(|s| s.pairs.iter().map(|p| p.offset));
        let read = pairs.chain(body.iter().flat_map(|b| b.under_any.iter().copied()));
        let reach = read.map(|(c, r)| c.abs().max(r.abs())).max().unwrap_or(0) as usize;
        Stance { disc, contacts, body, reach, cell_size_m: cell_size_m as f32 }
    }
}

impl Stencil {
    /// The plane about a cell whose own height is `here_m`, of heights by offset, NaN where unknown.
    #[inline]
    pub(crate) fn plane(&self, here_m: f32, at: impl Fn(Offset) -> f32) -> Plane {
        let mut height_m = self.centre * here_m;
        let mut gradient = [0.0; 2];
        for pair in &self.pairs {
            let (columns, rows) = pair.offset;
            let (one_m, other_m) = mirrored(here_m, at((columns, rows)), at((-columns, -rows)));
            height_m += pair.height * (one_m + other_m);
            gradient[0] += pair.gradient[0] * (one_m - other_m);
            gradient[1] += pair.gradient[1] * (one_m - other_m);
        }
        Plane { height_m, gradient }
    }
}

/// Two opposite heights; an unknown one is the other mirrored through the height between them, and level if both are.
#[inline(always)]
pub(crate) fn mirrored(here_m: f32, one_m: f32, other_m: f32) -> (f32, f32) {
    match (one_m.is_nan(), other_m.is_nan()) {
        (false, false) => (one_m, other_m),
        (true, false) => (2.0 * here_m - other_m, other_m),
        (false, true) => (one_m, 2.0 * here_m - one_m),
        (true, true) => (here_m, here_m),
    }
}

/// Weights of cells, by row and column, in a mean over places between their centres.
#[derive(Default)]
struct Shares(BTreeMap<(i32, i32), f64>);

impl Shares {
    /// Adds a share of the bilinear height at a place.
    fn add(&mut self, [x_m, y_m]: [f64; 2], cell_size_m: f64, share: f64) {
        let (column, row) = (x_m / cell_size_m, y_m / cell_size_m);
        let (west, south) = (column.floor() as i32, row.floor() as i32);
        let (east, north) = (column - f64::from(west), row - f64::from(south));
        for (dr, by_row) in [(0, 1.0 - north), (1, north)] {
            for (dc, by_column) in [(0, 1.0 - east), (1, east)] {
                if by_row * by_column > 0.0 {
                    *self.0.entry((south + dr, west + dc)).or_default() += share * by_row * by_column;
                }
            }
        }
    }
}

/// Least number of places along a length over which a mean is taken, and most of a cell between two of them: bilinear
/// heights are linear along a row, so that four to a cell keep the mean to a thousandth.
const PLACES: f64 = 4.0;

fn places(length_m: f64, cell_size_m: f64) -> usize {
    (PLACES * (length_m / cell_size_m).max(1.0)).ceil() as usize
}

/// The mean over a disc.
fn disc(radius_m: f64, cell_size_m: f64) -> Stencil {
    let across = 2 * places(radius_m, cell_size_m);
    let mut inside = Vec::new();
    for i in 0..across {
        for j in 0..across {
            let at = |n: usize| radius_m * ((2 * n + 1) as f64 / across as f64 - 1.0);
            let place_m = [at(i), at(j)];
            if place_m[0].hypot(place_m[1]) <= radius_m {
                inside.push(place_m);
            }
        }
    }
    let mut shares = Shares::default();
    for place_m in &inside {
        shares.add(*place_m, cell_size_m, 1.0 / inside.len() as f64);
    }
    paired(&shares, &Shares::default(), &Shares::default())
}

/// A place under a wheel, and what the ground there counts for in the plane of the wheels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Contact {
    /// Ahead and to the left of the robot's middle [m].
    pub(crate) place_m: [f64; 2],
    /// In its height at the robot's middle [-].
    pub(crate) height: f64,
    /// In its rise per metre ahead and to the left [1/m].
    pub(crate) rise: [f64; 2],
}

/// Places under the four wheels by which the plane through the ground there is told: of least squares, which for a rectangle is
///
/// ```text
/// z = Σ z_i / 4,   ∂z/∂along = Σ ±z_i / (2 a),   ∂z/∂left = Σ ±z_i / (2 b)
/// ```
///
/// Each z_i is the mean over the tyre's contact, taken as a square as wide as the tyre (see [`Footprint`]), of `across` places each way.
pub(crate) fn contact_places(robot: &Robot, across: usize) -> Vec<Contact> {
    let tyre_m = Footprint::tyre_width_m(robot);
    let share = 1.0 / (across * across) as f64;
    let offset_m = |n: usize| tyre_m * ((n as f64 + 0.5) / across as f64 - 0.5);
    let mut all = Vec::with_capacity(4 * across * across);
    for (front, left) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let rise = [front / (2.0 * robot.wheelbase_m), left / (2.0 * robot.track_m)].map(|rise| share * rise);
        for i in 0..across {
            for j in 0..across {
                let ahead_m = front * robot.wheelbase_m / 2.0 + offset_m(i);
                let left_m = left * robot.track_m / 2.0 + offset_m(j);
                all.push(Contact { place_m: [ahead_m, left_m], height: share / 4.0, rise });
            }
        }
    }
    all
}

/// The plane through four contacts at a heading, of the heights of cells.
fn contacts(robot: &Robot, heading_rad: f64, cell_size_m: f64) -> Stencil {
    let (sin, cos) = heading_rad.sin_cos();
    let turned = |[ahead, left]: [f64; 2]| [ahead * cos - left * sin, ahead * sin + left * cos];
    let [mut height, mut east, mut north] = [Shares::default(), Shares::default(), Shares::default()];
    for contact in contact_places(robot, places(Footprint::tyre_width_m(robot), cell_size_m)) {
        let (place_m, rise) = (turned(contact.place_m), turned(contact.rise));
        height.add(place_m, cell_size_m, contact.height);
        east.add(place_m, cell_size_m, rise[0]);
        north.add(place_m, cell_size_m, rise[1]);
    }
    paired(&height, &east, &north)
}

/// Shares as pairs of opposite cells. The places are symmetric, so a mean has no odd part and a gradient no even one.
fn paired(height: &Shares, east: &Shares, north: &Shares) -> Stencil {
    let of =
        |shares: &Shares, (row, column): (i32, i32)| shares.0.get(&(row, column)).copied().unwrap_or(0.0);
    let mut stencil = Stencil { centre: of(height, (0, 0)) as f32, pairs: Vec::new() };
    let mut cells: Vec<(i32, i32)> =
        [height, east, north].iter().flat_map(|shares| shares.0.keys().copied()).collect();
    cells.retain(|cell| *cell > (0, 0));
    // Cells of which only the opposite was named.
    let opposite = [height, east, north].into_iter().flat_map(|shares| shares.0.keys());
    cells.extend(opposite.map(|(row, column)| (-row, -column)).filter(|cell| *cell > (0, 0)));
    cells.sort_unstable();
    cells.dedup();
    for (row, column) in cells {
        let even = |shares| ((of(shares, (row, column)) + of(shares, (-row, -column))) / 2.0) as f32;
        let odd = |shares| ((of(shares, (row, column)) - of(shares, (-row, -column))) / 2.0) as f32;
        let gradient = [odd(east), odd(north)];
        stencil.pairs.push(Pair { offset: (column, row), height: even(height), gradient });
    }
    stencil
}

impl Body {
    /// The cells under the body; `None` where not one cell's centre lies between the wheels whichever way the robot stands,
    /// and the ground there is not known better than by the plane through the contacts.
    fn new(robot: &Robot, cell_size_m: f64) -> Option<Self> {
        if cell_size_m > robot.wheelbase_m.min(robot.track_m) / 2.0 {
            return None;
        }
        let outline = Footprint::of(robot);
        let radius_m = outline.length_m.hypot(outline.width_m) / 2.0;
        // Between cells' centres, heights are read from those around.
        let beside_m = cell_size_m * std::f64::consts::SQRT_2;
        let most = ((radius_m + beside_m) / cell_size_m).ceil() as i32;
        let square = || (-most..=most).flat_map(|row| (-most..=most).map(move |column| (column, row)));
        let at_m = |(column, row): Offset| [f64::from(column) * cell_size_m, f64::from(row) * cell_size_m];
        let under = std::array::from_fn(|k| {
            let (sin, cos) = Heading::new(k).angle_rad().sin_cos();
            let is_under = |offset: &Offset| {
                let [x_m, y_m] = at_m(*offset);
                let (ahead_m, left_m) = (x_m * cos + y_m * sin, y_m * cos - x_m * sin);
                ahead_m.abs() <= outline.length_m / 2.0 && left_m.abs() <= outline.width_m / 2.0
            };
            square().filter(is_under).collect()
        });
        let is_under_any = |offset: &Offset| {
            let [x_m, y_m] = at_m(*offset);
            x_m.hypot(y_m) <= radius_m + beside_m
        };
        // Four contacts that lie off by 1 m lift the middle by 1 m and tilt the plane by 2 / a and 2 / b.
        let apart = 1.0 + radius_m * (2.0 / robot.wheelbase_m).hypot(2.0 / robot.track_m);
        let under_any = square().filter(is_under_any).collect();
        Some(Body { under, under_any, apart: apart as f32, radius_m: radius_m as f32 })
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;
    use model::builtin;

    use super::*;

    const CELLS_M: [f64; 5] = [0.03, 0.05, 0.1, 0.5, 2.0];

    fn plane_at(cell_size_m: f64, gradient: [f64; 2]) -> impl Fn(Offset) -> f32 {
        move |(column, row)| {
            let (x_m, y_m) = (f64::from(column) * cell_size_m, f64::from(row) * cell_size_m);
            (7.0 + gradient[0] * x_m + gradient[1] * y_m) as f32
        }
    }

    #[test]
    fn a_plane_keeps_height_and_gradient_whatever_the_cells() {
        let robot = builtin::husky_a200();
        for cell_size_m in CELLS_M {
            let stance = Stance::new(&robot, cell_size_m);
            let ground = plane_at(cell_size_m, [0.3, -0.2]);
            for stencil in stance.contacts.iter() {
                let plane = stencil.plane(7.0, &ground);
                assert_relative_eq!(plane.height_m, 7.0, epsilon = 1e-5);
                assert_relative_eq!(plane.gradient[0], 0.3, epsilon = 1e-5);
                assert_relative_eq!(plane.gradient[1], -0.2, epsilon = 1e-5);
            }
            assert_relative_eq!(stance.disc.plane(7.0, &ground).height_m, 7.0, epsilon = 1e-5);
        }
    }

    #[test]
    fn a_plane_keeps_them_beside_unknown_ground_too() {
        let robot = builtin::husky_a200();
        for cell_size_m in CELLS_M {
            let stance = Stance::new(&robot, cell_size_m);
            let whole = plane_at(cell_size_m, [0.7, 0.1]);
            let cut = |(column, row): Offset| if column > 0 { f32::NAN } else { whole((column, row)) };
            for stencil in stance.contacts.iter() {
                let plane = stencil.plane(7.0, cut);
                assert_relative_eq!(plane.gradient[0], 0.7, epsilon = 1e-5);
                assert_relative_eq!(plane.gradient[1], 0.1, epsilon = 1e-5);
            }
            assert_relative_eq!(stance.disc.plane(7.0, cut).height_m, 7.0, epsilon = 1e-5);
        }
    }

    #[test]
    fn a_wheel_on_a_block_lifts_its_corner() {
        // The front left wheel, 0.27 m ahead and to the left, on a block of 0.1 m; the other three on the floor.
        let stance = Stance::new(&builtin::husky_a200(), 0.01);
        let block = |(column, row): Offset| if column >= 15 && row >= 15 { 0.1 } else { 0.0 };
        let plane = stance.contacts[0].plane(0.0, block);
        assert_relative_eq!(plane.height_m, 0.025, epsilon = 1e-3);
        for gradient in plane.gradient {
            assert_relative_eq!(gradient, 0.1 / (2.0 * 0.54), epsilon = 2e-3);
        }
    }

    #[test]
    fn cells_that_do_not_fit_between_the_wheels_tell_nothing_of_the_belly() {
        let robot = builtin::husky_a200();
        assert!(Stance::new(&robot, 0.27).body.is_some());
        assert!(Stance::new(&robot, 0.28).body.is_none());
    }
}
