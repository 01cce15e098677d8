//! Outlines of sets of cells, as polygons with holes.
//!
//! Isolines between cell centres, as libraries draw them, would cut through cells of which all is known; here a contour runs
//! along the edges of cells, and a cell lies inside exactly when its value does.

use planner::{Pacer, Patience, work};
use terrain::Grid;

/// A polygon on the map: rings of x and y [m], each closed, its last point the first again.
///
/// Rings never cross nor touch themselves. The exterior runs counter-clockwise, holes run clockwise (RFC 7946, 3.1.6).
#[derive(Clone, Debug, PartialEq)]
pub struct Polygon {
    /// The outer ring.
    pub exterior: Vec<[f64; 2]>,
    /// Rings of what is left out; they may touch the exterior and one another in single points.
    pub holes: Vec<Vec<[f64; 2]>>,
}

/// Work of a step along an edge, with the cells on either side.
const CORNER: u64 = 4 * work::CELL;

/// A corner of the grid, by column and row of the cell to its north-east.
type Corner = (usize, usize);

/// Polygons of the cells, by row-major position, that are inside: one for each set of cells that hang together by edges.
/// `None` where patience ends first.
pub fn outline(grid: &Grid, inside: impl Fn(usize) -> bool, patience: &Patience) -> Option<Vec<Polygon>> {
    let mut pacer = patience.pacer();
    let labels = Labels::new(grid, inside, &mut pacer)?;
    let mut walk = Walk { labels: &labels, seen: vec![false; grid.cells()] };
    let mut polygons: Vec<Polygon> = vec![Polygon { exterior: Vec::new(), holes: Vec::new() }; labels.count];
    for row in 0..grid.rows {
        for column in 0..grid.columns {
            pacer.after(work::CELL)?;
            let label = labels.at(column as isize, row as isize);
            let is_southern_edge = label != 0 && labels.at(column as isize, row as isize - 1) == 0;
            if !is_southern_edge || walk.seen[row * grid.columns + column] {
                continue;
            }
            let polygon = &mut polygons[label as usize - 1];
            let ring = walk.ring((column, row), &mut pacer)?;
            for ring in simple_rings(ring, &mut pacer)? {
                let is_exterior = doubled_area(&ring, &mut pacer)? > 0;
                let ring = in_metres(grid, &ring, &mut pacer)?;
                if is_exterior { polygon.exterior = ring } else { polygon.holes.push(ring) }
            }
        }
    }
    Some(polygons)
}

/// Cells by the set that they belong to.
struct Labels {
    rows: isize,
    columns: isize,
    /// From 1; 0 outside.
    label: Vec<u32>,
    count: usize,
}

impl Labels {
    /// Numbers the sets of cells that hang together by edges.
    fn new(grid: &Grid, inside: impl Fn(usize) -> bool, pacer: &mut Pacer<'_>) -> Option<Self> {
        const UNSEEN: u32 = u32::MAX;
        let mut label = vec![0; grid.cells()];
        for (index, label) in label.iter_mut().enumerate() {
            pacer.after(work::CELL)?;
            *label = if inside(index) { UNSEEN } else { 0 };
        }
        let (mut count, mut open) = (0, Vec::new());
        for first in 0..label.len() {
            pacer.after(work::CELL)?;
            if label[first] != UNSEEN {
                continue;
            }
            count += 1;
            label[first] = count as u32;
            open.push(first);
            while let Some(at) = open.pop() {
                pacer.after(CORNER)?;
                let (row, column) = (at / grid.columns, at % grid.columns);
                let beside = [
                    (column > 0).then(|| at - 1),
                    (column + 1 < grid.columns).then(|| at + 1),
                    (row > 0).then(|| at - grid.columns),
                    (row + 1 < grid.rows).then(|| at + grid.columns),
                ];
                for next in beside.into_iter().flatten() {
                    if label[next] == UNSEEN {
                        label[next] = count as u32;
                        open.push(next);
                    }
                }
            }
        }
        Some(Labels { rows: grid.rows as isize, columns: grid.columns as isize, label, count })
    }

