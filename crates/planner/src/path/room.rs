//! How near a path comes to what the robot must not touch.

use terrain::Cell;

use crate::{
    grid::heading::turn_rad,
    ground::{clearance::Clearance, footprint::Footprint},
    lattice::{
        graph::Lattice,
        primitive::Piece,
        swept::{Rectangle, SweptPiece},
    },
    path::route::Route,
    patience::{Patience, work},
};

/// Room that the cover of a turn may give away [m].
const SLACK_M: f64 = 1e-3;

/// The least distance along a route between the area that the robot's outline sweeps and the next blocked ground or the map's edge [m]; the
/// distance that is looked at where nothing is nearer, which is [`Clearance::FARTHEST`] cells less the robot's own half diagonal.
///
/// It is never more than the true one: straights are covered exactly, turns by rectangles that reach a millimetre too far at most.
///
/// `None` when patience ends first.
pub fn least_room_m(lattice: &Lattice, route: &Route, patience: &Patience) -> Option<f64> {
    let (grid, outline) = (&lattice.terrain.grid, Footprint::of(&lattice.robot));
    let half_diagonal_m = outline.length_m.hypot(outline.width_m) / 2.0;
    let farthest_m = f64::from(Clearance::FARTHEST) * grid.cell_size_m - half_diagonal_m;
    let mut least_m = farthest_m.max(0.0);
    let mut pacer = patience.pacer();
    let poses: Vec<[f64; 3]> =
        route.poses.iter().map(|pose| [pose.x_m, pose.y_m, pose.heading_rad]).collect();
    for piece in pieces(&poses) {
        pacer.after(work::STATE)?;
        let [x_m, y_m, _] = piece.pose_at(0.5);
        let Some(cell) = grid.cell_at(x_m, y_m) else { continue };
        let reach_m = half_diagonal_m + piece.length_m / 2.0;
        // From the middle to the next blocked cell's nearest edge it is at least so far.
        let free_cells = f64::from(lattice.clearance.at(grid.index(cell))) - 1.0;
        if free_cells * grid.cell_size_m - reach_m >= least_m {
            continue;
        }
        let near = cells_within(lattice, cell, least_m + reach_m);
        let blocked = near.filter(|(cell, _)| lattice.terrain.is_blocked(*cell));
        let squares_m: Vec<[f64; 4]> = blocked.map(|(_, square_m)| square_m).collect();
        pacer.after(squares_m.len() as u64 * work::CELL)?;
        let coarse = SweptPiece::new(&piece, &outline, grid.cell_size_m);
        let is_near = |part| room_of(&coarse.cover(part), lattice, &squares_m) < least_m;
        if !(0..coarse.parts()).any(is_near) {
            continue;
        }
        let close = SweptPiece::with_slack(&piece, &outline, SLACK_M, f64::INFINITY);
        for part in 0..close.parts() {
            pacer.after(squares_m.len() as u64 * work::CELL)?;
            least_m = least_m.min(room_of(&close.cover(part), lattice, &squares_m));
        }
    }
    Some(least_m.max(0.0))
}

/// The straights, arcs and turns on the spot between poses, in the map's metres; of a route of one pose a stand on the spot.
pub(crate) fn pieces(poses: &[[f64; 3]]) -> Vec<Piece> {
    /// Turn below which a piece is straight [rad]: its bulge is far below a micrometre.
    const STRAIGHT_RAD: f64 = 1e-9;
    let between = |&[x_m, y_m, heading_rad]: &[f64; 3], to: &[f64; 3]| {
        let (dx_m, dy_m) = (to[0] - x_m, to[1] - y_m);
        let turned_rad = turn_rad(heading_rad, to[2]);
        let turn_rad = if turned_rad.abs() < STRAIGHT_RAD { 0.0 } else { turned_rad };
        let (chord_m, half_rad) = (dx_m.hypot(dy_m), turn_rad / 2.0);
        let start_m = [x_m, y_m];
        if chord_m == 0.0 {
            return Piece { start_m, heading_rad, length_m: 0.0, turn_rad };
        }
        // A chord lies half the turn off the direction of travel at its ends.
        let length_m = if turn_rad == 0.0 { chord_m } else { chord_m * half_rad / half_rad.sin() };
        Piece { start_m, heading_rad: dy_m.atan2(dx_m) - half_rad, length_m, turn_rad }
    };
    match poses {
        [pose] => vec![between(pose, pose)],
        poses => poses.windows(2).map(|pair| between(&pair[0], &pair[1])).collect(),
    }
}

