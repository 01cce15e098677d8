//! Which cells a shape covers.

use super::shape::{Point, Shape};
use crate::Grid;

/// Why cells are no longer looked for.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Over;

/// Visits cells of a shape by their row-major positions, some of them several times: those whose centres a polygon holds, and those
/// that a line passes through. With `touched`, those that a polygon's edges pass through too.
///
/// # Errors
/// [`Over`] as soon as `is_over` says so, which is asked row by row.
pub(super) fn cover(
    grid: &Grid,
    shape: &Shape,
    touched: bool,
    is_over: &dyn Fn() -> bool,
    visit: &mut dyn FnMut(usize),
) -> Result<(), Over> {
    if let Shape::Polygon(_) = shape {
        fill(grid, shape, is_over, visit)?;
    }
    if touched || matches!(shape, Shape::Line(_)) {
        for edge in shape.edges() {
            trace(grid, edge, is_over, visit)?;
        }
    }
    Ok(())
}

/// Cells whose centres lie inside, by the crossings of each row of centres (even-odd rule).
fn fill(
    grid: &Grid,
    shape: &Shape,
    is_over: &dyn Fn() -> bool,
    visit: &mut dyn FnMut(usize),
) -> Result<(), Over> {
    let place = |point: Point| in_cells(grid, point);
    // Centres are at halves of cells.
    let row_from = |y: f64| (y - 0.5).ceil().clamp(0.0, grid.rows as f64) as usize;
    let [low, high] = shape.bounds().map(place);
    let (first, end) = (row_from(low[1]), row_from(high[1]));
    let mut crossings: Vec<Vec<f64>> = vec![Vec::new(); end.saturating_sub(first)];
    for [a, b] in shape.edges() {
        let (a, b) = if a[1] <= b[1] { (place(a), place(b)) } else { (place(b), place(a)) };
        for row in row_from(a[1]).max(first)..row_from(b[1]).min(end) {
            let share = (row as f64 + 0.5 - a[1]) / (b[1] - a[1]);
            crossings[row - first].push(a[0] + share * (b[0] - a[0]));
        }
    }
    for (row, crossings) in (first..).zip(&mut crossings) {
        if is_over() {
            return Err(Over);
        }
        crossings.sort_by(f64::total_cmp);
        for pair in crossings.chunks_exact(2) {
            let column = |x: f64| (x - 0.5).ceil().clamp(0.0, grid.columns as f64) as usize;
            (column(pair[0])..column(pair[1])).for_each(|column| visit(row * grid.columns + column));
        }
    }
    Ok(())
}

/// Cells that an edge passes through or touches, row by row, so that none is stepped over at a corner.
fn trace(
    grid: &Grid,
    edge: [Point; 2],
    is_over: &dyn Fn() -> bool,
    visit: &mut dyn FnMut(usize),
) -> Result<(), Over> {
    let [a, b] = edge.map(|point| in_cells(grid, point));
    let (low, high) = if a[1] <= b[1] { (a, b) } else { (b, a) };
    if high[1] < 0.0 || low[1] > grid.rows as f64 {
        return Ok(());
    }
    let last = (grid.rows - 1) as f64;
    let rows = low[1].floor().clamp(0.0, last) as usize..=high[1].floor().clamp(0.0, last) as usize;
    for row in rows {
        if is_over() {
            return Err(Over);
        }
        // The part of the edge in this row of cells.
        let at = |y: f64| match high[1] - low[1] {
            0.0 => None,
            rise => Some(low[0] + ((y - low[1]) / rise).clamp(0.0, 1.0) * (high[0] - low[0])),
        };
        let ends = match (at(row as f64), at(row as f64 + 1.0)) {
            (Some(from), Some(to)) => [from, to],
            _ => [low[0], high[0]],
        };
        let (west, east) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
        if east < 0.0 || west >= grid.columns as f64 {
            continue;
        }
        let column = |x: f64| x.floor().clamp(0.0, (grid.columns - 1) as f64) as usize;
        (column(west)..=column(east)).for_each(|column| visit(row * grid.columns + column));
    }
    Ok(())
}

/// A place in cells from the map's corner: columns, rows.
fn in_cells(grid: &Grid, [x_m, y_m]: Point) -> Point {
    [(x_m - grid.origin_m[0]) / grid.cell_size_m, (y_m - grid.origin_m[1]) / grid.cell_size_m]
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use proptest::prelude::*;

    use super::*;

    const GRID: Grid = Grid { rows: 9, columns: 11, cell_size_m: 2.0, origin_m: [-3.0, 5.0] };

    fn covered(shape: &Shape, touched: bool) -> BTreeSet<usize> {
        let mut cells = BTreeSet::new();
        cover(&GRID, shape, touched, &|| false, &mut |cell| {
            cells.insert(cell);
        })
        .unwrap();
        cells
    }

    /// Whether a point lies inside a ring, by the angles under which it sees the edges.
    fn winds_round(ring: &[Point], [x, y]: Point) -> bool {
        let angle = |p: Point| (p[1] - y).atan2(p[0] - x);
        let turned: f64 = ring
            .windows(2)
            .map(|pair| {
                let turn = angle(pair[1]) - angle(pair[0]);
                turn - (turn / std::f64::consts::TAU).round() * std::f64::consts::TAU
            })
            .sum();
        turned.abs() > 3.0
    }

    proptest! {
        #[test]
        fn a_triangle_covers_the_cells_whose_centres_it_winds_round(
            corners in prop::collection::vec((-8.0f64..25.0, 0.0f64..28.0), 3),
        ) {
            let mut ring: Vec<Point> = corners.iter().map(|&(x, y)| [x, y]).collect();
            ring.push(ring[0]);
            let shape = Shape::Polygon(vec![ring.clone()]);
            let inside: BTreeSet<usize> = (0..GRID.cells())
                .filter(|&cell| winds_round(&ring, GRID.center_m(GRID.cell(cell))))
                .collect();
            prop_assert_eq!(covered(&shape, false), inside);
        }

        #[test]
        fn a_line_covers_every_cell_that_points_along_it_lie_in(
            a in (-8.0f64..25.0, 0.0f64..28.0), b in (-8.0f64..25.0, 0.0f64..28.0),
        ) {
            let cells = covered(&Shape::Line(vec![[a.0, a.1], [b.0, b.1]]), false);
            for i in 0..=500 {
                let share = f64::from(i) / 500.0;
                let point = [a.0 + share * (b.0 - a.0), a.1 + share * (b.1 - a.1)];
                if let Some(cell) = GRID.cell_at(point[0], point[1]) {
                    prop_assert!(cells.contains(&GRID.index(cell)), "{:?} at {:?}", cell, point);
                }
            }
        }
    }

    #[test]
    fn patience_that_ends_ends_the_work() {
        let shape = Shape::Line(vec![[0.0, 6.0], [0.0, 20.0]]);
        assert_eq!(cover(&GRID, &shape, true, &|| true, &mut |_| ()), Err(Over));
    }
}
