//! Random ends on a map, for examples that go over many pairs.

use planner::{Goal, Patience, Query, Settings, Start};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use terrain::Terrain;

/// Pairs nearer than this share of the map's width have little relief between them.
const LEAST_SHARE: f64 = 0.4;

/// Two places far from each other, whether or not a path joins them.
pub(crate) fn random_query(random: &mut Pcg64Mcg, terrain: &Terrain, settings: Settings) -> Query {
    let grid = &terrain.grid;
    loop {
        let mut place =
            || grid.at_fraction_m(random.random_range(0.03..0.97), random.random_range(0.03..0.97));
        let (start, goal) = (place(), place());
        if (start[0] - goal[0]).hypot(start[1] - goal[1])
            < LEAST_SHARE * grid.columns as f64 * grid.cell_size_m
        {
            continue;
        }
        return Query {
            start: Start { x_m: start[0], y_m: start[1], heading_rad: None },
            goal: Goal { x_m: goal[0], y_m: goal[1], heading_rad: None, either_way: false, tolerance_m: 0.0 },
            settings,
            other_goals: Vec::new(),
            snap_radius_m: None,
            bound: 1.0,
            refine: false,
            exact_ends: false,
            patience: Patience::default(),
        };
    }
}
