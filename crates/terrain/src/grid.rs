//! Where cells lie.

/// A cell by row (from the south) and column (from the west).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Cell {
    /// Row, 0 the southernmost.
    pub row: usize,
    /// Column, 0 the westernmost.
    pub column: usize,
}

/// Position and size of a regular grid of square cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Number of rows.
    pub rows: usize,
    /// Number of columns.
    pub columns: usize,
    /// Edge of a cell [m].
    pub cell_size_m: f64,
    /// South-west corner of cell (0, 0), x and y [m].
    pub origin_m: [f64; 2],
}

impl Grid {
    /// Number of cells.
    pub fn cells(&self) -> usize {
        self.rows * self.columns
    }

    /// Position of a cell in row-major storage.
    pub fn index(&self, cell: Cell) -> usize {
        cell.row * self.columns + cell.column
    }

    /// The cell at a position in row-major storage.
    pub fn cell(&self, index: usize) -> Cell {
        Cell { row: index / self.columns, column: index % self.columns }
    }

    /// Centre of a cell, x and y [m].
    pub fn center_m(&self, cell: Cell) -> [f64; 2] {
        [
            self.origin_m[0] + (cell.column as f64 + 0.5) * self.cell_size_m,
            self.origin_m[1] + (cell.row as f64 + 0.5) * self.cell_size_m,
        ]
    }

    /// The cell that holds a point, if the grid covers it; the upper edges belong to the grid.
    pub fn cell_at(&self, x_m: f64, y_m: f64) -> Option<Cell> {
        let along = |position_m: f64, origin_m: f64, count: usize| {
            let cells = (position_m - origin_m) / self.cell_size_m;
            (cells >= 0.0 && cells <= count as f64).then(|| (cells as usize).min(count - 1))
        };
        Some(Cell {
            row: along(y_m, self.origin_m[1], self.rows)?,
            column: along(x_m, self.origin_m[0], self.columns)?,
        })
    }

    /// North-east corner, x and y [m].
    pub fn far_corner_m(&self) -> [f64; 2] {
        [
            self.origin_m[0] + self.columns as f64 * self.cell_size_m,
            self.origin_m[1] + self.rows as f64 * self.cell_size_m,
        ]
    }

    /// The point at fractions of the extent, (0, 0) south-west and (1, 1) north-east [m].
    pub fn at_fraction_m(&self, east: f64, north: f64) -> [f64; 2] {
        let far_m = self.far_corner_m();
        [
            self.origin_m[0] + east * (far_m[0] - self.origin_m[0]),
            self.origin_m[1] + north * (far_m[1] - self.origin_m[1]),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const GRID: Grid = Grid { rows: 3, columns: 5, cell_size_m: 0.5, origin_m: [10.0, -2.0] };

    #[test]
    fn every_centre_lies_in_its_cell() {
        for index in 0..GRID.cells() {
            let cell = GRID.cell(index);
            let [x, y] = GRID.center_m(cell);
            assert_eq!(GRID.cell_at(x, y), Some(cell));
            assert_eq!(GRID.index(cell), index);
        }
    }

    #[test]
    fn points_outside_have_no_cell_and_the_far_corner_has_the_last() {
        assert_eq!(GRID.cell_at(9.99, -1.0), None);
        assert_eq!(GRID.cell_at(10.0, -2.01), None);
        assert_eq!(GRID.cell_at(f64::NAN, 0.0), None);
        let [x, y] = GRID.far_corner_m();
        assert_eq!(GRID.cell_at(x, y), Some(Cell { row: 2, column: 4 }));
        assert_eq!(GRID.cell_at(x + 0.01, y), None);
    }
}
