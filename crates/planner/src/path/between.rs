//! How the robot stands between the poses of a path.
//!
//! Motions are weighed by the ground at the centres of cells and at the nearest of sixteen headings. Here a path is followed as it is driven:
//! the same wheels and the same outline as in [`crate::ground::stance`], but at any place and heading. Heights lie on the bilinear surface
//! through the centres of cells.

use terrain::{Cell, Terrain};

use crate::{
    ground::footprint::Footprint,
    lattice::graph::Lattice,
    path::room::pieces,
    patience::{Patience, work},
};

/// Places across a tyre's contact, and along and across the outline, at which the ground is looked at.
const ACROSS_TYRE: usize = 3;
const ACROSS_OUTLINE: usize = 7;
/// Places along a path, of a wheelbase and of a cell: nothing that the wheels meet is shorter than a tyre, a third of a wheelbase.
const OF_WHEELBASE: f64 = 0.25;
const OF_CELL: f64 = 0.5;

/// The most of something along a path, and where.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Most {
    /// How much.
    pub value: f64,
    /// East and north [m].
    pub at_m: [f64; 2],
}

/// How the robot stands along a path at most.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stances {
    /// Size of the pitch of the plane of its wheels [rad].
    pub pitch_rad: Most,
    /// Size of its roll [rad].
    pub roll_rad: Most,
    /// Height of the ground under its outline above that plane [m].
    pub above_m: Most,
    /// Height up to which ground is let pass there: the robot's clearance, widened by the noise of the map's heights [m].
    pub allowed_above_m: f64,
}

/// How the robot stands along the straights, arcs and turns between some poses of x, y \[m\] and heading \[rad\], where the ground under all of
/// its wheels is known. `None` when patience ends first, or where it is known nowhere.
pub fn stances(lattice: &Lattice, poses: &[[f64; 3]], patience: &Patience) -> Option<Stances> {
    let robot = &lattice.robot;
    let cell_size_m = lattice.terrain.grid.cell_size_m;
    let step_m = (OF_WHEELBASE * robot.wheelbase_m)
        .min(OF_CELL * cell_size_m)
        .max(OF_WHEELBASE * Footprint::tyre_width_m(robot));
    let half_diagonal_m = robot.wheelbase_m.hypot(robot.track_m) / 2.0;
    let wheels = Wheels::of(lattice);
    let mut most: Option<Stances> = None;
    let mut pacer = patience.pacer();
    for piece in pieces(poses) {
        // On the spot the wheels go round their middle.
        let way_m = piece.length_m.max(half_diagonal_m * piece.turn_rad.abs());
        let count = (way_m / step_m).ceil().max(1.0) as usize;
        for i in 0..=count {
            pacer.after(wheels.work())?;
            let pose = piece.pose_at(i as f64 / count as f64);
            if let Some(stance) = wheels.stance(pose) {
                most = Some(most.map_or(stance, |most| most.or(&stance)));
            }
        }
    }
    most
}

impl Stances {
    fn or(&self, other: &Stances) -> Stances {
        let most = |one: Most, other: Most| if other.value > one.value { other } else { one };
        Stances {
            pitch_rad: most(self.pitch_rad, other.pitch_rad),
            roll_rad: most(self.roll_rad, other.roll_rad),
            above_m: most(self.above_m, other.above_m),
            allowed_above_m: self.allowed_above_m,
        }
    }
}

/// The wheels and the outline of a robot over its map.
struct Wheels<'l> {
    lattice: &'l Lattice,
    outline: Footprint,
    allowed_above_m: f64,
}

impl<'l> Wheels<'l> {
    fn of(lattice: &'l Lattice) -> Self {
        let (ground, outline) = (&lattice.ground, Footprint::of(&lattice.robot));
        Wheels { lattice, outline, allowed_above_m: ground.allowed_above_m(&lattice.terrain) }
    }

    /// Cells that a stance is read from.
    fn work(&self) -> u64 {
        (4 * ACROSS_TYRE * ACROSS_TYRE + ACROSS_OUTLINE * ACROSS_OUTLINE) as u64 * work::CELL
    }

    /// How it stands in a pose; `None` where the ground under a wheel is not known.
    fn stance(&self, [x_m, y_m, heading_rad]: [f64; 3]) -> Option<Stances> {
        let (robot, terrain) = (&self.lattice.robot, &self.lattice.terrain);
        let (sin, cos) = heading_rad.sin_cos();
        let ground_m = |ahead_m: f64, left_m: f64| {
            height_m(terrain, [x_m + ahead_m * cos - left_m * sin, y_m + ahead_m * sin + left_m * cos])
        };
        let (half_a_m, half_b_m) = (robot.wheelbase_m / 2.0, robot.track_m / 2.0);
        let [mut middle_m, mut along, mut left] = [0.0; 3];
        for (front, side) in [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)] {
            let contact_m = mean(Footprint::tyre_width_m(robot), |dx, dy| {
                ground_m(front * half_a_m + dx, side * half_b_m + dy)
            })?;
            middle_m += contact_m / 4.0;
            along += front * contact_m / (4.0 * half_a_m);
            left += side * contact_m / (4.0 * half_b_m);
        }
        let above_m = places(ACROSS_OUTLINE, self.outline.length_m)
            .flat_map(|ahead_m| {
                places(ACROSS_OUTLINE, self.outline.width_m).map(move |left_m| (ahead_m, left_m))
            })
            .filter_map(|(ahead_m, left_m)| {
                Some(ground_m(ahead_m, left_m)? - (middle_m + along * ahead_m + left * left_m))
            })
            .fold(0.0, f64::max);
        let at_m = [x_m, y_m];
        let most = |value: f64| Most { value, at_m };
        Some(Stances {
            pitch_rad: most(along.abs().atan()),
            roll_rad: most(left.abs().atan()),
            above_m: most(above_m),
            allowed_above_m: self.allowed_above_m,
        })
    }
}

