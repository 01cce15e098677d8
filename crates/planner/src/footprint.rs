//! The ground under the robot: which cells a pose covers, and how far the next blocked cell is.

use std::sync::OnceLock;

use model::Robot;
use terrain::{Cell, Terrain};

/// Outline of the robot seen from above, a rectangle about its geometric centre.
///
/// Length is wheelbase plus wheel diameter. Width is track plus one wheel radius: a tyre is taken as wide as its
/// radius, which suits rover tyres (a Husky's 0.125 m against 0.165 m) and errs to the safe side.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Along the heading [m].
    pub length_m: f64,
    /// Across it [m].
    pub width_m: f64,
}

impl Footprint {
    /// The outline of a robot.
    pub fn of(robot: &Robot) -> Self {
        Footprint {
            length_m: robot.wheelbase_m + 2.0 * robot.wheel_radius_m,
            width_m: robot.track_m + robot.wheel_radius_m,
        }
    }

    /// Offsets (columns, rows) of the cells that a pose touches; the pose is relative to the centre of cell (0, 0).
    pub fn cells_at(&self, pose: [f64; 3], cell_size_m: f64) -> Vec<(i32, i32)> {
        let mut cells = Vec::new();
        self.any_cell(pose, cell_size_m, |cell| {
            cells.push(cell);
            false
        });
        cells
    }

    /// Whether any of the cells that a pose touches, by their offsets as in [`Footprint::cells_at`], is of a kind.
    pub fn any_cell(
        &self,
        [x_m, y_m, heading_rad]: [f64; 3],
        cell_size_m: f64,
        mut is: impl FnMut((i32, i32)) -> bool,
    ) -> bool {
        let (sin, cos) = heading_rad.sin_cos();
        let (half_l, half_w) = (self.length_m / 2.0, self.width_m / 2.0);
        // A square overlaps a rotated rectangle unless one of the four edge directions separates them.
        let half_c = cell_size_m / 2.0;
        let square_reach = half_c * (sin.abs() + cos.abs());
        let box_reach = [half_l * cos.abs() + half_w * sin.abs(), half_l * sin.abs() + half_w * cos.abs()];
        let range = |center_m: f64, reach_m: f64| {
            let low = ((center_m - reach_m) / cell_size_m - 0.5).floor() as i32;
            let high = ((center_m + reach_m) / cell_size_m + 0.5).ceil() as i32;
            low..=high
        };
        for row in range(y_m, box_reach[1]) {
            for column in range(x_m, box_reach[0]) {
                let dx = f64::from(column) * cell_size_m - x_m;
                let dy = f64::from(row) * cell_size_m - y_m;
                let overlaps = dx.abs() < box_reach[0] + half_c
                    && dy.abs() < box_reach[1] + half_c
                    && (dx * cos + dy * sin).abs() < half_l + square_reach
                    && (dy * cos - dx * sin).abs() < half_w + square_reach;
                if overlaps && is((column, row)) {
                    return true;
                }
            }
        }
        false
    }
}

/// Distance from cells to the nearest blocked one or the world outside, in king's moves, measured tile by tile as it is
/// asked for; [`Clearance::FARTHEST`] stands for any distance from there on.
#[derive(Debug)]
pub struct Clearance {
    terrain: Terrain,
    tile_columns: usize,
    tiles: Vec<OnceLock<Box<[u8]>>>,
}

impl Clearance {
    /// The greatest distance told apart: motions that sweep cells farther than this are rare and looked at cell by cell.
    pub const FARTHEST: u8 = 31;
    const TILE: usize = 64;

    /// Clearance on a piece of ground.
    pub fn new(terrain: &Terrain) -> Self {
        let tile_columns = terrain.grid.columns.div_ceil(Self::TILE);
        let tiles = tile_columns * terrain.grid.rows.div_ceil(Self::TILE);
        Clearance {
            terrain: terrain.clone(),
            tile_columns,
            tiles: (0..tiles).map(|_| OnceLock::new()).collect(),
        }
    }

    /// Clearance of the cell at a row-major position: 0 on blocked ground.
    #[inline]
    pub fn at(&self, index: usize) -> u8 {
        let Cell { row, column } = self.terrain.grid.cell(index);
        let tile = row / Self::TILE * self.tile_columns + column / Self::TILE;
        let measured = self.tiles[tile].get_or_init(|| self.measure(tile));
        measured[row % Self::TILE * Self::TILE + column % Self::TILE]
    }

