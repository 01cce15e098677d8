//! Cost of every motion from every state, for one objective, evaluated tile by tile as it is asked for.

use std::{
    ops::Range,
    sync::{
        Arc, Mutex, MutexGuard, OnceLock, TryLockError,
        atomic::{AtomicUsize, Ordering},
    },
    time::Duration,
};

use rayon::prelude::*;
use terrain::CellRange;

use crate::{
    grid::{
        cost::{FORBIDDEN, LARGEST_ROUNDING, SINGLE_PRECISION, UNITS_OF_REFERENCE, decode},
        layout::{Layout, TILE},
        state::State,
    },
    lattice::{
        displacement::Displacement,
        graph::Lattice,
        objective::{Objective, Surcharge, Weights},
        prices::Prices,
    },
    patience::Patience,
    table::{
        least::least_cost_per_m,
        proof::{Proof, cancellation},
        strips::{StateCodes, Strips},
        tile::TileKernel,
        tile_bound::{BoundKernel, Bounds},
        tile_builder::{Codes, Lanes, Least},
    },
};

/// Costs of all motions, with gravity taken out of energy so that none is negative.
///
/// Stored in 16 bits a motion, rounded up by at most [`CostTable::LARGEST_ROUNDING`], in tiles that are evaluated when they
/// are first asked for.
pub struct CostTable {
    lattice: Arc<Lattice>,
    weights: Weights,
    kernel: TileKernel,
    /// `None` where there are no bounds; prepared when first asked for.
    bound_kernel: OnceLock<Option<BoundKernel>>,
    units: f64,
    /// Codes of all motions of each tile's states, by quad of cells, heading, motion and cell.
    codes: Vec<OnceLock<Codes>>,
    /// Least codes of each tile's cells, by row, group of lanes, displacement and lane, over headings and motions.
    least: Vec<OnceLock<Least>>,
    /// Tiles of which a search has looked at little.
    strips: Vec<OnceLock<Arc<Strips>>>,
    /// Tiles whose codes are held.
    held: AtomicUsize,
    /// Held while a tile is evaluated, so that two threads that need it do not both do the work.
    turns: [Mutex<()>; TURNS],
    displacements: Vec<Displacement>,
    least_units_per_cell: f32,
    proof: Proof,
}

/// A small part of the time that a tile takes.
const WAIT_FOR_A_TURN: Duration = Duration::from_micros(50);
/// Waits for a turn, several times as long as a tile takes. Who has it may be waiting for this very thread: while its rows are evaluated side by
/// side a thread takes up other work, which may ask for the same turn.
const MOST_WAITS: usize = 400;

/// Tiles that can be evaluated at the same time; more than any machine has cores.
const TURNS: usize = 256;

impl CostTable {
    /// Largest relative rounding of a cost.
    pub const LARGEST_ROUNDING: f64 = LARGEST_ROUNDING;

    /// A table that evaluates a tile when it is first asked for one of its costs.
    pub fn lazy(lattice: &Arc<Lattice>, objective: Objective) -> Self {
        let table = Self::weighted(lattice, lattice.weights(objective));
        let proof = Proof::new(lattice, objective, &table.weights, table.units);
        CostTable { proof, ..table }
    }

    /// The same for a sum of energy beyond lifting, length and time, whose unit is that of the weights' products.
    pub fn weighted(lattice: &Arc<Lattice>, weights: Weights) -> Self {
        let units = units_per_cost(lattice, &weights);
        let cell_size_m = lattice.terrain.grid.cell_size_m;
        let takes_some =
            |columns, rows| weights.per_j > 0.0 || weights.per_s > 0.0 || (columns, rows) != (0, 0);
        CostTable {
            lattice: Arc::clone(lattice),
            weights,
            kernel: TileKernel::new(lattice, weights, units),
            bound_kernel: OnceLock::new(),
            units,
            codes: (0..lattice.layout.tiles()).map(|_| OnceLock::new()).collect(),
            least: (0..lattice.layout.tiles()).map(|_| OnceLock::new()).collect(),
            strips: (0..lattice.layout.tiles()).map(|_| OnceLock::new()).collect(),
            held: AtomicUsize::new(0),
            turns: [const { Mutex::new(()) }; TURNS],
            displacements: Displacement::of(lattice),
            least_units_per_cell: (least_cost_per_m(lattice, &weights) * units * cell_size_m) as f32,
            proof: Proof::of_sum(lattice, &weights, units, takes_some),
        }
    }

