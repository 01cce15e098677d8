//! Maps whose cells are far coarser than the robot.

use crate::lattice::Lattice;

/// Cells that are longer than so many wheelbases are coarse: an order of magnitude, from which on a cell's one slope stands for ground
/// that the robot climbs and descends many times over.
const COARSE_WHEELBASES: f64 = 10.0;

/// Whether the cells of a lattice's map are far coarser than its robot, so that they hide ups and downs, which the intervals of its
/// paths' energies hold.
pub fn is_coarse(lattice: &Lattice) -> bool {
    lattice.terrain.grid.cell_size_m > COARSE_WHEELBASES * lattice.robot.wheelbase_m
}
