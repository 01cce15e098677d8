//! Questions of many paths look at the clock after the same work, however large the map, and end for robots without
//! friction too.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use model::{Robot, builtin};
use planner::{Goal, Meter, Objective, Patience, Planner, Query, Settings, Start, work};
use routing::{
    Error, Kind, Limits, Question, Waypoint, alternatives, joints, matrix, outline, plan_within, reach,
};
use terrain::{Grid, Terrain, synthetic};

fn grid(side: usize) -> Grid {
    Grid { rows: side, columns: side, cell_size_m: 1.0, origin_m: [0.0, 0.0] }
}

fn hills(side: usize) -> Terrain {
    Terrain::new(grid(side), &synthetic::relief(grid(side), 5, 60.0, 8.0)).unwrap()
}

fn slippery() -> Robot {
    let mut robot = builtin::husky_a200();
    robot.hotel_power_w = 0.0;
    robot.drive_electronics_w = 0.0;
    robot.surfaces.values_mut().for_each(|surface| surface.mu_roll = 0.0);
    robot
}

fn planner(terrain: &Terrain, robot: &Robot) -> Planner {
    Planner::new(terrain, robot, Settings::of(robot)).unwrap()
}

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

fn place(terrain: &Terrain, at: f64) -> Waypoint {
    let [x_m, y_m] = terrain.grid.at_fraction_m(at, at);
    Waypoint { x_m, y_m, heading_rad: None }
}

fn query(planner: &Planner, from: &Waypoint, to: &Waypoint, patience: &Patience) -> Query {
    Query {
        start: Start { x_m: from.x_m, y_m: from.y_m, heading_rad: from.heading_rad },
        goal: Goal {
            x_m: to.x_m,
            y_m: to.y_m,
            heading_rad: to.heading_rad,
            either_way: false,
            tolerance_m: 0.0,
        },
        settings: planner.lattice().settings,
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: patience.clone(),
    }
}

#[test]
fn reachable_sets_and_their_outlines_look_after_the_same_work() {
    for side in [100, 400] {
        let terrain = hills(side);
        let planner = planner(&terrain, &builtin::husky_a200());
        let middle = place(&terrain, 0.5);
        for kind in [Kind::Outward, Kind::Homeward, Kind::OutAndBack] {
            let found = assert_looks("reach", 32 * side * side, |patience| {
                reach(&planner, &middle, kind, f64::INFINITY, None, patience).unwrap()
            });
            assert_looks("contour", 2 * side * side, |patience| {
                found.area_m2(5000.0, patience).unwrap();
                found.within(5000.0, patience).unwrap()
            });
        }
    }
    // Rings as long as there can be: combs whose teeth hang together.
    let comb = |i: usize| (i % 600).is_multiple_of(2) || i < 600;
    let polygons = assert_looks("comb", 600 * 600, |patience| outline(&grid(600), comb, patience).unwrap());
    assert!(polygons.len() == 1 && polygons[0].exterior.len() > 1000);
}

#[test]
fn matrices_limits_and_alternatives_look_after_the_same_work() {
    for side in [60, 160] {
        let terrain = hills(side);
        let planner = planner(&terrain, &builtin::husky_a200());
        let places = [0.2, 0.5, 0.8].map(|at| place(&terrain, at));
        assert_looks("matrix", 3 * side * side, |patience| {
            let question = Question { patience: patience.clone(), ..Question::default() };
            matrix(&planner, &places, &places, &question).unwrap();
        });
        assert_looks("joints", 32 * side * side, |patience| {
            let question = Question { patience: patience.clone(), ..Question::default() };
            joints(&planner, &places[..1], &question).unwrap();
        });
        assert_looks("limits", side * side, |patience| {
            let query = query(&planner, &places[0], &places[1], patience);
            let free = planner.plan(&query, Objective::Energy).unwrap().route.total.length_m;
            let limits = Limits { max_distance_m: Some(0.995 * free), ..Limits::default() };
            match plan_within(&planner, &query, Objective::Energy, &limits) {
                Ok(_) | Err(Error::Contradiction(_)) => {}
                Err(other) => panic!("{other}"),
            }
        });
        assert_looks("alternatives", side * side, |patience| {
            let query = query(&planner, &places[0], &places[1], patience);
            alternatives(&planner, &query, Objective::Time, &Limits::default(), 3).unwrap();
        });
    }
}

#[test]
fn whenever_patience_ends_questions_of_many_paths_stop() {
    let terrain = hills(100);
    let robot = builtin::husky_a200();
    let places = [0.2, 0.5, 0.8].map(|at| place(&terrain, at));
    for looks in [0, 3, 10, 40, 150, 600, 2400] {
        let planner = planner(&terrain, &robot);
        let (_, meter) = measured(Patience::for_looks(looks), |patience| {
            let question = Question { patience: patience.clone(), ..Question::default() };
            let _ = matrix(&planner, &places, &places, &question);
            let _ = joints(&planner, &places, &question);
            let _ = reach(&planner, &places[1], Kind::OutAndBack, f64::INFINITY, None, patience);
            let query = query(&planner, &places[0], &places[1], patience);
            let _ = alternatives(&planner, &query, Objective::Distance, &Limits::default(), 5);
        });
        // Each of the four stops for itself.
        assert!(meter.overrun() <= 1 << 22, "{looks} looks: {} after the last", meter.overrun());
    }
}

#[test]
fn questions_of_a_robot_without_friction_end_with_paths_that_take_nothing() {
    let level = Terrain::new(grid(14), &vec![0.0; 14 * 14]).unwrap();
    let robot = slippery();
    let planner = planner(&level, &robot);
    let places = [0.2, 0.8].map(|at| place(&level, at));
    let found = matrix(&planner, &places, &places, &Question::default()).unwrap();
    for (row, energies_j) in found.energy_j.iter().enumerate() {
        for (column, energy_j) in energies_j.iter().enumerate() {
            assert!(energy_j.unwrap().abs() < 1e-6);
            assert!((found.distance_m[row][column].unwrap() > 10.0) == (row != column));
        }
    }
    for kind in [Kind::Outward, Kind::Homeward, Kind::OutAndBack] {
        let found = reach(&planner, &places[0], kind, 50.0, None, &Patience::default()).unwrap();
        let reached = found.energy_j.iter().filter(|energy_j| **energy_j < 1.0).count();
        // There and back again takes a turn, which skids.
        let least = if kind == Kind::OutAndBack { 1 } else { 40 };
        assert!(reached >= least, "{reached} cells {kind:?}");
    }
    assert!(joints(&planner, &places, &Question::default()).unwrap().cost[0].iter().all(Option::is_some));
    let query = query(&planner, &places[0], &places[1], &Patience::default());
    let shortest_m = planner.plan(&query, Objective::Distance).unwrap().route.total.length_m;
    for limits in [
        Limits { max_energy_j: Some(0.001), ..Limits::default() },
        Limits { max_distance_m: Some(shortest_m * 1.001), ..Limits::default() },
    ] {
        for objective in [Objective::Energy, Objective::Distance, Objective::Time] {
            let plan = plan_within(&planner, &query, objective, &limits).unwrap();
            assert!(limits.hold(&plan.route.total));
            let last = plan.route.poses.last().unwrap();
            assert!((last.x_m - query.goal.x_m).hypot(last.y_m - query.goal.y_m) < 1.0);
        }
    }
    for against in [Objective::Distance, Objective::Time] {
        let found = alternatives(&planner, &query, against, &Limits::default(), 3).unwrap();
        assert!(!found.plans.is_empty());
    }
}