    /// A table with every tile evaluated, in parallel; `None` when patience ends first.
    pub fn new(lattice: &Arc<Lattice>, objective: Objective, patience: &Patience) -> Option<Self> {
        let table = Self::lazy(lattice, objective);
        let Layout { tile_rows, tile_columns, .. } = lattice.layout;
        let evaluated = (0..tile_rows * tile_columns).into_par_iter().try_for_each(|i| {
            let tile = lattice.layout.tile_at(i / tile_columns, i % tile_columns);
            table.evaluate(tile, true, patience)
        });
        evaluated.map(|()| table)
    }

    /// The table of a lattice over ground that differs in some cells only: tiles that these do not touch are shared.
    ///
    /// The lattice must be that of the same robot and settings over a map of the same size.
    pub(crate) fn patched(&self, lattice: &Arc<Lattice>, changed: &CellRange) -> Self {
        let table = CostTable { proof: self.proof, ..Self::weighted(lattice, self.weights) };
        for tile in (0..self.codes.len()).filter(|tile| self.is_untouched(*tile, lattice, changed)) {
            if let Some(least) = self.least[tile].get() {
                let _ = table.least[tile].set(Arc::clone(least));
            }
            if let Some(codes) = self.codes[tile].get() {
                let _ = table.codes[tile].set(Arc::clone(codes));
                table.held.fetch_add(1, Ordering::Relaxed);
            }
            if let Some(strips) = self.strips[tile].get() {
                let _ = table.strips[tile].set(Arc::clone(strips));
            }
        }
        table
    }

    /// Whether no motion from a tile depends on cells that another lattice of the same robot and settings has changed, nor on kinds of
    /// ground whose numbers have.
    pub(crate) fn is_untouched(&self, tile: usize, lattice: &Lattice, changed: &CellRange) -> bool {
        let reach = self.kernel.reach();
        let near = |at: usize, changed: &Range<usize>| {
            at * TILE < changed.end + reach && changed.start < (at + 1) * TILE + reach
        };
        let (row, column) = lattice.layout.tile_place(tile);
        lattice.classes == self.lattice.classes
            && !(near(row, &changed.rows) && near(column, &changed.columns))
    }

    /// The lattice whose motions it prices.
    pub fn lattice(&self) -> &Arc<Lattice> {
        &self.lattice
    }

    /// What the costs are of.
    pub fn weights(&self) -> &Weights {
        &self.weights
    }

    /// Number of tiles whose costs are held.
    pub fn tiles_held(&self) -> usize {
        self.held.load(Ordering::Relaxed)
    }

    /// Bytes held.
    pub fn bytes(&self) -> usize {
        let least = self.least.iter().filter_map(OnceLock::get).map(|least| size_of_val(&least[..]));
        let codes = self.codes.iter().filter_map(OnceLock::get).map(|codes| size_of_val(&codes[..]));
        let strips = self.strips.iter().filter_map(OnceLock::get).map(|strips| strips.bytes());
        least.chain(codes).chain(strips).sum()
    }

    /// Units per joule, metre or second.
    pub fn units(&self) -> f64 {
        self.units
    }

    /// The least amount of its objective, or of its sum of weights, that a path of at least so many units takes when it is
    /// driven; for energy without lifting.
    pub(crate) fn proven(&self, units: f64) -> f64 {
        self.proof.least(units)
    }

