//! Long steps look at the clock after the same work, however large the map, and stop soon after patience has ended.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use model::builtin;
use planner::{
    CostTable, Error, ExactField, FieldEnds, Goal, GoalField, Heading, Lattice, Meter, Objective, Patience,
    Place, Planner, Query, Settings, Start, State, work,
};
use terrain::{Cell, Grid, Terrain, synthetic};

/// Work after the end of patience that still makes an answer of a path that was found: motions driven, ten milliseconds.
const MOST_OVERRUN: u64 = 1 << 22;

/// What a step does with patience on one thread, so that no other thread's look hides its work.
fn measured<T: Send>(patience: Patience, step: impl FnOnce(&Patience) -> T + Send) -> (T, Arc<Meter>) {
    let (patience, meter) = patience.metered();
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    (pool.install(|| step(&patience)), meter)
}

/// Fails where a step does too much between two looks, or reports less work than it must have done.
fn assert_looks<T: Send>(name: &str, at_least: usize, step: impl FnOnce(&Patience) -> T + Send) -> T {
    let (done, meter) = measured(Patience::default(), step);
    let (largest, total) = (meter.largest(), meter.total());
    assert!(largest <= work::MOST_BETWEEN_LOOKS, "{name}: {largest} between two looks");
    assert!(total >= at_least as u64, "{name}: {total} in all, less than {at_least}");
    done
}

