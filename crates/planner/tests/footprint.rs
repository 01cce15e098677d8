//! The robot's outline stays off obstacles and unknown ground, in every pose of an answer and in the motion between poses.
//!
//! What is blocked is found here by clipping the outline, a polygon, to squares: nothing of the planner's own test is used.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeSet;

use model::{Robot, builtin};
use planner::{
    Error, Goal, Heading, Lattice, Objective, Patience, Plan, Pose, Query, Route, Settings, Start, plan,
};
use proptest::prelude::*;
use rand::{Rng, RngExt};
use terrain::{Cell, Grid, Terrain};

mod ground;

/// Overlaps no deeper than this are rounding, in cells.
const ROUNDING_CELLS: f64 = 1e-6;

/// Corners of the outline in a pose: wheelbase plus wheel diameter long, track plus one wheel radius wide.
fn corners_m(robot: &Robot, [x, y, heading]: [f64; 3]) -> Vec<[f64; 2]> {
    let half_l = robot.wheelbase_m / 2.0 + robot.wheel_radius_m;
    let half_w = (robot.track_m + robot.wheel_radius_m) / 2.0;
    let (sin, cos) = heading.sin_cos();
    let corner = |(l, w): (f64, f64)| [x + l * cos - w * sin, y + l * sin + w * cos];
    [(half_l, half_w), (-half_l, half_w), (-half_l, -half_w), (half_l, -half_w)].map(corner).to_vec()
}

/// The part of a polygon on one side of a line: `along` 0 for x or 1 for y, and below or above a value.
fn clipped(polygon: &[[f64; 2]], along: usize, sign: f64, at: f64) -> Vec<[f64; 2]> {
    let inside = |p: &[f64; 2]| sign * (p[along] - at);
    let mut kept = Vec::new();
    for (i, a) in polygon.iter().enumerate() {
        let b = &polygon[(i + 1) % polygon.len()];
        let (da, db) = (inside(a), inside(b));
        if da >= 0.0 {
            kept.push(*a);
        }
        if (da > 0.0 && db < 0.0) || (da < 0.0 && db > 0.0) {
            let share = da / (da - db);
            kept.push([a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])]);
        }
    }
    kept
}

/// Whether a convex polygon reaches into a square, given by its south-west corner.
fn reaches_into(polygon: &[[f64; 2]], [west, south]: [f64; 2], side: f64) -> bool {
    let margin = ROUNDING_CELLS * side;
    let (low, high) = ([west + margin, south + margin], [west + side - margin, south + side - margin]);
    let sides = [(0, 1.0, low[0]), (0, -1.0, high[0]), (1, 1.0, low[1]), (1, -1.0, high[1])];
    let inside = sides
        .iter()
        .fold(polygon.to_vec(), |polygon, (along, sign, at)| clipped(&polygon, *along, *sign, *at));
    let double_area: f64 = (0..inside.len())
        .map(|i| (inside[i], inside[(i + 1) % inside.len()]))
        .map(|(a, b)| a[0] * b[1] - a[1] * b[0])
        .sum();
    double_area.abs() > 0.0 && inside.len() > 2
}

/// Cells that the outline reaches into in a pose.
fn cells_under(robot: &Robot, grid: &Grid, pose: [f64; 3]) -> Vec<Cell> {
    let corners = corners_m(robot, pose);
    let side = grid.cell_size_m;
    let range = |along: usize, count: usize| {
        let places = || corners.iter().map(|c| (c[along] - grid.origin_m[along]) / side);
        let low = places().fold(f64::INFINITY, f64::min).floor().max(0.0) as usize;
        let high = places().fold(f64::NEG_INFINITY, f64::max).ceil().max(0.0) as usize;
        low..high.min(count)
    };
    let mut cells = Vec::new();
    for row in range(1, grid.rows) {
        for column in range(0, grid.columns) {
            let corner = [grid.origin_m[0] + column as f64 * side, grid.origin_m[1] + row as f64 * side];
            if reaches_into(&corners, corner, side) {
                cells.push(Cell { row, column });
            }
        }
    }
    cells
}

