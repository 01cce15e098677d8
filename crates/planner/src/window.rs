//! The ground that a tile's motions depend on, laid out for reading rows of cells side by side.

use terrain::{Cell, Terrain, slope};

use crate::{lattice::Lattice, layout::TILE};

/// The ground of a tile and around it; unknown and outside are NaN.
pub(crate) struct Window {
    width: usize,
    halo: usize,
    pub(crate) height_m: Vec<f32>,
    pub(crate) east: Vec<f32>,
    pub(crate) north: Vec<f32>,
    pub(crate) surface: Vec<u8>,
    /// Surfaces that occur.
    pub(crate) present: Vec<u8>,
}

impl Window {
    pub(crate) fn new(lattice: &Lattice, origin: Cell, halo: usize) -> Self {
        let terrain = &lattice.terrain;
        // A row of lanes may start anywhere in the halo and is as long as the tile.
        let width = TILE + 2 * halo;
        let cells = width * width;
        let mut window = Window {
            width,
            halo,
            height_m: vec![f32::NAN; cells],
            east: vec![f32::NAN; cells],
            north: vec![f32::NAN; cells],
            surface: vec![0; cells],
            present: Vec::new(),
        };
        for y in 0..width {
            let Some(row) = (origin.row + y).checked_sub(halo).filter(|r| *r < terrain.grid.rows) else {
                continue;
            };
            let west = origin.column.saturating_sub(halo);
            let east = (origin.column + TILE + halo).min(terrain.grid.columns);
            let at = y * width + west + halo - origin.column;
            let from = terrain.grid.index(Cell { row, column: west });
            let count = east - west;
            window.height_m[at..at + count].copy_from_slice(&terrain.relative_m()[from..from + count]);
            let (east_out, north_out) = (&mut window.east[at..at + count], &mut window.north[at..at + count]);
            slope::row(terrain, row, west, east_out, north_out);
            for (i, surface) in window.surface[at..at + count].iter_mut().enumerate() {
                *surface = surface_of(lattice, terrain, Cell { row, column: west + i });
            }
        }
        window.present = window.surface.clone();
        window.present.sort_unstable();
        window.present.dedup();
        window
    }

    /// The values under a row of the tile's cells, moved by an offset (columns, rows).
    #[inline(always)]
    pub(crate) fn lanes<'w, T>(
        &self,
        values: &'w [T],
        row: usize,
        (columns, rows): (i32, i32),
    ) -> &'w [T; TILE] {
        let y = (row + self.halo) as isize + rows as isize;
        let x = self.halo as isize + columns as isize;
        let start = (y * self.width as isize + x) as usize;
        match values[start..].first_chunk::<TILE>() {
            Some(lanes) => lanes,
            None => unreachable!("the halo holds every cell that a motion reads"),
        }
    }
}

fn surface_of(lattice: &Lattice, terrain: &Terrain, cell: Cell) -> u8 {
    if terrain.surfaces().is_none() { 0 } else { lattice.surface_index(cell) as u8 }
}
