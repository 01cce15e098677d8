//! How near a path comes to what the robot must not touch.

use terrain::Cell;

use crate::{
    ground::{clearance::Clearance, footprint::Footprint},
    lattice::graph::Lattice,
    path::route::{Pose, Route},
    patience::{Patience, work},
};

/// The least distance along a route between the robot's outline and the next blocked ground or the map's edge [m]; the distance that
/// is looked at where nothing is nearer, which is [`Clearance::FARTHEST`] cells less the robot's own half diagonal. It is taken at
/// the ends of steps, which are at most 1.25 cells apart.
///
/// `None` when patience ends first.
pub fn least_room_m(lattice: &Lattice, route: &Route, patience: &Patience) -> Option<f64> {
    let (grid, outline) = (&lattice.terrain.grid, Footprint::of(&lattice.robot));
    let half_diagonal_m = outline.length_m.hypot(outline.width_m) / 2.0;
    let farthest_m = f64::from(Clearance::FARTHEST) * grid.cell_size_m - half_diagonal_m;
    let mut least_m = farthest_m.max(0.0);
    let mut pacer = patience.pacer();
    for pose in &route.poses {
        pacer.after(work::STATE)?;
        let Some(cell) = grid.cell_at(pose.x_m, pose.y_m) else { continue };
        // From the pose to the next blocked cell's nearest edge it is at least so far.
        let free_cells = f64::from(lattice.clearance.at(grid.index(cell))) - 1.0;
        if free_cells * grid.cell_size_m - half_diagonal_m >= least_m {
            continue;
        }
        let reach_m = least_m + half_diagonal_m;
        for (near, square_m) in cells_within(lattice, cell, reach_m) {
            pacer.after(work::CELL)?;
            if lattice.terrain.is_blocked(near) {
                least_m = least_m.min(apart_m(pose, &outline, square_m));
            }
        }
        least_m = least_m.min(to_edge_m(lattice, pose, &outline));
    }
    Some(least_m.max(0.0))
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

/// Corners of the outline in a pose [m].
fn corners_m(pose: &Pose, outline: &Footprint) -> [[f64; 2]; 4] {
    let (sin, cos) = pose.heading_rad.sin_cos();
    [(0.5, 0.5), (0.5, -0.5), (-0.5, 0.5), (-0.5, -0.5)].map(|(front, left)| {
        let (ahead, aside) = (front * outline.length_m, left * outline.width_m);
        [pose.x_m + ahead * cos - aside * sin, pose.y_m + ahead * sin + aside * cos]
    })
}

/// Distance between the outline and a square of the map that it does not touch: it is least at a corner of either [m].
fn apart_m(pose: &Pose, outline: &Footprint, [west, south, east, north]: [f64; 4]) -> f64 {
    let beyond = |at: f64, low: f64, high: f64| (low - at).max(at - high).max(0.0);
    let to_square = |[x, y]: [f64; 2]| beyond(x, west, east).hypot(beyond(y, south, north));
    let (sin, cos) = pose.heading_rad.sin_cos();
    let to_outline = |[x, y]: [f64; 2]| {
        let (dx, dy) = (x - pose.x_m, y - pose.y_m);
        let (ahead, aside) = (dx * cos + dy * sin, dy * cos - dx * sin);
        let (half_length_m, half_width_m) = (outline.length_m / 2.0, outline.width_m / 2.0);
        beyond(ahead, -half_length_m, half_length_m).hypot(beyond(aside, -half_width_m, half_width_m))
    };
    let of_outline = corners_m(pose, outline).map(to_square);
    let of_square = [[west, south], [east, south], [east, north], [west, north]].map(to_outline);
    of_outline.into_iter().chain(of_square).fold(f64::INFINITY, f64::min)
}

/// Distance of the outline from the nearest edge of the map [m].
fn to_edge_m(lattice: &Lattice, pose: &Pose, outline: &Footprint) -> f64 {
    let grid = &lattice.terrain.grid;
    let (low, high) = (grid.origin_m, grid.far_corner_m());
    let of = |[x, y]: [f64; 2]| (x - low[0]).min(high[0] - x).min(y - low[1]).min(high[1] - y);
    corners_m(pose, outline).map(of).into_iter().fold(f64::INFINITY, f64::min)
}