    /// Two sweeps over a tile and as much around it as matters, which are exact for king's moves.
    fn measure(&self, tile: usize) -> Box<[u8]> {
        let halo = usize::from(Self::FARTHEST);
        let side = Self::TILE + 2 * halo;
        let origin = (tile / self.tile_columns * Self::TILE, tile % self.tile_columns * Self::TILE);
        let blocked = |y: usize, x: usize| {
            let row = (origin.0 + y).checked_sub(halo).filter(|row| *row < self.terrain.grid.rows);
            let column =
                (origin.1 + x).checked_sub(halo).filter(|column| *column < self.terrain.grid.columns);
            row.zip(column).is_none_or(|(row, column)| self.terrain.is_blocked(Cell { row, column }))
        };
        let mut distance: Vec<u8> =
            (0..side * side).map(|i| if blocked(i / side, i % side) { 0 } else { Self::FARTHEST }).collect();
        let neighbours = [(-1, -1), (-1, 0), (-1, 1), (0, -1)];
        let mut sweep = |i: usize, sign: isize| {
            let mut best = distance[i];
            for (dr, dc) in neighbours {
                let (y, x) = ((i / side) as isize + sign * dr, (i % side) as isize + sign * dc);
                if (0..side as isize).contains(&y) && (0..side as isize).contains(&x) {
                    best = best.min(distance[y as usize * side + x as usize] + 1);
                }
            }
            distance[i] = best;
        };
        (0..side * side).for_each(|i| sweep(i, 1));
        (0..side * side).rev().for_each(|i| sweep(i, -1));
        let rows = distance.chunks_exact(side).skip(halo).take(Self::TILE);
        rows.flat_map(|row| &row[halo..halo + Self::TILE]).copied().collect()
    }
}

/// The first blocked or outside cell among offsets from a cell.
pub(crate) fn first_blocked(terrain: &Terrain, cell: Cell, offsets: &[(i32, i32)]) -> Option<Option<Cell>> {
    offsets.iter().find_map(|&offset| match shifted(terrain, cell, offset) {
        None => Some(None),
        Some(touched) => terrain.is_blocked(touched).then_some(Some(touched)),
    })
}

/// The cell at an offset (columns, rows), if the grid has it.
pub(crate) fn shifted(terrain: &Terrain, cell: Cell, (columns, rows): (i32, i32)) -> Option<Cell> {
    let column = cell.column.checked_add_signed(columns as isize)?;
    let row = cell.row.checked_add_signed(rows as isize)?;
    (row < terrain.grid.rows && column < terrain.grid.columns).then_some(Cell { row, column })
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use terrain::{Grid, synthetic};

    use super::*;

    const HUSKY: Footprint = Footprint { length_m: 0.87, width_m: 0.705 };

    #[test]
    fn a_husky_across_its_own_cell_touches_that_cell_only_on_a_one_metre_grid() {
        assert_eq!(HUSKY.cells_at([0.0, 0.0, 0.0], 1.0), [(0, 0)]);
        assert_eq!(HUSKY.cells_at([0.0, 0.0, std::f64::consts::FRAC_PI_2], 1.0), [(0, 0)]);
    }

    proptest! {
        #[test]
        fn every_point_of_the_footprint_lies_in_a_cell_it_claims(
            x in -2.0f64..2.0, y in -2.0f64..2.0, heading in -4.0f64..4.0,
            along in -0.43f64..0.43, across in -0.35f64..0.35, cell in 0.1f64..1.5,
        ) {
            let cells = HUSKY.cells_at([x, y, heading], cell);
            let px = x + along * heading.cos() - across * heading.sin();
            let py = y + along * heading.sin() + across * heading.cos();
            let here = ((px / cell).round() as i32, (py / cell).round() as i32);
            prop_assert!(cells.contains(&here));
        }
    }

    #[test]
    fn clearance_equals_a_brute_force_search() {
        let grid = Grid { rows: 70, columns: 131, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        let flat = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap();
        let terrain = synthetic::scatter_obstacles(flat, 3, 0.0005);
        let clearance = Clearance::new(&terrain);
        for index in 0..grid.cells() {
            let cell = grid.cell(index);
            let free = |reach: i32| {
                (-reach..=reach).all(|r| {
                    (-reach..=reach).all(|c| {
                        shifted(&terrain, cell, (c, r)).is_some_and(|near| !terrain.is_blocked(near))
                    })
                })
            };
            let farthest = i32::from(Clearance::FARTHEST);
            let brute = (0..farthest).find(|reach| !free(*reach)).unwrap_or(farthest);
            assert_eq!(i32::from(clearance.at(index)), brute, "{cell:?}");
        }
    }
}
