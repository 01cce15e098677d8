//! Robots for which motions cost next to nothing: paths still lead from start to goal, and searches end.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use model::{KnownMechanism, Robot, builtin, mechanism};
use petgraph::{algo::dijkstra, graph::NodeIndex};
use planner::{
    CostTable, Error, Goal, HEADINGS, Lattice, Objective, Patience, Plan, Planner, Query, Settings, Start,
    State,
};
use rand::{Rng, RngExt};
use terrain::{Cell, Grid, Terrain};

mod ground;

const OBJECTIVES: [Objective; 3] = [Objective::Energy, Objective::Distance, Objective::Time];

fn level(side: usize) -> Terrain {
    let grid = Grid { rows: side, columns: side, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap()
}

/// A Husky on marble without rolling resistance and a share of its lateral friction.
fn slippery(skid: f64) -> Robot {
    let mut robot = builtin::husky_a200();
    robot.hotel_power_w = 0.0;
    robot.drive_electronics_w = 0.0;
    for surface in robot.surfaces.values_mut() {
        surface.mu_roll = 0.0;
        surface.mu_skid *= skid;
    }
    robot
}

fn between(robot: &Robot, start: [f64; 2], goal: [f64; 2], heading_rad: Option<f64>) -> Query {
    Query {
        start: Start { x_m: start[0], y_m: start[1], heading_rad },
        goal: Goal { x_m: goal[0], y_m: goal[1], heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings: Settings::of(robot),
        other_goals: Vec::new(),
        snap_radius_m: Some(0.0),
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    }
}

/// Fails unless a path begins where it was asked to, ends at the goal and has its energy by its own steps.
fn assert_joins(plan: &Plan, planner: &Planner, query: &Query) {
    let (first, last) = (plan.route.poses.first().unwrap(), plan.route.poses.last().unwrap());
    let center = |x, y| {
        let grid = &planner.lattice().terrain.grid;
        grid.center_m(grid.cell_at(x, y).unwrap())
    };
    let start = center(query.start.x_m, query.start.y_m);
    assert!((first.x_m - start[0]).hypot(first.y_m - start[1]) < 1e-9, "{first:?} for {start:?}");
    let off = (last.x_m - query.goal.x_m).hypot(last.y_m - query.goal.y_m);
    let room = query.goal.tolerance_m.max(planner.lattice().terrain.grid.cell_size_m);
    assert!(off < room && (off - plan.goal_snap.distance_m).abs() < 1e-9, "{last:?} for {:?}", query.goal);
    let energy_j: f64 = plan.route.steps.iter().map(planner::Step::energy_j).sum();
    assert!((energy_j - plan.route.total.energy_j).abs() <= 1e-9 * (1.0 + energy_j.abs()));
    assert!((last.energy_j - energy_j).abs() <= 1e-9 * (1.0 + energy_j.abs()));
}

#[test]
fn a_robot_without_rolling_resistance_drives_ten_metres_straight_for_nothing() {
    for skid in [1.0, 0.0] {
        for reverse in [false, true] {
            for objective in OBJECTIVES {
                let robot = slippery(skid);
                let planner =
                    Planner::new(&level(20), &robot, Settings { reverse, ..Settings::of(&robot) }).unwrap();
                let query = between(&robot, [5.5, 5.5], [15.5, 5.5], Some(0.0));
                let plan = planner.plan(&query, objective).unwrap();
                assert_joins(&plan, &planner, &query);
                let total = &plan.route.total;
                assert!((total.length_m - 10.0).abs() < 1e-9, "{objective:?}: {} m", total.length_m);
                assert!((total.duration_s - 20.0).abs() < 1e-9 && total.energy_j.abs() < 1e-9);
                assert!(plan.search.optimal);
            }
        }
    }
}

/// A path that the wind pays for may lead farther and gain more: costs of the table are never negative, so that it cannot tell.
#[test]
fn before_a_wind_that_pushes_for_nothing_no_path_is_called_the_best() {
    let grid = Grid { rows: 40, columns: 40, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let waves = |i: usize| 1.5 * (std::f64::consts::TAU * grid.cell(i).column as f64 / 20.0).sin();
    let waves = Terrain::new(grid, &(0..grid.cells()).map(waves).collect::<Vec<_>>()).unwrap();
    for (east_mps, is_told) in [(20.0, false), (2.0, true)] {
        let mut robot = builtin::husky_a200();
        let wind = mechanism::by_name("wind").unwrap();
        robot.mechanisms.push(KnownMechanism::new(wind, vec![1.1, east_mps, 0.0]));
        let planner = Planner::new(&waves, &robot, Settings::of(&robot)).unwrap();
        let query = between(&robot, [5.5, 20.5], [35.5, 20.5], Some(0.0));
        let plan = planner.plan(&query, Objective::Energy).unwrap();
        let (energy_j, search) = (plan.route.total.energy_j, &plan.search);
        assert_eq!(search.is_optimal(), is_told, "{east_mps} m/s: {energy_j} J, {search:?}");
        assert!(is_told || search.excess > 0.05 * energy_j.abs());
    }
}

#[test]
fn the_shortest_path_does_not_depend_on_friction() {
    for (goal, heading_rad) in [([15.5, 12.5], None), ([12.5, 15.5], Some(0.0)), ([3.5, 5.5], Some(0.0))] {
        let robots = [builtin::husky_a200(), slippery(1.0), slippery(0.0)];
        let lengths_m = robots.map(|robot| {
            let planner = Planner::new(&level(20), &robot, Settings::of(&robot)).unwrap();
            let query = between(&robot, [5.5, 5.5], goal, heading_rad);
            let plan = planner.plan(&query, Objective::Distance).unwrap();
            assert_joins(&plan, &planner, &query);
            plan.route.total.length_m
        });
        assert!((lengths_m[0] - lengths_m[1]).abs() < 0.01 && (lengths_m[0] - lengths_m[2]).abs() < 0.01);
    }
}

/// A robot with any of its numbers at their extremes.
fn extreme_robot(random: &mut impl Rng) -> Robot {
    fn one(random: &mut impl Rng, of: &[f64]) -> f64 {
        of[random.random_range(0..of.len())]
    }
    let mut robot = builtin::husky_a200();
    robot.mass_kg = one(random, &[0.1, 90.0, 20_000.0]);
    robot.hotel_power_w = one(random, &[0.0, 0.0, 20.0]);
    robot.drive_electronics_w = 0.0;
    robot.slip_track_m = random.random_range(0.54..0.9);
    let k1 = one(random, &[0.0, 1e-12, 0.002, 10.0]);
    (robot.motors.left.k1_w_per_n2, robot.motors.right.k1_w_per_n2) = (k1, k1);
    let k2 = one(random, &[1.0, 1.7, 20.0]);
    (robot.motors.left.k2, robot.motors.right.k2) = (k2, one(random, &[k2, 1.0]));
    robot.motors.regeneration = one(random, &[0.0, 0.5, 1.0]);
    robot.limits.max_side_force_n = None;
    for surface in robot.surfaces.values_mut() {
        surface.mu_roll = one(random, &[0.0, 0.0, 1e-9, 0.06, 2.0]);
        surface.mu_skid = one(random, &[0.0, 1e-9, 0.3, 3.0]);
    }
    robot
}

#[test]
fn paths_of_extreme_robots_join_their_ends_and_cost_the_least_of_the_table() {
    let mut random = ground::random(71);
    let (mut reached, mut free) = (0, 0);
    for case in 0..160 {
        let terrain = if case % 3 == 0 { level(9) } else { ground::small_terrain(&mut random, 9) };
        let robot = extreme_robot(&mut random);
        let query = ground::some_query(&mut random, &terrain, &robot);
        let query = Query { snap_radius_m: None, refine: case % 4 == 0, ..query };
        let Ok(planner) = Planner::new(&terrain, &robot, query.settings) else { continue };
        let objective = OBJECTIVES[case % 3];
        let ends = planner.ends(&query, objective);
        match planner.plan(&query, objective) {
            Ok(plan) => {
                reached += 1;
                let ends = ends.unwrap();
                let start = plan.route.poses[0];
                let states: Vec<State> = ends.starts.clone();
                assert!(states.iter().any(|s| (s.heading.angle_rad() - start.heading_rad).abs() < 1e-9));
                let [x, y] = terrain.grid.center_m(states[0].cell);
                assert!((start.x_m, start.y_m) == (x, y), "{start:?}");
                let last = plan.route.poses.last().unwrap();
                let ends_at = |goal: &State| {
                    let [x, y] = terrain.grid.center_m(goal.cell);
                    (last.x_m - x).hypot(last.y_m - y) < 1e-6
                };
                assert!(ends.goals.iter().any(ends_at), "{last:?}");
                let least = least_of_table(&planner, objective, &ends.starts, &ends.goals);
                let units = planner.table(objective).units();
                // Driven costs are at most the table's, by single precision.
                let is_least = |plan: &Plan| {
                    let room = 2.0 * plan.route.edges.len() as f64 / units + 1e-9;
                    cost_of(&planner, objective, plan, &ends.goals) <= least * (1.0 + 1e-4) + room
                };
                assert!(is_least(&plan));
                free += usize::from(least * units < 4.0 * plan.route.edges.len() as f64);
                planner.hold_goal(&query, objective).unwrap();
                let held = planner.plan(&query, objective).unwrap();
                assert_eq!(held.search.expanded, 0);
                assert!(is_least(&held));
            }
            Err(
                Error::NoPath { .. }
                | Error::NoRoomToTurn { .. }
                | Error::PlaceBlocked { .. }
                | Error::OutOfRange { .. },
            ) => {}
            Err(other) => panic!("{other}"),
        }
    }
    assert!(reached > 60 && free > 1, "{reached} paths, {free} for nothing");
}

/// Height potential above the lowest goal, for energy.
fn after(lattice: &Lattice, objective: Objective, goal: Cell, goals: &[State]) -> f64 {
    let lowest = goals.iter().map(|g| lattice.potential_j(g.cell)).fold(f64::INFINITY, f64::min);
    if objective == Objective::Energy { lattice.potential_j(goal) - lowest } else { 0.0 }
}

/// Cost of a path as driven, with what follows at its end.
fn cost_of(planner: &Planner, objective: Objective, plan: &Plan, goals: &[State]) -> f64 {
    let lattice = planner.lattice();
    let (first, last) = (plan.route.poses[0], plan.route.poses.last().unwrap());
    let grid = &lattice.terrain.grid;
    let at = |pose: &planner::Pose| grid.cell_at(pose.x_m, pose.y_m).unwrap();
    let lifted_j = lattice.potential_j(at(last)) - lattice.potential_j(at(&first));
    let total = &plan.route.total;
    let friction = planner::Edge { energy_j: (total.energy_j - lifted_j).max(0.0), ..*total };
    lattice.cost(objective, &friction, 0.0) + after(lattice, objective, at(last), goals)
}

/// The least cost in the table between ends, by petgraph.
fn least_of_table(planner: &Planner, objective: Objective, starts: &[State], goals: &[State]) -> f64 {
    let (lattice, table) = (planner.lattice(), planner.table(objective));
    let graph = ground::table_graph(lattice, table);
    let mut least = f64::INFINITY;
    for start in starts {
        let reached = dijkstra(&graph, NodeIndex::new(lattice.index(*start)), None, |e| *e.weight());
        for goal in goals {
            if let Some(cost) = reached.get(&NodeIndex::new(lattice.index(*goal))) {
                least = least.min(cost + after(lattice, objective, goal.cell, goals));
            }
        }
    }
    least
}

#[test]
fn no_motion_is_free_whatever_the_robot() {
    let mut random = ground::random(72);
    for case in 0..30 {
        let terrain = if case % 2 == 0 { level(70) } else { ground::small_terrain(&mut random, 70) };
        let robot = extreme_robot(&mut random);
        let lattice = Lattice::new(&terrain, &robot, Settings::of(&robot)).unwrap();
        let table = CostTable::lazy(&lattice, OBJECTIVES[case % 3]);
        for _ in 0..500 {
            let state = lattice.state(random.random_range(0..terrain.grid.cells() * HEADINGS));
            let motion = random.random_range(0..lattice.motions_per_state());
            assert!(table.cost(state, motion) * table.units() >= 1.0 - 1e-9);
        }
    }
}

#[test]
fn ground_exactly_at_the_steepest_that_the_robot_climbs_cuts_no_path_short() {
    let mut random = ground::random(73);
    for case in 0..120 {
        let grid = Grid { rows: 20, columns: 20, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        let grade = random.random_range(0.1..0.5);
        let z: Vec<f64> = (0..grid.cells()).map(|i| grade * (grid.cell(i).column as f64)).collect();
        let terrain = Terrain::new(grid, &z).unwrap();
        let mut robot = builtin::husky_a200();
        robot.limits.max_side_force_n = None;
        robot.limits.max_roll_rad = 0.6;
        // To the last digits of single precision, on either side.
        robot.limits.max_pitch_rad = f64::atan(grade) * (1.0 + f64::from(case % 9 - 4) * 3e-8);
        let planner = Planner::new(&terrain, &robot, Settings::of(&robot)).unwrap();
        let query = between(&robot, [2.5, 10.5], [17.5, 10.5], Some(0.0));
        match planner.plan(&query, Objective::Energy) {
            Ok(plan) => assert_joins(&plan, &planner, &query),
            Err(Error::NoPath { .. } | Error::NoRoomToTurn { .. } | Error::PlaceBlocked { .. }) => {}
            Err(other) => panic!("{other}"),
        }
    }
}
