//! Whether unknown ground is why there is no path, and how to fill it.

use planner::{Blocked, Error, Planner};
use terrain::{Terrain, gaps::gap_between};

use crate::problem::Problem;

/// Multiples of the width at the narrowest place that are tried for the width of the whole.
const WIDENINGS: [f64; 4] = [1.0, 2.0, 4.0, 8.0];

/// Why a planner has no path between two places, x and y [m], with the unknown ground that is in the way and how to fill it.
pub(crate) fn no_plan_over(planner: &Planner, ends_m: [[f64; 2]; 2], error: &Error) -> Problem {
    let problem = Problem::no_plan(error);
    let lattice = planner.lattice();
    let hint = match error {
        Error::NoPath { .. } | Error::NoRoomToTurn { .. } => parted(&lattice.terrain, ends_m)
            .or_else(|| small_holes(&lattice.terrain, lattice.robot.wheelbase_m)),
        Error::PlaceBlocked { reason: Blocked::Unknown { .. }, .. } => {
            small_holes(&lattice.terrain, lattice.robot.wheelbase_m)
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
        None => "it is too wide or open to the border to be filled from the ground around (--fill-voids-m): survey the ground there".to_owned(),
    };
    Some(format!(
        "unknown ground parts the map between start and goal: where it is narrowest, near ({x_m:.2}, {y_m:.2}), the strip is {cells} ({width_m} m) wide; {mend}"
    ))
}

/// How many cells are unknown, and how to fill holes that are smaller than the robot; none where all is known.
fn small_holes(terrain: &Terrain, wheelbase_m: f64) -> Option<String> {
    let unknown = terrain.relative_m().iter().filter(|z| z.is_nan()).count();
    let width_m = whole_millimetres(wheelbase_m.max(terrain.grid.cell_size_m));
    (unknown > 0).then(|| {
        format!("{unknown} cells of the map are unknown ground, which no wheel may touch; {}", mend(width_m))
    })
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
