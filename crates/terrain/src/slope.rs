//! Gradient of the ground at every cell.

use rayon::prelude::*;

use crate::{Cell, Terrain};

/// East and north components of the gradient, row-major [-].
#[derive(Clone, Debug, PartialEq)]
pub struct SlopeMap {
    /// ∂z/∂x.
    pub east: Vec<f32>,
    /// ∂z/∂y.
    pub north: Vec<f32>,
}

impl SlopeMap {
    /// Gradients by the weighted differences of the eight neighbours.
    ///
    /// ```text
    /// ∂z/∂x = ((ne + 2e + se) − (nw + 2w + sw)) / (8 d),   ∂z/∂y likewise
    /// ```
    ///
    /// d cell size [m]. Horn (1981), Hill shading and the reflectance map, Proc. IEEE 69(1). A neighbour that is
    /// unknown or outside counts as level with the cell; unknown cells have no gradient (NaN).
    pub fn new(terrain: &Terrain) -> Self {
        let grid = &terrain.grid;
        let mut east = vec![f32::NAN; grid.cells()];
        let mut north = vec![f32::NAN; grid.cells()];
        east.par_chunks_mut(grid.columns).zip(north.par_chunks_mut(grid.columns)).enumerate().for_each(
            |(row, (east, north))| {
                self::row(terrain, row, 0, east, north);
            },
        );
        SlopeMap { east, north }
    }

    /// Gradient at a cell, east and north.
    pub fn at(&self, terrain: &Terrain, cell: Cell) -> (f64, f64) {
        let index = terrain.grid.index(cell);
        (f64::from(self.east[index]), f64::from(self.north[index]))
    }
}

/// Gradients, east and north, of the cells of one row from a column on.
///
/// # Panics
/// When the row does not have that many cells.
pub fn row(terrain: &Terrain, row: usize, from_column: usize, east: &mut [f32], north: &mut [f32]) {
    let neighbours = Neighbours::of(terrain, row);
    for (i, (east, north)) in east.iter_mut().zip(north).enumerate() {
        (*east, *north) = neighbours.gradient(from_column + i);
    }
}

/// Gradient at one cell, east and north; NaN where the cell is unknown.
pub fn gradient_at(terrain: &Terrain, cell: Cell) -> (f64, f64) {
    let (east, north) = Neighbours::of(terrain, cell.row).gradient(cell.column);
    (f64::from(east), f64::from(north))
}

/// A row and those south and north of it, where there are any.
struct Neighbours<'a> {
    south: Option<&'a [f32]>,
    here: &'a [f32],
    north: Option<&'a [f32]>,
    per_cell: f32,
}

impl<'a> Neighbours<'a> {
    fn of(terrain: &'a Terrain, row: usize) -> Self {
        let columns = terrain.grid.columns;
        let line = |r: usize| terrain.relative_m().get(r * columns..(r + 1) * columns);
        Neighbours {
            south: row.checked_sub(1).and_then(line),
            here: line(row).unwrap_or_default(),
            north: line(row + 1),
            per_cell: 1.0 / (8.0 * terrain.grid.cell_size_m as f32),
        }
    }

    #[inline]
    fn gradient(&self, column: usize) -> (f32, f32) {
        let level = self.here[column];
        let or_level = |z: f32| if z.is_nan() { level } else { z };
        let three = |line: Option<&[f32]>| match line {
            None => [level; 3],
            Some(line) => {
                let west = column.checked_sub(1).map_or(level, |c| line[c]);
                let east = line.get(column + 1).copied().unwrap_or(level);
                [or_level(west), or_level(line[column]), or_level(east)]
            }
        };
        let [sw, s, se] = three(self.south);
        let [w, _, e] = three(Some(self.here));
        let [nw, n, ne] = three(self.north);
        let east = (ne - nw) + 2.0 * (e - w) + (se - sw);
        let north = (nw - sw) + 2.0 * (n - s) + (ne - se);
        (east * self.per_cell, north * self.per_cell)
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::Grid;

    #[test]
    fn a_plane_has_its_gradient_everywhere_inside() {
        let grid = Grid { rows: 5, columns: 7, cell_size_m: 0.5, origin_m: [3.0, 4.0] };
        let z: Vec<f64> =
            (0..35).map(|i| grid.center_m(grid.cell(i))).map(|[x, y]| 0.3 * x - 0.1 * y).collect();
        let terrain = Terrain::new(grid, &z).unwrap();
        let slope = SlopeMap::new(&terrain);
        for row in 1..4 {
            for column in 1..6 {
                let (east, north) = slope.at(&terrain, Cell { row, column });
                assert_relative_eq!(east, 0.3, epsilon = 1e-5);
                assert_relative_eq!(north, -0.1, epsilon = 1e-5);
            }
        }
    }

    #[test]
    fn an_unknown_neighbour_does_not_spread() {
        let grid = Grid { rows: 3, columns: 3, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        let mut z = vec![5.0; 9];
        z[0] = f64::NAN;
        let slope = SlopeMap::new(&Terrain::new(grid, &z).unwrap());
        assert_eq!((slope.east[4], slope.north[4]), (0.0, 0.0));
        assert!(slope.east[0].is_nan());
    }
}