fn hills(side: usize) -> Terrain {
    let grid = Grid { rows: side, columns: side, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    Terrain::new(grid, &synthetic::relief(grid, 5, 60.0, 8.0)).unwrap()
}

/// Level ground with walls that leave one way, to and fro.
fn winding(side: usize) -> Terrain {
    let grid = Grid { rows: side, columns: side, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let wall = |cell: Cell| {
        let open = if (cell.row / 4).is_multiple_of(2) { cell.column + 3 >= side } else { cell.column < 3 };
        cell.row % 4 == 3 && !open
    };
    let z: Vec<f64> = (0..grid.cells()).map(|i| if wall(grid.cell(i)) { f64::NAN } else { 0.0 }).collect();
    Terrain::new(grid, &z).unwrap()
}

fn lattice(terrain: &Terrain) -> Arc<Lattice> {
    let robot = builtin::husky_a200();
    Lattice::new(terrain, &robot, Settings::of(&robot)).unwrap()
}

fn poses(terrain: &Terrain, at: f64, headings: usize) -> Vec<(State, f64)> {
    let [x, y] = terrain.grid.at_fraction_m(at, at);
    let cell = terrain.grid.cell_at(x, y).unwrap();
    Heading::all().take(headings).map(|heading| (State { cell, heading }, 0.0)).collect()
}

fn across(terrain: &Terrain, patience: &Patience) -> Query {
    let robot = builtin::husky_a200();
    let [sx, sy] = terrain.grid.at_fraction_m(0.05, 0.008);
    let [gx, gy] = terrain.grid.at_fraction_m(0.9, 0.95);
    Query {
        start: Start { x_m: sx, y_m: sy, heading_rad: None },
        goal: Goal { x_m: gx, y_m: gy, heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings: Settings::of(&robot),
        other_goals: Vec::new(),
        snap_radius_m: Some(4.0),
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: patience.clone(),
    }
}

fn planner(terrain: &Terrain) -> Planner {
    let robot = builtin::husky_a200();
    Planner::new(terrain, &robot, Settings::of(&robot)).unwrap()
}

#[test]
fn fields_look_after_the_same_work_on_maps_of_any_size() {
    for side in [100, 500] {
        let terrain = hills(side);
        let table = CostTable::lazy(&lattice(&terrain), Objective::Energy);
        for (headings, start) in [(16, None), (1, None), (16, Some(Cell { row: 3, column: 3 }))] {
            let goals = poses(&terrain, 0.9, headings);
            let ends = FieldEnds { goals: &goals, start };
            assert_looks("field", side * side / 8, |patience| {
                GoalField::new(&table, ends, patience).unwrap()
            });
        }
        let seeds = poses(&terrain, 0.5, 16);
        for to_goals in [true, false] {
            let grow = if to_goals { ExactField::to_goals } else { ExactField::from_starts };
            assert_looks("exact field", 16 * side * side, |patience| {
                grow(&table, &seeds, f64::INFINITY, patience).unwrap();
            });
        }
    }
}

#[test]
fn many_goals_are_taken_up_between_looks() {
    let terrain = hills(300);
    let table = CostTable::lazy(&lattice(&terrain), Objective::Distance);
    for headings in [16, 2] {
        let cells = (0..terrain.grid.cells()).map(|i| terrain.grid.cell(i));
        let goals: Vec<(State, f64)> = cells
            .flat_map(|cell| Heading::all().take(headings).map(move |heading| (State { cell, heading }, 1.0)))
            .collect();
        let ends = FieldEnds { goals: &goals, start: None };
        assert_looks("many goals", goals.len(), |patience| GoalField::new(&table, ends, patience).unwrap());
        assert_looks("many seeds", goals.len(), |patience| {
            ExactField::to_goals(&table, &goals, f64::INFINITY, patience).unwrap();
        });
    }
}

#[test]
fn arcs_over_tiles_of_the_finest_cells_are_searched_between_looks() {
    let mut robot = builtin::husky_a200();
    robot.slip_track_m = 300.0;
    let terrain = hills(200);
    let lattice = Lattice::new(&terrain, &robot, Settings::of(&robot)).unwrap();
    let table = CostTable::lazy(&lattice, Objective::Distance);
    let goals = poses(&terrain, 0.5, 16);
    assert_looks("wide arcs", terrain.grid.cells(), |patience| {
        ExactField::to_goals(&table, &goals, f64::INFINITY, patience).unwrap();
    });
    let ends = FieldEnds { goals: &goals, start: None };
    assert_looks("field", terrain.grid.cells(), |patience| GoalField::new(&table, ends, patience).unwrap());
}

#[test]
fn plans_and_their_long_paths_look_after_the_same_work() {
    for (terrain, name) in
        [(hills(120), "hills"), (hills(400), "hills"), (winding(120), "winding"), (winding(300), "winding")]
    {
        let planner = planner(&terrain);
        for (refine, bound) in [(false, 1.0), (true, 1.2)] {
            // Twice, so that the second finds a workspace to clear.
            for _ in 0..2 {
                let plan = assert_looks(name, terrain.grid.rows, |patience| {
                    let query = Query { refine, bound, ..across(&terrain, patience) };
                    planner.plan(&query, Objective::Energy).unwrap()
                });
                assert!(plan.route.edges.len() >= terrain.grid.rows / 4);
            }
        }
        let plan = assert_looks("held", 16 * terrain.grid.cells() / 8, |patience| {
            let query = across(&terrain, patience);
            planner.hold_goal(&query, Objective::Time).unwrap();
            planner.plan(&query, Objective::Time).unwrap()
        });
        assert_eq!(plan.search.expanded, 0);
    }
}

#[test]
fn ground_without_a_way_is_looked_over_between_looks() {
    let grid = Grid { rows: 600, columns: 600, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let z: Vec<f64> =
        (0..grid.cells()).map(|i| if grid.cell(i).column == 500 { f64::NAN } else { 0.0 }).collect();
    let terrain = Terrain::new(grid, &z).unwrap();
    let planner = planner(&terrain);
    assert_looks("no way", 100 * 600, |patience| {
        let error = planner.plan(&across(&terrain, patience), Objective::Energy).unwrap_err();
        assert!(matches!(error, Error::NoPath { .. }), "{error}");
    });
    assert_looks("matrix entry", 100 * 600, |patience| {
        let states =
            |x_m, y_m| planner.states_at(Place::Start, [x_m, y_m], None, None, &Patience::default()).unwrap();
        let target = planner.target(&states(550.5, 20.5), Objective::Energy, patience).unwrap();
        assert!(planner.path_to(&target, &states(20.5, 20.5), patience).is_err());
    });
}

#[test]
fn a_path_that_was_found_is_not_lost_to_its_refinement() {
    let (mut answered, mut unanswered) = (0, 0);
    for terrain in [hills(250), winding(250)] {
        for looks in (0..14).map(|power| 1 << power) {
            let ask = |refine| {
                let patience = Patience::for_looks(looks);
                planner(&terrain).plan(&Query { refine, ..across(&terrain, &patience) }, Objective::Energy)
            };
            if ask(false).is_ok() {
                answered += 1;
                assert!(ask(true).is_ok(), "{looks} looks are enough without refinement");
            } else {
                unanswered += 1;
            }
        }
    }
    assert!(answered > 3 && unanswered > 3, "{answered} answered, {unanswered} not");
}

#[test]
fn whenever_patience_ends_there_is_little_work_left() {
    let (mut answered, mut late) = (0, 0);
    for terrain in [hills(250), winding(250)] {
        for looks in [0, 1, 2, 5, 11, 23, 47, 95, 191, 383, 767, 1535, 3071] {
            let planner = planner(&terrain);
            let (outcome, meter) = measured(Patience::for_looks(looks), |patience| {
                planner.plan(&Query { refine: true, ..across(&terrain, patience) }, Objective::Energy)
            });
            match outcome {
                Ok(_) => answered += 1,
                Err(Error::Timeout { .. }) => late += 1,
                Err(other) => panic!("{other}"),
            }
            assert!(meter.overrun() <= MOST_OVERRUN, "{looks} looks: {} after the last", meter.overrun());
        }
    }
    assert!(answered > 3 && late > 3, "{answered} answered, {late} late");
}
