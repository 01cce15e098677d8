//! Driving anywhere on the map, by the same evaluation as from cell centre to cell centre.

use model::Manoeuvre;
use terrain::Cell;

use crate::{
    changes::Changes,
    connection::{Connection, Waypoint, is_nothing},
    edge::Edge,
    footprint::Footprint,
    lattice::Lattice,
    objective::{Objective, Weights},
    primitive::Piece,
    step::{PreparedStep, Sample, Step, prepare_steps},
    swept::SweptPiece,
};

/// Longest step off the lattice, in cells: no coarser than the cells, so that no ground is skipped. The lattice's own
/// are up to a quarter longer.
const STEP_CELLS: f64 = 1.0;
/// Longest part of a piece that is looked at as one, in cells: short enough that parts far from obstacles are skipped.
const PART_CELLS: f64 = 1.0;

/// The cell from whose centre waypoints count.
const ORIGIN: Cell = Cell { row: 0, column: 0 };

/// The ground of a lattice, its robot and an objective.
pub(crate) struct FreeGround<'l> {
    pub(crate) lattice: &'l Lattice,
    pub(crate) weights: Weights,
    outline: Footprint,
    /// What a turn on the spot weighs besides what it takes, for the stop.
    stop: f64,
}

impl<'l> FreeGround<'l> {
    pub(crate) fn new(lattice: &'l Lattice, objective: Objective) -> Self {
        let weights = lattice.weights(objective);
        let changes = Changes::of(lattice, objective);
        let stop = changes.map_or(0.0, |changes| weights.of_surcharge(&changes.price(true, false)));
        FreeGround { lattice, weights, outline: Footprint::of(&lattice.robot), stop }
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
            let prepare = |class, heading_rad| (class, lattice.manoeuvre(piece, reverse, heading_rad, class));
            for step in prepare_steps(piece, reverse, cell_size_m, STEP_CELLS) {
                if !self.holds(&step) {
                    return None;
                }
                let (done, end_m) = step.drive_on(lattice, ORIGIN, height_m, reverse, |class| {
                    if anew || prepared.as_ref().is_some_and(|(of, _)| *of != class) {
                        prepared = None;
                    }
                    &prepared.get_or_insert_with(|| prepare(class, step.heading_rad)).1
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
        let spins = pieces.iter().filter(|piece| piece.length_m == 0.0 && !is_nothing(piece)).count();
        Some(self.weighed(&total) + spins as f64 * self.stop)
    }

    /// Totals in the objective's own unit, lifting included: between the same ends it is the same for every path.
    pub(crate) fn weighed(&self, total: &Edge) -> f64 {
        self.weights.of(total)
    }

    /// Whether the robot touches neither obstacles nor unknown ground nor the map's edge along a connection.
    pub(crate) fn is_clear(&self, connection: &Connection, from: &Waypoint, to: &Waypoint) -> bool {
        connection
            .pieces(from, to)
            .is_some_and(|pieces| pieces.iter().all(|piece| self.is_piece_clear(piece)))
    }

    /// Whether the outline stays off all that is blocked, proven by the rectangles that cover the area it sweeps.
    fn is_piece_clear(&self, piece: &Piece) -> bool {
        let clearance = &self.lattice.clearance;
        let cell_size_m = self.lattice.terrain.grid.cell_size_m;
        let swept = SweptPiece::with_parts(piece, &self.outline, cell_size_m, PART_CELLS * cell_size_m);
        let part_cells = swept.part_m() / cell_size_m;
        // From the middle of a part to the far corner of its cover, and a cell's half on either side: where in its cell the
        // robot's middle is, and where in theirs its corners are.
        let half_diagonal_m = self.outline.length_m.hypot(self.outline.width_m) / 2.0;
        let reach_cells = half_diagonal_m / cell_size_m + part_cells / 2.0 + 1.0;
        let mut part = 0;
        while part < swept.parts() {
            let [column, row] = swept.middle_m(part).map(|along_m| (along_m / cell_size_m).round() as i32);
            let Some(cell) = self.cell((column, row)) else { return false };
            let index = self.lattice.terrain.grid.index(cell);
            let room_cells = f64::from(clearance.at(index)) - reach_cells;
            if room_cells > 0.0 {
                // The next parts lie within the room; all of them where the robot turns on the spot.
                part = part.saturating_add(((room_cells / part_cells) as usize).max(1));
                continue;
            }
            let mut spans = swept.cover(part).spans(cell_size_m);
            if spans.any(|span| span.first_blocked(clearance, ORIGIN).is_some()) {
                return false;
            }
            part += 1;
        }
        true
    }

    /// The cell at an offset (columns, rows) from cell (0, 0), if the map has it.
    #[inline]
    fn cell(&self, (column, row): (i32, i32)) -> Option<Cell> {
        let grid = &self.lattice.terrain.grid;
        let (column, row) = (usize::try_from(column).ok()?, usize::try_from(row).ok()?);
        (row < grid.rows && column < grid.columns).then_some(Cell { row, column })
    }

    /// Whether all cells that a step reads lie on the map.
    fn holds(&self, step: &PreparedStep) -> bool {
        [step.middle, step.end.corner, step.end.far_corner()].iter().all(|&cell| self.cell(cell).is_some())
    }

    /// Height of the robot at a place, from the centre of cell (0, 0), above the map's lowest ground [m].
    pub(crate) fn height_at_m(&self, place_m: [f64; 2]) -> Option<f32> {
        self.height_m(&Sample::at(place_m, self.lattice.terrain.grid.cell_size_m))
    }

    fn height_m(&self, sample: &Sample) -> Option<f32> {
        let corner = self.cell(sample.corner)?;
        self.cell(sample.far_corner())?;
        let (terrain, ground) = (&self.lattice.terrain, &self.lattice.ground);
        Some(sample.height_m(|cell| ground.height_m(terrain, cell), corner))
    }
}