/// Poses between two of an answer, on the straight, arc or spot, a tenth of a cell apart at the outline's corners.
fn between(robot: &Robot, cell_size_m: f64, a: &Pose, b: &Pose) -> Vec<[f64; 3]> {
    let tau = std::f64::consts::TAU;
    let turn = (b.heading_rad - a.heading_rad + tau / 2.0).rem_euclid(tau) - tau / 2.0;
    let (dx, dy) = (b.x_m - a.x_m, b.y_m - a.y_m);
    let (chord_m, chord_rad) = (dx.hypot(dy), dy.atan2(dx));
    let half_diagonal_m =
        (robot.wheelbase_m + 2.0 * robot.wheel_radius_m).hypot(robot.track_m + robot.wheel_radius_m) / 2.0;
    let moved_m = chord_m * 1.1 + turn.abs() * half_diagonal_m;
    let count = (moved_m / (0.1 * cell_size_m)).ceil().max(1.0) as usize;
    (0..=count)
        .map(|i| {
            let share = i as f64 / count as f64;
            let half = turn / 2.0;
            let (length_m, off_rad) = match half.abs() < 1e-9 {
                true => (chord_m * share, 0.0),
                false => (chord_m * (half * share).sin() / half.sin(), half * share - half),
            };
            let way_rad = chord_rad + off_rad;
            [a.x_m + length_m * way_rad.cos(), a.y_m + length_m * way_rad.sin(), a.heading_rad + turn * share]
        })
        .collect()
}

/// The first blocked cell that the robot reaches into along a route, and the pose.
fn touched(terrain: &Terrain, robot: &Robot, route: &Route) -> Option<(Cell, [f64; 3])> {
    let side = terrain.grid.cell_size_m;
    let stretches = route.poses.windows(2).flat_map(|pair| between(robot, side, &pair[0], &pair[1]));
    let first = route.poses.first().map(|p| [p.x_m, p.y_m, p.heading_rad]);
    let blocked: Vec<Cell> =
        (0..terrain.grid.cells()).map(|i| terrain.grid.cell(i)).filter(|c| terrain.is_blocked(*c)).collect();
    let half_diagonal_m = corners_m(robot, [0.0; 3]).iter().map(|[x, y]| x.hypot(*y)).fold(0.0, f64::max);
    first.into_iter().chain(stretches).find_map(|pose| {
        let corners = corners_m(robot, pose);
        let hit = blocked.iter().find(|cell| {
            let [x, y] = terrain.grid.center_m(**cell);
            (x - pose[0]).hypot(y - pose[1]) < half_diagonal_m + side
                && reaches_into(&corners, [x - side / 2.0, y - side / 2.0], side)
        });
        hit.map(|cell| (*cell, pose))
    })
}

fn assert_clear(terrain: &Terrain, robot: &Robot, answer: &Plan) {
    assert_eq!(touched(terrain, robot, &answer.route), None, "the lattice's path");
    if let Some(refined) = &answer.refined {
        assert_eq!(touched(terrain, robot, &refined.route), None, "the refined path");
    }
}

/// A robot of about so many cells in length and width, with a slip track of its own.
fn robot_of(cell_size_m: f64, [length_cells, width_cells]: [f64; 2], slip: f64) -> Robot {
    let mut robot = builtin::husky_a200();
    robot.wheel_radius_m = (0.1 * cell_size_m * length_cells.min(width_cells)).clamp(0.005, 2.0);
    robot.wheelbase_m = (length_cells * cell_size_m - 2.0 * robot.wheel_radius_m).clamp(0.02, 10.0);
    robot.track_m = (width_cells * cell_size_m - robot.wheel_radius_m).clamp(0.02, 10.0);
    robot.slip_track_m = slip * robot.track_m;
    (robot.center_of_mass.forward_m, robot.center_of_mass.left_m) = (0.0, 0.0);
    // A robot of odd proportions may need any force to turn; here only its outline matters.
    robot.limits.max_side_force_n = None;
    robot
}

/// Level ground with scattered obstacles, unknown cells and a diagonal wall with a gap.
fn obstacle_course(random: &mut impl Rng, grid: Grid, share: f64) -> Terrain {
    let mut z = vec![0.0; grid.cells()];
    for z in z.iter_mut().skip(1) {
        if random.random_bool(share / 2.0) {
            *z = f64::NAN;
        }
    }
    let (wall, gap) = (random.random_range(0..grid.rows), random.random_range(0..grid.columns));
    let width = grid.columns / 4;
    let obstacle = (0..grid.cells())
        .map(|i| grid.cell(i))
        .map(|Cell { row, column }| {
            let on_wall = row + column == wall + grid.columns / 2 && column.abs_diff(gap) > width;
            on_wall || random.random_bool(share)
        })
        .collect();
    Terrain::new(grid, &z).unwrap().with_obstacles(obstacle)
}