/// Room between a rectangle and some squares or the map's edge [m].
fn room_of(rectangle: &Rectangle, lattice: &Lattice, squares_m: &[[f64; 4]]) -> f64 {
    let to_squares = squares_m.iter().map(|square_m| apart_m(rectangle, *square_m));
    to_squares.fold(to_edge_m(rectangle, lattice), f64::min)
}

/// Cells about a cell within a distance, each with its west, south, east and north [m].
fn cells_within(
    lattice: &Lattice,
    middle: Cell,
    reach_m: f64,
) -> impl Iterator<Item = (Cell, [f64; 4])> + '_ {
    let grid = lattice.terrain.grid;
    let reach = (reach_m / grid.cell_size_m).ceil() as usize + 1;
    let span = |at: usize, count: usize| at.saturating_sub(reach)..(at + reach + 1).min(count);
    let columns = span(middle.column, grid.columns);
    span(middle.row, grid.rows).flat_map(move |row| {
        columns.clone().map(move |column| {
            let cell = Cell { row, column };
            let ([x, y], half_m) = (grid.center_m(cell), grid.cell_size_m / 2.0);
            (cell, [x - half_m, y - half_m, x + half_m, y + half_m])
        })
    })
}

/// Distance between a rectangle and a square of the map: 0 where they overlap, else least at a corner of either [m].
fn apart_m(rectangle: &Rectangle, [west, south, east, north]: [f64; 4]) -> f64 {
    let beyond = |at: f64, low: f64, high: f64| (low - at).max(at - high).max(0.0);
    let corners = rectangle.corners(1.0);
    let ([cos, sin], [half_length_m, half_width_m]) = (rectangle.direction, rectangle.half_m);
    let within = |[x, y]: [f64; 2]| {
        let (dx, dy) = (x - rectangle.center_m[0], y - rectangle.center_m[1]);
        [dx * cos + dy * sin, dy * cos - dx * sin]
    };
    let square = [[west, south], [east, south], [east, north], [west, north]];
    let of_square = square.map(within);
    let overlaps = |points: &[[f64; 2]; 4], axis: usize, low: f64, high: f64| {
        let along = || points.iter().map(|point| point[axis]);
        along().fold(f64::INFINITY, f64::min) < high && along().fold(f64::NEG_INFINITY, f64::max) > low
    };
    if overlaps(&corners, 0, west, east)
        && overlaps(&corners, 1, south, north)
        && overlaps(&of_square, 0, -half_length_m, half_length_m)
        && overlaps(&of_square, 1, -half_width_m, half_width_m)
    {
        return 0.0;
    }
    let to_square = |[x, y]: [f64; 2]| beyond(x, west, east).hypot(beyond(y, south, north));
    let to_rectangle = |[ahead, aside]: [f64; 2]| {
        beyond(ahead, -half_length_m, half_length_m).hypot(beyond(aside, -half_width_m, half_width_m))
    };
    corners.map(to_square).into_iter().chain(of_square.map(to_rectangle)).fold(f64::INFINITY, f64::min)
}

/// Distance of a rectangle from the nearest edge of the map [m].
fn to_edge_m(rectangle: &Rectangle, lattice: &Lattice) -> f64 {
    let grid = &lattice.terrain.grid;
    let (low, high) = (grid.origin_m, grid.far_corner_m());
    let of = |[x, y]: [f64; 2]| (x - low[0]).min(high[0] - x).min(y - low[1]).min(high[1] - y);
    rectangle.corners(1.0).map(of).into_iter().fold(f64::INFINITY, f64::min)
}
