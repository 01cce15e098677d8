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
        let per_cell = 1.0 / (8.0 * grid.cell_size_m as f32);
        east.par_chunks_mut(grid.columns).zip(north.par_chunks_mut(grid.columns)).enumerate().for_each(
            |(row, (east, north))| {
                let rows = neighbour_rows(terrain, row);
                for column in 0..grid.columns {
                    let (gx, gy) = gradient(rows, column);
                    east[column] = gx * per_cell;
                    north[column] = gy * per_cell;
                }
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

/// The rows south of, at and north of a row; the row itself where there is none.
fn neighbour_rows(terrain: &Terrain, row: usize) -> [&[f32]; 3] {
    let columns = terrain.grid.columns;
    let line = |r: usize| &terrain.relative_m()[r * columns..(r + 1) * columns];
    [line(row.saturating_sub(1)), line(row), line((row + 1).min(terrain.grid.rows - 1))]
}

fn gradient([south, here, north]: [&[f32]; 3], column: usize) -> (f32, f32) {
    let (west, east) = (column.saturating_sub(1), (column + 1).min(here.len() - 1));
    let level = here[column];
    let or_level = |z: f32| if z.is_nan() { level } else { z };
    let [sw, s, se] = [west, column, east].map(|c| or_level(south[c]));
    let [w, e] = [west, east].map(|c| or_level(here[c]));
    let [nw, n, ne] = [west, column, east].map(|c| or_level(north[c]));
    ((ne - nw) + 2.0 * (e - w) + (se - sw), (nw - sw) + 2.0 * (n - s) + (ne - se))
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
