//! Driving anywhere on the map, by the same evaluation as from cell centre to cell centre.

use std::cell::OnceCell;

use model::{Manoeuvre, PreparedSurface};
use terrain::Cell;

use crate::{
    ground::footprint::Footprint,
    lattice::{
        edge::Edge,
        graph::{Lattice, prepared_manoeuvre},
        ground_class::GroundClass,
        objective::{Objective, Weights},
        primitive::Piece,
        step::{PreparedStep, Sample, Step, prepare_steps},
        swept::SweptPiece,
    },
    refinement::connection::{Connection, Waypoint, is_nothing},
    search::changes::Changes,
    table::least::least_cost_per_m,
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
    /// By kind of ground.
    surfaces: Vec<PreparedSurface<'l>>,
    outline: Footprint,
    /// Manoeuvres straight ahead and astern, by direction and kind of ground: half of all pieces are straight.
    straights: [Vec<OnceCell<Manoeuvre>>; 2],
    /// What a turn on the spot weighs besides what it takes, for the stop.
    stop: f64,
    /// What lifting weighs at least, per metre of height.
    lifted_per_m: f64,
    /// What a metre of the map weighs at least besides lifting.
    least_per_m: f64,
}

impl<'l> FreeGround<'l> {
    pub(crate) fn new(lattice: &'l Lattice, objective: Objective) -> Self {
        let weights = lattice.weights(objective);
        let changes = Changes::of(lattice, objective);
        let stop = changes.map_or(0.0, |changes| weights.of_surcharge(&changes.price(true, false)));
        let (robot, model) = (&lattice.robot, lattice.settings.power_model);
        let prepared = |class: &'l GroundClass| PreparedSurface::new(model, robot, &class.surface);
        FreeGround {
            lattice,
            weights,
            surfaces: lattice.classes.list.iter().map(prepared).collect(),
            straights: [0, 1].map(|_| vec![OnceCell::new(); lattice.classes.list.len()]),
            outline: Footprint::of(&lattice.robot),
            stop,
            lifted_per_m: weights.per_j * lattice.lift_j_per_m(),
            least_per_m: least_cost_per_m(lattice, &weights),
        }
    }

    /// Visits every step of driving pieces; `None`, possibly after some visits, where ground or limits forbid it or a visit ends it.
    ///
    /// Obstacles are [`FreeGround::is_clear`]'s business.
    pub(crate) fn drive(
        &self,
        pieces: &[Piece],
        reverse: bool,
        mut visit: impl FnMut(&Step) -> Option<()>,
    ) -> Option<()> {
        let lattice = self.lattice;
        let cell_size_m = lattice.terrain.grid.cell_size_m;
        let start = Sample::at(pieces.first()?.start_m, cell_size_m);
        let mut height_m = self.height_m(&start)?;
        for piece in pieces.iter().filter(|piece| !is_nothing(piece)) {
            // Without mechanisms no force follows the heading, and a manoeuvre holds for the whole piece.
            let anew = !lattice.robot.mechanisms.is_empty();
            let mut prepared: Option<(usize, Manoeuvre)> = None;
            let straights = (!anew && piece.turn_rad == 0.0).then(|| &self.straights[usize::from(reverse)]);
            let prepare = |class, heading_rad| (class, self.manoeuvre(piece, reverse, heading_rad, class));
            for step in prepare_steps(piece, reverse, cell_size_m, STEP_CELLS) {
                if !self.holds(&step) {
                    return None;
                }
                let (done, end_m) = step.drive_on(lattice, ORIGIN, height_m, reverse, |class| {
                    if let Some(straights) = straights {
                        return straights[class].get_or_init(|| prepare(class, step.heading_rad).1);
                    }
                    if anew || prepared.as_ref().is_some_and(|(of, _)| *of != class) {
                        prepared = None;
                    }
                    &prepared.get_or_insert_with(|| prepare(class, step.heading_rad)).1
                })?;
                visit(&done)?;
                height_m = end_m;
            }
        }
        Some(())
    }

    /// A piece as driven on one kind of ground at a heading [rad].
    pub(crate) fn manoeuvre(
        &self,
        piece: &Piece,
        reverse: bool,
        heading_rad: f64,
        class: usize,
    ) -> Manoeuvre {
        let Lattice { robot, settings, classes, .. } = self.lattice;
        let driven = (piece, reverse, heading_rad);
        prepared_manoeuvre(&self.surfaces[class], (robot, settings), driven, &classes.list[class])
    }

