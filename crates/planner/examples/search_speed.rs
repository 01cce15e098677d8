//! Times the parts of one least-energy search over the lidar terrain, mirrored to size, on one core.
//!
//!     cargo run --release -p joulepath-planner --example search_speed [-- LARGEST_SIDE]

use std::{
    error::Error,
    path::Path,
    time::{Duration, Instant},
};

use model::builtin;
use planner::{
    CostTable, FieldEnds, GoalField, HEADINGS, Heading, Lattice, Objective, Outcome, Patience, Search,
    Settings, State, search,
};
use terrain::{Cell, io, synthetic};

fn main() -> Result<(), Box<dyn Error + Send + Sync>> {
    let largest: usize = std::env::args().nth(1).map_or(Ok(1000), |n| n.parse())?;
    let tile = io::read_path(Path::new("maps/minnesota.tif"))?;
    let one_core = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    println!(
        "{:>6} {:>14} {:>15} {:>11} {:>17} {:>10}",
        "side", "table ns/edge", "field ns/cell", "expansions", "ns per expansion", "search ms"
    );
    for side in [250, 500, 1000, 2000].into_iter().filter(|side| *side <= largest) {
        one_core.install(|| measure(&tile, side))?;
    }
    Ok(())
}

/// Corner to corner over a map of `side` × `side` cells.
fn measure(tile: &terrain::Terrain, side: usize) -> Result<(), Box<dyn Error + Send + Sync>> {
    let (terrain, robot) = (synthetic::mirrored(tile, side, side)?, builtin::husky_a200());
    let lattice = Lattice::new(&terrain, &robot, Settings::of(&robot))?;
    let patience = Patience::default();
    let (table, table_time) = timed(|| CostTable::new(&lattice, Objective::Energy, &patience));
    let table = table.ok_or("the table was not built")?;
    let at = |share: f64| (share * side as f64) as usize;
    let standing = |cell: Cell| Heading::all().map(move |heading| State { cell, heading });
    let starts: Vec<State> =
        standing(Cell { row: at(0.12), column: at(0.1) }).filter(|s| lattice.stand(*s).is_ok()).collect();
    let goal = Cell { row: at(0.88), column: at(0.9) };
    let goals: Vec<(State, f64)> =
        standing(goal).filter(|s| lattice.stand(*s).is_ok()).map(|s| (s, 0.0)).collect();
    let goal_cells = [(goal, 0.0)];
    let everywhere = FieldEnds { goals: &goal_cells, start: None };
    let (field, field_time) = timed(|| GoalField::new(&table, everywhere, &patience));
    let field = field.ok_or("the field was not built")?;
    let towards = FieldEnds { goals: &goal_cells, start: starts.first().map(|s| s.cell) };
    let (t, tt) = timed(|| GoalField::new(&table, towards, &patience));
    let t = t.ok_or("x")?;
    println!("towards: {tt:?}");
    let mut workspace = planner::Workspace::of(&lattice);
    for (f, name) in [(&field, "whole"), (&t, "towards")] {
        for bound in [1.2, 1.05, 1.0, 1.2, 1.05, 1.0] {
            let question =
                Search { starts: &starts, goals: &goals, besides: 0.0, bound, patience: &patience };
            let (outcome, st) = timed(|| search(&table, f, &question, &mut workspace));
            let Outcome::Found(found) = outcome else { return Err("no path".into()) };
            println!("{name} bound {bound}: {st:?} {} expanded, proven {:?}", found.expanded, found.bound);
        }
    }
    let question = Search { starts: &starts, goals: &goals, besides: 0.0, bound: 1.0, patience: &patience };
    let (outcome, search_time) = timed(|| search(&table, &field, &question, &mut workspace));
    let Outcome::Found(found) = outcome else { return Err("no path".into()) };
    let expanded = found.expanded;
    let (exact, et) = timed(|| planner::ExactField::new(&table, &goals, &patience));
    let exact = exact.ok_or("late")?;
    let (w, wt) = timed(|| exact.walk(&table, &starts));
    println!(
        "exact {:.1} ns/state, walk {wt:?} {}",
        nanoseconds_each(et, (side * side * 16) as u64),
        w.map_or(0, |w| w.1.len())
    );
    let edges = side * side * HEADINGS * lattice.motions_per_state();
    println!(
        "{side:>6} {:>14.1} {:>15.1} {expanded:>11} {:>17.1} {:>10.1}",
        nanoseconds_each(table_time, edges as u64),
        nanoseconds_each(field_time, (side * side) as u64),
        nanoseconds_each(search_time, expanded),
        search_time.as_secs_f64() * 1e3
    );
    Ok(())
}

fn timed<T>(work: impl FnOnce() -> T) -> (T, Duration) {
    let began = Instant::now();
    let done = work();
    (done, began.elapsed())
}

fn nanoseconds_each(time: Duration, count: u64) -> f64 {
    time.as_secs_f64() * 1e9 / count as f64
}
