//! Goals of several kinds, part of a way, room beside a path and what stops take.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::f64::consts::{FRAC_PI_2, PI};

use model::{Robot, builtin};
use planner::{
    Error, Footprint, Goal, Objective, Patience, Plan, Planner, Pose, Prices, Query, Settings, Start,
    least_room_m, stops, stops_j,
};
use rand::RngExt;
use terrain::{Grid, Terrain};

mod ground;

const GRID: Grid = Grid { rows: 60, columns: 60, cell_size_m: 0.5, origin_m: [0.0, 0.0] };

/// Level ground, blocked where a function says so.
fn level(is_blocked: impl Fn(f64, f64) -> bool) -> Terrain {
    let blocked =
        (0..GRID.cells()).map(|i| GRID.center_m(GRID.cell(i))).map(|[x, y]| is_blocked(x, y)).collect();
    Terrain::new(GRID, &vec![0.0; GRID.cells()]).unwrap().with_obstacles(blocked)
}

fn husky() -> Robot {
    Robot { hotel_power_w: 20.0, ..builtin::husky_a200() }
}

fn at(x_m: f64, y_m: f64, heading_rad: Option<f64>) -> Goal {
    Goal { x_m, y_m, heading_rad, either_way: false, tolerance_m: 0.0 }
}

fn query(goal: Goal, settings: Settings) -> Query {
    Query {
        start: Start { x_m: 5.25, y_m: 5.25, heading_rad: Some(0.0) },
        goal,
        other_goals: Vec::new(),
        settings,
        snap_radius_m: Some(0.0),
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    }
}

fn planner(terrain: &Terrain) -> Planner {
    Planner::new(terrain, &husky(), Settings::of(&husky())).unwrap()
}

fn energy_j(plan: &Plan) -> f64 {
    plan.route.total.energy_j
}

#[test]
fn either_way_takes_the_cheaper_of_both_headings() {
    let planner = planner(&level(|_, _| false));
    let settings = Settings::of(&husky());
    for (heading_rad, goal) in [(PI, [15.25, 5.25]), (FRAC_PI_2, [15.25, 9.25]), (0.3, [9.25, 20.25])] {
        let one = |heading_rad: f64, either_way: bool| {
            let goal = Goal { either_way, ..at(goal[0], goal[1], Some(heading_rad)) };
            planner.plan(&query(goal, settings), Objective::Energy).unwrap()
        };
        let (there, back) = (one(heading_rad, false), one(heading_rad + PI - 2.0 * PI, false));
        let either = one(heading_rad, true);
        let least_j = energy_j(&there).min(energy_j(&back));
        assert!((energy_j(&either) - least_j).abs() < 1e-6 * least_j, "{} of {least_j}", energy_j(&either));
        assert!(either.goal_snap.turn_rad.abs() < 0.25, "{:?}", either.goal_snap);
    }
}

#[test]
fn of_several_goals_the_cheapest_is_reached_and_named() {
    let terrain = level(|x, y| (x - 15.0).abs() < 1.0 && (y - 5.0).abs() < 4.0);
    let planner = planner(&terrain);
    let goals = [at(25.25, 25.25, None), at(20.25, 5.25, None), at(5.25, 14.25, None), at(15.25, 5.25, None)];
    let alone: Vec<f64> = goals[..3]
        .iter()
        .map(|goal| {
            energy_j(&planner.plan(&query(*goal, Settings::of(&husky())), Objective::Energy).unwrap())
        })
        .collect();
    let together = Query { other_goals: goals[1..].to_vec(), ..query(goals[0], Settings::of(&husky())) };
    let plan = planner.plan(&together, Objective::Energy).unwrap();
    let best = (0..3).min_by(|a, b| alone[*a].total_cmp(&alone[*b])).unwrap();
    assert_eq!(plan.goal, best);
    assert!((energy_j(&plan) - alone[best]).abs() < 1e-6 * alone[best]);
    assert!(plan.goal_snap.distance_m < 1e-9 && plan.search.is_optimal());
    let blocked = Query { other_goals: vec![goals[3]], ..query(goals[3], Settings::of(&husky())) };
    assert!(matches!(planner.plan(&blocked, Objective::Energy), Err(Error::PlaceBlocked { .. })));
}

