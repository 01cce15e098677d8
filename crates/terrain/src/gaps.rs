//! Unknown ground that keeps two places of a map apart.

use std::collections::VecDeque;

use crate::{Cell, Terrain};

/// The least unknown ground between two places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gap {
    /// Unknown cells on the way that crosses fewest of them.
    pub cells: usize,
    /// Most of them one after the other.
    pub widest_cells: usize,
    /// Centre of the first of them, x and y [m].
    pub at_m: [f64; 2],
}

/// The gap between two cells: the way along edges of cells, clear of obstacles, that crosses fewest unknown cells; none where
/// that is no cell, or where there is no such way.
pub fn gap_between(terrain: &Terrain, from: Cell, to: Cell) -> Option<Gap> {
    const UNSEEN: u8 = u8::MAX;
    let grid = &terrain.grid;
    let is_unknown = |index: usize| terrain.relative_m[index].is_nan();
    let is_obstacle = |index: usize| terrain.obstacle.as_ref().is_some_and(|obstacle| obstacle[index]);
    // Steps by which cells were reached: known cells at once, unknown ones after all that crosses fewer.
    let mut came_by = vec![UNSEEN; grid.cells()];
    let mut reached = vec![u32::MAX; grid.cells()];
    let (start, goal) = (grid.index(from), grid.index(to));
    let mut queue = VecDeque::from([start]);
    reached[start] = 0;
    while let Some(index) = queue.pop_front() {
        if index == goal {
            break;
        }
        let crossed = reached[index];
        for (way, next) in steps(terrain, grid.cell(index)) {
            let cost = crossed + u32::from(is_unknown(next));
            if is_obstacle(next) || cost >= reached[next] {
                continue;
            }
            reached[next] = cost;
            came_by[next] = way;
            if cost == crossed { queue.push_front(next) } else { queue.push_back(next) }
        }
    }
    let cells = usize::try_from(reached[goal]).ok().filter(|_| reached[goal] != u32::MAX)?;
    let (mut index, mut run, mut widest_cells, mut first) = (goal, 0, 0, None);
    while index != start {
        run = if is_unknown(index) { run + 1 } else { 0 };
        widest_cells = widest_cells.max(run);
        first = if is_unknown(index) { Some(index) } else { first };
        index = stepped_back(terrain, index, came_by[index])?;
    }
    let at_m = grid.center_m(grid.cell(first?));
    Some(Gap { cells, widest_cells, at_m })
}

/// Cells beside a cell by edges, each with the number of the way to it: east, north, west, south.
fn steps(terrain: &Terrain, Cell { row, column }: Cell) -> impl Iterator<Item = (u8, usize)> {
    let grid = terrain.grid;
    let index = grid.index(Cell { row, column });
    let is_there = [column + 1 < grid.columns, row + 1 < grid.rows, column > 0, row > 0];
    let moved = move |way: u8| match way {
        0 => index + 1,
        1 => index + grid.columns,
        2 => index - 1,
        _ => index - grid.columns,
    };
    (0..4u8).filter(move |way| is_there[usize::from(*way)]).map(move |way| (way, moved(way)))
}

fn stepped_back(terrain: &Terrain, index: usize, way: u8) -> Option<usize> {
    let columns = terrain.grid.columns;
    match way {
        0 => index.checked_sub(1),
        1 => index.checked_sub(columns),
        2 => Some(index + 1),
        3 => Some(index + columns),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;

    fn ground(unknown: impl Fn(Cell) -> bool) -> Terrain {
        let grid = Grid { rows: 10, columns: 10, cell_size_m: 1.0, origin_m: [100.0, 200.0] };
        let z = |index| if unknown(grid.cell(index)) { f64::NAN } else { 1.0 };
        Terrain::new(grid, &(0..100).map(z).collect::<Vec<f64>>()).unwrap()
    }

    fn cell(row: usize, column: usize) -> Cell {
        Cell { row, column }
    }

    #[test]
    fn the_narrowest_crossing_is_found() {
        let seam = ground(|cell| cell.column == 4 || (cell.column == 5 && cell.row != 7));
        let gap = gap_between(&seam, cell(1, 1), cell(2, 8)).unwrap();
        assert_eq!((gap.cells, gap.widest_cells, gap.at_m), (1, 1, [104.5, 207.5]));
        assert_eq!(gap_between(&seam, cell(1, 1), cell(9, 3)), None, "on one side of it");
    }

    #[test]
    fn obstacles_are_no_gap() {
        let walled = ground(|_| false).with_obstacles((0..100).map(|i| i % 10 == 5).collect());
        assert_eq!(gap_between(&walled, cell(1, 1), cell(2, 8)), None);
    }
}