    /// What a connection costs, in the objective's own unit; `None` where ground or limits forbid it or it is not less than `most`.
    ///
    /// It is driven no further than it takes to know that: what is left of it weighs as much as its height and its length at least.
    pub(crate) fn cost_below(
        &self,
        connection: &Connection,
        [from, to]: [&Waypoint; 2],
        most: f64,
    ) -> Option<f64> {
        let pieces = connection.pieces(from, to)?;
        let spins = pieces.iter().filter(|piece| piece.length_m == 0.0 && !is_nothing(piece)).count();
        let stops = spins as f64 * self.stop;
        let length_m: f64 = pieces.iter().map(|piece| piece.length_m).sum();
        // What may be spent so far falls with the height and the length that are left.
        let mut allowed = most - stops - self.lifted(from, to)? - self.least_per_m * length_m;
        let mut total = Edge::default();
        self.drive(&pieces, connection.reverse, |step| {
            total.add(step);
            allowed += self.lifted_per_m * step.rise_m + self.least_per_m * step.horizontal_m();
            (self.weighed(&total) < allowed).then_some(())
        })?;
        Some(self.weighed(&total) + stops).filter(|cost| *cost < most)
    }

    /// The least that any connection costs between two places, in the objective's own unit; `None` off the map.
    pub(crate) fn least_between(&self, from: &Waypoint, to: &Waypoint) -> Option<f64> {
        let distance_m = (to.x_m - from.x_m).hypot(to.y_m - from.y_m);
        Some(self.lifted(from, to)? + self.least_per_m * distance_m)
    }

    /// What lifting from one place to another weighs at least.
    fn lifted(&self, from: &Waypoint, to: &Waypoint) -> Option<f64> {
        let height_m = |place: &Waypoint| self.height_at_m([place.x_m, place.y_m]).map(f64::from);
        Some(self.lifted_per_m * (height_m(to)? - height_m(from)?))
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

#[cfg(test)]
mod tests {
    use model::builtin;
    use rand::{RngExt, SeedableRng};
    use terrain::{Grid, Terrain};

    use super::*;
    use crate::{lattice::graph::Settings, refinement::connection::WORDS};

    /// Ground with hills of a few metres, in cells of one metre.
    fn hills(side: usize) -> Terrain {
        let grid = Grid { rows: side, columns: side, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        let height_m = |i: usize| {
            let (x, y) = ((i % side) as f64, (i / side) as f64);
            1.5 * (x / 5.0).sin() * (y / 7.0).cos() + 0.4 * (x / 2.0 + y / 3.0).sin()
        };
        let heights_m: Vec<f64> = (0..grid.cells()).map(height_m).collect();
        Terrain::new(grid, &heights_m).unwrap()
    }

    #[test]
    fn a_connection_is_given_up_only_where_it_costs_as_much_as_it_may() {
        let (terrain, robot) = (hills(60), builtin::husky_a200());
        let settings = Settings { reverse: true, ..Settings::of(&robot) };
        let lattice = Lattice::new(&terrain, &robot, settings).unwrap();
        let mut random = rand_pcg::Pcg64::seed_from_u64(7);
        let (mut driven, mut given_up) = (0, 0);
        for _ in 0..4000 {
            let objective =
                [Objective::Energy, Objective::Distance, Objective::Time][random.random_range(0..3)];
            let ground = FreeGround::new(&lattice, objective);
            let mut waypoint = || Waypoint {
                x_m: random.random_range(10.0..50.0),
                y_m: random.random_range(10.0..50.0),
                heading_rad: random.random_range(-3.2..3.2),
            };
            let (from, to) = (waypoint(), waypoint());
            let connection = Connection {
                radii_m: [random.random_range(0.0..4.0), random.random_range(0.5..20.0)],
                sides: WORDS[random.random_range(0..4)],
                reverse: random.random(),
            };
            let Some(cost) = ground.cost_below(&connection, [&from, &to], f64::INFINITY) else { continue };
            driven += 1;
            assert!(ground.least_between(&from, &to).unwrap() <= cost);
            let most = cost + random.random_range(-0.5..0.5) * cost.abs();
            let within = ground.cost_below(&connection, [&from, &to], most);
            assert_eq!(within, Some(cost).filter(|cost| *cost < most), "{connection:?} by {objective:?}");
            given_up += usize::from(within.is_none());
        }
        assert!(driven > 1000 && given_up > 300, "{driven} {given_up}");
    }
}