    /// The most that a path of so many units costs when it is driven, in the objective's unit.
    pub(crate) fn at_most(&self, units: f64) -> f64 {
        units / self.units * (1.0 + SINGLE_PRECISION)
    }

    /// Amount that each unit of a path's cost proves where nothing is taken off.
    pub(crate) fn proven_per_unit(&self) -> f64 {
        self.proof.per_unit()
    }

    /// The fewest units of a path that takes so much when it is driven, in the objective's unit.
    pub(crate) fn fewest_units(&self, amount: f64) -> f64 {
        amount * self.units / ((1.0 + SINGLE_PRECISION) * (1.0 + self.proof.lost(self.units)))
    }

    /// Least cost of a motion per cell of distance between its ends, in units.
    pub(crate) fn least_units_per_cell(&self) -> f32 {
        self.least_units_per_cell
    }

    /// Codes per state, one for each motion.
    pub(crate) fn stride(&self) -> usize {
        self.kernel.stride
    }

    /// The codes of all motions of a tile's states, evaluated when they are first asked for; `None` when patience ends first.
    #[inline(always)]
    pub(crate) fn codes(&self, tile: usize, patience: &Patience) -> Option<&[u16]> {
        match self.codes[tile].get() {
            Some(codes) => Some(codes),
            None => {
                self.evaluate_around(tile, true, patience)?;
                self.codes[tile].get().map(|codes| &codes[..])
            }
        }
    }