#[test]
fn part_of_the_way_ends_nearest_to_the_goal_and_costs_least() {
    // The goal lies behind a wall across the map.
    let terrain = level(|x, _| (x - 20.25).abs() < 0.5);
    let planner = planner(&terrain);
    let asked = query(at(27.25, 10.25, Some(0.0)), Settings::of(&husky()));
    assert!(matches!(planner.plan(&asked, Objective::Energy), Err(Error::NoPath { .. })));
    let plan = planner.plan_partly(&asked, Objective::Energy).unwrap();
    let end = plan.route.poses.last().unwrap();
    let away_m = (end.x_m - 27.25).hypot(end.y_m - 10.25);
    assert!((plan.short_of_goal_m.unwrap() - away_m).abs() < 1e-9);
    // The nearest that the robot can stand to the wall is half its length or width away.
    let outline = Footprint::of(&husky());
    let nearest_m = 20.0 - outline.length_m.min(outline.width_m) / 2.0;
    assert!(end.x_m > nearest_m - 0.8 && end.x_m < nearest_m, "{end:?}");
    let whole = planner
        .plan_partly(&query(at(10.25, 10.25, None), Settings::of(&husky())), Objective::Energy)
        .unwrap();
    assert_eq!(whole.short_of_goal_m, None);
}

#[test]
fn the_room_beside_a_path_is_what_a_look_at_all_obstacles_finds() {
    let terrain = level(|x, y| (x - 12.0).hypot(y - 6.0) < 1.0 || (x - 20.0).abs() < 0.6 && y < 9.0);
    let planner = planner(&terrain);
    for goal in [at(25.25, 12.25, None), at(16.25, 4.25, None), at(5.25, 25.25, None)] {
        let plan = planner.plan(&query(goal, Settings::of(&husky())), Objective::Energy).unwrap();
        let found_m = least_room_m(planner.lattice(), &plan.route, &Patience::default()).unwrap();
        // Points all over the outline and all over every blocked cell.
        let outline = Footprint::of(&husky());
        let steps = |n: i32| (0..=n).map(move |i| f64::from(i) / f64::from(n) - 0.5);
        let mut least_m = f64::INFINITY;
        for pose in driven(&plan.route.poses, 8) {
            let (sin, cos) = pose.heading_rad.sin_cos();
            for (ahead, aside) in steps(16).flat_map(|a| steps(16).map(move |b| (a, b))) {
                let (ahead, aside) = (ahead * outline.length_m, aside * outline.width_m);
                let [x, y] = [pose.x_m + ahead * cos - aside * sin, pose.y_m + ahead * sin + aside * cos];
                let cells = (0..GRID.cells()).map(|i| GRID.cell(i)).filter(|c| terrain.is_blocked(*c));
                for cell in cells {
                    let [cx, cy] = GRID.center_m(cell);
                    let beyond = |d: f64| (d.abs() - 0.25).max(0.0);
                    least_m = least_m.min(beyond(x - cx).hypot(beyond(y - cy)));
                }
                least_m = least_m.min(x.min(y).min(30.0 - x).min(30.0 - y));
            }
        }
        assert!(found_m <= least_m + 1e-9 && least_m - found_m < 0.04, "{found_m}, by points {least_m}");
    }
}

/// Poses along the arcs between those of a path, so many to each.
fn driven(poses: &[Pose], between: usize) -> Vec<Pose> {
    let along = |pair: &[Pose]| {
        let [from, to] = [pair[0], pair[1]];
        let (dx_m, dy_m) = (to.x_m - from.x_m, to.y_m - from.y_m);
        let turned_rad = (to.heading_rad - from.heading_rad + PI).rem_euclid(2.0 * PI) - PI;
        (0..=between).map(move |i| {
            let share = i as f64 / between as f64;
            let heading_rad = from.heading_rad + share * turned_rad;
            // The chord to a point of an arc lies half the rest of the turn off the whole chord.
            let (sin, cos) = ((share - 1.0) * turned_rad / 2.0).sin_cos();
            let whole = (turned_rad / 2.0).sin();
            let part = if whole == 0.0 { share } else { (share * turned_rad / 2.0).sin() / whole };
            let (x_m, y_m) =
                (from.x_m + part * (dx_m * cos - dy_m * sin), from.y_m + part * (dx_m * sin + dy_m * cos));
            Pose { x_m, y_m, heading_rad, ..from }
        })
    };
    poses.windows(2).flat_map(along).collect()
}

