//! Positions of all cells of a grid in another one, exact at every so many and bilinear between.

use rayon::prelude::*;

use super::WarpRefusal;
use crate::crs::Size;

/// Positions at a lattice of cells.
///
/// Over h metres a graticule in UTM bends by h² · tan φ / 8R (R the earth's radius): at 60° over 16 cells of 30 m that is a
/// thousandth of a cell. Where it is more than [`Lattice::BOUND_CELLS`], as it may be of cells of 100 m close to 84°, the lattice is made finer.
pub(super) struct Lattice {
    step: usize,
    /// Nodes of a row.
    across: usize,
    nodes: Vec<[f64; 2]>,
}

impl Lattice {
    /// Cells from one node to the next.
    pub(super) const STEP: usize = 16;
    /// Largest error of a position [cells]; heights are off by as large a part of the step between neighbouring cells.
    pub(super) const BOUND_CELLS: f64 = 0.01;

    /// The lattice of a grid of some size; `exact` has the position of a cell by its column and row. The error is bounded where it is
    /// largest: midway between nodes.
    ///
    /// # Errors
    /// What `exact` says.
    pub(super) fn of<F>(size: Size, exact: &F) -> Result<Self, WarpRefusal>
    where
        F: Fn([f64; 2]) -> Result<[f64; 2], WarpRefusal> + Sync,
    {
        let mut step = Self::STEP;
        loop {
            let lattice = Self::with_step(step, size, exact)?;
            if step == 1 || lattice.largest_error(exact)? < Self::BOUND_CELLS {
                return Ok(lattice);
            }
            step /= 2;
        }
    }

    fn with_step<F>(step: usize, size: Size, exact: &F) -> Result<Self, WarpRefusal>
    where
        F: Fn([f64; 2]) -> Result<[f64; 2], WarpRefusal> + Sync,
    {
        // One node lies past the last cell, so that every cell has nodes on all sides.
        let nodes_along = |cells: usize| (cells - 1) / step + 2;
        let (across, along) = (nodes_along(size.columns), nodes_along(size.rows));
        let node = |index: usize| exact([index % across, index / across].map(|at| (at * step) as f64));
        let nodes = (0..across * along).into_par_iter().map(node).collect::<Result<Vec<_>, _>>()?;
        Ok(Lattice { step, across, nodes })
    }

    /// Position of a cell.
    pub(super) fn at(&self, column: f64, row: f64) -> [f64; 2] {
        let step = self.step as f64;
        let (east, north) = (column / step, row / step);
        let (node_column, node_row) = (east as usize, north as usize);
        let (east, north) = (east - node_column as f64, north - node_row as f64);
        let south_west = node_row * self.across + node_column;
        let [sw, se] = [self.nodes[south_west], self.nodes[south_west + 1]];
        let [nw, ne] = [self.nodes[south_west + self.across], self.nodes[south_west + self.across + 1]];
        [0, 1].map(|axis| {
            let south = sw[axis] + east * (se[axis] - sw[axis]);
            let north_side = nw[axis] + east * (ne[axis] - nw[axis]);
            south + north * (north_side - south)
        })
    }

    /// Largest difference from the exact positions midway between nodes [cells].
    fn largest_error<F>(&self, exact: &F) -> Result<f64, WarpRefusal>
    where
        F: Fn([f64; 2]) -> Result<[f64; 2], WarpRefusal> + Sync,
    {
        let (across, along) = (self.across - 1, self.nodes.len() / self.across - 1);
        let error = |index: usize| {
            let [column, row] =
                [index % across, index / across].map(|at| (at as f64 + 0.5) * self.step as f64);
            let ([x, y], [exact_x, exact_y]) = (self.at(column, row), exact([column, row])?);
            Ok((x - exact_x).abs().max((y - exact_y).abs()))
        };
        (0..across * along).into_par_iter().map(error).try_reduce(|| 0.0, |one, other| Ok(one.max(other)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn largest_off(bend: f64, size: Size) -> (f64, usize) {
        let exact = |[column, row]: [f64; 2]| Ok([column + bend * row * row, row - bend * column * column]);
        let lattice = Lattice::of(size, &exact).unwrap();
        let mut largest = 0.0f64;
        for (column, row) in (0..size.columns).flat_map(|c| (0..size.rows).map(move |r| (c as f64, r as f64)))
        {
            let ([x, y], [u, v]) = (lattice.at(column, row), exact([column, row]).unwrap());
            largest = largest.max((x - u).abs()).max((y - v).abs());
        }
        (largest, lattice.step)
    }

    #[test]
    fn positions_are_off_by_less_than_the_bound_however_much_they_bend() {
        let size = Size { columns: 37, rows: 50 };
        for (bend, step) in [(0.0, 16), (1e-4, 16), (1e-3, 4), (0.1, 1)] {
            let (off, found) = largest_off(bend, size);
            assert!(off < Lattice::BOUND_CELLS && found == step, "{bend}: {off} at step {found}");
        }
    }

    #[test]
    fn a_single_cell_has_a_position() {
        assert_eq!(largest_off(0.0, Size { columns: 1, rows: 1 }).0, 0.0);
    }
}
