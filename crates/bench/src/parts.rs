//! What plans are made of: slopes, costs of motions, fields, walks, batches.

use std::time::{Duration, Instant};

use planner::{CostTable, ExactField, FieldEnds, GoalField, Objective, Patience, Planner, Query, State};
use serde::Serialize;
use terrain::SlopeMap;

use crate::{Error, scene::Scene};

/// Speeds of the parts on one map of relief, on one core.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parts {
    /// Side of the map [cells].
    pub cells_per_side: usize,
    /// Slope map [million cells/s].
    pub slope_million_cells_per_s: f64,
    /// Costs of motions [ns for each].
    pub table_ns_per_edge: f64,
    /// Memory of the costs [bytes for each motion].
    pub table_bytes_per_edge: f64,
    /// Field of a goal over the whole map [ns per cell].
    pub field_ns_per_cell: f64,
    /// Field of a goal over all headings, where it was measured [ns per state].
    pub exact_field_ns_per_state: Option<f64>,
    /// Walk to a goal that is held, where it was measured [ms].
    pub held_goal_ms: Option<f64>,
    /// By how much a plan that is not prepared at all outlasts its deadline at most, over several deadlines [ms].
    pub deadline_overrun_ms: f64,
    /// Time for a batch of plans on one core over that on all.
    pub all_cores_ratio: f64,
}

/// Costs and field of a scene, with what they took.
pub(crate) struct Built {
    pub(crate) table: CostTable,
    pub(crate) field: GoalField,
    goals: Vec<(State, f64)>,
    table_time: Duration,
    field_time: Duration,
}

/// Plans in a batch.
const BATCH: usize = 16;
/// Walks of which the fastest counts.
const REPEATS: usize = 5;

pub(crate) fn build(scene: &Scene) -> Result<Built, Error> {
    let patience = Patience::default();
    let (table, table_time) = timed(|| CostTable::new(&scene.lattice, Objective::Energy, &patience));
    let table = table.ok_or_else(|| scene.no_path())?;
    let goals: Vec<(State, f64)> = scene.goals.iter().map(|goal| (*goal, 0.0)).collect();
    let ends = FieldEnds { goals: &goals, start: None };
    let (field, field_time) = timed(|| GoalField::new(&table, ends, &patience));
    let field = field.ok_or_else(|| scene.no_path())?;
    Ok(Built { table, field, goals, table_time, field_time })
}

pub(crate) fn measure(scene: &Scene, built: &Built, exact: bool) -> Result<Parts, Error> {
    let cells = scene.terrain.grid.cells();
    let edges = scene.states() * scene.lattice.motions_per_state();
    let slope_time =
        (0..REPEATS).map(|_| timed(|| SlopeMap::new(&scene.terrain)).1).min().unwrap_or_default();
    let mut parts = Parts {
        cells_per_side: scene.side,
        slope_million_cells_per_s: cells as f64 / slope_time.as_secs_f64() / 1e6,
        table_ns_per_edge: nanoseconds_each(built.table_time, edges),
        table_bytes_per_edge: built.table.bytes() as f64 / edges as f64,
        field_ns_per_cell: nanoseconds_each(built.field_time, cells),
        exact_field_ns_per_state: None,
        held_goal_ms: None,
        deadline_overrun_ms: deadline_overrun(scene)?.as_secs_f64() * 1e3,
        all_cores_ratio: 1.0,
    };
    if exact {
        let (field, time) =
            timed(|| ExactField::to_goals(&built.table, &built.goals, f64::INFINITY, &Patience::default()));
        let field = field.ok_or_else(|| scene.no_path())?;
        let walk = (0..REPEATS)
            .map(|_| timed(|| field.walk(&built.table, &scene.starts, &Patience::default())).1)
            .min();
        parts.exact_field_ns_per_state = Some(nanoseconds_each(time, scene.states()));
        parts.held_goal_ms = walk.map(|time| time.as_secs_f64() * 1e3);
    }
    Ok(parts)
}

/// Time for a batch of plans to one goal on one core over that on all, costs and field at hand.
pub(crate) fn batch_ratio(scene: &Scene) -> Result<f64, Error> {
    let side = scene.side;
    let plan_error = |source| Error::Plan { side, source };
    let planner = Planner::new(&scene.terrain, &scene.robot, scene.lattice.settings).map_err(plan_error)?;
    let step_m = scene.terrain.grid.cell_size_m * side as f64 / 100.0;
    let queries: Vec<Query> =
        (0..BATCH).map(|i| scene.query([step_m * (i % 4) as f64, step_m * (i / 4) as f64])).collect();
    let one_core =
        rayon::ThreadPoolBuilder::new().num_threads(1).build().map_err(|e| Error::Threads(e.to_string()))?;
    // The first round evaluates costs and the field, and leaves memory to search in.
    for answer in planner.plan_many(&queries, Objective::Energy) {
        answer.map_err(plan_error)?;
    }
    let alone = one_core.install(|| timed(|| planner.plan_many(&queries, Objective::Energy)).1);
    let together = timed(|| planner.plan_many(&queries, Objective::Energy)).1;
    Ok(alone.as_secs_f64() / together.as_secs_f64())
}

/// Deadlines that fall into every stage of a plan [ms].
const DEADLINES_MS: [u64; 6] = [1, 5, 15, 40, 100, 250];

/// How much later than its deadline an answer comes at most.
fn deadline_overrun(scene: &Scene) -> Result<Duration, Error> {
    let side = scene.side;
    let mut worst = Duration::ZERO;
    for deadline_ms in DEADLINES_MS {
        let planner = Planner::new(&scene.terrain, &scene.robot, scene.lattice.settings)
            .map_err(|source| Error::Plan { side, source })?;
        let deadline = Instant::now() + Duration::from_millis(deadline_ms);
        let query = Query { patience: Patience::until(deadline), ..scene.query([0.0, 0.0]) };
        // Whether there was a path yet does not matter here.
        let _ = planner.plan(&query, Objective::Energy);
        worst = worst.max(Instant::now().saturating_duration_since(deadline));
    }
    Ok(worst)
}

pub(crate) fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let began = Instant::now();
    let done = work();
    (done, began.elapsed())
}

fn nanoseconds_each(time: Duration, count: usize) -> f64 {
    time.as_secs_f64() * 1e9 / count.max(1) as f64
}
