//! Times the parts of one search.
use model::builtin;
use planner::*;
use std::time::Instant;
use terrain::{Cell, io, synthetic};
fn main() {
    let robot = builtin::husky_a200();
    let small = io::read_path(std::path::Path::new("maps/minnesota.tif")).unwrap();
    for side in [250usize, 500, 1000, 2000] {
        let terrain = synthetic::mirrored(&small, side, side).unwrap();
        let t = Instant::now();
        let lattice = Lattice::new(&terrain, &robot, Settings::of(&robot)).unwrap();
        let t_lattice = t.elapsed();
        let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
        let patience = Patience::default();
        let t = Instant::now();
        let table = pool.install(|| CostTable::new(&lattice, Objective::Energy, &patience).unwrap());
        let t_table = t.elapsed();
        let place =
            |e: f64, n: f64| Cell { row: (n * side as f64) as usize, column: (e * side as f64) as usize };
        let stand = |cell: Cell| {
            Heading::all()
                .map(|heading| State { cell, heading })
                .filter(|s| lattice.stand(*s).is_ok())
                .collect::<Vec<_>>()
        };
        let starts = stand(place(0.1, 0.12));
        let goals = stand(place(0.9, 0.88));
        let t = Instant::now();
        let field = GoalField::new(&lattice, &table, &[(goals[0].cell, 0.0)], &patience).unwrap();
        let t_field = t.elapsed();
        let goals: Vec<_> = goals.into_iter().map(|g| (g, 0.0)).collect();
        let t = Instant::now();
        let outcome =
            search(&lattice, &table, &field, &Search { starts: &starts, goals: &goals, patience: &patience });
        let t_search = t.elapsed();
        let Outcome::Found { expanded, .. } = outcome else { panic!() };
        let edges = (lattice.states() * 7) as f64;
        println!(
            "{side}: lattice {t_lattice:?} table {t_table:?} = {:.2} ns/edge; field {t_field:?} = {:.1} ns/cell; search {t_search:?} {expanded} = {:.1} ns/exp",
            t_table.as_secs_f64() * 1e9 / edges,
            t_field.as_secs_f64() * 1e9 / (side * side) as f64,
            t_search.as_secs_f64() * 1e9 / expanded as f64
        );
    }
}
