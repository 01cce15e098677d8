//! Heights of a rectangle of the map and around it, laid out for reading rows of cells side by side.

use terrain::{Cell, Terrain};

use crate::ground::stance::Offset;

/// Heights about a rectangle of cells; those beyond the map are unknown.
pub(crate) struct Heights {
    /// Row and column of the map, of the first of the cells held.
    first: (isize, isize),
    width: usize,
    relative_m: Vec<f32>,
}

impl Heights {
    /// The heights of `rows` by `columns` cells from one on, possibly before the map's first, and `margin` cells around.
    pub(crate) fn new(
        terrain: &Terrain,
        (row, column): (isize, isize),
        (rows, columns): (usize, usize),
        margin: usize,
    ) -> Self {
        let first = (row - margin as isize, column - margin as isize);
        let (height, width) = (rows + 2 * margin, columns + 2 * margin);
        let mut relative_m = vec![f32::NAN; width * height];
        let grid = &terrain.grid;
        let west = usize::try_from(first.1).unwrap_or(0);
        let east = usize::try_from(first.1 + width as isize).unwrap_or(0).min(grid.columns);
        for (y, out) in relative_m.chunks_exact_mut(width).enumerate() {
            let Some(row) = usize::try_from(first.0 + y as isize).ok().filter(|row| *row < grid.rows) else {
                continue;
            };
            if west < east {
                let from = grid.index(Cell { row, column: west });
                let at = (west as isize - first.1) as usize;
                out[at..at + east - west].copy_from_slice(&terrain.relative_m()[from..from + east - west]);
            }
        }
        Heights { first, width, relative_m }
    }

    /// Height at an offset from a cell, NaN where unknown [m].
    #[inline]
    pub(crate) fn at_m(&self, cell: Cell, offset: Offset) -> f32 {
        self.row_m((cell.row as isize, cell.column as isize), offset, 1)[0]
    }

    /// Heights of `count` cells at an offset from those of a row of the map.
    #[inline(always)]
    pub(crate) fn row_m(&self, place: (isize, isize), (columns, rows): Offset, count: usize) -> &[f32] {
        let row = (place.0 - self.first.0) + rows as isize;
        let column = (place.1 - self.first.1) + columns as isize;
        let start = row as usize * self.width + column as usize;
        &self.relative_m[start..start + count]
    }
}
