//! Grids of square cells, north up, out of rasters that are oblong, turned or upside down.

use rayon::prelude::*;

use crate::{Error, Grid, Terrain};

/// A map from pixels, counted from a raster's first corner, to coordinates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Affine {
    /// Coordinates of the outer corner of the first pixel.
    pub(crate) origin: [f64; 2],
    /// Step from one column to the next.
    pub(crate) column: [f64; 2],
    /// Step from one row to the next.
    pub(crate) row: [f64; 2],
}

impl Affine {
    /// Signed area of a pixel.
    pub(crate) fn area(&self) -> f64 {
        self.column[0] * self.row[1] - self.column[1] * self.row[0]
    }

    /// Coordinates of a place in the raster.
    pub(crate) fn at(&self, column: f64, row: f64) -> [f64; 2] {
        [0, 1].map(|axis| self.origin[axis] + column * self.column[axis] + row * self.row[axis])
    }

    /// The place in the raster with some coordinates, as column and row.
    pub(crate) fn inverse(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (dx, dy) = (x - self.origin[0], y - self.origin[1]);
        let area = self.area();
        [(dx * self.row[1] - dy * self.row[0]) / area, (dy * self.column[0] - dx * self.column[1]) / area]
    }

    /// The same map with coordinates multiplied.
    pub(crate) fn scaled(&self, east: f64, north: f64) -> Self {
        let scale = |[x, y]: [f64; 2]| [x * east, y * north];
        Affine { origin: scale(self.origin), column: scale(self.column), row: scale(self.row) }
    }

    /// The same map with rows or columns counted from their other end.
    pub(crate) fn counted_from(&self, columns: Option<usize>, rows: Option<usize>) -> Self {
        let origin = self.at(columns.unwrap_or(0) as f64, rows.unwrap_or(0) as f64);
        let turned = |step: [f64; 2], is_turned: bool| if is_turned { step.map(|by| -by) } else { step };
        Affine {
            origin,
            column: turned(self.column, columns.is_some()),
            row: turned(self.row, rows.is_some()),
        }
    }

    /// The same map with pixels counted from the middle of the first one.
    pub(crate) fn with_centred_pixels(&self) -> Self {
        Affine { origin: self.at(-0.5, -0.5), ..*self }
    }

    /// Lowest and highest coordinates of a raster of so many pixels: west, south, east, north.
    pub(crate) fn bounds(&self, columns: usize, rows: usize) -> [f64; 4] {
        let (columns, rows) = (columns as f64, rows as f64);
        let corners = [(0.0, 0.0), (columns, 0.0), (0.0, rows), (columns, rows)].map(|(c, r)| self.at(c, r));
        let least = |axis: usize| corners.iter().map(|corner| corner[axis]).fold(f64::INFINITY, f64::min);
        let most = |axis: usize| corners.iter().map(|corner| corner[axis]).fold(f64::NEG_INFINITY, f64::max);
        [least(0), least(1), most(0), most(1)]
    }

    /// Edges of a pixel.
    pub(crate) fn edges(&self) -> [f64; 2] {
        [self.column, self.row].map(|[x, y]| x.hypot(y))
    }

    /// Whether columns run east or west and rows north or south.
    pub(crate) fn is_upright(&self) -> bool {
        self.column[1] == 0.0 && self.row[0] == 0.0
    }
}

/// A raster's pixels, row-major as they come.
pub(crate) struct Raster<'a, T> {
    pub(crate) samples: &'a [T],
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    pub(crate) affine: Affine,
}

impl<T: Copy + Into<f64> + Sync> Raster<'_, T> {
    /// Samples at the centres of a grid's cells, bilinear between centres of pixels, row-major from the south; NaN outside and where
    /// a pixel that counts is NaN.
    pub(crate) fn on(&self, grid: &Grid, number: impl Fn(f64) -> T + Sync) -> Vec<T>
    where
        T: Send,
    {
        let cell = |index: usize| number(self.at(grid.center_m(grid.cell(index))));
        (0..grid.cells()).into_par_iter().map(cell).collect()
    }

    fn at(&self, place: [f64; 2]) -> f64 {
        self.between(self.affine.inverse(place))
    }

    /// The sample at a position in pixels from the raster's first corner, bilinear between centres; NaN outside and where a pixel that
    /// counts is NaN. The outer half of outer pixels holds what their centres do.
    pub(crate) fn between(&self, [column, row]: [f64; 2]) -> f64 {
        // Rounding must not push the outermost places off the raster.
        const ROUNDING: f64 = 1e-6;
        let within = |position: f64, count: usize| (-ROUNDING..=count as f64 + ROUNDING).contains(&position);
        if !within(column, self.columns) || !within(row, self.rows) {
            return f64::NAN;
        }
        let along = |position: f64, count: usize| {
            let centre = (position - 0.5).clamp(0.0, (count - 1) as f64);
            (centre as usize, centre.fract())
        };
        let ((column, east), (row, south)) = (along(column, self.columns), along(row, self.rows));
        let corners = [
            (0, 0, (1.0 - east) * (1.0 - south)),
            (1, 0, east * (1.0 - south)),
            (0, 1, (1.0 - east) * south),
            (1, 1, east * south),
        ];
        let sample = |(right, below, weight): &(usize, usize, f64)| {
            weight * self.samples[(row + below) * self.columns + column + right].into()
        };
        corners.iter().filter(|(.., weight)| *weight > 0.0).map(sample).sum()
    }
}

