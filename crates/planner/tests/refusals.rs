//! Questions without an answer are refused by name, with the place and the reason.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::time::{Duration, Instant};

use model::builtin;
use planner::{Blocked, Error, Goal, Objective, Patience, Place, Query, Settings, Start, plan};
use terrain::{Cell, Grid, Surfaces, Terrain};

const GRID: Grid = Grid { rows: 20, columns: 20, cell_size_m: 1.0, origin_m: [0.0, 0.0] };

fn flat() -> Terrain {
    Terrain::new(GRID, &vec![0.0; GRID.cells()]).unwrap()
}

fn query(start: (f64, f64), goal: (f64, f64)) -> Query {
    Query {
        start: Start { x_m: start.0, y_m: start.1, heading_rad: None },
        goal: Goal { x_m: goal.0, y_m: goal.1, heading_rad: None, tolerance_m: 0.0 },
        settings: Settings::of(&builtin::husky_a200()),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
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
