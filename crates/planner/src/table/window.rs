//! The ground that a tile's motions depend on, laid out for reading rows of cells side by side.

use terrain::{Cell, Terrain};

use crate::{
    grid::layout::TILE,
    ground::{heights::Heights, stance::ORIENTATIONS},
    lattice::graph::Lattice,
};

/// The ground of a tile and around it; unknown and outside are NaN.
pub(crate) struct Window {
    width: usize,
    halo: usize,
    pub(crate) height_m: Vec<f32>,
    /// Gradients under the wheels east and north, by orientation.
    pub(crate) gradients: [[Vec<f32>; 2]; ORIENTATIONS],
    /// Kinds of ground.
    pub(crate) class: Vec<u8>,
    /// Those that occur.
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
            gradients: std::array::from_fn(|_| [vec![f32::NAN; cells], vec![f32::NAN; cells]]),
            class: vec![0; cells],
            present: Vec::new(),
        };
        let first = (origin.row as isize - halo as isize, origin.column as isize - halo as isize);
        let heights = Heights::new(terrain, first, (width, width), lattice.ground.reach());
        for y in 0..width {
            let Some(row) = (origin.row + y).checked_sub(halo).filter(|r| *r < terrain.grid.rows) else {
                continue;
            };
            let west = origin.column.saturating_sub(halo);
            let east = (origin.column + TILE + halo).min(terrain.grid.columns);
            let at = y * width + west + halo - origin.column;
            let count = east.saturating_sub(west);
            lattice.ground.copy_heights(terrain, row, west, &mut window.height_m[at..at + count]);
            for (k, gradients) in window.gradients.iter_mut().enumerate() {
                let out = gradients.each_mut().map(|values| &mut values[at..at + count]);
                lattice.ground.gradient_row(terrain, &heights, (row, west), k, out);
            }
            for (i, class) in window.class[at..at + count].iter_mut().enumerate() {
                *class = class_of(lattice, terrain, Cell { row, column: west + i });
            }
        }
        window.present = window.class.clone();
        window.present.sort_unstable();
        window.present.dedup();
        window
    }

    /// The only kind of ground of a map's cells in a window; `None` where there are several.
    pub(crate) fn only_class(lattice: &Lattice, origin: Cell, halo: usize) -> Option<u8> {
        let terrain = &lattice.terrain;
        let near = |at: usize, count: usize| at.saturating_sub(halo)..(at + TILE + halo).min(count);
        let mut cells = near(origin.row, terrain.grid.rows).flat_map(|row| {
            near(origin.column, terrain.grid.columns).map(move |column| Cell { row, column })
        });
        let first = class_of(lattice, terrain, cells.next()?);
        let is_only =
            lattice.classes.list.len() == 1 || cells.all(|cell| class_of(lattice, terrain, cell) == first);
        is_only.then_some(first)
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        let gradients =
            self.gradients.iter().flatten().chain([&self.height_m]).map(|values| size_of_val(&values[..]));
        gradients.sum::<usize>() + self.class.len() + self.present.len()
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

fn class_of(lattice: &Lattice, terrain: &Terrain, cell: Cell) -> u8 {
    if lattice.classes.list.len() == 1 { 0 } else { lattice.classes.at(terrain, cell) as u8 }
}
