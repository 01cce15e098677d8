//! Ground and questions that the tests share.

#![allow(dead_code, clippy::unwrap_used)]

use mission::{Doubt, Question};
use model::{Robot, builtin};
use planner::{Goal, Patience, Planner, Query, Settings, Start};
use terrain::{Grid, Terrain};

/// Ground of 1 m cells whose height is a function of the place.
pub(crate) fn ground(rows: usize, columns: usize, height_m: impl Fn(f64, f64) -> f64) -> Terrain {
    let grid = Grid { rows, columns, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let heights: Vec<f64> = (0..grid.cells())
        .map(|i| {
            let [x_m, y_m] = grid.center_m(grid.cell(i));
            height_m(x_m, y_m)
        })
        .collect();
    Terrain::new(grid, &heights).unwrap()
}

/// Level ground.
pub(crate) fn level(rows: usize, columns: usize) -> Terrain {
    ground(rows, columns, |_, _| 0.0)
}

/// A Husky whose battery has no resistance, one voltage and no Peukert loss: energy is charge.
pub(crate) fn ideal_husky(capacity_wh: f64) -> Robot {
    let mut robot = builtin::husky_a200();
    let battery = robot.battery.as_mut().unwrap();
    battery.capacity_wh = capacity_wh;
    battery.peukert_exponent = 1.0;
    battery.internal_resistance_ohm = Some(0.0);
    battery.full_voltage_v = Some(24.0);
    battery.empty_voltage_v = Some(24.0);
    robot
}

pub(crate) fn planner(terrain: &Terrain, robot: &Robot) -> Planner {
    Planner::new(terrain, robot, Settings::of(robot)).unwrap()
}

/// From the centre of one cell to that of another, eastwards.
pub(crate) fn query(planner: &Planner, from: [f64; 2], to: [f64; 2]) -> Query {
    Query {
        start: Start { x_m: from[0], y_m: from[1], heading_rad: Some(0.0) },
        goal: Goal { x_m: to[0], y_m: to[1], heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings: planner.lattice().settings,
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    }
}

/// A question without any doubt beyond the robot's file, with few draws.
pub(crate) fn question(query: Query) -> Question {
    Question {
        query,
        farthest: false,
        back: false,
        charge: 1.0,
        ambient_c: 20.0,
        doubt: Doubt::NONE,
        samples: 200,
        replanned: 0,
        seed: 1,
    }
}