/// A robot far smaller than the cells passes obstacles between the ends of its steps.
#[test]
fn the_room_beside_a_path_is_never_more_than_the_true_one_where_cells_are_large() {
    let robot = Robot { wheelbase_m: 0.1, track_m: 0.1, slip_track_m: 0.1, wheel_radius_m: 0.02, ..husky() };
    let is_post = |x: f64, y: f64| (x / 1.5).fract() > 0.66 && (y / 1.5).fract() > 0.66;
    let terrain = level(|x, y| is_post(x + 0.4 * y.sin(), y) && (x - 5.0).hypot(y - 5.0) > 2.0);
    let planner = Planner::new(&terrain, &robot, Settings::of(&robot)).unwrap();
    let outline = Footprint::of(&robot);
    for goal in [at(25.25, 12.25, None), at(16.25, 24.25, None)] {
        let asked = Query { refine: true, ..query(goal, Settings::of(&robot)) };
        let plan = planner.plan(&asked, Objective::Energy).unwrap();
        for route in plan.routes() {
            let found_m = least_room_m(planner.lattice(), route, &Patience::default()).unwrap();
            let mut least_m = f64::INFINITY;
            for pose in driven(&route.poses, 24) {
                let (sin, cos) = pose.heading_rad.sin_cos();
                for (ahead, aside) in [(0.5, 0.5), (0.5, -0.5), (-0.5, 0.5), (-0.5, -0.5)] {
                    let (ahead, aside) = (ahead * outline.length_m, aside * outline.width_m);
                    let [x, y] = [pose.x_m + ahead * cos - aside * sin, pose.y_m + ahead * sin + aside * cos];
                    for cell in
                        (0..GRID.cells()).map(|i| GRID.cell(i)).filter(|cell| terrain.is_blocked(*cell))
                    {
                        let [cx, cy] = GRID.center_m(cell);
                        let beyond = |d: f64| (d.abs() - GRID.cell_size_m / 2.0).max(0.0);
                        least_m = least_m.min(beyond(x - cx).hypot(beyond(y - cy)));
                    }
                }
            }
            assert!(found_m <= least_m + 1e-9, "{found_m}, by points {least_m}");
        }
    }
}

#[test]
fn a_stop_takes_the_kinetic_energy_that_does_not_come_back() {
    // 470 kg at 3 m/s through gears without loss that give nothing back: ½ m v² = 2115 J, once down and once up.
    let mut robot = Robot { mass_kg: 470.0, max_wheel_speed_mps: 6.0, yaw_inertia_kgm2: 1e-9, ..husky() };
    robot.limits.max_side_force_n = None;
    (robot.motors.left.k2, robot.motors.right.k2, robot.motors.regeneration) = (1.0, 1.0, 0.0);
    let settings = Settings { reverse: true, spin: false, ..Settings::of(&robot) };
    assert_eq!(settings.speed_mps, 3.0);
    let planner = Planner::new(&level(|_, _| false), &robot, settings).unwrap();
    let mut asked = query(at(5.25, 9.25, Some(PI)), settings);
    asked.start.heading_rad = Some(0.0);
    let plan = planner.plan(&asked, Objective::Distance).unwrap();
    let reversals = plan
        .route
        .steps
        .windows(2)
        .filter(|pair| pair[0].motion.speed_mps * pair[1].motion.speed_mps < 0.0)
        .count();
    assert_eq!(stops(&plan.route), reversals);
    let straight = planner.plan(&query(at(20.25, 5.25, Some(0.0)), settings), Objective::Energy).unwrap();
    assert_eq!((stops(&straight.route), stops_j(&robot, &straight.route)), (0, 0.0));
    let spinning = Settings { reverse: false, ..Settings::of(&robot) };
    let planner = Planner::new(&level(|_, _| false), &robot, spinning).unwrap();
    let at_end = planner.plan(&query(at(20.25, 5.25, Some(PI)), spinning), Objective::Distance).unwrap();
    assert_eq!(
        (stops(&at_end.route), stops_j(&robot, &at_end.route)),
        (0, 0.0),
        "a turn where it stops anyway"
    );
    // An L of lanes too narrow for its arcs.
    robot.slip_track_m = 4.0;
    let lanes = level(|x, y| !((y - 5.25).abs() < 0.8 && x < 16.0 || (x - 15.25).abs() < 0.8 && y > 4.5));
    let planner = Planner::new(&lanes, &robot, spinning).unwrap();
    let turned = planner.plan(&query(at(15.25, 20.25, None), spinning), Objective::Distance).unwrap();
    let (count, found_j) = (stops(&turned.route), stops_j(&robot, &turned.route));
    let expected_j = count as f64 * 470.0 * 9.0 / 2.0;
    assert!(count >= 1 && (found_j - expected_j).abs() < 0.02 * expected_j, "{found_j} for {count} stops");
    let whole = Robot { motors: model::robot::Motors { regeneration: 1.0, ..robot.motors }, ..robot.clone() };
    assert_eq!(stops_j(&whole, &turned.route), 0.0, "all of it comes back");
}