    /// Codes of all motions from a packed state, for a search that looks at few of a tile's: evaluated with those of its row and heading, and
    /// with the whole tile once it has looked at many; `None` when patience ends first.
    #[inline(always)]
    pub(crate) fn state_codes(&self, state: u32, patience: &Patience) -> Option<StateCodes<'_>> {
        match self.codes[Layout::tile(state)].get() {
            Some(codes) => Some(StateCodes::of_tile(codes, state, self.stride())),
            None => self.strip_codes(state, patience),
        }
    }

    fn strip_codes(&self, state: u32, patience: &Patience) -> Option<StateCodes<'_>> {
        let tile = Layout::tile(state);
        let strips = self.strips[tile].get_or_init(|| Strips::new(&self.lattice, tile).into());
        if !strips.are_many() {
            return strips.codes((&self.kernel, &self.lattice), state, patience);
        }
        self.evaluate(tile, true, patience)?;
        self.state_codes_at_hand(state)
    }

    /// The same if they have been evaluated.
    #[inline(always)]
    pub(crate) fn state_codes_at_hand(&self, state: u32) -> Option<StateCodes<'_>> {
        let tile = Layout::tile(state);
        match self.codes.get(tile)?.get() {
            Some(codes) => Some(StateCodes::of_tile(codes, state, self.stride())),
            None => self.strips[tile].get()?.codes_at_hand(state),
        }
    }

    /// Lets go of what only further costs need, which is made again when they are asked for.
    pub(crate) fn rest(&self) {
        self.strips.iter().filter_map(OnceLock::get).for_each(|strips| strips.rest());
    }

    /// The least codes of a tile, evaluated when first asked for; `None` when patience ends first.
    #[inline(always)]
    pub(crate) fn least(&self, tile: usize, patience: &Patience) -> Option<&[Lanes]> {
        match self.least[tile].get() {
            Some(least) => Some(least),
            None => {
                let keep_codes = self.held.load(Ordering::Relaxed) < HELD_FOR_FIELDS;
                self.evaluate_around(tile, keep_codes, patience)?;
                self.least[tile].get().map(|least| &least[..])
            }
        }
    }

    /// Lower bounds of the least codes of a tile, in the same order, which are not held, or those codes themselves where there are
    /// no bounds; `None` when patience ends first.
    pub(crate) fn bounds(&self, tile: usize, patience: &Patience) -> Option<Least> {
        let (lattice, known) = (&self.lattice, &self.least[tile]);
        if known.get().is_none()
            && lattice.layout.holds(tile)
            && let Some(kernel) = self.bound_kernel(patience)?
        {
            let place = lattice.layout.tile_place(tile);
            let bounds = kernel.evaluate((&self.kernel, &self.displacements), lattice, place, patience)?;
            if let Bounds::Known(bounds) = bounds {
                return Some(bounds);
            }
        }
        self.least(tile, patience)?;
        known.get().map(Arc::clone)
    }

    /// What bounds are worked out with, `Some(None)` where there are none; `None` when patience ends first.
    pub(crate) fn bound_kernel(&self, patience: &Patience) -> Option<Option<&BoundKernel>> {
        if let Some(prepared) = self.bound_kernel.get() {
            return Some(prepared.as_ref());
        }
        let cancellation = cancellation(&self.lattice, &self.weights) * self.units;
        let precision = (self.units, cancellation);
        let prepared =
            BoundKernel::prepare(&self.lattice, &self.weights, &self.displacements, precision, patience)?;
        Some(self.bound_kernel.get_or_init(|| prepared).as_ref())
    }

    /// A tile's codes if they are held.
    #[inline(always)]
    pub(crate) fn codes_at_hand(&self, tile: usize) -> Option<&[u16]> {
        self.codes.get(tile)?.get().map(|codes| &codes[..])
    }

    /// Evaluates a tile together with its neighbours, in parallel: a search that needs one will soon need those.
    #[cold]
    fn evaluate_around(&self, tile: usize, keep_codes: bool, patience: &Patience) -> Option<()> {
        let around = self.lattice.layout.tiles_around(tile);
        let around: Vec<usize> = around.filter(|t| self.least[*t].get().is_none()).collect();
        around.into_par_iter().try_for_each(|t| self.evaluate(t, keep_codes, patience))?;
        self.evaluate(tile, keep_codes, patience)
    }

    /// One tile; those beyond the grid hold nothing. `None` when patience ends first: nothing half-done is kept.
    fn evaluate(&self, tile: usize, keep_codes: bool, patience: &Patience) -> Option<()> {
        let is_held =
            || self.least[tile].get().is_some() && (!keep_codes || self.codes[tile].get().is_some());
        if is_held() {
            return Some(());
        }
        let _turn = self.turn(tile, patience)?;
        if is_held() {
            return Some(());
        }
        let (codes, least) = if self.lattice.layout.holds(tile) {
            let place = self.lattice.layout.tile_place(tile);
            self.kernel.evaluate(&self.lattice, place, &self.displacements, patience)?
        } else {
            (Codes::default(), Least::default())
        };
        if keep_codes && self.codes[tile].set(codes).is_ok() {
            self.held.fetch_add(1, Ordering::Relaxed);
        }
        let _ = self.least[tile].set(least);
        Some(())
    }

    /// The turn to evaluate a tile, or leave to do so without one after [`MOST_WAITS`]; `None` when patience ends before.
    fn turn(&self, tile: usize, patience: &Patience) -> Option<Option<MutexGuard<'_, ()>>> {
        for _ in 0..MOST_WAITS {
            match self.turns[tile % TURNS].try_lock() {
                Ok(turn) => return Some(Some(turn)),
                Err(TryLockError::Poisoned(poisoned)) => return Some(Some(poisoned.into_inner())),
                Err(TryLockError::WouldBlock) if patience.is_over() => return None,
                Err(TryLockError::WouldBlock) => std::thread::sleep(WAIT_FOR_A_TURN),
            }
        }
        Some(None)
    }

    /// Steps between cells that motions make.
    pub(crate) fn displacements(&self) -> &[Displacement] {
        &self.displacements
    }

    /// Code of a motion from a packed state, whatever it takes to know it.
    pub(crate) fn code(&self, state: u32, motion: usize) -> u16 {
        let codes = self.codes(Layout::tile(state), &Patience::default());
        codes
            .and_then(|codes| StateCodes::of_tile(codes, state, self.stride()).of(motion))
            .unwrap_or(FORBIDDEN)
    }

    /// Where the motions from a state lead and what they cost in the table's units, for other searches over the same graph.
    pub fn successors(&self, state: State) -> impl Iterator<Item = (State, u32)> + '_ {
        let packed = self.lattice.layout.pack(state);
        (0..self.lattice.motions_per_state()).filter_map(move |motion| {
            let code = self.code(packed, motion);
            let next = self.lattice.successor(state, motion).filter(|_| code != FORBIDDEN)?;
            Some((next, decode(code)))
        })
    }

    /// Cost of a motion from a state, in the objective's own unit; infinite where it cannot be driven.
    pub fn cost(&self, state: State, motion: usize) -> f64 {
        let code = self.code(self.lattice.layout.pack(state), motion);
        if code == FORBIDDEN { f64::INFINITY } else { f64::from(decode(code)) / self.units }
    }
}

