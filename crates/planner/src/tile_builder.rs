//! The codes of a tile, put together row by row.

use std::sync::Arc;

use crate::{
    cost::FORBIDDEN,
    displacement::Displacement,
    heading::HEADINGS,
    layout::{TILE, TILE_CELLS},
};

/// Codes of a tile; clones share them.
pub(crate) type Codes = Arc<[u16]>;
/// Codes of one motion from a row of cells.
pub(crate) type RowCodes = [u16; TILE];
/// Cells in a row that a field works on at once.
pub(crate) const LANES: usize = 16;
/// Groups of lanes in a row of a tile.
pub(crate) const GROUPS: usize = TILE / LANES;
/// Codes of one step from a group of lanes.
pub(crate) type Lanes = [u16; LANES];
/// Least codes of a tile by row, group of lanes, displacement and lane, so that they are read in the order they lie in.
pub(crate) type Least = Arc<[Lanes]>;
/// States of a tile.
pub(crate) const TILE_STATES: usize = TILE_CELLS * HEADINGS;

/// A tile in the making.
pub(crate) struct TileBuilder<'d> {
    displacements: &'d [Displacement],
    codes: Vec<u16>,
    least: Vec<Lanes>,
}

impl<'d> TileBuilder<'d> {
    /// A tile without any motion.
    pub(crate) fn new(stride: usize, displacements: &'d [Displacement]) -> Self {
        TileBuilder {
            displacements,
            codes: vec![FORBIDDEN; TILE_STATES * stride],
            least: vec![[FORBIDDEN; LANES]; TILE * GROUPS * displacements.len()],
        }
    }

    /// Stores the codes of a row of cells, given slot by slot.
    pub(crate) fn store_row(&mut self, row: usize, slots: &[RowCodes]) {
        let codes = &mut self.codes[row * TILE * slots.len()..][..TILE * slots.len()];
        // Eight slots at a time, so that neighbouring codes are written together.
        for (at, eight) in slots.chunks(8).enumerate() {
            for (x, cell) in codes.chunks_exact_mut(slots.len()).enumerate() {
                for (code, slot) in cell[8 * at..].iter_mut().zip(eight) {
                    *code = slot[x];
                }
            }
        }
        let steps = self.displacements.len();
        let least = &mut self.least[row * GROUPS * steps..][..GROUPS * steps];
        for (i, least) in least.iter_mut().enumerate() {
            for &slot in &self.displacements[i % steps].slots {
                lower(least, &slots[slot][i / steps * LANES..][..LANES]);
            }
        }
    }

    /// Codes by cell, heading and motion, and the least by displacement and cell.
    pub(crate) fn finish(self) -> (Codes, Least) {
        (self.codes.into(), self.least.into())
    }
}

/// Lowers codes to others where those are lower.
#[inline(always)]
pub(crate) fn lower(codes: &mut [u16], others: &[u16]) {
    for (code, other) in codes.iter_mut().zip(others) {
        *code = (*code).min(*other);
    }
}
