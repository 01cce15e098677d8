//! Sets of cells as runs along rows: sweeps of a large robot over small cells hold a few runs a row.

use terrain::{Cell, Terrain};

use crate::ground::clearance::Clearance;

/// A run of cells within one row, as offsets from a start cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Span {
    /// Rows to the north.
    pub(crate) row: i32,
    /// Columns to the east of the run's first cell.
    pub(crate) first: i32,
    /// Columns to the east of its last cell.
    pub(crate) last: i32,
}

impl Span {
    /// Number of its cells.
    pub(crate) fn cells(&self) -> u32 {
        self.first.abs_diff(self.last) + 1
    }

    /// Largest king's distance of its cells from the start cell.
    pub(crate) fn reach(&self) -> u32 {
        self.row.unsigned_abs().max(self.first.unsigned_abs()).max(self.last.unsigned_abs())
    }

    /// The first of its cells, counted from `from`, that is blocked or outside the map.
    ///
    /// `Some(None)` stands for a cell outside the map. A cell of clearance n is followed by n − 1 free ones.
    pub(crate) fn first_blocked(&self, clearance: &Clearance, from: Cell) -> Option<Option<Cell>> {
        let grid = &clearance.terrain().grid;
        let mut column = self.first;
        while column <= self.last {
            let Some(cell) = shifted(clearance.terrain(), from, (column, self.row)) else {
                return Some(None);
            };
            match clearance.at(grid.index(cell)) {
                0 => return Some(Some(cell)),
                free => column += i32::from(free),
            }
        }
        None
    }
}

/// The first blocked or outside cell of a set of spans, counted from a cell; `Some(None)` is outside the map.
pub(crate) fn first_blocked(clearance: &Clearance, from: Cell, spans: &[Span]) -> Option<Option<Cell>> {
    spans.iter().find_map(|span| span.first_blocked(clearance, from))
}

/// The cell at an offset (columns, rows), if the grid has it.
pub(crate) fn shifted(terrain: &Terrain, cell: Cell, (columns, rows): (i32, i32)) -> Option<Cell> {
    let column = cell.column.checked_add_signed(columns as isize)?;
    let row = cell.row.checked_add_signed(rows as isize)?;
    (row < terrain.grid.rows && column < terrain.grid.columns).then_some(Cell { row, column })
}

/// The union of spans that are added one after the other.
#[derive(Default)]
pub(crate) struct SpanUnion {
    /// Runs by row from `south` on. Those of neighbouring rectangles overlap, so that most grow the last run.
    rows: Vec<Vec<(i32, i32)>>,
    south: i32,
}

impl SpanUnion {
    /// Adds the cells of a span.
    pub(crate) fn add(&mut self, span: Span) {
        if self.rows.is_empty() {
            self.south = span.row;
        }
        if span.row < self.south {
            let missing = self.south.abs_diff(span.row) as usize;
            self.rows.splice(0..0, std::iter::repeat_with(Vec::new).take(missing));
            self.south = span.row;
        }
        let row = span.row.abs_diff(self.south) as usize;
        if row >= self.rows.len() {
            self.rows.resize_with(row + 1, Vec::new);
        }
        match self.rows[row].last_mut() {
            Some(run) if span.first <= run.1 + 1 && run.0 <= span.last + 1 => {
                *run = (run.0.min(span.first), run.1.max(span.last));
            }
            _ => self.rows[row].push((span.first, span.last)),
        }
    }

    /// The union, from south to north and west to east, without overlaps.
    pub(crate) fn finish(self) -> Vec<Span> {
        let mut spans: Vec<Span> = Vec::with_capacity(self.rows.len());
        for (row, mut runs) in (self.south..).zip(self.rows) {
            runs.sort_unstable();
            for (first, last) in runs {
                match spans.last_mut() {
                    Some(span) if span.row == row && first <= span.last + 1 => {
                        span.last = span.last.max(last);
                    }
                    _ => spans.push(Span { row, first, last }),
                }
            }
        }
        spans
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;
    use terrain::{Grid, synthetic};

    use super::*;

    proptest! {
        #[test]
        fn a_union_holds_the_cells_of_its_spans_once_and_no_others(
            added in prop::collection::vec((-4i32..5, -9i32..10, 0i32..6), 0..30),
        ) {
            let cells = |span: Span| (span.first..=span.last).map(move |column| (span.row, column));
            let mut union = SpanUnion::default();
            let mut expected = BTreeSet::new();
            for (row, first, length) in added {
                let span = Span { row, first, last: first + length };
                union.add(span);
                expected.extend(cells(span));
            }
            let found: Vec<(i32, i32)> = union.finish().into_iter().flat_map(cells).collect();
            prop_assert_eq!(found, expected.into_iter().collect::<Vec<_>>());
        }
    }

    #[test]
    fn the_first_blocked_cell_of_a_span_equals_a_look_at_every_cell() {
        let grid = Grid { rows: 40, columns: 90, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        let flat = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap();
        let terrain = synthetic::scatter_obstacles(flat, 5, 0.004);
        let clearance = Clearance::new(&terrain);
        let (mut blocked, mut outside) = (0, 0);
        for index in (0..grid.cells()).step_by(3) {
            let from = grid.cell(index);
            for span in [Span { row: 2, first: -1, last: 30 }, Span { row: -3, first: -40, last: -2 }] {
                let one_by_one = (span.first..=span.last).find_map(|column| {
                    match shifted(&terrain, from, (column, span.row)) {
                        None => Some(None),
                        Some(cell) => terrain.is_blocked(cell).then_some(Some(cell)),
                    }
                });
                assert_eq!(span.first_blocked(&clearance, from), one_by_one, "{from:?} {span:?}");
                blocked += usize::from(matches!(one_by_one, Some(Some(_))));
                outside += usize::from(one_by_one == Some(None));
            }
        }
        assert!(blocked > 20 && outside > 20, "{blocked} blocked, {outside} outside");
    }
}
