//! How far the next blocked cell is.

use std::sync::OnceLock;

use terrain::{Cell, Terrain};

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

    /// The ground that it is measured on.
    pub(crate) fn terrain(&self) -> &Terrain {
        &self.terrain
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

#[cfg(test)]
mod tests {
    use terrain::{Grid, synthetic};

    use super::*;
    use crate::ground::spans::shifted;

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
