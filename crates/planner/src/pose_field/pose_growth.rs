//! How an exact field grows: tile by tile, in the order of the least cost at which anything in them may still fall.
//!
//! Dijkstra's search takes states one by one in the order of their costs, and waits for memory at each. Settled tile by
//! tile a state is looked at some thirteen times instead of once, but rows of them together and where they are at hand: a third
//! of the time (`joulepath bench`). Costs are the least in the end, in whatever order tiles are taken.

use std::{cmp::Reverse, collections::BinaryHeap};

use rayon::prelude::*;

use crate::{
    frontier::dijkstra::{Dijkstra, Direction},
    grid::{
        heading::HEADINGS,
        layout::{Layout, TILE},
        state::State,
    },
    patience::{Patience, work},
    pose_field::{
        pose_codes::CodesAround, pose_costs::PoseCosts, pose_stencil::PoseStencil, pose_sweep::PoseSweep,
    },
    table::cost_table::CostTable,
};

/// Tiles that are settled at the same time, each as if the others stayed as they were; what they change is looked at again
/// from tile to tile.
const ABREAST: usize = 8;

/// Costs that are copied in the time in which a cell is looked at.
const COPIED_IN_A_CELL: u64 = 8;

/// Where costs may fall.
struct Waiting {
    /// No cost below this one will fall.
    key: u32,
    /// By row: headings under which costs may fall.
    pending: [u16; TILE],
}

/// The tiles of a field that are still to be taken up.
struct Front<'f> {
    layout: &'f Layout,
    stencil: &'f PoseStencil,
    queue: BinaryHeap<Reverse<(u32, u32)>>,
    waiting: Vec<Option<Box<Waiting>>>,
}

/// Least costs of all poses up to a limit, from seeds with theirs, in the table's units; `None` when patience ends first.
pub(crate) fn grow(
    table: &CostTable,
    direction: Direction,
    seeds: &[(State, u32)],
    limit: u32,
    patience: &Patience,
) -> Option<PoseCosts> {
    let layout = &table.lattice().layout;
    let stencil = PoseStencil::new(table.lattice(), table.stride(), direction);
    if stencil.reach > TILE {
        // Arcs over the finest of cells lead past the tiles around.
        let mut search = Dijkstra::new(table, direction, seeds.iter().copied(), patience)?;
        search.settle_within(limit)?;
        return PoseCosts::of_labels(layout, &search.labels, patience);
    }
    let mut costs = PoseCosts::new(layout);
    let mut front = Front::new(layout, &stencil);
    let mut pacer = patience.pacer();
    for &(seed, cost) in seeds {
        pacer.after(work::STATE)?;
        if cost <= limit && costs.lower(layout.pack(seed), cost) {
            front.seed(seed, cost);
        }
    }
    drop(pacer);
    let mut sweeps = Vec::new();
    loop {
        let taken = front.pop(ABREAST);
        if taken.is_empty() {
            return Some(costs);
        }
        let codes = taken
            .iter()
            .map(|(tile, _)| codes_around(table, direction, *tile, patience))
            .collect::<Option<Vec<_>>>()?;
        sweeps.resize_with(taken.len().max(sweeps.len()), || PoseSweep::new(stencil.clone(), limit));
        let known = &costs;
        taken.par_iter().zip(&mut sweeps).zip(codes).try_for_each(|(((tile, waiting), sweep), codes)| {
            if patience.is_over() {
                return None;
            }
            sweep.begin(&waiting.pending);
            known.load(&around(layout, *tile), sweep);
            patience.worked(sweep.costs.len() as u64 / COPIED_IN_A_CELL);
            sweep.settle(&codes, patience)
        })?;
        for ((tile, _), sweep) in taken.iter().zip(&sweeps) {
            costs.store(*tile, sweep);
            front.pass_on(*tile, sweep);
        }
    }
}

/// A tile and those around it from south-west to north-east, as far as there are any.
fn around(layout: &Layout, tile: usize) -> [Option<usize>; 9] {
    let (row, column) = layout.tile_place(tile);
    std::array::from_fn(|i| {
        let row = (row + i / 3).checked_sub(1).filter(|row| *row < layout.tile_rows)?;
        let column = (column + i % 3).checked_sub(1).filter(|column| *column < layout.tile_columns)?;
        Some(layout.tile_at(row, column))
    })
}

