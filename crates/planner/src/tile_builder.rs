//! The codes of a tile, put together row by row.

use std::sync::Arc;

use multiversion::multiversion;

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
        let steps = self.displacements.len();
        let least = &mut self.least[row * GROUPS * steps..][..GROUPS * steps];
        store_row(slots, codes, self.displacements, least);
    }

    /// Codes by cell, heading and motion, and the least by displacement and cell.
    pub(crate) fn finish(self) -> (Codes, Least) {
        (self.codes.into(), self.least.into())
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2", "aarch64+neon"))]
fn store_row(slots: &[RowCodes], codes: &mut [u16], displacements: &[Displacement], least: &mut [Lanes]) {
    let stride = slots.len() / PACKED;
    let (cells, _) = codes.as_chunks_mut::<PACKED>();
    for (at, four) in slots.as_chunks::<PACKED>().0.iter().enumerate() {
        for (x, packed) in pack(four).into_iter().enumerate() {
            for (slot, code) in cells[x * stride + at].iter_mut().enumerate() {
                *code = (packed >> (16 * slot)) as u16;
            }
        }
    }
    let steps = displacements.len();
    for (i, least) in least.iter_mut().enumerate() {
        for &slot in &displacements[i % steps].slots {
            lower(least, &slots[slot][i / steps * LANES..][..LANES]);
        }
    }
}

/// Codes that fill a word; every stride is a multiple of it.
const PACKED: usize = 4;

/// The codes of each cell in one word, the first slot lowest.
#[inline(always)]
fn pack(slots: &[RowCodes; PACKED]) -> [u64; TILE] {
    let mut packed = [0; TILE];
    for x in 0..TILE {
        let low = u32::from(slots[0][x]) | u32::from(slots[1][x]) << 16;
        let high = u32::from(slots[2][x]) | u32::from(slots[3][x]) << 16;
        packed[x] = u64::from(low) | u64::from(high) << 32;
    }
    packed
}

/// Lowers codes to others where those are lower.
#[inline(always)]
pub(crate) fn lower(codes: &mut [u16], others: &[u16]) {
    for (code, other) in codes.iter_mut().zip(others) {
        *code = (*code).min(*other);
    }
}
