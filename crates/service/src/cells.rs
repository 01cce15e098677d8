//! A map's cells as bytes, a tenth of what they take as JSON, for who draws it.

use std::{ops::Range, sync::Arc};

use terrain::{Cell, Terrain};

/// What the bytes begin with.
const MAGIC: &[u8; 4] = b"JPC1";

/// Cells of a piece.
const PIECE_CELLS: usize = 1 << 14;

/// The cells of a map in pieces, little-endian, southernmost row first:
///
/// ```text
/// at  0   4 bytes  "JPC1"
/// at  4   u32      columns
/// at  8   u32      rows
/// at 12   u32      stride: how many of the map's cells stand behind one here, each way
/// at 16   f64 × 3  cell_size_m of these cells, x and y of their south-west corner [m]
/// at 40   f64      base_m, which elevations count from [m]
/// at 48   f32 each elevation above base_m, NaN where unknown [m]
/// then    u8 each  surface: index into the summary's names, 255 where the map leaves it open
/// then    u8 each  1 where there is an obstacle
/// ```
///
/// Of every `stride × stride` cells the middle one is given, with the least stride that keeps to `most_cells`.
pub(crate) struct CellBytes {
    terrain: Arc<Terrain>,
    stride: usize,
    rows: usize,
    columns: usize,
    /// What comes next: the head, or a layer from one of its cells on.
    next: Option<(Part, usize)>,
}

#[derive(Clone, Copy)]
enum Part {
    Head,
    Elevation,
    Surface,
    Obstacle,
}

impl CellBytes {
    pub(crate) fn of(terrain: Arc<Terrain>, most_cells: usize) -> Self {
        let grid = &terrain.grid;
        let stride = stride(grid.rows, grid.columns, most_cells);
        let (rows, columns) = (grid.rows.div_ceil(stride), grid.columns.div_ceil(stride));
        CellBytes { terrain, stride, rows, columns, next: Some((Part::Head, 0)) }
    }

    /// Bytes of all pieces together.
    pub(crate) fn length(&self) -> usize {
        HEAD_BYTES + CELL_BYTES * self.rows * self.columns
    }

    fn head(&self) -> Vec<u8> {
        let grid = &self.terrain.grid;
        let mut bytes = Vec::with_capacity(HEAD_BYTES);
        bytes.extend_from_slice(MAGIC);
        for number in [self.columns, self.rows, self.stride] {
            bytes.extend_from_slice(&u32::try_from(number).unwrap_or(u32::MAX).to_le_bytes());
        }
        let [x_m, y_m] = grid.origin_m;
        for number in [grid.cell_size_m * self.stride as f64, x_m, y_m, self.terrain.base_m()] {
            bytes.extend_from_slice(&number.to_le_bytes());
        }
        bytes
    }

    /// Index in the map of a cell that is given.
    fn index(&self, cell: usize) -> usize {
        let middle = |i: usize, most: usize| (i * self.stride + self.stride / 2).min(most - 1);
        let grid = &self.terrain.grid;
        grid.index(Cell {
            row: middle(cell / self.columns, grid.rows),
            column: middle(cell % self.columns, grid.columns),
        })
    }

    fn cells(&self, part: Part, cells: Range<usize>) -> Vec<u8> {
        let terrain = &self.terrain;
        let indices = cells.map(|cell| self.index(cell));
        match part {
            Part::Head => self.head(),
            Part::Elevation => indices.flat_map(|i| terrain.relative_m()[i].to_le_bytes()).collect(),
            Part::Surface => indices.map(|i| terrain.surface_class(terrain.grid.cell(i))).collect(),
            Part::Obstacle => indices.map(|i| u8::from(terrain.obstacles().is_some_and(|o| o[i]))).collect(),
        }
    }
}

impl Iterator for CellBytes {
    type Item = Vec<u8>;

    fn next(&mut self) -> Option<Vec<u8>> {
        let (part, from) = self.next?;
        let cells = self.rows * self.columns;
        let until = (from + PIECE_CELLS).min(cells);
        self.next = match part {
            Part::Head => Some((Part::Elevation, 0)),
            part if until < cells => Some((part, until)),
            Part::Elevation => Some((Part::Surface, 0)),
            Part::Surface => Some((Part::Obstacle, 0)),
            Part::Obstacle => None,
        };
        Some(self.cells(part, from..until))
    }
}

/// Bytes before the first cell.
const HEAD_BYTES: usize = 48;
/// Bytes of a cell over all layers.
const CELL_BYTES: usize = 6;

fn stride(rows: usize, columns: usize, most_cells: usize) -> usize {
    let fits = |stride: &usize| rows.div_ceil(*stride) * columns.div_ceil(*stride) <= most_cells.max(1);
    (1..).find(fits).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use terrain::Grid;

    use super::*;

    #[test]
    fn elevations_come_back_exactly_and_coarser_maps_keep_to_the_limit() {
        let grid = Grid { rows: 5, columns: 7, cell_size_m: 0.5, origin_m: [10.0, -3.0] };
        let z: Vec<f64> = (0..35).map(|i| if i == 3 { f64::NAN } else { 100.0 + f64::from(i) }).collect();
        let terrain = Arc::new(Terrain::new(grid, &z).unwrap());
        let bytes = |most_cells| {
            let pieces = CellBytes::of(Arc::clone(&terrain), most_cells);
            let length = pieces.length();
            let bytes: Vec<u8> = pieces.flatten().collect();
            assert_eq!(bytes.len(), length);
            bytes
        };
        let u32_at = |b: &[u8], at: usize| u32::from_le_bytes(b[at..at + 4].try_into().unwrap());
        let f64_at = |b: &[u8], at: usize| f64::from_le_bytes(b[at..at + 8].try_into().unwrap());
        let z_at = |b: &[u8], i: usize| {
            f64_at(b, 40) + f64::from(f32::from_le_bytes(b[48 + 4 * i..52 + 4 * i].try_into().unwrap()))
        };

        let all = bytes(usize::MAX);
        assert_eq!((u32_at(&all, 4), u32_at(&all, 8), u32_at(&all, 12)), (7, 5, 1));
        assert_eq!(all.len(), 48 + 6 * 35);
        assert!(z_at(&all, 3).is_nan());
        assert_eq!(z_at(&all, 34), 134.0);

        let few = bytes(12);
        assert_eq!((u32_at(&few, 4), u32_at(&few, 8), u32_at(&few, 12)), (4, 3, 2));
        assert_eq!((f64_at(&few, 16), f64_at(&few, 24), f64_at(&few, 32)), (1.0, 10.0, -3.0));
        // The middle of the first block of four is its north-east cell.
        assert_eq!(z_at(&few, 0), 108.0);
    }
}
