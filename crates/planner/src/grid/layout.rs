//! Where states lie in memory: in tiles, so that neighbours stay close and untouched ground costs nothing.

use terrain::{Cell, Grid};

use crate::grid::{
    heading::{HEADINGS, Heading},
    state::State,
};

/// Edge of a tile in cells, as a power of two.
const TILE_BITS: u32 = 6;
/// Edge of a tile in cells.
pub(crate) const TILE: usize = 1 << TILE_BITS;
/// Cells in a tile.
pub(crate) const TILE_CELLS: usize = TILE * TILE;
/// Bits of a heading, the lowest of a state.
pub(crate) const HEADING_BITS: u32 = 4;
/// Bits of a state within its tile.
const WITHIN_BITS: u32 = 2 * TILE_BITS + HEADING_BITS;

/// Packs states into 32 bits: tile row, tile column, row in tile, column in tile, heading.
///
/// With the columns' bits at fixed places, a move by some columns and rows is two additions under masks.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout {
    /// Tiles from west to east.
    pub(crate) tile_columns: usize,
    /// Tiles from south to north.
    pub(crate) tile_rows: usize,
    tile_column_bits: u32,
    column_mask: u32,
    row_mask: u32,
}

/// A move prepared for [`Layout::shift`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Shift {
    columns: u32,
    rows: u32,
}

impl Layout {
    /// The layout of a grid, or `None` when its states do not fit 32 bits (beyond about 16 000 × 16 000 cells).
    pub(crate) fn new(grid: &Grid) -> Option<Self> {
        let tile_columns = grid.columns.div_ceil(TILE);
        let tile_rows = grid.rows.div_ceil(TILE);
        let tile_column_bits = tile_columns.next_power_of_two().trailing_zeros();
        let row_bits = tile_rows.next_power_of_two().trailing_zeros();
        if WITHIN_BITS + tile_column_bits + row_bits > 32 {
            return None;
        }
        let in_tile = (TILE as u32 - 1) << HEADING_BITS;
        let column_mask = in_tile | (((1u32 << tile_column_bits) - 1) << WITHIN_BITS);
        let row_mask = !column_mask & !((1 << HEADING_BITS) - 1);
        Some(Layout { tile_columns, tile_rows, tile_column_bits, column_mask, row_mask })
    }

    /// Number of tiles that the packing distinguishes; some of them lie beyond the grid.
    pub(crate) fn tiles(&self) -> usize {
        self.tile_rows << self.tile_column_bits
    }

    /// The tile of a packed state.
    #[inline(always)]
    pub(crate) fn tile(state: u32) -> usize {
        (state >> WITHIN_BITS) as usize
    }

    /// Position of a packed state within its tile.
    #[inline(always)]
    pub(crate) fn within(state: u32) -> usize {
        (state & ((1 << WITHIN_BITS) - 1)) as usize
    }

    /// Position of a packed state's cell among all cells of all tiles.
    #[inline(always)]
    pub(crate) fn cell(state: u32) -> usize {
        (state >> HEADING_BITS) as usize
    }

    /// Number of cells in all tiles that the packing distinguishes.
    pub(crate) fn cells(&self) -> usize {
        self.tiles() * TILE_CELLS
    }

    /// Whether a tile holds cells of the grid.
    pub(crate) fn holds(&self, tile: usize) -> bool {
        let (row, column) = self.tile_place(tile);
        row < self.tile_rows && column < self.tile_columns
    }

    /// The tile at a tile row and column.
    pub(crate) fn tile_at(&self, tile_row: usize, tile_column: usize) -> usize {
        (tile_row << self.tile_column_bits) | tile_column
    }

    /// Row and column of a tile.
    pub(crate) fn tile_place(&self, tile: usize) -> (usize, usize) {
        (tile >> self.tile_column_bits, tile & ((1 << self.tile_column_bits) - 1))
    }

