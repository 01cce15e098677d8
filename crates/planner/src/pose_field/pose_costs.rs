//! Costs of all poses of a map, in tiles that exist once they are reached.

use crate::{
    frontier::labels::Labels,
    grid::{
        cost::ENDLESS,
        heading::HEADINGS,
        layout::{HEADING_BITS, Layout, TILE, TILE_CELLS},
    },
    patience::{Patience, work},
    pose_field::pose_sweep::PoseSweep,
    table::tile_builder::TILE_STATES,
};

/// Costs in the table's units by heading, row and column of each tile; [`ENDLESS`] where no motions lead.
pub(crate) struct PoseCosts {
    tiles: Vec<Option<Box<[u32]>>>,
}

impl PoseCosts {
    pub(crate) fn new(layout: &Layout) -> Self {
        PoseCosts { tiles: vec![None; layout.tiles()] }
    }

    /// The costs that a search left; `None` when patience ends first.
    pub(crate) fn of_labels(layout: &Layout, labels: &Labels, patience: &Patience) -> Option<Self> {
        let (mut costs, mut pacer) = (Self::new(layout), patience.pacer());
        for tile in (0..layout.tiles()).filter(|tile| labels.holds(*tile)) {
            pacer.after(TILE_STATES as u64 * work::CELL)?;
            let first = (tile * TILE_STATES) as u32;
            let known = costs.tile_mut(tile);
            for state in first..first + TILE_STATES as u32 {
                known[place(state)] = labels.cost(state).min(ENDLESS);
            }
        }
        Some(costs)
    }

    /// Cost of a packed state.
    #[inline(always)]
    pub(crate) fn cost(&self, state: u32) -> u32 {
        self.tiles[Layout::tile(state)].as_ref().map_or(ENDLESS, |tile| tile[place(state)])
    }

    /// Lowers a packed state's cost; `false` when it was as low before.
    pub(crate) fn lower(&mut self, state: u32, cost: u32) -> bool {
        let known = &mut self.tile_mut(Layout::tile(state))[place(state)];
        let falls = cost < *known;
        *known = cost.min(*known);
        falls
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        self.tiles.iter().flatten().map(|tile| size_of_val(&tile[..])).sum()
    }

    /// Copies the costs of a tile and within reach around it, given the tiles from south-west to north-east.
    pub(crate) fn load(&self, around: &[Option<usize>; 9], sweep: &mut PoseSweep) {
        let reach = sweep.stencil.reach;
        // First row or column of a tile that is needed, where it goes, and how many are.
        let parts = [(TILE - reach, 0, reach), (0, reach, TILE), (0, reach + TILE, reach)];
        for (i, tile) in around.iter().enumerate() {
            let ((from_row, to_row, rows), (from_column, to_column, columns)) = (parts[i / 3], parts[i % 3]);
            let known = tile.and_then(|tile| self.tiles[tile].as_ref());
            for (heading, row) in (0..HEADINGS).flat_map(|heading| (0..rows).map(move |row| (heading, row))) {
                let to = sweep.row_place(heading, to_row + row) + to_column;
                let to = &mut sweep.costs[to..][..columns];
                match known {
                    None => to.fill(ENDLESS),
                    Some(known) => {
                        let from = heading * TILE_CELLS + (from_row + row) * TILE + from_column;
                        to.copy_from_slice(&known[from..][..columns]);
                    }
                }
            }
        }
    }

    /// Copies back what has fallen.
    pub(crate) fn store(&mut self, tile: usize, sweep: &PoseSweep) {
        let tile = self.tile_mut(tile);
        for (heading, rows) in sweep.lowered.iter().enumerate() {
            for row in (0..TILE).filter(|row| rows >> row & 1 == 1) {
                let costs = &sweep.costs[sweep.place(heading, row)..][..TILE];
                tile[heading * TILE_CELLS + row * TILE..][..TILE].copy_from_slice(costs);
            }
        }
    }

    fn tile_mut(&mut self, tile: usize) -> &mut [u32] {
        self.tiles[tile].get_or_insert_with(|| vec![ENDLESS; TILE_STATES].into_boxed_slice())
    }
}

/// Place of a packed state among the costs of its tile.
#[inline(always)]
fn place(state: u32) -> usize {
    let within = Layout::within(state);
    (within & (HEADINGS - 1)) * TILE_CELLS + (within >> HEADING_BITS)
}
