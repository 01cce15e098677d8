//! Questions without an answer are refused by name, with the place and the reason.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::time::{Duration, Instant};

use model::builtin;
use planner::{
    Blocked, Error, Goal, Hindrance, Limit, Objective, Patience, Place, Planner, Query, Settings, Start, plan,
};
use terrain::{Cell, Grid, Surfaces, Terrain};

const GRID: Grid = Grid { rows: 20, columns: 20, cell_size_m: 1.0, origin_m: [0.0, 0.0] };

fn flat() -> Terrain {
    Terrain::new(GRID, &vec![0.0; GRID.cells()]).unwrap()
}

fn query(start: (f64, f64), goal: (f64, f64)) -> Query {
    Query {
        start: Start { x_m: start.0, y_m: start.1, heading_rad: None },
        goal: Goal { x_m: goal.0, y_m: goal.1, heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings: Settings::of(&builtin::husky_a200()),
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    }
}

fn refused(terrain: &Terrain, query: &Query) -> Error {
    plan(terrain, &builtin::husky_a200(), query, Objective::Energy).unwrap_err()
}

#[test]
fn ends_off_the_map_are_told_apart_and_the_extent_is_named() {
    let start = refused(&flat(), &query((-1.0, 5.0), (10.0, 10.0)));
    assert!(matches!(start, Error::OutsideMap { place: Place::Start, .. }));
    assert!(start.to_string().contains("(-1.00, 5.00)") && start.to_string().contains("0 to 20"), "{start}");
    let goal = refused(&flat(), &query((5.0, 5.0), (10.0, 20.5)));
    assert!(matches!(goal, Error::OutsideMap { place: Place::Goal, .. }));
}

#[test]
fn what_could_be_degrees_on_a_map_far_from_them_is_told_how_degrees_are_written() {
    let grid = Grid { origin_m: [512_340.004_999_9, 5_402_110.0], ..GRID };
    let far = Terrain::new(grid, &vec![1.0; grid.cells()]).unwrap();
    let said = |terrain: &Terrain, start| refused(terrain, &query(start, (10.0, 10.0))).to_string();
    let degrees = said(&far, (48.77, 9.17));
    assert!(degrees.contains("46.5046N,93.9217W") && degrees.contains("x 512340 to "), "{degrees}");
    assert!(!said(&far, (512_000.0, 9.17)).contains("degrees"), "no longitude");
    assert!(!said(&flat(), (48.77, 9.17)).contains("degrees"), "metres about the origin");
}

#[test]
fn an_end_amid_obstacles_names_the_obstacle_and_one_beside_free_ground_is_snapped() {
    let block = |reach: usize| {
        let obstacle = (0..GRID.cells())
            .map(|i| GRID.cell(i))
            .map(|c| c.row.abs_diff(10) <= reach && c.column.abs_diff(10) <= reach)
            .collect();
        flat().with_obstacles(obstacle)
    };
    let error = refused(&block(3), &query((10.5, 10.5), (2.5, 2.5)));
    let Error::PlaceBlocked { place: Place::Start, reason: Blocked::Obstacle { .. }, .. } = error else {
        panic!("{error}")
    };
    let moved = plan(&block(0), &builtin::husky_a200(), &query((10.1, 10.5), (2.5, 2.5)), Objective::Energy);
    let moved = moved.unwrap();
    assert!(moved.start_snap.distance_m > 0.5, "the answer says how far: {}", moved.start_snap.distance_m);
}

#[test]
fn an_end_on_unknown_or_too_steep_ground_says_so() {
    let mut z = vec![0.0; GRID.cells()];
    for row in 8..13 {
        for column in 8..13 {
            z[GRID.index(Cell { row, column })] = f64::NAN;
        }
    }
    let unknown = refused(&Terrain::new(GRID, &z).unwrap(), &query((2.5, 2.5), (10.5, 10.5)));
    assert!(matches!(
        unknown,
        Error::PlaceBlocked { place: Place::Goal, reason: Blocked::Unknown { .. }, .. }
    ));
    let wall: Vec<f64> = (0..GRID.cells()).map(|i| GRID.cell(i)).map(|c| c.column as f64 * 1.2).collect();
    let steep = refused(&Terrain::new(GRID, &wall).unwrap(), &query((5.5, 5.5), (10.5, 10.5)));
    assert!(steep.to_string().contains("limit"), "{steep}");
}

#[test]
fn a_wall_across_the_map_leaves_no_path_and_the_message_says_where_it_ends() {
    let obstacle = (0..GRID.cells()).map(|i| GRID.cell(i).column == 10).collect();
    let error = refused(&flat().with_obstacles(obstacle), &query((3.5, 10.5), (16.5, 10.5)));
    let Error::NoPath { gap_m, x_m, .. } = error else { panic!("{error}") };
    assert!((7.0..9.0).contains(&gap_m) && (11.0..12.0).contains(&x_m), "{gap_m} m, x {x_m}");
}

#[test]
fn a_surface_that_the_robot_lacks_is_named_with_those_it_has() {
    let terrain = flat().with_surfaces(Surfaces { names: vec!["lava".into()], class: vec![0; GRID.cells()] });
    let error = refused(&terrain, &query((5.5, 5.5), (10.5, 10.5)));
    assert!(error.to_string().contains("lava") && error.to_string().contains("marble"), "{error}");
}

#[test]
fn numbers_out_of_range_name_their_field() {
    let mut fast = query((5.5, 5.5), (10.5, 10.5));
    fast.settings.speed_mps = 50.0;
    assert!(refused(&flat(), &fast).to_string().contains("speed_mps"));
    let mut loose = query((5.5, 5.5), (10.5, 10.5));
    loose.goal.tolerance_m = -1.0;
    assert!(refused(&flat(), &loose).to_string().contains("goal.tolerance_m"));
    let mut nan = query((5.5, 5.5), (10.5, 10.5));
    nan.snap_radius_m = Some(f64::NAN);
    assert!(refused(&flat(), &nan).to_string().contains("snap_radius_m"));
}

#[test]
fn cells_finer_than_the_lattice_can_turn_on_are_refused_with_the_size_that_works() {
    let grid = Grid { rows: 30, columns: 30, cell_size_m: 0.01, origin_m: [0.0, 0.0] };
    let terrain = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap();
    let mut wide = builtin::husky_a200();
    wide.slip_track_m = 5.0;
    let error = plan(&terrain, &wide, &query((0.1, 0.1), (0.2, 0.2)), Objective::Energy).unwrap_err();
    assert!(matches!(error, Error::CellsTooFine { .. }), "{error}");
    let mut long = builtin::husky_a200();
    long.wheelbase_m = 10.0;
    let error = plan(&terrain, &long, &query((0.1, 0.1), (0.2, 0.2)), Objective::Energy).unwrap_err();
    assert!(error.to_string().contains("resample"), "{error}");
}

#[test]
fn a_deadline_in_the_past_stops_a_long_search() {
    let grid = Grid { rows: 120, columns: 120, ..GRID };
    let terrain = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap();
    let mut long = query((5.5, 5.5), (115.5, 80.5));
    long.patience = Patience::until(Instant::now() - Duration::from_secs(1));
    assert!(matches!(refused(&terrain, &long), Error::Timeout { .. }));
}

/// Level ground with an elevation by column.
fn by_column(height_m: impl Fn(usize) -> f64) -> Terrain {
    let z: Vec<f64> = (0..GRID.cells()).map(|i| height_m(GRID.cell(i).column)).collect();
    Terrain::new(GRID, &z).unwrap()
}

#[test]
fn a_side_force_limit_that_forbids_every_path_is_named_with_its_value_and_the_force_needed() {
    let question = query((3.5, 10.5), (16.5, 10.5));
    let mut robot = builtin::husky_a200();
    robot.limits.max_side_force_n = None;
    let free = plan(&flat(), &robot, &question, Objective::Energy).unwrap();
    robot.limits.max_side_force_n = Some(5.0);
    for objective in [Objective::Energy, Objective::Distance, Objective::Time] {
        let error = plan(&flat(), &robot, &question, objective).unwrap_err();
        let Error::NoPath { hindrance: Hindrance::OneLimit { limit, allowed, needed }, .. } = error else {
            panic!("{error}")
        };
        assert_eq!((limit, allowed), (Limit::SideForce, 5.0));
        // A straight on level ground: rolling resistance, which both sides share.
        let rolling_n = robot.surface("marble").unwrap().mu_roll * robot.mass_kg * 9.81;
        assert!((0.4 * rolling_n..0.7 * rolling_n).contains(&needed), "{needed} N of {rolling_n} N");
        let message = error.to_string();
        assert!(message.contains("max_side_force_n is 5.0 N") && !message.contains("slope"), "{message}");
    }
    assert!(free.route.total.length_m > 12.0);
    assert!(
        Planner::new(&flat(), &robot, question.settings)
            .unwrap()
            .compare(&question)
            .is_err_and(|error| matches!(error, Error::NoPath { hindrance: Hindrance::OneLimit { .. }, .. }))
    );
}

#[test]
fn a_side_force_limit_that_only_forbids_turning_is_not_taken_for_want_of_room() {
    let mut question = query((10.5, 10.5), (10.5, 10.5));
    (question.start.heading_rad, question.goal.heading_rad) = (Some(0.0), Some(1.5));
    let mut robot = builtin::husky_a200();
    let rolling_n = robot.surface("marble").unwrap().mu_roll * robot.mass_kg * 9.81;
    robot.limits.max_side_force_n = Some(0.6 * rolling_n);
    let error = plan(&flat(), &robot, &question, Objective::Energy).unwrap_err();
    let Error::NoPath { hindrance: Hindrance::OneLimit { limit: Limit::SideForce, needed, .. }, .. } = error
    else {
        panic!("{error}")
    };
    assert!(needed > 0.6 * rolling_n, "{error}");
}

#[test]
fn a_ridge_that_is_too_steep_names_the_pitch_and_a_wall_blames_no_limit() {
    let ridge = by_column(|column| if column < 10 { 0.0 } else { 2.0 });
    let error = refused(&ridge, &query((3.5, 10.5), (16.5, 10.5)));
    let Error::NoPath { hindrance: Hindrance::OneLimit { limit: Limit::Pitch, allowed, needed }, .. } = error
    else {
        panic!("{error}")
    };
    assert!(needed > allowed && error.to_string().contains("max_pitch_rad"), "{error}");
    let obstacle = (0..GRID.cells()).map(|i| GRID.cell(i).column == 10).collect();
    let error = refused(&flat().with_obstacles(obstacle), &query((3.5, 10.5), (16.5, 10.5)));
    assert!(matches!(error, Error::NoPath { hindrance: Hindrance::Ground, .. }), "{error}");
    assert!(!error.to_string().contains("slope") && error.to_string().contains("wall"), "{error}");
}

#[test]
fn limits_that_forbid_a_path_only_together_are_told_as_several() {
    // A step beyond the pitch limit all across the map, and a side force that allows no motion at all.
    let mut robot = builtin::husky_a200();
    robot.limits.max_side_force_n = Some(5.0);
    let ridge = by_column(|column| if column < 10 { 0.0 } else { 2.0 });
    let error = plan(&ridge, &robot, &query((3.5, 10.5), (16.5, 10.5)), Objective::Energy).unwrap_err();
    assert!(matches!(error, Error::NoPath { hindrance: Hindrance::SeveralLimits, .. }), "{error}");
}

/// Obstacles everywhere but in a pocket of 3 × 3 cells about (6, 10) and east of column 10.
fn pocket() -> Terrain {
    let free =
        |cell: Cell| cell.column >= 10 || (cell.row.abs_diff(10) <= 1 && (5..8).contains(&cell.column));
    let obstacle = (0..GRID.cells()).map(|i| !free(GRID.cell(i))).collect();
    flat().with_obstacles(obstacle)
}

#[test]
fn an_end_is_moved_to_the_nearest_place_that_is_connected_to_the_other_end() {
    let robot = builtin::husky_a200();
    // In the wall, 0.5 m from the pocket and 1.5 m from open ground.
    for (start, goal) in [((8.1, 10.5), (16.5, 10.5)), ((16.5, 10.5), (8.1, 10.5))] {
        let mut question = query(start, goal);
        question.snap_radius_m = Some(3.0);
        let answer = plan(&pocket(), &robot, &question, Objective::Energy).unwrap();
        let moved_m = answer.start_snap.distance_m.max(answer.goal_snap.distance_m);
        assert!((moved_m - 2.4).abs() < 1e-9, "to the centre of column 10, {moved_m} m away");
        // Out of the radius of everything connected, the nearest place is kept and there is no path.
        question.snap_radius_m = Some(2.0);
        let error = plan(&pocket(), &robot, &question, Objective::Energy).unwrap_err();
        assert!(matches!(error, Error::NoPath { .. }), "{error}");
    }
}

#[test]
fn both_ends_move_where_both_lie_in_pockets_and_neither_where_nothing_asks_for_it() {
    let robot = builtin::husky_a200();
    let mut question = query((7.5, 10.5), (16.5, 10.5));
    let error = plan(&pocket(), &robot, &question, Objective::Energy).unwrap_err();
    assert!(matches!(error, Error::NoPath { .. }), "a start where the robot can stand stays: {error}");
    question.snap_radius_m = Some(3.5);
    let answer = plan(&pocket(), &robot, &question, Objective::Energy).unwrap();
    assert!((answer.start_snap.distance_m - 3.0).abs() < 1e-9, "{:?}", answer.start_snap);
    // A second pocket about the goal.
    let mut obstacle = pocket().obstacles().unwrap().to_vec();
    for (i, blocked) in obstacle.iter_mut().enumerate() {
        let cell = GRID.cell(i);
        *blocked |= cell.row.abs_diff(10).max(cell.column.abs_diff(16)) == 2;
    }
    let walled = flat().with_obstacles(obstacle);
    let answer = plan(&walled, &robot, &question, Objective::Energy).unwrap();
    let moved_m = [answer.start_snap.distance_m, answer.goal_snap.distance_m];
    // 1 m out of its pocket to the wall, and 3 m to the cell beyond it; or the goal into the start's ground, which is farther.
    assert!((moved_m[0] - 3.0).abs() < 1e-9 && (moved_m[1] - 3.0).abs() < 1e-9, "{moved_m:?}");
}

#[test]
fn looking_for_a_place_to_stand_keeps_to_the_deadline() {
    let grid = Grid { rows: 400, columns: 400, ..GRID };
    let mut obstacle = vec![true; grid.cells()];
    obstacle[0] = false;
    let terrain = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap().with_obstacles(obstacle);
    let robot = builtin::husky_a200();
    let mut question = query((350.5, 350.5), (10.5, 10.5));
    question.snap_radius_m = Some(1000.0);
    let planner = Planner::new(&terrain, &robot, question.settings).unwrap();
    // 160 000 cells at 256 a look.
    for looks in [0, 10, 500] {
        question.patience = Patience::for_looks(looks);
        let error = planner.plan(&question, Objective::Energy).unwrap_err();
        assert!(matches!(error, Error::Timeout { .. }), "{looks} looks: {error}");
    }
}

#[test]
fn more_surfaces_than_memory_has_room_for_are_refused_with_the_number_that_fits() {
    let grid = Grid { rows: 30, columns: 30, cell_size_m: 0.02, origin_m: [0.0, 0.0] };
    let mut robot = builtin::husky_a200();
    robot.slip_track_m = 5.0;
    let names: Vec<String> = (0..120).map(|i| format!("surface {i}")).collect();
    for name in &names {
        robot.surfaces.insert(name.clone(), robot.surfaces["marble"].clone());
    }
    let surfaces = Surfaces { names, class: vec![0; grid.cells()] };
    let terrain = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap().with_surfaces(surfaces);
    let mut question = query((0.1, 0.1), (0.2, 0.2));
    question.settings.reverse = true;
    let error = plan(&terrain, &robot, &question, Objective::Energy).unwrap_err();
    let Error::TooManySurfaces { surfaces: 121, most, .. } = error else { panic!("{error}") };
    assert!((1..121).contains(&most) && error.to_string().contains("merge classes"), "{error}");
}
