//! Cells in the order of their king's distance from a cell.

use terrain::{Cell, Grid};

/// The cells of the map at exactly a king's distance from a cell, row by row.
pub(crate) fn ring(grid: &Grid, home: Cell, distance: usize) -> impl Iterator<Item = Cell> + use<> {
    let (rows, columns) = (grid.rows, grid.columns);
    let south = home.row.saturating_sub(distance);
    let north = home.row.saturating_add(distance).min(rows.saturating_sub(1));
    (south..=north).flat_map(move |row| {
        let west = home.column.checked_sub(distance);
        let east = home.column.checked_add(distance).filter(|column| *column < columns);
        let whole = row.abs_diff(home.row) == distance;
        let first = home.column.saturating_sub(distance);
        let last = home.column.saturating_add(distance).min(columns.saturating_sub(1));
        let ends = [west, east.filter(|_| distance > 0)].into_iter().flatten();
        let inner = ends.filter(move |_| !whole);
        let run = (first..=last).filter(move |_| whole);
        inner.chain(run).map(move |column| Cell { row, column })
    })
}

/// King's distance from a cell to the farthest cell of the map.
pub(crate) fn farthest_ring(grid: &Grid, home: Cell) -> usize {
    let rows = home.row.max(grid.rows.saturating_sub(1).saturating_sub(home.row));
    rows.max(home.column).max(grid.columns.saturating_sub(1).saturating_sub(home.column))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_hold_every_cell_of_the_map_once_at_its_distance() {
        let grid = Grid { rows: 6, columns: 9, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        for home in [Cell { row: 0, column: 0 }, Cell { row: 3, column: 7 }, Cell { row: 5, column: 2 }] {
            let mut seen = Vec::new();
            for distance in 0..=farthest_ring(&grid, home) {
                for cell in ring(&grid, home, distance) {
                    assert_eq!(cell.row.abs_diff(home.row).max(cell.column.abs_diff(home.column)), distance);
                    seen.push(cell);
                }
            }
            seen.sort();
            assert_eq!(seen, (0..grid.cells()).map(|i| grid.cell(i)).collect::<Vec<_>>());
        }
    }
}