/// The way from a raster's own pixels, kept as ground on a grid of their number, to the cells of a map.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Resampling {
    /// From pixels, counted from the first cell's outer corner, to the map's metres.
    pub(crate) affine: Affine,
    /// The map's cells.
    pub(crate) grid: Grid,
    /// The map's system.
    pub(crate) crs: Option<String>,
}

impl Resampling {
    /// A grid of so many pixels, for what is asked of them before they are resampled: square, of the map's cells.
    pub(crate) fn source_grid(&self, columns: usize, rows: usize) -> Grid {
        Grid { rows, columns, origin_m: [0.0; 2], ..self.grid }
    }

    /// Ground on the map's cells out of ground on [`Resampling::source_grid`], with its warnings.
    ///
    /// # Errors
    /// No known cell.
    pub(crate) fn apply(&self, source: &Terrain) -> Result<Terrain, Error> {
        let Grid { rows, columns, .. } = source.grid;
        let raster = Raster { samples: source.relative_m(), columns, rows, affine: self.affine };
        let relative_m = raster.on(&self.grid, |relative_m| relative_m as f32);
        let base_m = source.base_m();
        let terrain = Terrain::from_samples(self.grid, relative_m, |relative_m| base_m + relative_m)?;
        let terrain = Terrain { crs: self.crs.clone(), ..terrain };
        Ok(source.warnings().iter().cloned().fold(terrain, Terrain::with_warning))
    }
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;

    fn plane([x, y]: [f64; 2]) -> f64 {
        100.0 + 0.3 * x - 0.2 * y
    }

    #[test]
    fn a_plane_is_the_same_plane_however_the_raster_lies() {
        let (sin, cos) = 0.4f64.sin_cos();
        for affine in [
            Affine { origin: [10.0, 50.0], column: [0.5, 0.0], row: [0.0, -0.8] },
            Affine { origin: [10.0, 50.0], column: [0.5 * cos, 0.5 * sin], row: [0.5 * sin, -0.5 * cos] },
            Affine { origin: [40.0, 20.0], column: [-0.5, 0.0], row: [0.0, 0.5] },
        ] {
            let (columns, rows) = (40, 30);
            let centre = |i: usize| affine.at((i % columns) as f64 + 0.5, (i / columns) as f64 + 0.5);
            let samples: Vec<f64> = (0..columns * rows).map(|i| plane(centre(i))).collect();
            let [west, south, east, north] = affine.bounds(columns, rows);
            let grid = Grid {
                rows: ((north - south) / 0.5) as usize,
                columns: ((east - west) / 0.5) as usize,
                cell_size_m: 0.5,
                origin_m: [west, south],
            };
            let found = Raster { samples: &samples, columns, rows, affine }.on(&grid, |z| z);
            let mut known = 0;
            for (index, z) in found.iter().enumerate().filter(|(_, z)| !z.is_nan()) {
                let place = grid.center_m(grid.cell(index));
                // Half a pixel along the edge holds the value of the outermost centre.
                assert_abs_diff_eq!(*z, plane(place), epsilon = 0.3);
                known += usize::from((*z - plane(place)).abs() < 1e-9);
            }
            assert!(known as f64 > 0.8 * (columns * rows) as f64 * affine.area().abs() / 0.25);
        }
    }

    #[test]
    fn unknown_pixels_stay_unknown_and_reach_no_further_than_their_neighbours() {
        let mut samples = vec![1.0; 100];
        samples[55] = f64::NAN;
        let affine = Affine { origin: [0.0, 10.0], column: [1.0, 0.0], row: [0.0, -1.0] };
        let grid = Grid { rows: 20, columns: 20, cell_size_m: 0.5, origin_m: [0.0, 0.0] };
        let found = Raster { samples: &samples, columns: 10, rows: 10, affine }.on(&grid, |z| z);
        assert_eq!(found.iter().filter(|z| z.is_nan()).count(), 16);
    }
}
