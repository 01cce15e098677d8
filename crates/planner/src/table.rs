//! Cost of every motion from every state, for one objective, evaluated tile by tile as it is asked for.

use std::{collections::BTreeMap, sync::OnceLock};

use rayon::prelude::*;

use crate::{
    cost::{FORBIDDEN, LARGEST_ROUNDING, UNITS_OF_REFERENCE, decode},
    edge::Edge,
    heading::HEADINGS,
    lattice::{Lattice, State},
    layout::{Layout, TILE, TILE_CELLS},
    patience::Patience,
    rate::least_cost_per_m,
    tile::{Codes, TileKernel},
};

/// What a path is to have least of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Objective {
    /// Energy drawn from the battery.
    #[default]
    Energy,
    /// Length along the ground.
    Distance,
    /// Time.
    Time,
}

/// Share of a path's length or time that its energy may weigh on level ground, to choose between equals.
const TIE_SHARE: f64 = 1e-5;

/// An objective as weights of what a motion takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Weights {
    /// Of energy beyond lifting.
    pub(crate) per_j: f64,
    /// Of length.
    pub(crate) per_m: f64,
    /// Of time.
    pub(crate) per_s: f64,
}

impl Objective {
    /// The objective's weights for a robot that takes `level` for a step on level ground.
    pub(crate) fn weights(self, level: &Edge) -> Weights {
        let tie = |amount: f64| if level.energy_j > 0.0 { TIE_SHARE * amount / level.energy_j } else { 0.0 };
        match self {
            Objective::Energy => Weights { per_j: 1.0, per_m: 0.0, per_s: 0.0 },
            Objective::Distance => Weights { per_j: tie(level.length_m), per_m: 1.0, per_s: 0.0 },
            Objective::Time => Weights { per_j: tie(level.duration_s), per_m: 0.0, per_s: 1.0 },
        }
    }
}

impl Weights {
    /// Cost of a motion that was driven, between places whose height potentials differ by `lifted_j`.
    pub(crate) fn cost(&self, edge: &Edge, lifted_j: f64) -> f64 {
        let friction_j = edge.energy_j - lifted_j;
        debug_assert!(
            friction_j >= -1e-6 * (1.0 + lifted_j.abs()),
            "a motion gained {friction_j} J besides gravity"
        );
        // Only rounding can have made it negative.
        self.per_j * friction_j.max(0.0) + self.per_m * edge.length_m + self.per_s * edge.duration_s
    }
}

/// Costs of all motions, with gravity taken out of energy so that none is negative.
///
/// Stored in 16 bits a motion, rounded up by at most [`CostTable::LARGEST_ROUNDING`].
pub struct CostTable<'l> {
    lattice: &'l Lattice<'l>,
    kernel: TileKernel,
    units: f64,
    tiles: Vec<OnceLock<Tile>>,
    displacements: Vec<Displacement>,
    least_units_per_cell: f32,
}

impl<'l> CostTable<'l> {
    /// Largest relative rounding of a cost.
    pub const LARGEST_ROUNDING: f64 = LARGEST_ROUNDING;

    /// A table that evaluates a tile when it is first asked for one of its costs.
    pub fn lazy(lattice: &'l Lattice<'l>, objective: Objective) -> Self {
        let weights = lattice.weights(objective);
        let units = UNITS_OF_REFERENCE / reference_cost(lattice, &weights);
        CostTable {
            lattice,
            kernel: TileKernel::new(lattice, weights, units),
            units,
            tiles: (0..lattice.layout.tiles()).map(|_| OnceLock::new()).collect(),
            displacements: Displacement::of(lattice),
            least_units_per_cell: (least_cost_per_m(lattice, &weights)
                * units
                * lattice.terrain.grid.cell_size_m) as f32,
        }
    }

    /// Least cost of a motion per cell of distance between its ends, in units.
    pub(crate) fn least_units_per_cell(&self) -> f32 {
        self.least_units_per_cell
    }

    /// A table with every tile evaluated, in parallel; `None` when patience ends first.
    pub fn new(lattice: &'l Lattice<'l>, objective: Objective, patience: &Patience) -> Option<Self> {
        let table = Self::lazy(lattice, objective);
        let Layout { tile_rows, tile_columns, .. } = lattice.layout;
        let evaluated = (0..tile_rows * tile_columns).into_par_iter().try_for_each(|i| {
            if patience.is_over() {
                return None;
            }
            table.evaluated(lattice.layout.tile_at(i / tile_columns, i % tile_columns));
            Some(())
        });
        evaluated.map(|()| table)
    }

    /// Units per joule, metre or second.
    pub(crate) fn units(&self) -> f64 {
        self.units
    }

    /// Slots per state; those beyond the motions are forbidden.
    pub(crate) fn stride(&self) -> usize {
        self.kernel.stride
    }

    /// A tile, evaluated when it is first asked for.
    #[inline(always)]
    fn whole_tile(&self, tile: usize) -> &Tile {
        match self.tiles[tile].get() {
            Some(evaluated) => evaluated,
            None => self.evaluate_around(tile),
        }
    }

    /// Evaluates a tile together with its neighbours, in parallel: a search that needs one will soon need those.
    #[cold]
    fn evaluate_around(&self, tile: usize) -> &Tile {
        let layout = &self.lattice.layout;
        let (row, column) = layout.tile_place(tile);
        let near = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
        let around: Vec<usize> = near(row, layout.tile_rows)
            .flat_map(|r| near(column, layout.tile_columns).map(move |c| layout.tile_at(r, c)))
            .filter(|t| self.tiles[*t].get().is_none())
            .collect();
        around.into_par_iter().for_each(|t| {
            self.evaluated(t);
        });
        self.evaluated(tile)
    }

