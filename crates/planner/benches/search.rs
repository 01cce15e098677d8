//! The planner's parts on a quarter of a square kilometre of seeded hills: `cargo bench -p joulepath-planner`.

use std::sync::Arc;

use divan::Bencher;
use model::builtin;
use planner::{
    CostTable, FieldEnds, GoalField, Heading, Lattice, Objective, Patience, Search, Settings, State,
    Workspace, search,
};
use terrain::{Cell, Grid, SlopeMap, Terrain, synthetic};

const SIDE: usize = 500;

fn main() {
    divan::main();
}

fn hills() -> Terrain {
    let grid = Grid { rows: SIDE, columns: SIDE, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let elevation_m = synthetic::relief(grid, 1, 120.0, 25.0);
    Terrain::new(grid, &elevation_m).unwrap_or_else(|error| unreachable!("seeded relief is ground: {error}"))
}

fn lattice() -> Arc<Lattice> {
    let robot = builtin::husky_a200();
    Lattice::new(&hills(), &robot, Settings::of(&robot))
        .unwrap_or_else(|error| unreachable!("a Husky suits cells of a metre: {error}"))
}

fn table(lattice: &Arc<Lattice>) -> CostTable {
    CostTable::new(lattice, Objective::Energy, &Patience::default())
        .unwrap_or_else(|| unreachable!("patience has no end"))
}

const GOAL: Cell = Cell { row: SIDE * 9 / 10, column: SIDE * 9 / 10 };

/// Poses at a cell.
fn poses(cell: Cell) -> impl Iterator<Item = State> {
    Heading::all().map(move |heading| State { cell, heading })
}

fn goals() -> Vec<(State, f64)> {
    poses(GOAL).map(|goal| (goal, 0.0)).collect()
}

fn field(table: &CostTable, goals: &[(State, f64)]) -> GoalField {
    GoalField::new(table, FieldEnds { goals, start: None }, &Patience::default())
        .unwrap_or_else(|| unreachable!("patience has no end"))
}

#[divan::bench]
fn slope_map(bencher: Bencher<'_, '_>) {
    let terrain = hills();
    bencher.counter(divan::counter::ItemsCount::new(SIDE * SIDE)).bench(|| SlopeMap::new(&terrain));
}

#[divan::bench(sample_count = 5)]
fn cost_table(bencher: Bencher<'_, '_>) {
    let lattice = lattice();
    let edges = lattice.states() * lattice.motions_per_state();
    bencher.counter(divan::counter::ItemsCount::new(edges)).bench(|| table(&lattice));
}

#[divan::bench(sample_count = 10)]
fn goal_field(bencher: Bencher<'_, '_>) {
    let table = table(&lattice());
    bencher.counter(divan::counter::ItemsCount::new(SIDE * SIDE)).bench(|| field(&table, &goals()));
}

#[divan::bench(args = [1.0, 1.05, 1.2], sample_count = 10)]
fn warm_search(bencher: Bencher<'_, '_>, bound: f64) {
    warm(bencher, &goals(), bound);
}

/// To a goal that is to be left the way one came.
#[divan::bench(sample_count = 10)]
fn warm_search_turning_at_the_goal(bencher: Bencher<'_, '_>) {
    warm(bencher, &[(State { cell: GOAL, heading: Heading::new(10) }, 0.0)], 1.0);
}

fn warm(bencher: Bencher<'_, '_>, goals: &[(State, f64)], bound: f64) {
    let lattice = lattice();
    let table = table(&lattice);
    let field = field(&table, goals);
    let starts: Vec<State> = poses(Cell { row: SIDE / 10, column: SIDE / 10 }).collect();
    let patience = Patience::default();
    let question = Search { starts: &starts, goals, besides: 0.0, bound, patience: &patience };
    let mut workspace = Workspace::of(&lattice);
    bencher.bench_local(|| search(&table, &field, &question, &mut workspace));
}