/// The codes that settling a tile asks for; `None` when patience ends first.
fn codes_around<'t>(
    table: &'t CostTable,
    direction: Direction,
    tile: usize,
    patience: &Patience,
) -> Option<CodesAround<'t>> {
    let mut codes = [None; 9];
    for (i, near) in around(&table.lattice().layout, tile).into_iter().enumerate() {
        if let Some(near) = near.filter(|near| *near == tile || direction == Direction::FromStarts) {
            codes[i] = Some(table.codes(near, patience)?);
        }
    }
    Some(codes)
}

/// Poses of a row of a tile under one heading, and the least of their costs.
struct Fallen {
    tile: usize,
    heading: usize,
    row: usize,
    cells: u64,
    least: u32,
}

impl<'f> Front<'f> {
    fn new(layout: &'f Layout, stencil: &'f PoseStencil) -> Self {
        let waiting = (0..layout.tiles()).map(|_| None).collect();
        Front { layout, stencil, queue: BinaryHeap::new(), waiting }
    }

    /// Takes up to `most` tiles in the order of their keys.
    fn pop(&mut self, most: usize) -> Vec<(usize, Box<Waiting>)> {
        let mut taken = Vec::with_capacity(most);
        while taken.len() < most
            && let Some(Reverse((key, tile))) = self.queue.pop()
        {
            // A tile is queued again whenever its key falls; only the last entry counts.
            let waiting = self.waiting[tile as usize].take_if(|waiting| waiting.key == key);
            taken.extend(waiting.map(|waiting| (tile as usize, waiting)));
        }
        taken
    }

    /// Has everything looked at that may take its cost from a seed.
    fn seed(&mut self, seed: State, cost: u32) {
        let packed = self.layout.pack(seed);
        let (row, column) = (seed.cell.row % TILE, seed.cell.column % TILE);
        let heading = seed.heading.index();
        let fallen = Fallen { tile: Layout::tile(packed), heading, row, cells: 1 << column, least: cost };
        self.note(&fallen, |_| true);
    }

    /// Has tiles around looked at as far as they depend on what has fallen.
    fn pass_on(&mut self, tile: usize, sweep: &PoseSweep) {
        let reach = self.stencil.reach;
        let west = 1u64.checked_shl(reach as u32).unwrap_or(0).wrapping_sub(1);
        for (heading, row) in (0..HEADINGS).flat_map(|heading| (0..TILE).map(move |row| (heading, row))) {
            let is_inside = (reach..TILE - reach).contains(&row);
            let cells =
                sweep.fallen[heading][row] & if is_inside { west | west.reverse_bits() } else { u64::MAX };
            if cells != 0 {
                let costs = sweep.costs[sweep.place(heading, row)..][..TILE].iter().enumerate();
                let fallen = costs.filter(|(x, _)| cells >> x & 1 == 1).map(|(_, cost)| *cost);
                let least = fallen.min().unwrap_or(u32::MAX);
                self.note(&Fallen { tile, heading, row, cells, least }, |near| near != tile);
            }
        }
    }

    /// Has those tiles looked at where poses may take costs that have fallen.
    fn note(&mut self, fallen: &Fallen, is_wanted: impl Fn(usize) -> bool) {
        let around = around(self.layout, fallen.tile);
        for taker in &self.stencil.takers[fallen.heading] {
            let y = (fallen.row + TILE).wrapping_add_signed(-taker.rows);
            let tiles = &around[y / TILE * 3..][..3];
            for (tile, origins) in tiles.iter().zip(taker.origins(fallen.cells)) {
                let Some(tile) = tile.filter(|tile| origins != 0 && is_wanted(*tile)) else { continue };
                let nothing = || Box::new(Waiting { key: u32::MAX, pending: [0; TILE] });
                let waiting = self.waiting[tile].get_or_insert_with(nothing);
                waiting.pending[y % TILE] |= 1 << taker.heading;
                if fallen.least < waiting.key {
                    waiting.key = fallen.least;
                    self.queue.push(Reverse((fallen.least, tile as u32)));
                }
            }
        }
    }
}
