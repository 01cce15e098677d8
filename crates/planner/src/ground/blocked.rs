//! Which cells in and around a tile are blocked, a bit each, so that a row of start cells is looked at in one go.

use terrain::{Cell, Terrain};

use crate::{grid::layout::TILE, ground::spans::Span};

/// Blocked cells of a tile and around it; those beyond the map are blocked too.
pub(crate) struct Blocked {
    reach: usize,
    /// Words on either side of a row's own.
    beside: usize,
    /// Bits by row from `reach` rows south of the tile on; a row of a tile is one word. The k-th entry has a bit where any
    /// of 2^k cells from there to the east is blocked, so that two looks tell of a run of any length.
    runs: Vec<Vec<u64>>,
    /// By row of the tile: whether anything is blocked in the rows within reach.
    near: Vec<bool>,
}

const _: () = assert!(TILE == 64, "a row of a tile is a word of 64 bits");

impl Blocked {
    /// The ground of a tile and `reach` cells around it, for spans of up to `longest` cells.
    pub(crate) fn new(terrain: &Terrain, origin: Cell, reach: usize, longest: u32) -> Self {
        let beside = reach.div_ceil(TILE);
        let width = 2 * beside + 1;
        let rows = TILE + 2 * reach;
        let mut words = vec![u64::MAX; rows * width];
        for (y, words) in words.chunks_exact_mut(width).enumerate() {
            let Some(row) = (origin.row + y).checked_sub(reach).filter(|row| *row < terrain.grid.rows) else {
                continue;
            };
            let first = origin.column as isize - (beside * TILE) as isize;
            let from = origin.column.saturating_sub(reach);
            for column in from..(origin.column + TILE + reach).min(terrain.grid.columns) {
                if !terrain.is_blocked(Cell { row, column }) {
                    let bit = (column as isize - first) as usize;
                    words[bit / TILE] &= !(1 << (bit % TILE));
                }
            }
        }
        let mut blocked = Blocked { reach, beside, runs: vec![words], near: Vec::new() };
        let rows_with_any: Vec<bool> = (0..rows).map(|y| blocked.has_any(y)).collect();
        blocked.near = rows_with_any.windows(2 * reach + 1).map(|rows| rows.contains(&true)).collect();
        blocked.double(longest);
        blocked
    }

    /// Bytes held.
    pub(crate) fn bytes(&self) -> usize {
        self.runs.iter().map(|words| size_of_val(&words[..])).sum::<usize>() + self.near.len()
    }

    /// Whether anything is blocked within reach of a row of the tile's cells.
    pub(crate) fn is_near(&self, row: usize) -> bool {
        self.near[row]
    }

    /// Adds the runs of 2, 4, 8... cells that spans of up to `longest` cells need.
    fn double(&mut self, longest: u32) {
        for power in 0..longest.max(1).ilog2() {
            let step = 1usize << power;
            let Some(shorter) = self.runs.last() else { return };
            // Beyond the last word everything counts as blocked; no span reaches that far.
            let word = |at: usize| shorter.get(at).copied().unwrap_or(u64::MAX);
            let ahead = |at: usize| match (step / TILE, step % TILE) {
                (words, 0) => word(at + words),
                (words, bits) => word(at + words) >> bits | word(at + words + 1) << (TILE - bits),
            };
            let longer = (0..shorter.len()).map(|at| shorter[at] | ahead(at)).collect();
            self.runs.push(longer);
        }
    }

    /// The cells of a row, bit by bit, from which any of some spans holds a blocked one.
    #[inline(always)]
    pub(crate) fn touched(&self, row: usize, spans: &[Span]) -> u64 {
        let width = 2 * self.beside + 1;
        let first = (row + self.reach) * width + self.beside;
        let mut touched = 0;
        for span in spans {
            let power = span.cells().ilog2();
            let words = &self.runs[power as usize];
            let start = (first as isize + span.row as isize * width as isize) * TILE as isize;
            let mut look = |column: i32| {
                let at = start + column as isize;
                let (word, bit) = (at as usize / TILE, at as usize % TILE);
                touched |= words[word] >> bit;
                if bit > 0 {
                    touched |= words[word + 1] << (TILE - bit);
                }
            };
            look(span.first);
            let second = span.last + 1 - (1 << power);
            if second != span.first {
                look(second);
            }
        }
        touched
    }

    /// Whether a row has any blocked cell within reach of the tile.
    fn has_any(&self, y: usize) -> bool {
        let width = 2 * self.beside + 1;
        let (first, end) = (self.beside * TILE - self.reach, (self.beside + 1) * TILE + self.reach);
        (first..end).any(|bit| self.runs[0][y * width + bit / TILE] >> (bit % TILE) & 1 == 1)
    }
}

#[cfg(test)]
mod tests {
    use terrain::{Grid, synthetic};

    use super::*;
    use crate::ground::{clearance::Clearance, spans::first_blocked};

    #[test]
    fn rows_at_a_time_equal_cells_one_by_one() {
        let grid = Grid { rows: 140, columns: 131, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        let flat = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap();
        let terrain = synthetic::scatter_obstacles(flat, 3, 0.002);
        let clearance = Clearance::new(&terrain);
        for reach in [0, 3, 70] {
            let far = reach as i32;
            let span = |row, first, last| Span { row, first, last };
            let spans = [
                span(0, 0, 0),
                span(-far, far / 2, far),
                span(far / 2, -far, -far / 3),
                span(far, -far, far),
            ];
            let spans = [&spans[..3], &spans[..]];
            for origin in [(0, 0), (64, 64), (128, 128), (64, 0)] {
                let origin = Cell { row: origin.0, column: origin.1 };
                let blocked = Blocked::new(&terrain, origin, reach, 2 * reach as u32 + 1);
                for (row, spans) in (0..)
                    .flat_map(|row| spans.map(|s| (row, s)))
                    .take_while(|(row, _)| *row < TILE.min(grid.rows - origin.row))
                {
                    let touched = blocked.touched(row, spans);
                    for x in 0..TILE.min(grid.columns - origin.column) {
                        let cell = Cell { row: origin.row + row, column: origin.column + x };
                        let alone = first_blocked(&clearance, cell, spans).is_some();
                        assert_eq!(touched >> x & 1 == 1, alone, "{cell:?} at reach {reach}");
                        assert!(blocked.is_near(row) || !alone);
                    }
                }
            }
        }
    }
}
