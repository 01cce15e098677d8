//! Holes of unknown ground, filled from the ground around them.

mod width;

use std::sync::Arc;

use crate::{Cell, Error, Grid, Terrain, Warning, WarningKind};

/// Widest hole that may be filled [m].
pub const WIDEST_VOID_M: f64 = 1000.0;
/// Share of a cell by which lengths in cells may miss a width in metres by rounding.
const ROUNDING: f64 = 1e-6;
/// Directions across a hole, in rows and columns: along them, known ground is looked for on both sides.
const DIRECTIONS: [(usize, isize); 4] = [(0, 1), (1, 0), (1, 1), (1, -1)];

/// What the ground across a hole says about its cells, row-major.
struct Bridges {
    /// Sum of weights; 0 where no two sides are near enough.
    weight: Vec<f32>,
    /// Sum of weighted elevations above the base [m].
    weighted_m: Vec<f32>,
}

impl Terrain {
    /// The ground with those holes filled that are at most so wide, the cells filled marked ([`Terrain::filled`]), and a warning
    /// of how many there are.
    ///
    /// A hole is a set of unknown cells that touch by edges or corners. It is as wide as the shortest of the lines through its
    /// widest cell, east, north or diagonal, from known ground to known ground. A cell is filled with the mean of what these
    /// lines have there by linear interpolation, weighted by one over the length squared: exact on a plane, and no cell lies
    /// farther than half the width from known ground. Holes at the border stay, where ground would have to be extrapolated,
    /// but for a seam that leads from a border to the opposite one.
    ///
    /// # Errors
    /// A width that is not above 0 or above [`WIDEST_VOID_M`].
    pub fn with_filled_voids(self, width_m: f64) -> Result<Self, Error> {
        if !(width_m > 0.0 && width_m <= WIDEST_VOID_M) {
            return Err(Error::VoidWidth { value: width_m, limit: WIDEST_VOID_M });
        }
        let unknown = self.relative_m.iter().filter(|z| z.is_nan()).count();
        if unknown == 0 {
            return Ok(self);
        }
        let bridges = self.bridges(width_m);
        let mut seen = vec![false; self.grid.cells()];
        let mut filled = self.filled.as_ref().map_or_else(|| vec![false; seen.len()], |f| f.to_vec());
        let mut relative_m = Arc::clone(&self.relative_m);
        let (mut holes, mut cells, mut largest) = (0usize, 0usize, 0usize);
        for index in 0..seen.len() {
            if seen[index] || !self.relative_m[index].is_nan() {
                continue;
            }
            let hole = self.hole_at(index, &mut seen);
            if !self.can_be_filled(&hole, &bridges) {
                continue;
            }
            let relative_m = Arc::make_mut(&mut relative_m);
            for &cell in &hole {
                relative_m[cell] = bridges.weighted_m[cell] / bridges.weight[cell];
                filled[cell] = true;
            }
            (holes, cells, largest) = (holes + 1, cells + hole.len(), largest.max(hole.len()));
        }
        let left = unknown - cells;
        let detail = match holes {
            0 => format!(
                "no hole of unknown ground is at most {width_m} m wide with known ground on both sides: {left} cells stay unknown"
            ),
            _ => format!(
                "{cells} cells of unknown ground in {holes} {} up to {width_m} m wide were filled from the ground around, the largest of {largest} {}; {left} cells stay unknown",
                if holes == 1 { "hole" } else { "holes" },
                if largest == 1 { "cell" } else { "cells" },
            ),
        };
        let mut terrain = Terrain { relative_m, ..self };
        if holes > 0 {
            terrain = terrain.with_filled(filled);
        }
        Ok(terrain.with_warning(Warning::new(WarningKind::FilledVoids, detail)))
    }

