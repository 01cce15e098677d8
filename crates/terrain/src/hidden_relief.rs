//! How steep the ground may be within a cell, where the map has one slope: as much as the slopes of neighbouring cells differ.
//!
//! On a lidar map of 1 m that is coarsened to cells of 4 to 60 m, this is 1.0 to 1.9 times the slope that the coarsening hides
//! (`crates/terrain/tests/hidden_relief.rs`).

use crate::{Cell, Terrain};

/// Cells on each side whose slopes are compared.
const AROUND: usize = 2;

/// Most that [`slope_rms`] overstates the slope that is hidden, as a factor; it hardly understates it.
pub const MOST_OVERSTATED: f64 = 1.9;

/// Root mean square of the differences between the slopes of neighbouring cells around a cell, along rows and columns [-]; 0 where
/// fewer than three known cells lie in a row.
///
/// ```text
/// √ mean ((z₊ − 2 z + z₋) / d)²
/// ```
///
/// d cell size [m].
pub fn slope_rms(terrain: &Terrain, cell: Cell) -> f64 {
    let grid = &terrain.grid;
    let span = |at: usize, count: usize| at.saturating_sub(AROUND)..(at + AROUND + 1).min(count);
    let (rows, columns) = (span(cell.row, grid.rows), span(cell.column, grid.columns));
    let height_m = |row: usize, column: usize| {
        (row < grid.rows && column < grid.columns)
            .then(|| terrain.elevation_m(Cell { row, column }))
            .flatten()
    };
    let (mut sum, mut count) = (0.0, 0.0);
    let mut hold = |heights_m: [Option<f64>; 3]| {
        if let [Some(before), Some(at), Some(after)] = heights_m {
            sum += ((after - 2.0 * at + before) / grid.cell_size_m).powi(2);
            count += 1.0;
        }
    };
    for row in rows {
        for column in columns.clone() {
            let at = height_m(row, column);
            let beside =
                |row: Option<usize>, column: Option<usize>| row.zip(column).and_then(|(r, c)| height_m(r, c));
            hold([beside(Some(row), column.checked_sub(1)), at, beside(Some(row), Some(column + 1))]);
            hold([beside(row.checked_sub(1), Some(column)), at, beside(Some(row + 1), Some(column))]);
        }
    }
    if count > 0.0 { f64::sqrt(sum / count) } else { 0.0 }
}
