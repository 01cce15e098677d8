//! Codes of motions as the poses of a tile pull by them, rows of cells side by side.

use crate::{
    frontier::prefetch::prefetch,
    grid::{
        heading::HEADINGS,
        layout::{TILE, TILE_CELLS},
    },
    pose_field::pose_stencil::{PoseStencil, Pull},
    table::tile_builder::{QUAD, RowCodes},
};

/// Codes of a tile and those around it, from south-west to north-east; `None` beyond the map or where they are not needed.
pub(crate) type CodesAround<'c> = [Option<&'c [u16]>; 9];

/// The codes of one tile, in the order in which they are needed.
pub(crate) struct PoseCodes {
    /// By row, heading and pull.
    rows: Vec<RowCodes>,
    /// Rows that are in order.
    ready: u64,
    /// Rows of the table's codes that were asked of memory, from one beyond those needed on.
    asked: Vec<bool>,
}

/// Codes in 64 bytes, which is what memory hands out at once.
const CODES_IN_A_LINE: usize = 32;

impl PoseCodes {
    pub(crate) fn new(stencil: &PoseStencil) -> Self {
        PoseCodes {
            rows: vec![[0; TILE]; TILE * HEADINGS * stencil.motions],
            ready: 0,
            asked: vec![false; TILE + 2 * stencil.driven_within + 2],
        }
    }

    /// Begins with another tile.
    pub(crate) fn clear(&mut self) {
        self.ready = 0;
        self.asked.fill(false);
    }

    /// Codes of a row of a heading, pull by pull.
    #[inline(always)]
    pub(crate) fn of(&self, row: usize, heading: usize, motions: usize) -> &[RowCodes] {
        &self.rows[(row * HEADINGS + heading) * motions..][..motions]
    }

    /// Puts the codes of a row in order.
    #[inline(always)]
    pub(crate) fn make_ready(&mut self, row: usize, stencil: &PoseStencil, around: &CodesAround<'_>) {
        if self.ready >> row & 1 == 1 {
            return;
        }
        self.ready |= 1 << row;
        let within = stencil.driven_within;
        // The rows beside are likely to be next.
        for y in row..=row + 2 * within + 2 {
            if !std::mem::replace(&mut self.asked[y], true) {
                ask(around, y + TILE - within - 1);
            }
        }
        let count = HEADINGS * stencil.motions;
        let codes = &mut self.rows[row * count..][..count];
        for (codes, pull) in codes.iter_mut().zip(stencil.pulls.iter().flatten()) {
            collect(around, row, pull, codes);
        }
    }
}

/// Asks memory for the codes of a row of cells, counted from the southernmost of the tiles around: they lie one after the
/// other but are not read so.
#[inline(always)]
fn ask(around: &CodesAround<'_>, y: usize) {
    for codes in around.iter().skip(y / TILE * 3).take(3).flatten() {
        let count = codes.len() / TILE;
        for at in (y % TILE * count..(y % TILE + 1) * count).step_by(CODES_IN_A_LINE) {
            prefetch(codes, at);
        }
    }
}

/// Codes of a motion for the poses of a row, wherever it is driven from.
#[inline(always)]
fn collect(around: &CodesAround<'_>, row: usize, pull: &Pull, lanes: &mut RowCodes) {
    let (rows, columns) = pull.driven_from;
    let (y, x) = ((row + TILE).wrapping_add_signed(rows), TILE.wrapping_add_signed(columns));
    let tiles: [_; 3] =
        std::array::from_fn(|i| around[y / TILE * 3 + i].map(|codes| row_of(codes, y % TILE)));
    let (lanes, _) = lanes.as_chunks_mut::<QUAD>();
    if let (0, Some(quads)) = (columns, tiles[1]) {
        for (lanes, quad) in lanes.iter_mut().zip(quads.chunks_exact(quads.len() / QUADS)) {
            *lanes = quad[pull.slot];
        }
        return;
    }
    let quad = |x: usize| -> u64 {
        let quads = tiles.get(x / TILE).copied().flatten();
        quads.map_or(u64::MAX, |quads| word(quads[x % TILE / QUAD * (quads.len() / QUADS) + pull.slot]))
    };
    // Four cells at a time, moved into place together.
    let shift = (x % QUAD) as u32 * u16::BITS;
    let mut this = quad(x);
    for (i, lanes) in lanes.iter_mut().enumerate() {
        let next = quad(x + (i + 1) * QUAD);
        *lanes = codes(if shift == 0 { this } else { this >> shift | next << (u64::BITS - shift) });
        this = next;
    }
}

/// Quads of cells in a row of a tile.
const QUADS: usize = TILE / QUAD;

/// The codes of a row of a tile, quad by quad and slot by slot.
#[inline(always)]
fn row_of(codes: &[u16], row: usize) -> &[[u16; QUAD]] {
    let (quads, _) = codes.as_chunks();
    let count = quads.len() / (TILE_CELLS / TILE);
    &quads[row * count..][..count]
}

/// Four codes in a word, the first lowest.
#[inline(always)]
fn word(codes: [u16; QUAD]) -> u64 {
    let [a, b, c, d] = codes.map(u64::from);
    a | b << 16 | c << 32 | d << 48
}

/// The codes in a word.
#[inline(always)]
fn codes(word: u64) -> [u16; QUAD] {
    [word as u16, (word >> 16) as u16, (word >> 32) as u16, (word >> 48) as u16]
}