fn query(random: &mut impl Rng, terrain: &Terrain, robot: &Robot) -> Query {
    let mut place =
        || terrain.grid.at_fraction_m(random.random_range(0.1..0.9), random.random_range(0.1..0.9));
    let (start, goal) = (place(), place());
    Query {
        start: Start {
            x_m: start[0],
            y_m: start[1],
            heading_rad: random.random_bool(0.5).then(|| random.random_range(-3.1..3.1)),
        },
        goal: Goal {
            x_m: goal[0],
            y_m: goal[1],
            heading_rad: random.random_bool(0.5).then(|| random.random_range(-3.1..3.1)),
            either_way: false,
            tolerance_m: 0.0,
        },
        settings: Settings { reverse: random.random_bool(0.5), ..Settings::of(robot) },
        other_goals: Vec::new(),
        snap_radius_m: Some(3.0 * terrain.grid.cell_size_m),
        bound: 1.0,
        refine: true,
        exact_ends: false,
        patience: Patience::default(),
    }
}

#[test]
fn no_answer_touches_an_obstacle_or_unknown_ground_whatever_the_robot_and_the_cells() {
    let (mut found, mut large, mut tiny) = (0, 0, 0);
    for seed in 0..160 {
        let mut random = ground::random(7100 + seed);
        let cell_size_m = 0.02 * 1500.0f64.powf(random.random_range(0.0..1.0));
        // From a twentieth of a cell to a dozen cells, long and thin, wide, or square.
        let extent = |random: &mut rand_pcg::Pcg64Mcg| 0.05 * 240.0f64.powf(random.random_range(0.0..1.0));
        let size = [extent(&mut random), extent(&mut random)];
        let robot = robot_of(cell_size_m, size, random.random_range(0.6..2.5));
        let across = (robot.wheelbase_m.hypot(robot.track_m) / cell_size_m).ceil() as usize;
        let grid = Grid {
            rows: 16 + 4 * across,
            columns: 17 + 4 * across,
            cell_size_m,
            origin_m: [10.0 * cell_size_m, -3.0 * cell_size_m],
        };
        let share = 0.12 / (1.0 + (across * across) as f64);
        let terrain = obstacle_course(&mut random, grid, share);
        let query = query(&mut random, &terrain, &robot);
        let objective = [Objective::Energy, Objective::Distance, Objective::Time][seed as usize % 3];
        let Ok(answer) = plan(&terrain, &robot, &query, objective) else { continue };
        assert_clear(&terrain, &robot, &answer);
        found += 1;
        large += usize::from(across > 4);
        tiny += usize::from(across <= 1);
    }
    assert!(found > 60 && large > 10 && tiny > 10, "{found} found, {large} large, {tiny} tiny");
}

/// Cells that a chain of pieces reaches into, by poses a twentieth of a cell apart at the outline's corners.
fn swept(robot: &Robot, grid: &Grid, from: Cell, pieces: &[planner::Piece]) -> BTreeSet<Cell> {
    let [x, y] = grid.center_m(from);
    let half_diagonal_m = corners_m(robot, [0.0; 3])[0].iter().map(|v| v * v).sum::<f64>().sqrt();
    let mut cells = BTreeSet::new();
    for piece in pieces {
        let moved_m = piece.length_m + piece.turn_rad.abs() * half_diagonal_m;
        let count = (moved_m / (0.05 * grid.cell_size_m)).ceil().max(1.0) as usize;
        for i in 0..=count {
            let [dx, dy, heading] = piece.pose_at(i as f64 / count as f64);
            cells.extend(cells_under(robot, grid, [x + dx, y + dy, heading]));
        }
    }
    cells
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]
    #[test]
    fn a_motion_needs_the_cells_that_it_touches_and_no_more_than_one_cell_of_clearance(
        scale in 0.0f64..1.0, length in 0.0f64..1.0, width in 0.0f64..1.0, slip in 0.6f64..2.5, heading in 0usize..16,
    ) {
        let cell_size_m = 0.02 * 1500.0f64.powf(scale);
        let size = [length, width].map(|extent| 0.05 * 160.0f64.powf(extent));
        let robot = robot_of(cell_size_m, size, slip);
        let grid = Grid { rows: 81, columns: 81, cell_size_m, origin_m: [0.0, 0.0] };
        let from = Cell { row: 40, column: 40 };
        let level = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap();
        let settings = Settings { reverse: true, ..Settings::of(&robot) };
        let lattice = Lattice::new(&level, &robot, settings).unwrap();
        let heading = Heading::new(heading);
        for (index, motion) in lattice.motions[heading.index()].iter().enumerate() {
            for (variant, pieces) in motion.variants.iter().enumerate() {
                let exact = swept(&robot, &grid, from, pieces);
                let is_near = |cell: &Cell| {
                    exact.iter().any(|e| e.row.abs_diff(cell.row) <= 1 && e.column.abs_diff(cell.column) <= 1)
                };
                let driven = |obstacle: Vec<bool>| {
                    let walled = lattice.over(&level.clone().with_obstacles(obstacle), &Patience::default()).unwrap();
                    walled.variants(from, heading, index).nth(variant).unwrap().is_some()
                };
                let cells = || (0..grid.cells()).map(|i| grid.cell(i));
                if exact.iter().all(|c| (1..80).contains(&c.row) && (1..80).contains(&c.column)) {
                    prop_assert!(driven(cells().map(|c| !is_near(&c)).collect()), "{motion:?} needs too much");
                }
                for touched in [exact.first(), exact.last(), exact.iter().nth(exact.len() / 2)] {
                    let touched = *touched.unwrap();
                    prop_assert!(!driven(cells().map(|c| c == touched).collect()), "{motion:?} over {touched:?}");
                }
            }
        }
    }
}

