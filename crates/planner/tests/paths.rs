//! What every answer must satisfy, whatever the map.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use approx::assert_relative_eq;
use model::{Attitude, Motion, PowerModel, Sides, builtin, power};
use planner::{
    Error, Goal, HEADINGS, Lattice, Objective, Patience, Plan, Query, Settings, Start, State, compare, plan,
};
use rand::RngExt;
use terrain::{Cell, Grid, Terrain, io, synthetic};

mod ground;

fn hilly(side: usize, seed: u64) -> Terrain {
    let grid = Grid { rows: side, columns: side, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    Terrain::new(grid, &synthetic::relief(grid, seed, 20.0, 4.0)).unwrap()
}

fn across(terrain: &Terrain, robot: &model::Robot) -> Query {
    // Cell centres, so that turned and mirrored places fall into turned and mirrored cells.
    let n = terrain.grid.rows;
    let [sx, sy] = terrain.grid.center_m(Cell { row: n / 5, column: n / 8 });
    let [gx, gy] = terrain.grid.center_m(Cell { row: 2 * n / 3, column: n - n / 8 });
    Query {
        start: Start { x_m: sx, y_m: sy, heading_rad: Some(0.0) },
        goal: Goal { x_m: gx, y_m: gy, heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings: Settings::of(robot),
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    }
}

#[test]
fn the_sum_of_edge_energies_is_the_answers_energy() {
    let robot = builtin::husky_a200();
    for seed in 0..6 {
        let terrain = hilly(40, seed);
        let answer = plan(&terrain, &robot, &across(&terrain, &robot), Objective::Energy).unwrap();
        let sum: f64 = answer.route.edges.iter().map(|e| e.energy_j).sum();
        let total_j = answer.route.total.energy_j;
        assert_relative_eq!(sum, total_j, epsilon = 1e-9 * total_j.abs());
        assert_relative_eq!(answer.route.poses.last().unwrap().energy_j, total_j, epsilon = 1e-9);
        let by_steps: f64 = answer.route.steps.iter().map(planner::Step::energy_j).sum();
        assert_relative_eq!(by_steps, total_j, epsilon = 1e-9 * total_j.abs());
    }
}

/// Integrates the power model over nothing but the poses of an answer.
fn reintegrate_j(answer: &Plan, robot: &model::Robot, model: PowerModel) -> f64 {
    answer
        .route
        .poses
        .windows(2)
        .map(|pair| {
            let (a, b) = (pair[0], pair[1]);
            let dt = b.t_s - a.t_s;
            let speed = (b.distance_m - a.distance_m) / dt;
            let yaw = match b.radius_m {
                None => 0.0,
                Some(0.0) => planner_turn(a.heading_rad, b.heading_rad) / dt,
                Some(radius) => speed / radius,
            };
            let motion = Motion::of_body(robot, speed, yaw);
            let attitude = Attitude { pitch_rad: b.pitch_rad, roll_rad: b.roll_rad };
            let marble = robot.surface("marble").unwrap();
            power(model, robot, marble, motion, attitude, Sides::both(20.0)).bus_w * dt
        })
        .sum()
}

fn planner_turn(from: f64, to: f64) -> f64 {
    (to - from + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
}

#[test]
fn integrating_the_returned_poses_anew_gives_the_same_energy() {
    let robot = builtin::husky_a200();
    for seed in 0..6 {
        let terrain = hilly(40, 10 + seed);
        for model in [PowerModel::ForceBalance, PowerModel::DogruMarques] {
            let mut query = across(&terrain, &robot);
            query.settings.power_model = model;
            let answer = plan(&terrain, &robot, &query, Objective::Energy).unwrap();
            let anew_j = reintegrate_j(&answer, &robot, model);
            assert_relative_eq!(anew_j, answer.route.total.energy_j, max_relative = 0.005);
        }
    }
}

#[test]
fn poses_lie_on_the_ground_and_their_lengths_and_climbs_add_up() {
    let robot = builtin::husky_a200();
    let terrain = hilly(40, 3);
    let answer = plan(&terrain, &robot, &across(&terrain, &robot), Objective::Energy).unwrap();
    let total = &answer.route.total;
    let (first, last) = (answer.route.poses.first().unwrap(), answer.route.poses.last().unwrap());
    for pose in &answer.route.poses {
        let z_m = ground::standing_m(&terrain, &robot, pose.x_m, pose.y_m).unwrap();
        assert_relative_eq!(pose.z_m, z_m, epsilon = 1e-3);
    }
    assert_relative_eq!(total.climb_m - total.descent_m, last.z_m - first.z_m, epsilon = 1e-4);
    let chords: f64 = answer
        .route
        .poses
        .windows(2)
        .map(|p| (p[1].x_m - p[0].x_m).hypot(p[1].y_m - p[0].y_m).hypot(p[1].z_m - p[0].z_m))
        .sum();
    assert!(chords <= total.length_m + 1e-9 && chords > 0.97 * total.length_m, "{chords} m");
    assert!(answer.energy_interval_j[0] < total.energy_j && total.energy_j < answer.energy_interval_j[1]);
}

#[test]
fn gravity_does_no_work_on_any_closed_loop() {
    let robot = builtin::husky_a200();
    let terrain = hilly(24, 5);
    let mut settings = Settings::of(&robot);
    settings.reverse = true;
    let lattice = Lattice::new(&terrain, &robot, settings).unwrap();
    let mut random = ground::random(5);
    let mut loops = 0;
    while loops < 40 {
        let home = State { cell: Cell { row: 12, column: 12 }, heading: planner::Heading::new(0) };
        let (mut state, mut rise_m, mut energy_j, mut closed) = (home, 0.0, 0.0, false);
        for _ in 0..4000 {
            let motion = random.random_range(0..lattice.motions_per_state());
            let Some(end) = lattice.successor(state, motion) else { continue };
            let Some(edge) = lattice.variants(state.cell, state.heading, motion).flatten().next() else {
                continue;
            };
            rise_m += edge.climb_m - edge.descent_m;
            energy_j += edge.energy_j;
            state = end;
            if state == home && energy_j > 0.0 {
                closed = true;
                break;
            }
        }
        if closed {
            loops += 1;
            assert!(rise_m.abs() < 1e-5, "{rise_m} m gained on a closed loop");
        }
        assert!(energy_j >= -robot.mass_kg * 9.81 * 8.0, "more came back than the hill holds");
    }
}

/// The same ground turned by a quarter to the left, or mirrored east to west.
fn transformed(terrain: &Terrain, mirror: bool) -> Terrain {
    let n = terrain.grid.rows;
    let z: Vec<f64> = (0..n * n)
        .map(|i| terrain.grid.cell(i))
        .map(|Cell { row, column }| {
            let from = if mirror {
                Cell { row, column: n - 1 - column }
            } else {
                // A point (x, y) comes from (y, −x) of the ground before.
                Cell { row: n - 1 - column, column: row }
            };
            terrain.elevation_m(from).unwrap()
        })
        .collect();
    Terrain::new(terrain.grid, &z).unwrap()
}

#[test]
fn turned_and_mirrored_ground_gives_the_same_costs() {
    let mut robot = builtin::husky_a200();
    robot.motors.right = robot.motors.left;
    for seed in 0..4 {
        let terrain = hilly(30, 30 + seed);
        let side_m = 30.0;
        let query = across(&terrain, &robot);
        let straight = plan(&terrain, &robot, &query, Objective::Energy).unwrap();
        let place = |mirror: bool, x: f64, y: f64| if mirror { (side_m - x, y) } else { (side_m - y, x) };
        for mirror in [false, true] {
            let mut other = query.clone();
            (other.start.x_m, other.start.y_m) = place(mirror, query.start.x_m, query.start.y_m);
            (other.goal.x_m, other.goal.y_m) = place(mirror, query.goal.x_m, query.goal.y_m);
            let heading = query.start.heading_rad.unwrap();
            other.start.heading_rad = Some(if mirror {
                std::f64::consts::PI - heading
            } else {
                heading + std::f64::consts::FRAC_PI_2
            });
            let turned = plan(&transformed(&terrain, mirror), &robot, &other, Objective::Energy).unwrap();
            assert_relative_eq!(
                turned.route.total.energy_j,
                straight.route.total.energy_j,
                max_relative = 1e-5
            );
        }
    }
}

#[test]
fn the_answer_is_the_same_for_one_and_two_threads() {
    let robot = builtin::husky_a200();
    let terrain = hilly(50, 9);
    let query = across(&terrain, &robot);
    let with = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| plan(&terrain, &robot, &query, Objective::Energy).unwrap().route)
    };
    assert_eq!(with(1), with(2));
}

#[test]
fn limits_hold_along_every_path() {
    let mut robot = builtin::husky_a200();
    robot.limits.max_pitch_rad = 0.2;
    robot.limits.max_roll_rad = 0.2;
    robot.limits.max_side_force_n = Some(200.0);
    let terrain = hilly(40, 2);
    let mut query = across(&terrain, &robot);
    query.start.heading_rad = None;
    query.snap_radius_m = Some(6.0);
    let answer = plan(&terrain, &robot, &query, Objective::Distance).unwrap();
    let free = plan(&terrain, &builtin::husky_a200(), &query, Objective::Distance).unwrap();
    assert!(answer.route.total.length_m > free.route.total.length_m, "the limits must matter on this ground");
    for (pose, step) in answer.route.poses.iter().skip(1).zip(&answer.route.steps) {
        assert!(pose.pitch_rad.abs() <= 0.2 + 1e-9 && pose.roll_rad.abs() <= 0.2 + 1e-9);
        let attitude = Attitude { pitch_rad: pose.pitch_rad, roll_rad: pose.roll_rad };
        let marble = robot.surface("marble").unwrap();
        let p = power(PowerModel::ForceBalance, &robot, marble, step.motion, attitude, Sides::both(20.0));
        assert!(p.force_n.left.abs().max(p.force_n.right.abs()) <= 200.0 + 1e-6);
    }
}

#[test]
fn no_wheel_is_asked_for_more_than_its_limit() {
    let robot = builtin::husky_a200();
    let terrain = hilly(40, 4);
    let mut query = across(&terrain, &robot);
    query.settings.speed_mps = robot.max_wheel_speed_mps;
    let answer = plan(&terrain, &robot, &query, Objective::Time).unwrap();
    for step in &answer.route.steps {
        let rims = step.motion.rim_speeds_mps;
        assert!(rims.left.abs().max(rims.right.abs()) <= robot.max_wheel_speed_mps + 1e-9);
    }
}

#[test]
fn obstacles_are_kept_clear_of_and_reversing_helps_where_there_is_no_room_to_turn() {
    // A dead-end lane one robot wide: out of it only backwards. Cells of 0.25 m, walls on both sides.
    let grid = Grid { rows: 20, columns: 40, cell_size_m: 0.25, origin_m: [0.0, 0.0] };
    let obstacle: Vec<bool> = (0..grid.cells())
        .map(|i| grid.cell(i))
        .map(|Cell { row, column }| column < 20 && !(9..=11).contains(&row))
        .collect();
    let terrain = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap().with_obstacles(obstacle);
    let robot = builtin::husky_a200();
    let mut query = Query {
        start: Start { x_m: 1.4, y_m: 2.6, heading_rad: Some(std::f64::consts::PI) },
        goal: Goal {
            x_m: 8.0,
            y_m: 2.5,
            heading_rad: Some(std::f64::consts::PI),
            either_way: false,
            tolerance_m: 0.0,
        },
        settings: Settings::of(&robot),
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    };
    let error = plan(&terrain, &robot, &query, Objective::Energy).unwrap_err();
    assert!(matches!(error, Error::NoRoomToTurn { .. }), "{error}");
    query.settings.reverse = true;
    let out = plan(&terrain, &robot, &query, Objective::Energy).unwrap();
    assert!(out.route.steps.iter().all(|s| s.motion.speed_mps <= 0.0), "it must back out");
}

#[test]
fn on_the_real_map_the_energy_minimal_path_is_cheaper_on_nine_of_ten_pairs_and_never_dearer() {
    let map = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../maps/minnesota.tif");
    let terrain = io::read_path(&map).unwrap();
    let robot = builtin::husky_a200();
    let mut random = ground::random(99);
    let mut cheaper = 0;
    for _ in 0..10 {
        let mut place = |low: f64, high: f64| {
            terrain.grid.at_fraction_m(random.random_range(low..high), random.random_range(0.1..0.9))
        };
        let (start, goal) = (place(0.05, 0.3), place(0.7, 0.95));
        let query = Query {
            start: Start { x_m: start[0], y_m: start[1], heading_rad: None },
            goal: Goal { x_m: goal[0], y_m: goal[1], heading_rad: None, either_way: false, tolerance_m: 0.0 },
            settings: Settings::of(&robot),
            other_goals: Vec::new(),
            snap_radius_m: None,
            bound: 1.0,
            refine: false,
            exact_ends: false,
            patience: Patience::default(),
        };
        let both = compare(&terrain, &robot, &query).unwrap();
        let (e, d, t) = (&both.energy.route.total, &both.distance.route.total, &both.time.route.total);
        assert!(e.energy_j <= d.energy_j && e.energy_j <= t.energy_j, "never dearer");
        assert!(d.length_m <= e.length_m * (1.0 + 1e-4) && d.length_m <= t.length_m * (1.0 + 1e-4));
        assert!(t.duration_s <= e.duration_s * (1.0 + 1e-4) && t.duration_s <= d.duration_s * (1.0 + 1e-4));
        cheaper += usize::from(both.saving_fraction() > 0.01);
    }
    assert!(cheaper >= 9, "cheaper on {cheaper} of 10");
}

#[test]
fn a_state_position_and_its_state_are_each_others_inverse() {
    let terrain = hilly(5, 1);
    let robot = builtin::husky_a200();
    let lattice = Lattice::new(&terrain, &robot, Settings::of(&robot)).unwrap();
    assert_eq!(lattice.states(), 25 * HEADINGS);
    assert!((0..lattice.states()).all(|i| lattice.index(lattice.state(i)) == i));
}