    /// Interpolation across unknown cells along all lines of at most so many metres.
    fn bridges(&self, width_m: f64) -> Bridges {
        let grid = &self.grid;
        let mut bridges = Bridges { weight: vec![0.0; grid.cells()], weighted_m: vec![0.0; grid.cells()] };
        for direction in DIRECTIONS {
            let step_m = grid.cell_size_m * (direction.0 as f64).hypot(direction.1 as f64);
            let most = (width_m / step_m + ROUNDING).floor() as usize;
            if most == 0 {
                continue;
            }
            for start in line_starts(grid, direction) {
                self.bridge_line(start, direction, (step_m, most), &mut bridges);
            }
        }
        bridges
    }

    /// Interpolates across the unknown stretches of one line.
    fn bridge_line(
        &self,
        start: Cell,
        direction: (usize, isize),
        (step_m, most): (f64, usize),
        bridges: &mut Bridges,
    ) {
        let mut stretch: Vec<usize> = Vec::new();
        let mut before_m: Option<f32> = None;
        let mut next = Some(start);
        while let Some(cell) = next {
            next = stepped(&self.grid, cell, direction);
            let index = self.grid.index(cell);
            let z_m = self.relative_m[index];
            if z_m.is_nan() {
                // What is longer than the most need not be kept.
                if stretch.len() <= most {
                    stretch.push(index);
                }
                continue;
            }
            let gap = stretch.len();
            if let Some(before_m) = before_m.filter(|_| (1..=most).contains(&gap)) {
                let weight = 1.0 / (gap as f64 * step_m).powi(2);
                for (position, cell) in stretch.iter().enumerate() {
                    let share = (position + 1) as f32 / (gap + 1) as f32;
                    bridges.weight[*cell] += weight as f32;
                    bridges.weighted_m[*cell] += weight as f32 * (before_m + share * (z_m - before_m));
                }
            }
            stretch.clear();
            before_m = Some(z_m);
        }
    }

    /// The cells of the hole that an unknown cell belongs to.
    fn hole_at(&self, index: usize, seen: &mut [bool]) -> Vec<usize> {
        let mut hole = vec![index];
        seen[index] = true;
        let mut position = 0;
        while let Some(&index) = hole.get(position) {
            position += 1;
            for neighbour in neighbours(&self.grid, self.grid.cell(index)) {
                let neighbour = self.grid.index(neighbour);
                if self.relative_m[neighbour].is_nan() && !seen[neighbour] {
                    seen[neighbour] = true;
                    hole.push(neighbour);
                }
            }
        }
        hole
    }

    /// Whether known ground lies near on two sides of every cell, and no border in the way.
    fn can_be_filled(&self, hole: &[usize], bridges: &Bridges) -> bool {
        let (last_row, last_column) = (self.grid.rows - 1, self.grid.columns - 1);
        let [mut south, mut north, mut west, mut east] = [false; 4];
        for &index in hole {
            if bridges.weight[index] == 0.0 {
                return false;
            }
            let Cell { row, column } = self.grid.cell(index);
            south |= row == 0;
            north |= row == last_row;
            west |= column == 0;
            east |= column == last_column;
        }
        let touches_none = !(south || north || west || east);
        touches_none || (south && north) || (west && east)
    }
}

/// Cells beside a cell, by edges and corners.
fn neighbours(grid: &Grid, Cell { row, column }: Cell) -> impl Iterator<Item = Cell> {
    let rows = row.saturating_sub(1)..(row + 2).min(grid.rows);
    let columns = column.saturating_sub(1)..(column + 2).min(grid.columns);
    rows.flat_map(move |row| columns.clone().map(move |column| Cell { row, column }))
}

/// The next cell in a direction, if the map has it.
fn stepped(grid: &Grid, cell: Cell, (rows, columns): (usize, isize)) -> Option<Cell> {
    let row = cell.row + rows;
    let column = cell.column.checked_add_signed(columns)?;
    (row < grid.rows && column < grid.columns).then_some(Cell { row, column })
}