/// Least cost with the prices of changes by brute force: Dijkstra over poses and what the robot did last, on the table's own costs.
fn least_with_changes(planner: &Planner, asked: &Query, [stop_j, back_j]: [f64; 2]) -> Option<f64> {
    let (lattice, table) = (planner.lattice(), planner.table(Objective::Energy));
    let ends = planner.ends(asked, Objective::Energy).ok()?;
    // What was done last: nothing, ahead, astern; and whether the robot has turned on the spot since.
    let node = |state: planner::State, last: usize, spun: usize| (lattice.index(state) * 3 + last) * 2 + spun;
    let mut least = vec![f64::INFINITY; lattice.states() * 6];
    let mut open: std::collections::BTreeSet<(u64, usize, usize, usize)> = Default::default();
    for start in &ends.starts {
        least[node(*start, 0, 0)] = 0.0;
        open.insert((0, lattice.index(*start), 0, 0));
    }
    let mut best: Option<f64> = None;
    while let Some((bits, index, last, spun)) = open.pop_first() {
        let (cost, state) = (f64::from_bits(bits), lattice.state(index));
        if cost > least[node(state, last, spun)] {
            continue;
        }
        if ends.goals.contains(&state) {
            let lifted_j = lattice.potential_j(state.cell) - lattice.potential_j(ends.starts[0].cell);
            best = Some(best.map_or(cost + lifted_j, |best: f64| best.min(cost + lifted_j)));
        }
        for (motion, kind) in lattice.motions[state.heading.index()].iter().enumerate() {
            let taken = table.cost(state, motion);
            let Some(next) = lattice.successor(state, motion).filter(|_| taken.is_finite()) else { continue };
            let spins = matches!(kind.kind, planner::Kind::PointTurn { .. });
            let way = if kind.reverse { 2 } else { 1 };
            let (now, price) = match (spins, last) {
                (true, _) => ((last, usize::from(last > 0)), 0.0),
                (false, 0) => ((way, 0), 0.0),
                (false, last) if last == way => ((way, 0), if spun == 1 { stop_j } else { 0.0 }),
                (false, _) => ((way, 0), stop_j + back_j),
            };
            let total = cost + taken + price;
            if total < least[node(next, now.0, now.1)] {
                least[node(next, now.0, now.1)] = total;
                open.insert((total.to_bits(), lattice.index(next), now.0, now.1));
            }
        }
    }
    best
}

#[test]
fn with_prices_of_changes_the_best_path_is_that_of_brute_force() {
    let mut random = ground::random(24);
    let (mut compared, mut differs) = (0, 0);
    while compared < 60 {
        let terrain = ground::small_terrain(&mut random, 9);
        let robot = ground::some_robot(&mut random, [0.0, 1.0][compared % 2]);
        let mut asked = ground::some_query(&mut random, &terrain, &robot);
        let (stops, back_j) = (random.random_bool(0.7), random.random_range(0.0..300.0));
        let prices = Prices { direction_change_j: back_j, stops, ..Prices::default() };
        let settings = Settings { reverse: true, ..Settings::of(&robot) };
        asked.settings = Settings { prices, ..settings };
        let free = Planner::new(&terrain, &robot, settings).unwrap();
        let priced = Planner::new(&terrain, &robot, asked.settings).unwrap();
        let Ok(plan) = priced.plan(&asked, Objective::Energy) else { continue };
        compared += 1;
        let k2 = (robot.motors.left.k2 + robot.motors.right.k2) / 2.0;
        let kinetic_j = robot.mass_kg / 2.0 * settings.speed_mps.powi(2);
        let stop_j = if stops { (k2 - robot.motors.regeneration / k2) * kinetic_j } else { 0.0 };
        let best_j = least_with_changes(&free, &asked, [stop_j, back_j]).unwrap();
        let total = &plan.route.total;
        let found_j = total.energy_j + total.surcharge.j;
        assert!((found_j - best_j).abs() < 1e-3 * best_j.abs() + 0.2, "{found_j}, but the best is {best_j}");
        assert!(
            plan.search.is_optimal() && plan.search.excess < 0.02 * best_j.abs() + 1.0,
            "{:?}",
            plan.search
        );
        let plain = free.plan(&Query { settings, ..asked.clone() }, Objective::Energy).unwrap();
        differs += usize::from(plain.route.poses != plan.route.poses);
        let loose = priced.plan(&Query { bound: 1.5, ..asked.clone() }, Objective::Energy).unwrap();
        let bound = loose.search.bound.unwrap_or(f64::INFINITY);
        let loose_j = loose.route.total.energy_j + loose.route.total.surcharge.j;
        assert!(
            best_j <= 0.0 || loose_j <= bound * best_j * (1.0 + 1e-3) + 0.2,
            "{loose_j} for {best_j} within {bound}"
        );
    }
    assert!(differs > 10, "prices changed {differs} of {compared} paths");
}

