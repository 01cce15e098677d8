//! The codes of a tile, put together row by row.

use std::{iter::repeat_n, sync::Arc};

use multiversion::multiversion;

use crate::{
    grid::{
        cost::FORBIDDEN,
        heading::HEADINGS,
        layout::{TILE, TILE_CELLS},
    },
    lattice::displacement::Displacement,
};

/// Codes of a tile; clones share them.
pub(crate) type Codes = Arc<[u16]>;
/// Codes of one motion from a row of cells.
pub(crate) type RowCodes = [u16; TILE];
/// Cells in a row that a field works on at once.
pub(crate) const LANES: usize = 16;
/// Groups of lanes in a row of a tile.
pub(crate) const GROUPS: usize = TILE / LANES;
/// Codes of one step from a group of lanes, within one line of memory.
#[derive(Clone, Copy)]
#[repr(align(32))]
pub(crate) struct Lanes(pub(crate) [u16; LANES]);
/// Least codes of a tile by row, group of lanes, displacement and lane, so that they are read in the order they lie in.
pub(crate) type Least = Arc<[Lanes]>;
/// States of a tile.
pub(crate) const TILE_STATES: usize = TILE_CELLS * HEADINGS;

/// A tile in the making.
pub(crate) struct TileBuilder<'d> {
    displacements: &'d [Displacement],
    codes: Codes,
    least: Least,
}

impl<'d> TileBuilder<'d> {
    /// A tile without any motion.
    pub(crate) fn new(stride: usize, displacements: &'d [Displacement]) -> Self {
        TileBuilder {
            displacements,
            codes: repeat_n(FORBIDDEN, TILE_STATES * stride).collect(),
            least: repeat_n(Lanes([FORBIDDEN; LANES]), TILE * GROUPS * displacements.len()).collect(),
        }
    }

    /// Its rows, each to be stored on its own.
    pub(crate) fn rows(&mut self) -> Vec<TileRow<'_>> {
        let (Some(codes), Some(least)) = (Arc::get_mut(&mut self.codes), Arc::get_mut(&mut self.least))
        else {
            unreachable!("a tile in the making is shared with nobody");
        };
        let rows = codes.chunks_exact_mut(codes.len() / TILE).zip(least.chunks_exact_mut(least.len() / TILE));
        rows.map(|(codes, least)| TileRow { displacements: self.displacements, codes, least }).collect()
    }

    /// Codes by quad of cells, heading, motion and cell, and the least by displacement and cell.
    pub(crate) fn finish(self) -> (Codes, Least) {
        (self.codes, self.least)
    }
}

/// A row of a tile in the making.
pub(crate) struct TileRow<'t> {
    displacements: &'t [Displacement],
    codes: &'t mut [u16],
    least: &'t mut [Lanes],
}

impl TileRow<'_> {
    /// Stores the codes of its cells, given slot by slot.
    pub(crate) fn store(&mut self, slots: &[RowCodes]) {
        store_row(slots, self.codes, self.displacements, self.least);
    }
}

#[multiversion(targets("x86_64+avx512f+avx512vl+avx512dq+avx512bw", "x86_64+avx2+fma", "aarch64+neon"))]
fn store_row(slots: &[RowCodes], codes: &mut [u16], displacements: &[Displacement], least: &mut [Lanes]) {
    let (codes, _) = codes.as_chunks_mut::<QUAD>();
    for (quad, codes) in codes.chunks_exact_mut(slots.len()).enumerate() {
        for (four, slot) in codes.iter_mut().zip(slots) {
            *four = slot.as_chunks().0[quad];
        }
    }
    let steps = displacements.len();
    for (i, least) in least.iter_mut().enumerate() {
        for &slot in &displacements[i % steps].slots {
            lower(&mut least.0, &slots[slot][i / steps * LANES..][..LANES]);
        }
    }
}

/// Cells of a row whose codes lie together by heading, motion and cell: those of a state are within a memory line or two,
/// and those of a motion can be read four at a time.
pub(crate) const QUAD: usize = 4;

/// Place of the code of the first motion from a state of a tile; those of its other motions follow every [`QUAD`] codes.
#[inline(always)]
pub(crate) fn code_place(within: usize, stride: usize) -> usize {
    let (cell, heading) = (within / HEADINGS, within % HEADINGS);
    (cell / QUAD * HEADINGS + heading) * stride * QUAD + cell % QUAD
}

/// Lowers codes to others where those are lower.
#[inline(always)]
pub(crate) fn lower(codes: &mut [u16], others: &[u16]) {
    for (code, other) in codes.iter_mut().zip(others) {
        *code = (*code).min(*other);
    }
}