/// The first cells of all lines in a direction.
fn line_starts(grid: &Grid, (rows, columns): (usize, isize)) -> Vec<Cell> {
    let west = (0..grid.rows).map(|row| Cell { row, column: 0 });
    let east = (0..grid.rows).map(|row| Cell { row, column: grid.columns - 1 });
    let south = (0..grid.columns).map(|column| Cell { row: 0, column });
    match (rows, columns) {
        (0, _) => west.collect(),
        (_, 0) => south.collect(),
        (_, 1) => south.chain(west.skip(1)).collect(),
        _ => south.chain(east.skip(1)).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(rows: usize, columns: usize) -> (Grid, Vec<f64>) {
        let grid = Grid { rows, columns, cell_size_m: 0.5, origin_m: [0.0; 2] };
        let z = |i| grid.center_m(grid.cell(i));
        (grid, (0..grid.cells()).map(z).map(|[x, y]| 100.0 + 0.3 * x - 0.2 * y).collect())
    }

    /// The plane with some cells unknown, filled up to a width.
    fn filled(unknown: &[(usize, usize)], width_m: f64) -> Terrain {
        let (grid, mut z) = plane(12, 15);
        for &(row, column) in unknown {
            z[grid.index(Cell { row, column })] = f64::NAN;
        }
        Terrain::new(grid, &z).unwrap().with_filled_voids(width_m).unwrap()
    }

    fn count(terrain: &Terrain) -> usize {
        terrain.filled().map_or(0, |filled| filled.iter().filter(|f| **f).count())
    }

    #[test]
    fn a_small_hole_is_filled_exactly_on_a_plane_and_marked() {
        let terrain = filled(&[(4, 4), (4, 5), (5, 4), (5, 5), (9, 9)], 1.0);
        let (grid, z) = plane(12, 15);
        for (index, z) in z.iter().enumerate() {
            approx::assert_relative_eq!(terrain.elevation_m(grid.cell(index)).unwrap(), *z, epsilon = 1e-5);
        }
        assert_eq!(count(&terrain), 5);
        let said = &terrain.warnings()[0].detail;
        assert!(
            said.contains("5 cells") && said.contains("2 holes") && said.contains("largest of 4"),
            "{said}"
        );
    }

    #[test]
    fn wider_holes_and_holes_at_the_border_stay() {
        let square: Vec<_> = (3..6).flat_map(|row| (3..6).map(move |column| (row, column))).collect();
        assert_eq!(count(&filled(&square, 1.0)), 0);
        assert_eq!(count(&filled(&square, 1.5)), 9);
        for border in [[(0, 4), (1, 4)], [(11, 4), (11, 5)], [(4, 0), (5, 0)], [(0, 0), (0, 1)]] {
            let terrain = filled(&border, 5.0);
            assert_eq!(count(&terrain), 0, "{border:?}");
            assert!(
                terrain.warnings()[0].detail.contains("2 cells stay unknown"),
                "{:?}",
                terrain.warnings()
            );
        }
    }

    #[test]
    fn a_seam_across_the_map_is_filled_from_both_its_sides() {
        let seam: Vec<_> = (0..12).map(|row| (row, 7)).collect();
        assert_eq!(count(&filled(&seam, 0.5)), 12);
        let crossing: Vec<_> = seam.iter().copied().chain((0..15).map(|column| (6, column))).collect();
        assert_eq!(count(&filled(&crossing, 0.8)), 26);
        assert_eq!(count(&filled(&seam, 0.4)), 0, "narrower than a cell");
    }

    #[test]
    fn widths_that_cannot_be_are_refused() {
        let (grid, z) = plane(3, 3);
        for width_m in [0.0, -1.0, f64::NAN, 1001.0] {
            let error = Terrain::new(grid, &z).unwrap().with_filled_voids(width_m).unwrap_err();
            assert!(error.to_string().contains("fill_voids_m"), "{error}");
        }
        let whole = Terrain::new(grid, &z).unwrap().with_filled_voids(1.0).unwrap();
        assert!(whole.warnings().is_empty() && whole.filled().is_none());
    }
}