/// Tiles whose codes a field, which needs only the least of them, keeps for the search that follows: a gigabyte. On larger
/// ground the search evaluates again what it comes across, which is little of what a field covers.
const HELD_FOR_FIELDS: usize = 1024;

/// Units per joule, metre or second: one step east on level ground sets the scale.
fn units_per_cost(lattice: &Lattice, weights: &Weights) -> f64 {
    let cost = weights.cost(&lattice.level_step(), 0.0).max(lattice.reference_j() * weights.per_j);
    let grid = &lattice.terrain.grid;
    let across = (grid.rows + grid.columns) as f64;
    let dearer = dearest(lattice, weights, cost) / DEAREST;
    UNITS_OF_REFERENCE / cost / (across / LONGEST_ACROSS).max(1.0) / dearer.max(1.0)
}

/// How much preferences may make of a step at most, in costs of one on level ground.
fn dearest(lattice: &Lattice, weights: &Weights, level_cost: f64) -> f64 {
    let [_, factor] = lattice.classes.factors();
    let step = lattice.level_step();
    let Prices { reverse_j_per_m, reverse_s_per_m, spin_j_per_rad, spin_s_per_rad, .. } =
        lattice.settings.prices;
    let risk_j_per_m = lattice.classes.largest_risk_j_per_m();
    let reverse = Surcharge { j: reverse_j_per_m + risk_j_per_m, m: 0.0, s: reverse_s_per_m };
    let spin = Surcharge { j: spin_j_per_rad, m: 0.0, s: spin_s_per_rad };
    let priced = weights.of_surcharge(&reverse) * step.length_m + weights.of_surcharge(&spin);
    factor + priced / level_cost
}

/// Units grow coarser from where preferences make a step so many times as dear.
const DEAREST: f64 = 4.0;

/// Rows and columns of a map from which on units grow coarser. Costs stay below 2^31 units, 32 768 steps on level ground
/// where units are finest, so a path may then cost four times as much as level steps along two sides of the map.
const LONGEST_ACROSS: f64 = 8192.0;

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use model::builtin;
    use terrain::{Grid, Terrain};

    use super::*;
    use crate::lattice::graph::Settings;

    /// As where the thread that evaluates a tile takes up another search, which asks for the same tile. It waited for itself until its
    /// deadline.
    #[test]
    fn a_thread_that_has_a_turn_and_asks_for_it_again_gets_its_tile() {
        let grid = Grid { rows: 8, columns: 8, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        let terrain = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap();
        let robot = builtin::husky_a200();
        let deadline = Patience::until(Instant::now() + Duration::from_secs(60));
        let lattice = Lattice::prepare(&terrain, &robot, Settings::of(&robot), &deadline).unwrap();
        let table = CostTable::lazy(&lattice, Objective::Energy);
        let held = table.turns[0].lock().unwrap();
        assert!(table.codes(0, &deadline).is_some());
        drop(held);
    }
}