#[test]
fn exact_ends_are_where_they_were_asked_for_and_the_way_between_is_driven_and_clear() {
    let mut random = ground::random(25);
    let (mut compared, mut exact) = (0, 0);
    while compared < 60 {
        let terrain = ground::small_terrain(&mut random, 12);
        let robot = ground::some_robot(&mut random, 1.0);
        let mut asked = ground::some_query(&mut random, &terrain, &robot);
        asked.goal.tolerance_m = 0.0;
        asked.refine = compared % 2 == 0;
        let planner = Planner::new(&terrain, &robot, asked.settings).unwrap();
        let Ok(snapped) = planner.plan(&asked, Objective::Energy) else { continue };
        let plan = planner.plan(&Query { exact_ends: true, ..asked.clone() }, Objective::Energy).unwrap();
        compared += 1;
        let (first, last) = (plan.route.poses.first().unwrap(), plan.route.poses.last().unwrap());
        let [start_m, goal_m] = [plan.start_snap.distance_m, plan.goal_snap.distance_m];
        assert!(start_m < 1e-9 || start_m == snapped.start_snap.distance_m, "{start_m}");
        assert!(goal_m < 1e-9 || (goal_m - snapped.goal_snap.distance_m).abs() < 1e-12, "{goal_m}");
        if start_m < 1e-9 && goal_m < 1e-9 {
            exact += 1;
            assert!((first.x_m - asked.start.x_m).hypot(first.y_m - asked.start.y_m) < 1e-9);
            assert!((last.x_m - asked.goal.x_m).hypot(last.y_m - asked.goal.y_m) < 1e-9);
            for (wanted, pose) in [(asked.start.heading_rad, first), (asked.goal.heading_rad, last)] {
                let off = wanted.map_or(0.0, |wanted| (wanted - pose.heading_rad).sin());
                assert!(off.abs() < 1e-9, "{wanted:?} and {pose:?}");
            }
        }
        for route in plan.routes() {
            // Poses follow from the steps, and none stands on blocked ground.
            let drawn_j: f64 = route.steps.iter().map(|s| s.bus_w * s.duration_s).sum();
            assert!((drawn_j - route.total.energy_j).abs() < 1e-6 * (1.0 + drawn_j.abs()));
            for pair in route.poses.windows(2) {
                assert!((pair[1].x_m - pair[0].x_m).hypot(pair[1].y_m - pair[0].y_m) < 1.3, "{pair:?}");
            }
            let room_m = least_room_m(planner.lattice(), route, &Patience::default()).unwrap();
            assert!(room_m >= 0.0);
            for pose in &route.poses {
                let cell = terrain.grid.cell_at(pose.x_m, pose.y_m).unwrap();
                assert!(!terrain.is_blocked(cell), "{pose:?}");
            }
        }
        if let Some(refined) = &plan.refined {
            let end = refined.route.poses.last().unwrap();
            assert!((end.x_m - last.x_m).hypot(end.y_m - last.y_m) < 1e-9);
            assert!(refined.route.total.energy_j <= plan.route.total.energy_j + 1e-9);
        }
    }
    assert!(exact > 20, "{exact} of {compared} had both ends exact");
}
