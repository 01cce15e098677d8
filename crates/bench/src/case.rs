//! Plans corner to corner under each bound.

use planner::{Found, Objective, Outcome, Patience, Planner, Query, Search, Workspace, search};
use serde::Serialize;

use crate::{
    Error,
    parts::{Built, timed},
    scene::Scene,
};

/// One way across one map under one bound, on one core.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Case {
    /// Side of the map [cells].
    pub cells_per_side: usize,
    /// `relief` or `obstacles`.
    pub terrain: &'static str,
    /// What the path may cost as a multiple of the least.
    pub bound: f64,
    /// What was proven of it.
    pub proven: f64,
    /// The first plan with nothing at hand: preparation of the robot's motions, costs, field and search [ms].
    pub cold_ms: f64,
    /// With costs and the goal's field at hand and memory kept: the search alone [ms].
    pub warm_ms: f64,
    /// States expanded.
    pub expansions: u64,
    /// Warm time for each expansion [ns].
    pub ns_per_expansion: f64,
    /// Cost of the path in units of the table.
    #[serde(skip)]
    pub(crate) cost_units: u64,
    /// Memory of the search for each state of the tiles it touched [bytes].
    pub bytes_per_state: f64,
}

/// Bounds, from the loosest to the least itself.
const BOUNDS: [f64; 4] = [1.2, 1.05, 1.01, 1.0];
/// Searches of which the fastest counts as warm.
const REPEATS: usize = 3;

pub(crate) fn measure(scene: &Scene, built: &Built) -> Result<Vec<Case>, Error> {
    let goals: Vec<_> = scene.goals.iter().map(|goal| (*goal, 0.0)).collect();
    let mut cases = Vec::new();
    for bound in BOUNDS {
        let patience = Patience::default();
        let question =
            Search { starts: &scene.starts, goals: &goals, besides: 0.0, bound, patience: &patience };
        let (cold, cold_time) = timed(|| {
            let planner = Planner::new(&scene.terrain, &scene.robot, scene.lattice.settings)?;
            planner.plan(&Query { bound, ..scene.query([0.0, 0.0]) }, Objective::Energy)
        });
        cold.map_err(|source| Error::Plan { side: scene.side, source })?;
        let mut workspace = Workspace::of(&scene.lattice);
        let mut fastest: Option<(Found, f64)> = None;
        for _ in 0..REPEATS {
            let (outcome, time) = timed(|| search(&built.table, &built.field, &question, &mut workspace));
            let ms = time.as_secs_f64() * 1e3;
            let found = found(scene, Some(outcome))?;
            if fastest.as_ref().is_none_or(|(_, least_ms)| ms < *least_ms) {
                fastest = Some((found, ms));
            }
        }
        let (found, warm_ms) = fastest.ok_or_else(|| scene.no_path())?;
        cases.push(Case {
            cells_per_side: scene.side,
            terrain: scene.ground.name(),
            bound,
            proven: found.bound.unwrap_or(f64::INFINITY),
            cold_ms: cold_time.as_secs_f64() * 1e3,
            warm_ms,
            expansions: found.expanded,
            ns_per_expansion: warm_ms * 1e6 / found.expanded.max(1) as f64,
            cost_units: cost_units(built, &found),
            bytes_per_state: workspace.bytes_per_state(),
        });
    }
    Ok(cases)
}

/// Cost of a path, motion by motion.
fn cost_units(built: &Built, found: &Found) -> u64 {
    let mut state = found.start;
    let mut units = 0.0;
    for &motion in &found.motions {
        units += built.table.cost(state, motion) * built.table.units();
        if let Some(next) = built.table.lattice().successor(state, motion) {
            state = next;
        }
    }
    units.round() as u64
}

fn found(scene: &Scene, outcome: Option<Outcome>) -> Result<Found, Error> {
    match outcome {
        Some(Outcome::Found(found)) => Ok(found),
        _ => Err(scene.no_path()),
    }
}
