//! How the robot stands between the poses of a path.
//!
//! Motions are weighed by the ground at the centres of cells and at the nearest of sixteen headings. Here a path is followed as it is driven:
//! the same wheels and the same outline as in [`crate::ground::stance`], but at any place and heading. Heights lie on the bilinear surface
//! through the centres of cells.

use terrain::{Cell, Terrain};

use crate::{
    ground::{
        footprint::Footprint,
        stance::{Contact, contact_places},
    },
    lattice::{graph::Lattice, step::Sample},
    path::room::pieces,
    patience::{Patience, work},
};

/// Places across a tyre's contact at which the ground is looked at: bilinear heights bend only where cells meet, a few of them under a tyre.
const ACROSS_TYRE: usize = 3;
/// Places along and across the outline: at most a wheel radius apart on any robot of up to seven wheel radii. Narrower rises lie in single cells,
/// which the search looks at one by one where cells are so small.
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
/// its wheels is known; level where it is known nowhere. `None` when patience ends first.
pub fn stances(lattice: &Lattice, poses: &[[f64; 3]], patience: &Patience) -> Option<Stances> {
    let robot = &lattice.robot;
    let cell_size_m = lattice.terrain.grid.cell_size_m;
    let tyre_m = Footprint::tyre_width_m(robot);
    let step_m = (OF_WHEELBASE * robot.wheelbase_m).min(OF_CELL * cell_size_m).max(OF_WHEELBASE * tyre_m);
    let half_diagonal_m = robot.wheelbase_m.hypot(robot.track_m) / 2.0;
    let wheels = Wheels::of(lattice);
    let mut most = wheels.level(poses.first().map_or([0.0; 2], |pose| [pose[0], pose[1]]));
    let mut pacer = patience.pacer();
    for piece in pieces(poses) {
        // On the spot the wheels go round their middle.
        let way_m = piece.length_m.max(half_diagonal_m * piece.turn_rad.abs());
        let count = (way_m / step_m).ceil().max(1.0) as usize;
        for i in 0..=count {
            pacer.after(wheels.work())?;
            let pose = piece.pose_at(i as f64 / count as f64);
            most = wheels.stance(pose).map_or(most, |stance| most.or(&stance));
        }
    }
    Some(most)
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
    contacts: Vec<Contact>,
    /// Places under the outline, ahead and to the left [m].
    under_m: Vec<[f64; 2]>,
    allowed_above_m: f64,
}

impl<'l> Wheels<'l> {
    fn of(lattice: &'l Lattice) -> Self {
        let outline = Footprint::of(&lattice.robot);
        let across = |length_m: f64, i: usize| length_m * ((i as f64 + 0.5) / ACROSS_OUTLINE as f64 - 0.5);
        let under_m = (0..ACROSS_OUTLINE * ACROSS_OUTLINE)
            .map(|i| (i / ACROSS_OUTLINE, i % ACROSS_OUTLINE))
            .map(|(i, j)| [across(outline.length_m, i), across(outline.width_m, j)]);
        Wheels {
            lattice,
            contacts: contact_places(&lattice.robot, ACROSS_TYRE),
            under_m: under_m.collect(),
            allowed_above_m: lattice.ground.allowed_above_m(&lattice.terrain),
        }
    }

    /// Cells that a stance is read from.
    fn work(&self) -> u64 {
        (self.contacts.len() + self.under_m.len()) as u64 * work::CELL
    }

    /// On level ground at a place.
    fn level(&self, at_m: [f64; 2]) -> Stances {
        self.stances(at_m, [0.0; 3])
    }

    fn stances(&self, at_m: [f64; 2], values: [f64; 3]) -> Stances {
        let [pitch_rad, roll_rad, above_m] = values.map(|value| Most { value, at_m });
        Stances { pitch_rad, roll_rad, above_m, allowed_above_m: self.allowed_above_m }
    }

    /// How it stands in a pose; `None` where the ground under a wheel is not known.
    fn stance(&self, [x_m, y_m, heading_rad]: [f64; 3]) -> Option<Stances> {
        let (sin, cos) = heading_rad.sin_cos();
        let ground_m = |[ahead_m, left_m]: [f64; 2]| {
            let place_m = [x_m + ahead_m * cos - left_m * sin, y_m + ahead_m * sin + left_m * cos];
            height_m(&self.lattice.terrain, place_m)
        };
        let [mut middle_m, mut along, mut left] = [0.0; 3];
        for Contact { place_m, height, rise } in &self.contacts {
            let ground_m = ground_m(*place_m)?;
            middle_m += height * ground_m;
            along += rise[0] * ground_m;
            left += rise[1] * ground_m;
        }
        let above_m = |place_m: &[f64; 2]| {
            Some(ground_m(*place_m)? - (middle_m + along * place_m[0] + left * place_m[1]))
        };
        let above_m = self.under_m.iter().filter_map(above_m).fold(0.0, f64::max);
        Some(self.stances([x_m, y_m], [along.abs().atan(), left.abs().atan(), above_m]))
    }
}

/// Height of the surface through the centres of cells [m above the map's lowest]; beyond the outermost centres that of the nearest. `None`
/// where a cell that counts is unknown.
fn height_m(terrain: &Terrain, place_m: [f64; 2]) -> Option<f64> {
    let grid = &terrain.grid;
    let [first_m, last_m] = [
        grid.center_m(Cell { row: 0, column: 0 }),
        grid.center_m(Cell { row: grid.rows - 1, column: grid.columns - 1 }),
    ];
    let inside_m = [0, 1].map(|axis| place_m[axis].clamp(first_m[axis], last_m[axis]) - first_m[axis]);
    let mut sum_m = 0.0;
    for ((column, row), weight) in Sample::at(inside_m, grid.cell_size_m).taps() {
        let cell = Cell { row: usize::try_from(row).ok()?, column: usize::try_from(column).ok()? };
        let own_m = f64::from(*terrain.relative_m().get(grid.index(cell))?);
        sum_m += (!own_m.is_nan()).then_some(f64::from(weight) * own_m)?;
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