/// The middles of so many equal parts of a length about 0.
fn places(count: usize, length_m: f64) -> impl Iterator<Item = f64> + Clone {
    (0..count).map(move |i| length_m * ((i as f64 + 0.5) / count as f64 - 0.5))
}

/// The mean over a square; `None` where any of it is not known.
fn mean(side_m: f64, ground_m: impl Fn(f64, f64) -> Option<f64>) -> Option<f64> {
    let mut sum_m = 0.0;
    for dx in places(ACROSS_TYRE, side_m) {
        for dy in places(ACROSS_TYRE, side_m) {
            sum_m += ground_m(dx, dy)?;
        }
    }
    Some(sum_m / (ACROSS_TYRE * ACROSS_TYRE) as f64)
}

/// Height of the surface through the centres of cells [m above the map's lowest]; beyond the outermost centres that of the nearest. `None`
/// where a cell that counts is unknown.
fn height_m(terrain: &Terrain, [x_m, y_m]: [f64; 2]) -> Option<f64> {
    let grid = &terrain.grid;
    let place = |at_m: f64, origin_m: f64, count: usize| -> (usize, f64) {
        let cells = ((at_m - origin_m) / grid.cell_size_m - 0.5).clamp(0.0, (count - 1) as f64);
        let first = (cells as usize).min(count.saturating_sub(2));
        (first, cells - first as f64)
    };
    let (column, east) = place(x_m, grid.origin_m[0], grid.columns);
    let (row, north) = place(y_m, grid.origin_m[1], grid.rows);
    let mut sum_m = 0.0;
    for (rows, by_row) in [(0, 1.0 - north), (1, north)] {
        for (columns, by_column) in [(0, 1.0 - east), (1, east)] {
            let weight = by_row * by_column;
            if weight > 0.0 {
                let cell = Cell { row: row + rows, column: column + columns };
                let own_m = f64::from(terrain.relative_m()[grid.index(cell)]);
                sum_m += (!own_m.is_nan()).then_some(weight * own_m)?;
            }
        }
    }
    Some(sum_m)
}

#[cfg(test)]
mod tests {
    use model::builtin;
    use terrain::Grid;

    use super::*;
    use crate::Settings;

    /// How a Husky stands along poses over heights by column of cells of a length.
    fn along(cell_size_m: f64, height_m: impl Fn(f64) -> f64, poses: &[[f64; 3]]) -> Stances {
        let count = (24.0 / cell_size_m) as usize;
        let grid = Grid { rows: count, columns: count, cell_size_m, origin_m: [0.0; 2] };
        let at = |index: usize| height_m(((index % count) as f64 + 0.5) * cell_size_m);
        let heights_m: Vec<f64> = (0..grid.cells()).map(at).collect();
        let terrain = Terrain::new(grid, &heights_m).unwrap();
        let robot = builtin::husky_a200();
        let lattice = Lattice::new(&terrain, &robot, Settings::of(&robot)).unwrap();
        stances(&lattice, poses, &Patience::default()).unwrap()
    }

    const ACROSS: [[f64; 3]; 2] = [[3.0, 12.0, 0.0], [21.0, 12.0, 0.0]];

    #[test]
    fn on_a_plane_the_robot_is_pitched_and_rolled_as_it_is() {
        let plane = |x_m: f64| 0.2 * x_m;
        let straight = along(0.5, plane, &ACROSS);
        assert!((straight.pitch_rad.value - 0.2_f64.atan()).abs() < 1e-5 && straight.roll_rad.value < 1e-5);
        assert!(straight.above_m.value < 1e-4);
        let turn = [[12.0, 12.0, 0.0], [12.0, 12.0, 1.5]];
        let turned = along(0.5, plane, &turn);
        assert!(
            (turned.roll_rad.value - 0.2_f64.atan()).abs() < 1e-2,
            "turning on the spot comes to roll too"
        );
    }

    #[test]
    fn a_bank_between_the_centres_of_cells_is_seen() {
        // A metre over 1.2 m, whose cells of a metre differ by up to 0.84 m.
        let bank = |x_m: f64| (40.0_f64.to_radians().tan() * (x_m - 10.25)).clamp(0.0, 1.0);
        let found = along(1.0, bank, &ACROSS);
        let steepest = (1..24).map(|i| bank(f64::from(i) + 0.5) - bank(f64::from(i) - 0.5));
        let steepest_rad = steepest.fold(0.0, f64::max).atan();
        assert!(
            (found.pitch_rad.value - steepest_rad).abs() < 0.02,
            "{:?} and {steepest_rad}",
            found.pitch_rad
        );
        assert!((10.0..12.5).contains(&found.pitch_rad.at_m[0]), "{:?}", found.pitch_rad);
    }

    #[test]
    fn ground_that_rises_between_the_wheels_is_seen_whatever_the_cells() {
        let wall = |x_m: f64| if x_m >= 12.0 { 0.3 } else { 0.0 };
        for cell_size_m in [0.25, 0.5, 1.0] {
            let found = along(cell_size_m, wall, &ACROSS);
            let level = along(cell_size_m, |_| 0.0, &ACROSS);
            assert_eq!(level.above_m.value, 0.0);
            let seen = found.above_m.value > 0.055 || found.pitch_rad.value > 0.28;
            assert!(seen, "{cell_size_m} m: {:?} {:?}", found.above_m, found.pitch_rad);
        }
    }
}
