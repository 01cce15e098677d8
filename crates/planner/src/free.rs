//! Driving anywhere on the map, by the same evaluation as from cell centre to cell centre.

use model::Manoeuvre;

use crate::{
    connection::{Connection, Waypoint, is_nothing},
    edge::Edge,
    footprint::Footprint,
    lattice::Lattice,
    objective::{Objective, Weights},
    primitive::Piece,
    step::{PreparedStep, Sample, Step, prepare_steps},
};

/// Longest step off the lattice, in cells: no coarser than the cells, so that no ground is skipped. The lattice's own
/// are up to a quarter longer.
const STEP_CELLS: f64 = 1.0;
/// Spacing of the poses whose footprints are looked at, in cells.
const SWEEP_CELLS: f64 = 0.125;

/// The ground of a lattice, its robot and an objective.
pub(crate) struct FreeGround<'l> {
    pub(crate) lattice: &'l Lattice,
    pub(crate) weights: Weights,
    /// The robot's outline, wider by what it may move between two poses that are looked at.
    outline: Footprint,
    /// Half the diagonal of that outline [m].
    half_diagonal_m: f64,
}

impl<'l> FreeGround<'l> {
    pub(crate) fn new(lattice: &'l Lattice, objective: Objective) -> Self {
        let robot = Footprint::of(&lattice.robot);
        // Half the spacing on every side.
        let between_m = SWEEP_CELLS * lattice.terrain.grid.cell_size_m;
        let outline = Footprint { length_m: robot.length_m + between_m, width_m: robot.width_m + between_m };
        FreeGround {
            lattice,
            weights: lattice.weights(objective),
            half_diagonal_m: outline.length_m.hypot(outline.width_m) / 2.0,
            outline,
        }
    }

    /// Visits every step of driving pieces; `None`, possibly after some visits, where ground or limits forbid it.
    ///
    /// Obstacles are [`FreeGround::is_clear`]'s business.
    pub(crate) fn drive(&self, pieces: &[Piece], reverse: bool, mut visit: impl FnMut(&Step)) -> Option<()> {
        let lattice = self.lattice;
        let cell_size_m = lattice.terrain.grid.cell_size_m;
        let start = Sample::at(pieces.first()?.start_m, cell_size_m);
        let mut height_m = self.height_m(&start)?;
        for piece in pieces.iter().filter(|piece| !is_nothing(piece)) {
            // Without mechanisms no force follows the heading, and a manoeuvre holds for the whole piece.
            let anew = !lattice.robot.mechanisms.is_empty();
            let mut prepared: Option<(usize, Manoeuvre)> = None;
            for step in prepare_steps(piece, reverse, cell_size_m, STEP_CELLS) {
                if !self.holds(&step) {
                    return None;
                }
                let (done, end_m) = step.drive_on(lattice, 0, height_m, reverse, |surface| {
                    let same = prepared.take().filter(|(of, _)| *of == surface && !anew);
                    let heading_rad = step.heading_rad();
                    let ready = same.unwrap_or_else(|| {
                        (surface, lattice.manoeuvre(piece, reverse, heading_rad, surface))
                    });
                    &prepared.insert(ready).1
                })?;
                visit(&done);
                height_m = end_m;
            }
        }
        Some(())
    }

    /// What a connection costs, in the objective's own unit; `None` where ground or limits forbid it.
    pub(crate) fn cost(&self, connection: &Connection, from: &Waypoint, to: &Waypoint) -> Option<f64> {
        let mut total = Edge::default();
        let pieces = connection.pieces(from, to)?;
        self.drive(&pieces, connection.reverse, |step| total.add(step))?;
        Some(self.weighed(&total))
    }

    /// Totals in the objective's own unit, lifting included: between the same ends it is the same for every path.
    pub(crate) fn weighed(&self, total: &Edge) -> f64 {
        let Weights { per_j, per_m, per_s } = self.weights;
        per_j * total.energy_j + per_m * total.length_m + per_s * total.duration_s
    }

    /// Whether the robot touches neither obstacles nor unknown ground nor the map's edge along a connection.
    pub(crate) fn is_clear(&self, connection: &Connection, from: &Waypoint, to: &Waypoint) -> bool {
        connection
            .pieces(from, to)
            .is_some_and(|pieces| pieces.iter().all(|piece| self.is_piece_clear(piece)))
    }

    fn is_piece_clear(&self, piece: &Piece) -> bool {
        let grid = &self.lattice.terrain.grid;
        let cell_size_m = grid.cell_size_m;
        let travelled_m = piece.length_m + piece.turn_rad.abs() * self.half_diagonal_m;
        let poses = (travelled_m / (SWEEP_CELLS * cell_size_m)).ceil().max(1.0) as usize;
        // A cell's half on either side: where in its cell the robot's middle is, and where in theirs its corners are.
        let reach_cells = self.half_diagonal_m / cell_size_m + 1.0;
        let mut i = 0;
        while i <= poses {
            let pose = piece.pose_at(i as f64 / poses as f64);
            let cell = [pose[0], pose[1]].map(|along_m| (along_m / cell_size_m).round() as i32);
            let Some(index) = self.index((cell[0], cell[1])) else { return false };
            let room_cells = f64::from(self.lattice.clearance.at(index)) - reach_cells;
            if room_cells > 0.0 {
                i += ((room_cells / SWEEP_CELLS) as usize).max(1);
                continue;
            }
            let touches = self.outline.any_cell(pose, cell_size_m, |offset| {
                self.index(offset).is_none_or(|index| self.lattice.clearance.at(index) == 0)
            });
            if touches {
                return false;
            }
            i += 1;
        }
        true
    }

    /// Row-major position of the cell at an offset (columns, rows) from cell (0, 0), if the map has it.
    fn index(&self, (column, row): (i32, i32)) -> Option<usize> {
        let grid = &self.lattice.terrain.grid;
        let (column, row) = (usize::try_from(column).ok()?, usize::try_from(row).ok()?);
        (row < grid.rows && column < grid.columns).then(|| row * grid.columns + column)
    }

    /// Whether all cells that a step reads lie on the map.
    fn holds(&self, step: &PreparedStep) -> bool {
        [step.middle, step.end.corner, step.end.far_corner()].iter().all(|&cell| self.index(cell).is_some())
    }

    fn height_m(&self, sample: &Sample) -> Option<f32> {
        let corner = self.index(sample.corner)?;
        self.index(sample.far_corner())?;
        let terrain = &self.lattice.terrain;
        Some(sample.height_m(terrain.relative_m(), corner, terrain.grid.columns))
    }
}