#[test]
fn a_closed_diagonal_wall_has_no_gap_at_any_cell_size() {
    let robot = builtin::husky_a200();
    for cell_size_m in [1.0, 5.0, 15.0, 20.0, 30.0] {
        let grid = Grid { rows: 12, columns: 12, cell_size_m, origin_m: [0.0, 0.0] };
        let wall = (0..grid.cells()).map(|i| grid.cell(i)).map(|c| c.row + c.column == 11).collect();
        let terrain = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap().with_obstacles(wall);
        let place = |cells: f64| cells * cell_size_m;
        let query = Query {
            start: Start { x_m: place(2.5), y_m: place(2.5), heading_rad: None },
            goal: Goal {
                x_m: place(9.5),
                y_m: place(9.5),
                heading_rad: None,
                either_way: false,
                tolerance_m: 0.0,
            },
            settings: Settings::of(&robot),
            other_goals: Vec::new(),
            snap_radius_m: None,
            bound: 1.0,
            refine: true,
            exact_ends: false,
            patience: Patience::default(),
        };
        let error = plan(&terrain, &robot, &query, Objective::Energy).unwrap_err();
        assert!(matches!(error, Error::NoPath { .. }), "cells of {cell_size_m} m: {error}");
    }
}

#[test]
fn a_robot_wider_than_long_does_not_turn_through_what_lies_beside_it() {
    // 0.1 m long and 2.02 m wide on cells of 0.25 m; an obstacle that only its ends come to while it turns.
    let mut robot = builtin::husky_a200();
    (robot.wheelbase_m, robot.track_m, robot.wheel_radius_m) = (0.05, 2.0, 0.02);
    robot.slip_track_m = 2.0;
    let grid = Grid { rows: 15, columns: 15, cell_size_m: 0.25, origin_m: [0.0, 0.0] };
    let level = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap();
    let to_rad = Heading::new(1).angle_rad();
    let (mut spun, mut kept_off) = (0, 0);
    for index in 0..grid.cells() {
        let obstacle = (0..grid.cells()).map(|i| i == index).collect();
        let terrain = level.clone().with_obstacles(obstacle);
        let query = Query {
            start: Start { x_m: 1.875, y_m: 1.875, heading_rad: Some(0.0) },
            goal: Goal {
                x_m: 1.875,
                y_m: 1.875,
                heading_rad: Some(to_rad),
                either_way: false,
                tolerance_m: 0.0,
            },
            settings: Settings::of(&robot),
            other_goals: Vec::new(),
            snap_radius_m: Some(0.0),
            bound: 1.0,
            refine: true,
            exact_ends: false,
            patience: Patience::default(),
        };
        match plan(&terrain, &robot, &query, Objective::Energy) {
            Ok(answer) => {
                assert_clear(&terrain, &robot, &answer);
                spun += 1;
            }
            Err(_) => kept_off += 1,
        }
    }
    assert!(spun > 100 && kept_off > 10, "{spun} turned, {kept_off} did not");
}
