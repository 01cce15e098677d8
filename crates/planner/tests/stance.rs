//! What the robot feels of ground that is smaller than itself.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use model::{Robot, STANDARD_GRAVITY_MPS2, builtin};
use planner::{
    Error, Goal, Heading, Hindrance, Lattice, Limit, Objective, Patience, Plan, Query, Settings, Start,
    State, plan,
};
use rand::RngExt;
use terrain::{Cell, Grid, Terrain};

mod ground;

const CELL_M: f64 = 0.05;

/// Ground of 8 m by 4 m.
fn ground_of(cell_size_m: f64, height_m: impl FnMut([f64; 2]) -> f64) -> Terrain {
    let across = |length_m: f64| (length_m / cell_size_m).round() as usize;
    let grid = Grid { rows: across(4.0), columns: across(8.0), cell_size_m, origin_m: [0.0, 0.0] };
    let places = (0..grid.cells()).map(|i| grid.center_m(grid.cell(i)));
    let z: Vec<f64> = places.map(height_m).collect();
    Terrain::new(grid, &z).unwrap()
}

/// From west to east along the middle.
fn along(terrain: &Terrain, robot: &Robot, y_m: f64) -> Result<Plan, Error> {
    let query = Query {
        start: Start { x_m: 1.0, y_m, heading_rad: Some(0.0) },
        goal: Goal { x_m: 7.0, y_m, heading_rad: Some(0.0), either_way: false, tolerance_m: 0.0 },
        settings: Settings::of(robot),
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    };
    plan(terrain, robot, &query, Objective::Energy)
}

fn husky() -> Robot {
    let mut robot = builtin::husky_a200();
    robot.motors.regeneration = 0.0;
    robot
}

#[test]
fn a_robot_does_not_drive_along_the_top_of_a_wall_narrower_than_its_track() {
    let wall =
        |width_m: f64| ground_of(0.1, move |[_, y]| if (y - 2.0).abs() < width_m / 2.0 { 2.0 } else { 0.0 });
    assert!(along(&wall(0.3), &husky(), 2.05).is_err());
    assert!(along(&wall(1.5), &husky(), 2.05).is_ok(), "a dam is a road");
}

#[test]
fn a_slot_of_heights_alone_lets_through_what_fits() {
    // The outline is 0.705 m wide.
    let slot = |width_m: f64| {
        ground_of(CELL_M, move |[x, y]| {
            let in_slot = (y - 2.025).abs() < width_m / 2.0;
            if (3.0..5.0).contains(&x) && !in_slot { 1.0 } else { 0.0 }
        })
    };
    assert!(matches!(along(&slot(0.6), &husky(), 2.025), Err(Error::NoPath { .. })));
    assert!(along(&slot(0.9), &husky(), 2.025).is_ok());
}

#[test]
fn ground_between_the_wheels_may_rise_by_the_clearance() {
    // A sleeper across the whole corridor between two walls, 0.2 m wide: no way around, and the wheels pass to either side.
    let ridge =
        |height_m: f64| ground_of(CELL_M, move |[_, y]| if (y - 2.025).abs() < 0.1 { height_m } else { 0.0 });
    let reaches = |height_m: f64, clearance_m: f64| {
        let mut robot = husky();
        robot.ground_clearance_m = Some(clearance_m);
        along(&ridge(height_m), &robot, 2.025).is_ok()
    };
    assert!(reaches(0.10, 0.13));
    assert!(!reaches(0.16, 0.13), "it would have to leave the ridge to start with");
    assert!(!reaches(0.10, 0.055));
}

#[test]
fn where_only_the_clearance_forbids_a_way_the_answer_says_what_would_do() {
    // A sleeper from border to border, lower than a wheel climbs and higher than the body is off the ground.
    let sleeper = ground_of(CELL_M, |[x, _]| if (x - 4.0).abs() < 0.06 { 0.09 } else { 0.0 });
    let error = along(&sleeper, &husky(), 2.025).unwrap_err();
    let Error::NoPath { hindrance: Hindrance::OneLimit { limit: Limit::Clearance, allowed, needed }, .. } =
        error
    else {
        panic!("{error}")
    };
    assert!(allowed == 0.055 && (0.055..0.0901).contains(&needed), "{allowed} {needed}");
    let mut raised = husky();
    raised.ground_clearance_m = Some(needed + 1e-3);
    assert!(along(&sleeper, &raised, 2.025).is_ok());
}

#[test]
fn a_kerb_of_five_centimetres_stays_a_kerb() {
    let kerb = ground_of(CELL_M, |[x, _]| if x > 4.0 { 0.05 } else { 0.0 });
    let level = ground_of(CELL_M, |_| 0.0);
    let robot = husky();
    let (up, flat) = (along(&kerb, &robot, 2.025).unwrap(), along(&level, &robot, 2.025).unwrap());
    assert!((up.route.total.climb_m - 0.05).abs() < 1e-3, "{}", up.route.total.climb_m);
    let lifted_j = robot.mass_kg * STANDARD_GRAVITY_MPS2 * 0.05;
    assert!(up.route.total.energy_j > flat.route.total.energy_j + lifted_j);
    let steepest = up.route.steps.iter().map(|s| s.stance_pitch_rad()).fold(0.0, f64::max);
    assert!(
        (steepest - (0.05f64 / 0.54).atan()).abs() < 0.01,
        "on the kerb with the front wheels: {steepest}"
    );
}

#[test]
fn a_centimetre_of_noise_adds_less_than_a_tenth() {
    let mut random = ground::random(46);
    let noisy = ground_of(CELL_M, |_| {
        // Twelve uniform numbers make a normal.
        0.01 * ((0..12).map(|_| random.random_range(0.0..1.0)).sum::<f64>() - 6.0)
    });
    let level = ground_of(CELL_M, |_| 0.0);
    let energy_j = |terrain: &Terrain| along(terrain, &husky(), 2.025).unwrap().route.total.energy_j;
    let ratio = energy_j(&noisy) / energy_j(&level);
    assert!((0.9..1.1).contains(&ratio), "{ratio} times that of level ground");
}

#[test]
fn a_slope_beside_unknown_ground_and_the_border_is_what_it_is() {
    for grade in [0.3, 0.7] {
        for void in [false, true] {
            let terrain =
                ground_of(1.0, |[_, y]| if void && (2.0..3.0).contains(&y) { f64::NAN } else { grade * y });
            // Across the slope, in the row beside the void and in that at the border.
            let planned = along(&terrain, &husky(), 1.5);
            assert_eq!(planned.is_ok(), grade < 0.45f64.tan(), "{grade}: the limit of roll is 0.45 rad");
            let lattice = Lattice::new(&terrain, &husky(), Settings::of(&husky())).unwrap();
            for heading in Heading::all() {
                let (pitch_rad, roll_rad) =
                    lattice.tilt_rad(State { cell: Cell { row: 1, column: 3 }, heading });
                let (sin, cos) = heading.angle_rad().sin_cos();
                assert!((pitch_rad.tan() - grade * sin).abs() < 1e-4, "{pitch_rad}");
                assert!((roll_rad.tan() - grade * cos).abs() < 1e-4, "{roll_rad}");
            }
        }
    }
}

#[test]
fn where_the_body_touches_the_ground_the_answer_says_so() {
    let stone = ground_of(CELL_M, |[x, y]| if (x - 1.0).hypot(y - 2.025) < 0.12 { 0.2 } else { 0.0 });
    let robot = husky();
    let error = along(&stone, &robot, 2.025).unwrap_err().to_string();
    assert!(error.contains("ground_clearance_m") && error.contains("0.055"), "{error}");
}