    /// The set of a cell; none beyond the grid.
    fn at(&self, column: isize, row: isize) -> u32 {
        if column < 0 || row < 0 || column >= self.columns || row >= self.rows {
            return 0;
        }
        self.label[(row * self.columns + column) as usize]
    }
}

/// Walks along edges with the inside on the left.
struct Walk<'l> {
    labels: &'l Labels,
    /// Cells whose southern edge has been walked along; every ring has one.
    seen: Vec<bool>,
}

impl Walk<'_> {
    /// The ring that runs east along the southern edge of a cell, corner by corner.
    fn ring(&mut self, (column, row): (usize, usize), pacer: &mut Pacer<'_>) -> Option<Vec<Corner>> {
        let mut ring = Vec::new();
        let (mut x, mut y) = (column as isize, row as isize);
        let (mut dx, mut dy) = (1, 0);
        loop {
            pacer.after(CORNER)?;
            if (dx, dy) == (1, 0) {
                let at = (y * self.labels.columns + x) as usize;
                if std::mem::replace(&mut self.seen[at], true) {
                    return Some(ring);
                }
            }
            ring.push((x as usize, y as usize));
            (x, y) = (x + dx, y + dy);
            // Of the two cells ahead, left and right of the line: where the left is outside turn left, so that cells which
            // share a corner alone stay apart; where the right is inside turn right.
            let ahead = |side: isize| {
                let (cx, cy) = (2 * x + dx - side * dy, 2 * y + dy + side * dx);
                self.labels.at((cx - 1).div_euclid(2), (cy - 1).div_euclid(2)) != 0
            };
            (dx, dy) = match (ahead(1), ahead(-1)) {
                (false, _) => (-dy, dx),
                (true, false) => (dx, dy),
                (true, true) => (dy, -dx),
            };
        }
    }
}

/// Takes a ring apart where it comes back to a corner, so that none touches itself.
fn simple_rings(ring: Vec<Corner>, pacer: &mut Pacer<'_>) -> Option<Vec<Vec<Corner>>> {
    let mut rings = Vec::new();
    let mut path: Vec<Corner> = Vec::new();
    let mut at = std::collections::HashMap::new();
    for corner in ring {
        pacer.after(work::STATE)?;
        if let Some(&from) = at.get(&corner) {
            let part = path.split_off(from);
            for corner in &part {
                pacer.after(work::STATE)?;
                at.remove(corner);
            }
            rings.push(part);
        }
        at.insert(corner, path.len());
        path.push(corner);
    }
    rings.push(path);
    Some(rings)
}

/// Twice the area of a ring of corners, positive when it runs counter-clockwise [cells].
fn doubled_area(ring: &[Corner], pacer: &mut Pacer<'_>) -> Option<i64> {
    let mut doubled = 0;
    for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
        pacer.after(work::CELL)?;
        doubled += a.0 as i64 * b.1 as i64 - b.0 as i64 * a.1 as i64;
    }
    Some(doubled)
}

/// The ring's corners on the map, without those on a straight line, and closed.
fn in_metres(grid: &Grid, ring: &[Corner], pacer: &mut Pacer<'_>) -> Option<Vec<[f64; 2]>> {
    let count = ring.len();
    let bends = |i: usize| {
        let (before, here, after) = (ring[(i + count - 1) % count], ring[i], ring[(i + 1) % count]);
        !(before.0 == here.0 && here.0 == after.0 || before.1 == here.1 && here.1 == after.1)
    };
    let place = |i: usize| {
        let (column, row) = ring[i];
        [
            grid.origin_m[0] + column as f64 * grid.cell_size_m,
            grid.origin_m[1] + row as f64 * grid.cell_size_m,
        ]
    };
    let mut points = Vec::new();
    for i in 0..count {
        pacer.after(work::CELL)?;
        if bends(i) {
            points.push(place(i));
        }
    }
    points.extend(points.first().copied());
    Some(points)
}

#[cfg(test)]
mod tests {
    use rand::{RngExt, SeedableRng};

    use super::*;

