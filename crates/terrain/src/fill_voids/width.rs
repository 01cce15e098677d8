//! How wide holes of unknown ground are.

use super::{DIRECTIONS, ROUNDING, WIDEST_VOID_M, line_starts, stepped};
use crate::{Cell, Terrain};

impl Terrain {
    /// The least width with which [`Terrain::with_filled_voids`] fills the holes that some cells lie in, rounded up to millimetres; `None` where
    /// one is too wide or open to the border, and 0 where all cells are known [m].
    pub fn void_width_m(&self, cells: &[Cell]) -> Option<f64> {
        let shortest_m = self.shortest_lines_m();
        let mut seen = vec![false; self.grid.cells()];
        let mut widest_m = 0.0f64;
        for cell in cells {
            let index = self.grid.index(*cell);
            if seen[index] || !self.relative_m[index].is_nan() {
                continue;
            }
            let of_hole = self.hole_at(index, &mut seen).into_iter().map(|cell| f64::from(shortest_m[cell]));
            widest_m = of_hole.fold(widest_m, f64::max);
        }
        let fills = |width_m: f64| {
            let is_known = |terrain: &Terrain| cells.iter().all(|cell| terrain.elevation_m(*cell).is_some());
            width_m == 0.0 || self.clone().with_filled_voids(width_m).is_ok_and(|filled| is_known(&filled))
        };
        let millimetres = (1000.0 * widest_m * (1.0 - ROUNDING)).ceil();
        if millimetres > 1000.0 * WIDEST_VOID_M {
            return None;
        }
        // Single precision may miss a length by less than the next millimetre.
        [millimetres, millimetres + 1.0]
            .map(|millimetres| millimetres / 1000.0)
            .into_iter()
            .find(|width_m| fills(*width_m))
    }

    /// Length of the shortest line through each unknown cell, east, north or diagonal, from known ground to known ground; infinite where
    /// there is none [m].
    fn shortest_lines_m(&self) -> Vec<f32> {
        let mut shortest_m = vec![f32::INFINITY; self.grid.cells()];
        for direction in DIRECTIONS {
            let step_m = self.grid.cell_size_m * (direction.0 as f64).hypot(direction.1 as f64);
            for start in line_starts(&self.grid, direction) {
                self.measure_line(start, direction, step_m, &mut shortest_m);
            }
        }
        shortest_m
    }

    fn measure_line(&self, start: Cell, direction: (usize, isize), step_m: f64, shortest_m: &mut [f32]) {
        let mut stretch: Vec<usize> = Vec::new();
        let mut is_bounded = false;
        let mut next = Some(start);
        while let Some(cell) = next {
            next = stepped(&self.grid, cell, direction);
            let index = self.grid.index(cell);
            if self.relative_m[index].is_nan() {
                stretch.push(index);
                continue;
            }
            let length_m = (stretch.len() as f64 * step_m) as f32;
            for cell in stretch.drain(..).filter(|_| is_bounded) {
                shortest_m[cell] = shortest_m[cell].min(length_m);
            }
            is_bounded = true;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Grid;

    fn holed(unknown: impl Fn(Cell) -> bool) -> Terrain {
        let grid = Grid { rows: 30, columns: 40, cell_size_m: 1.0, origin_m: [0.0; 2] };
        let z = |index| if unknown(grid.cell(index)) { f64::NAN } else { 1.0 };
        Terrain::new(grid, &(0..grid.cells()).map(z).collect::<Vec<f64>>()).unwrap()
    }

    #[test]
    fn the_width_is_the_least_with_which_the_hole_is_filled() {
        let square = holed(|c| (10..20).contains(&c.row) && (10..20).contains(&c.column));
        let middle = Cell { row: 15, column: 15 };
        let width_m = square.void_width_m(&[middle]).unwrap();
        // Through each cell east or north; the diagonals are longer there.
        assert_eq!(width_m, 10.0);
        let known = |width_m: f64| square.clone().with_filled_voids(width_m).unwrap().elevation_m(middle);
        assert!(known(width_m).is_some() && known(width_m - 0.01).is_none());
        assert_eq!(square.void_width_m(&[Cell { row: 0, column: 0 }]), Some(0.0), "known ground");
    }

    #[test]
    fn holes_that_no_width_fills_have_none() {
        let at_border = holed(|c| c.row < 3 && c.column < 3);
        assert_eq!(at_border.void_width_m(&[Cell { row: 1, column: 1 }]), None);
    }
}
