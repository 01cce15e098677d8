//! Whether unknown ground is why there is no path, and how to fill it.

use planner::{Blocked, Error, Planner};
use terrain::{Cell, Terrain, gaps::gap_between};

use crate::problem::Problem;

/// Multiples of the width at the narrowest place that are tried for the width of the whole.
const WIDENINGS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

/// What is said of unknown ground that no width fills.
const UNFILLABLE: &str = "it is too wide or open to the border to be filled from the ground around (--fill-voids-m): survey the ground there";

/// Why a planner has no path between two places, x and y [m], with the unknown ground that is in the way and how to fill it.
pub(crate) fn no_plan_over(planner: &Planner, ends_m: [[f64; 2]; 2], error: &Error) -> Problem {
    let problem = Problem::no_plan(error);
    let lattice = planner.lattice();
    let hint = match error {
        Error::NoPath { .. } | Error::NoRoomToTurn { .. } => parted(&lattice.terrain, ends_m)
            .or_else(|| small_holes(&lattice.terrain, lattice.robot.wheelbase_m)),
        Error::PlaceBlocked { reason: Blocked::Unknown { cell }, x_m, y_m, .. } => {
            let beneath = lattice.terrain.grid.cell_at(*x_m, *y_m);
            let reach_m = lattice.robot.wheelbase_m.hypot(lattice.robot.track_m);
            let cells: Vec<Cell> =
                around(&lattice.terrain, [*x_m, *y_m], reach_m).chain([*cell]).chain(beneath).collect();
            Some(hole_beneath(&lattice.terrain, &cells))
        }
        _ => None,
    };
    match hint {
        Some(hint) => problem.and(&hint),
        None => problem,
    }
}

/// How two places are parted by unknown ground, if they are, and the width of holes with which they would be joined.
fn parted(terrain: &Terrain, ends_m: [[f64; 2]; 2]) -> Option<String> {
    let [start, goal] = ends_m.map(|[x_m, y_m]| terrain.grid.cell_at(x_m, y_m));
    let (start, goal) = (start?, goal?);
    let gap = gap_between(terrain, start, goal)?;
    let width_m = whole_millimetres(gap.widest_cells as f64 * terrain.grid.cell_size_m);
    let [x_m, y_m] = gap.at_m;
    let cells =
        if gap.widest_cells == 1 { "one cell".to_owned() } else { format!("{} cells", gap.widest_cells) };
    // A strip may be wider elsewhere, and is filled as a whole or not at all.
    let joins = |width_m: &f64| {
        let filled = terrain.clone().with_filled_voids(*width_m);
        filled.is_ok_and(|filled| gap_between(&filled, start, goal).is_none())
    };
    let mend = match WIDENINGS.map(|factor| factor * width_m).iter().find(|width_m| joins(width_m)) {
        Some(width_m) => mend(*width_m),
        None => UNFILLABLE.to_owned(),
    };
    Some(format!(
        "unknown ground parts the map between start and goal: where it is narrowest, near ({x_m:.2}, {y_m:.2}), the strip is {cells} ({width_m} m) wide; {mend}"
    ))
}

/// How many cells are unknown, and how to fill holes that are smaller than the robot; none where all is known, or nothing is so small.
fn small_holes(terrain: &Terrain, wheelbase_m: f64) -> Option<String> {
    let unknown = unknown_cells(terrain);
    let width_m = whole_millimetres(wheelbase_m.max(terrain.grid.cell_size_m));
    let filled =
        terrain.clone().with_filled_voids(width_m).ok().filter(|filled| unknown_cells(filled) < unknown);
    filled.map(|_| {
        format!("{unknown} cells of the map are unknown ground, which no wheel may touch; {}", mend(width_m))
    })
}

/// How many cells are unknown, and how to fill the holes that a robot stands over.
fn hole_beneath(terrain: &Terrain, cells: &[Cell]) -> String {
    let unknown = unknown_cells(terrain);
    let cure = terrain
        .void_width_m(cells)
        .filter(|width_m| *width_m > 0.0)
        .map_or_else(|| UNFILLABLE.to_owned(), mend);
    format!("{unknown} cells of the map are unknown ground, which no wheel may touch; {cure}")
}

fn unknown_cells(terrain: &Terrain) -> usize {
    terrain.relative_m().iter().filter(|z| z.is_nan()).count()
}

/// Cells within a distance of a place, along x and y.
fn around(terrain: &Terrain, [x_m, y_m]: [f64; 2], reach_m: f64) -> impl Iterator<Item = Cell> {
    let grid = terrain.grid;
    let along = move |at_m: f64, axis: usize, count: usize| {
        let cell =
            |at_m: f64| ((at_m - grid.origin_m[axis]) / grid.cell_size_m).clamp(0.0, count as f64) as usize;
        cell(at_m - reach_m)..(cell(at_m + reach_m) + 1).min(count)
    };
    let columns = along(x_m, 0, grid.columns);
    along(y_m, 1, grid.rows).flat_map(move |row| columns.clone().map(move |column| Cell { row, column }))
}

/// A width rounded up to millimetres, but for rounding itself [m].
fn whole_millimetres(width_m: f64) -> f64 {
    const ROUNDING_MM: f64 = 1e-6;
    (1000.0 * width_m - ROUNDING_MM).ceil() / 1000.0
}

fn mend(width_m: f64) -> String {
    format!(
        "if such gaps are those of a survey over ground that goes on, fill them by --fill-voids-m {width_m} (fill_voids_m={width_m} in the query of POST /v1/maps)"
    )
}
