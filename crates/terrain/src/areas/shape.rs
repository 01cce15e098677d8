//! Polygons and lines in the map's metres.

use crate::Grid;

/// A place of the map [m].
pub(super) type Point = [f64; 2];

/// A polygon, or a line.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// Closed rings, the last point of each being its first; what an odd number of them encloses is inside.
    Polygon(Vec<Vec<Point>>),
    /// Points in a row.
    Line(Vec<Point>),
}

impl Shape {
    /// Its chains of points.
    pub(super) fn chains(&self) -> &[Vec<Point>] {
        match self {
            Shape::Polygon(rings) => rings,
            Shape::Line(line) => std::slice::from_ref(line),
        }
    }

    /// Edges from point to point.
    pub(super) fn edges(&self) -> impl Iterator<Item = [Point; 2]> + '_ {
        self.chains().iter().flat_map(|chain| chain.windows(2).map(|pair| [pair[0], pair[1]]))
    }

    /// South-west and north-east corner of what it spans [m].
    pub(super) fn bounds(&self) -> [Point; 2] {
        let points = || self.chains().iter().flatten();
        let least = |axis: usize| points().map(|point| point[axis]).fold(f64::INFINITY, f64::min);
        let most = |axis: usize| points().map(|point| point[axis]).fold(f64::NEG_INFINITY, f64::max);
        [[least(0), least(1)], [most(0), most(1)]]
    }

    /// Whether what it spans and the map have any place in common.
    pub(super) fn meets(&self, grid: &Grid) -> bool {
        let ([west, south], [east, north]) = (self.bounds()[0], self.bounds()[1]);
        let far = grid.far_corner_m();
        west <= far[0] && east >= grid.origin_m[0] && south <= far[1] && north >= grid.origin_m[1]
    }

    /// Where two of its edges that are not neighbours meet, if they do. Lines may cross themselves.
    pub(super) fn crossing(&self) -> Option<Point> {
        let Shape::Polygon(rings) = self else { return None };
        let mut edges: Vec<Edge> = Vec::new();
        for (ring, points) in rings.iter().enumerate() {
            let last = points.len().saturating_sub(2);
            let edge = |(at, pair): (usize, &[Point])| Edge { ring, at, last, ends: [pair[0], pair[1]] };
            edges.extend(points.windows(2).enumerate().map(edge));
        }
        // From west to east, each is held against those that begin before it ends.
        edges.sort_by(|a, b| a.west().total_cmp(&b.west()));
        for (i, edge) in edges.iter().enumerate() {
            let east = edge.east();
            for other in edges[i + 1..].iter().take_while(|other| other.west() <= east) {
                if !edge.is_beside(other)
                    && let Some(point) = meeting(edge.ends, other.ends)
                {
                    return Some(point);
                }
            }
        }
        None
    }
}

/// An edge of a ring.
struct Edge {
    ring: usize,
    at: usize,
    /// Position of the ring's last edge.
    last: usize,
    ends: [Point; 2],
}

impl Edge {
    fn west(&self) -> f64 {
        self.ends[0][0].min(self.ends[1][0])
    }

    fn east(&self) -> f64 {
        self.ends[0][0].max(self.ends[1][0])
    }

    /// Whether both share a corner of the ring.
    fn is_beside(&self, other: &Edge) -> bool {
        let (low, high) = (self.at.min(other.at), self.at.max(other.at));
        self.ring == other.ring && (high - low == 1 || (low == 0 && high == self.last))
    }
}

/// Twice the area of a triangle, positive where its corners go counter-clockwise.
fn turn(a: Point, b: Point, c: Point) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Where two edges cross; edges that only touch, as rings at a corner do, do not.
fn meeting([a, b]: [Point; 2], [c, d]: [Point; 2]) -> Option<Point> {
    let (of_c, of_d) = (turn(a, b, c), turn(a, b, d));
    let (of_a, of_b) = (turn(c, d, a), turn(c, d, b));
    let crosses = of_c * of_d < 0.0 && of_a * of_b < 0.0;
    crosses.then(|| {
        let share = of_a / (of_a - of_b);
        [a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ring(points: &[Point]) -> Vec<Point> {
        points.iter().chain(points.first()).copied().collect()
    }

    #[test]
    fn a_polygon_that_crosses_itself_is_found_where_it_does() {
        let bow = Shape::Polygon(vec![ring(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]])]);
        assert_eq!(bow.crossing(), Some([1.0, 1.0]));
        let hole_across = Shape::Polygon(vec![
            ring(&[[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0]]),
            ring(&[[3.0, 1.0], [5.0, 1.0], [5.0, 2.0], [3.0, 2.0]]),
        ]);
        assert!(hole_across.crossing().is_some());
    }

    #[test]
    fn neighbours_holes_and_touching_corners_do_not_cross() {
        let notched = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [2.0, 1.0], [0.0, 4.0]];
        let with_hole = Shape::Polygon(vec![ring(&notched), ring(&[[1.0, 0.5], [1.5, 0.5], [1.5, 0.8]])]);
        assert_eq!(with_hole.crossing(), None);
        let line = Shape::Line(vec![[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 2.0]]);
        assert_eq!(line.crossing(), None, "a line may cross itself");
    }
}