    /// A tile and those around it that hold cells of the grid.
    pub(crate) fn tiles_around(&self, tile: usize) -> impl Iterator<Item = usize> + '_ {
        let (row, column) = self.tile_place(tile);
        let near = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
        near(row, self.tile_rows)
            .flat_map(move |row| near(column, self.tile_columns).map(move |column| self.tile_at(row, column)))
    }

    /// Packs a state.
    pub(crate) fn pack(&self, state: State) -> u32 {
        let Cell { row, column } = state.cell;
        let tile = self.tile_at(row / TILE, column / TILE) as u32;
        let within = ((row % TILE) << TILE_BITS | (column % TILE)) as u32;
        tile << WITHIN_BITS | within << HEADING_BITS | state.heading.index() as u32
    }

    /// Unpacks a state.
    pub(crate) fn unpack(&self, state: u32) -> State {
        let (row, column) = self.place(state);
        State { cell: Cell { row, column }, heading: Heading::new(state as usize & (HEADINGS - 1)) }
    }

    /// Row and column of a packed state's cell.
    #[inline(always)]
    pub(crate) fn place(&self, state: u32) -> (usize, usize) {
        let (tile_row, tile_column) = self.tile_place(Self::tile(state));
        let within = Self::within(state) >> HEADING_BITS;
        (tile_row * TILE + (within >> TILE_BITS), tile_column * TILE + (within & (TILE - 1)))
    }

    /// Prepares a move.
    pub(crate) fn prepare(&self, columns: i32, rows: i32) -> Shift {
        Shift { columns: self.spread(columns, self.column_mask), rows: self.spread(rows, self.row_mask) }
    }

    /// A number's bits laid out under a mask; negative numbers wrap as the masked addition does.
    fn spread(&self, value: i32, mask: u32) -> u32 {
        let (mut spread, mut bits, mut value) = (0, mask, value as u32);
        while bits != 0 {
            let lowest = bits & bits.wrapping_neg();
            if value & 1 == 1 {
                spread |= lowest;
            }
            value >>= 1;
            bits &= bits - 1;
        }
        spread
    }

    /// Moves the cell of a packed state; the heading's bits are lost.
    ///
    /// Bits between those of a coordinate are set before the addition, so that its carries run across them.
    #[inline(always)]
    pub(crate) fn shift(&self, state: u32, by: Shift) -> u32 {
        let columns = (state | !self.column_mask).wrapping_add(by.columns) & self.column_mask;
        let rows = (state | !self.row_mask).wrapping_add(by.rows) & self.row_mask;
        columns | rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packing_and_moving_agree_with_rows_and_columns() {
        for (rows, columns) in [(5, 3), (64, 64), (65, 700), (300, 129)] {
            let grid = Grid { rows, columns, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
            let layout = Layout::new(&grid).unwrap();
            for index in (0..grid.cells()).step_by(7) {
                let state = State { cell: grid.cell(index), heading: Heading::new(index) };
                let packed = layout.pack(state);
                assert_eq!(layout.unpack(packed), state);
                for (dc, dr) in [(1, 0), (-1, 2), (3, -3), (0, 64), (-65, 1)] {
                    let Some(column) = state.cell.column.checked_add_signed(dc) else { continue };
                    let Some(row) = state.cell.row.checked_add_signed(dr) else { continue };
                    if row >= rows || column >= columns {
                        continue;
                    }
                    let moved = State { cell: Cell { row, column }, heading: Heading::new(0) };
                    assert_eq!(
                        layout.shift(packed, layout.prepare(dc as i32, dr as i32)),
                        layout.pack(moved)
                    );
                }
            }
        }
    }

    #[test]
    fn a_grid_of_ten_thousand_by_ten_thousand_fits() {
        let grid = |side| Grid { rows: side, columns: side, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        assert!(Layout::new(&grid(10_000)).is_some());
        assert!(Layout::new(&grid(20_000)).is_none());
    }
}