    fn grid(rows: usize, columns: usize) -> Grid {
        Grid { rows, columns, cell_size_m: 1.0, origin_m: [0.0, 0.0] }
    }

    /// Rows as text, northernmost first.
    fn drawn(picture: &[&str]) -> Vec<Polygon> {
        let cells: Vec<bool> = picture.iter().rev().flat_map(|row| row.chars().map(|c| c == '#')).collect();
        outline(&grid(picture.len(), picture[0].len()), |i| cells[i], &Patience::default()).unwrap()
    }

    fn area(ring: &[[f64; 2]]) -> f64 {
        ring.windows(2).map(|pair| (pair[0][0] * pair[1][1] - pair[1][0] * pair[0][1]) / 2.0).sum()
    }

    /// Whether a point lies within a ring: crossings of a ray to the east are odd.
    fn winds(ring: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
        let crossed = ring.windows(2).filter(|pair| {
            let [[ax, ay], [_, by]] = [pair[0], pair[1]];
            ax > x && (ay > y) != (by > y)
        });
        crossed.count() % 2 == 1
    }

    #[test]
    fn a_single_cell_is_a_square_that_runs_counter_clockwise() {
        let [square] = &drawn(&["#"])[..] else { panic!("one polygon") };
        assert_eq!(square.exterior, [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [0.0, 0.0]]);
        assert!(square.holes.is_empty());
    }

    #[test]
    fn cells_that_share_a_corner_alone_are_two_polygons() {
        assert_eq!(drawn(&["#.", ".#"]).len(), 2);
    }

    #[test]
    fn a_ring_that_closes_over_a_corner_has_a_hole_there_and_an_exterior_that_does_not_touch_itself() {
        let [ring] = &drawn(&["##.", "#.#", "###"])[..] else { panic!("one polygon") };
        assert_eq!((area(&ring.exterior), ring.holes.len()), (8.0, 1));
        assert_eq!(area(&ring.holes[0]), -1.0);
    }

    #[test]
    fn polygons_of_random_sets_are_simple_and_hold_exactly_their_cells() {
        let mut random = rand_pcg::Pcg64Mcg::seed_from_u64(7);
        for case in 0..60 {
            let grid = grid(random.random_range(1..14), random.random_range(1..14));
            let share = f64::from(case) / 60.0;
            let cells: Vec<bool> = (0..grid.cells()).map(|_| random.random_bool(share)).collect();
            let polygons = outline(&grid, |i| cells[i], &Patience::default()).unwrap();
            for polygon in &polygons {
                assert!(area(&polygon.exterior) > 0.0);
                assert!(polygon.holes.iter().all(|hole| area(hole) < 0.0));
                for ring in polygon.holes.iter().chain([&polygon.exterior]) {
                    assert_eq!(ring.first(), ring.last());
                    // Along grid lines rings can meet themselves only in corners, bends or not.
                    let mut corners: Vec<[i64; 2]> = ring.windows(2).flat_map(corners_between).collect();
                    let count = corners.len();
                    corners.sort_unstable();
                    corners.dedup();
                    assert_eq!(corners.len(), count, "a ring touches itself: {ring:?}");
                }
            }
            for (index, inside) in cells.iter().enumerate() {
                let point = grid.center_m(grid.cell(index));
                let within = |polygon: &&Polygon| {
                    winds(&polygon.exterior, point) && !polygon.holes.iter().any(|hole| winds(hole, point))
                };
                assert_eq!(polygons.iter().filter(within).count(), usize::from(*inside));
            }
        }
    }

    /// Corners from one bend to before the next.
    fn corners_between(pair: &[[f64; 2]]) -> Vec<[i64; 2]> {
        let [from, to] = [pair[0], pair[1]].map(|p| p.map(|v| v as i64));
        let count = (to[0] - from[0]).abs().max((to[1] - from[1]).abs());
        let step = [0, 1].map(|axis| (to[axis] - from[axis]).signum());
        (0..count).map(|i| [from[0] + i * step[0], from[1] + i * step[1]]).collect()
    }
}