    /// One tile; those beyond the grid hold nothing.
    fn evaluated(&self, tile: usize) -> &Tile {
        self.tiles[tile].get_or_init(|| {
            if !self.lattice.layout.holds(tile) {
                return Tile::default();
            }
            let place = self.lattice.layout.tile_place(tile);
            self.kernel.evaluate(self.lattice, place, &self.displacements, &Patience::default()).unwrap_or_default()
        })
    }

    /// The codes of all motions of a tile's states.
    #[inline(always)]
    pub(crate) fn tile(&self, tile: usize) -> &[u16] {
        &self.whole_tile(tile).codes
    }

    /// Steps between cells that motions make.
    pub(crate) fn displacements(&self) -> &[Displacement] {
        &self.displacements
    }

    /// The least code of the motions by a displacement from any heading of a packed state's cell; forbidden beyond the map.
    #[inline(always)]
    pub(crate) fn least(&self, state: u32, displacement: usize) -> u16 {
        let place = displacement * TILE_CELLS + Layout::within(state) / HEADINGS;
        self.whole_tile(Layout::tile(state)).least.get(place).copied().unwrap_or(FORBIDDEN)
    }

    /// Cost of a motion from a state, in the objective's own unit; infinite where it cannot be driven.
    pub fn cost(&self, state: State, motion: usize) -> f64 {
        let packed = self.lattice.layout.pack(state);
        let code = self.tile(Layout::tile(packed))[Layout::within(packed) * self.stride() + motion];
        if code == FORBIDDEN { f64::INFINITY } else { f64::from(decode(code)) / self.units }
    }
}

/// The costs of one tile.
#[derive(Default)]
pub(crate) struct Tile {
    /// By cell, heading and motion.
    codes: Box<[u16]>,
    /// By displacement and cell, the least over headings and motions.
    least: Box<[u16]>,
}

impl Tile {
    /// A tile without any motion.
    pub(crate) fn forbidden(stride: usize, displacements: usize) -> Self {
        Tile {
            codes: vec![FORBIDDEN; TILE_STATES * stride].into_boxed_slice(),
            least: vec![FORBIDDEN; TILE_CELLS * displacements].into_boxed_slice(),
        }
    }

    /// Stores the codes of a row of cells, given slot by slot.
    pub(crate) fn store_row(&mut self, row: usize, slots: &[Codes], displacements: &[Displacement]) {
        let codes = &mut self.codes[row * TILE * slots.len()..][..TILE * slots.len()];
        // Eight slots at a time, so that neighbouring codes are written together.
        for (at, eight) in slots.chunks(8).enumerate() {
            for (x, cell) in codes.chunks_exact_mut(slots.len()).enumerate() {
                for (code, slot) in cell[8 * at..].iter_mut().zip(eight) {
                    *code = slot[x];
                }
            }
        }
        for (d, displacement) in displacements.iter().enumerate() {
            let least = &mut self.least[d * TILE_CELLS + row * TILE..][..TILE];
            for &slot in &displacement.slots {
                lower(least, &slots[slot]);
            }
        }
    }
}

/// Lowers codes to others where those are lower.
#[inline(always)]
pub(crate) fn lower(codes: &mut [u16], others: &[u16]) {
    for (code, other) in codes.iter_mut().zip(others) {
        *code = (*code).min(*other);
    }
}

/// A step between cells and the motions that make it, as slots among the codes of a cell.
pub(crate) struct Displacement {
    pub(crate) columns: i32,
    pub(crate) rows: i32,
    slots: Vec<usize>,
}

impl Displacement {
    /// All steps of a lattice's motions; turning on the spot is none.
    pub(crate) fn of(lattice: &Lattice<'_>) -> Vec<Self> {
        let stride = lattice.motions_per_state().next_multiple_of(4);
        let mut steps = BTreeMap::<(i32, i32), Vec<usize>>::new();
        for (heading, motions) in lattice.motions.iter().enumerate() {
            for (index, motion) in motions.iter().enumerate() {
                if (motion.columns, motion.rows) != (0, 0) {
                    steps.entry((motion.columns, motion.rows)).or_default().push(heading * stride + index);
                }
            }
        }
        steps.into_iter().map(|((columns, rows), slots)| Displacement { columns, rows, slots }).collect()
    }
}

/// Cost of one step east on level ground, which sets the scale.
fn reference_cost(lattice: &Lattice<'_>, weights: &Weights) -> f64 {
    let cost = weights.cost(&lattice.level_step(), 0.0);
    // A robot without any friction still needs a scale: that of lifting it by a thousandth of a cell.
    cost.max(1e-3 * lattice.lift_j_per_m() * lattice.terrain.grid.cell_size_m * weights.per_j)
}

/// The cheapest way to drive a motion from a state: its variant and cost.
pub(crate) fn cheapest(
    lattice: &Lattice<'_>,
    weights: &Weights,
    state: State,
    motion: usize,
) -> Option<(usize, f64)> {
    let end = lattice.successor(state, motion)?;
    let lifted_j = lattice.potential_j(end.cell) - lattice.potential_j(state.cell);
    lattice
        .variants(state.cell, state.heading, motion)
        .enumerate()
        .filter_map(|(variant, edge)| Some((variant, weights.cost(&edge?, lifted_j))))
        .min_by(|a, b| a.1.total_cmp(&b.1))
}

/// States of a tile.
pub(crate) const TILE_STATES: usize = TILE_CELLS * HEADINGS;
