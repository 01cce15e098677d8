//! Maps far coarser than the robot: what their cells hide is in the draws, by as much as the fine ground takes.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use mission::{Conditions, Doubt, Drawn, Journey, Spread, draws};
use model::{Robot, builtin, robot::Uncertainty};
use planner::{Goal, Objective, Patience, Planner, Query, Settings, Start};
use terrain::{Terrain, synthetic::coarsened};

const CONDITIONS: Conditions = Conditions { ambient_c: 20.0, motor_c: 20.0, reserve: 0.0 };

/// A Husky about which there is no doubt, with a battery that takes back what descents give.
fn certain_husky() -> Robot {
    let mut robot = builtin::husky_a200();
    robot.uncertainty =
        Uncertainty { mu_roll: 0.0, mu_skid: 0.0, k1: 0.0, k2: 0.0, mass_kg: 0.0, hotel_power_w: 0.0 };
    let battery = robot.battery.as_mut().unwrap();
    (battery.capacity_sigma, battery.charge_sigma) = (0.0, 0.0);
    robot
}

/// Energy over the shortest way between two places in a row, over draws [J]; `None` where there is no way.
fn energy_j(
    terrain: &Terrain,
    robot: &Robot,
    (from_m, to_m): ([f64; 2], [f64; 2]),
    doubt: &Doubt,
) -> Option<Spread> {
    let planner = Planner::new(terrain, robot, Settings::of(robot)).unwrap();
    let query = Query {
        start: Start { x_m: from_m[0], y_m: from_m[1], heading_rad: None },
        goal: Goal { x_m: to_m[0], y_m: to_m[1], heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings: planner.lattice().settings,
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    };
    let route = planner.plan(&query, Objective::Distance).ok()?.route;
    let lattice = planner.lattice();
    let mut journey = Journey::new(lattice.settings.power_model);
    journey.drive_route(lattice, &route, &planner::surface_names(lattice)).unwrap();
    let battery = robot.battery.as_ref().unwrap();
    let drawn = Drawn { robot, battery, charge: 0.8, doubt, seed: 3 };
    let outcomes = draws(&journey, &drawn, &CONDITIONS, 200, &Patience::default()).unwrap();
    Some(Spread::of(outcomes.iter().map(|outcome| outcome.energy_j).collect()))
}

#[test]
fn draws_over_coarse_cells_hold_what_the_fine_ground_takes_and_without_that_doubt_they_do_not() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../maps/minnesota.tif");
    let fine = terrain::io::read_path(&path).unwrap();
    let coarse = coarsened(&fine, 20).unwrap();
    let robot = certain_husky();
    let relief = Doubt { hidden_relief: true, ..Doubt::NONE };
    let [west_m, south_m] = fine.grid.origin_m;
    let (mut asked, mut held, mut held_without) = (0, 0, 0);
    for row in (2..18).step_by(3) {
        for is_east in [true, false] {
            let y_m = south_m + 20.0 * row as f64 + 10.0;
            let mut ends_m = [[west_m + 50.0, y_m], [west_m + 350.0, y_m]];
            if !is_east {
                ends_m.reverse();
            }
            let way = (ends_m[0], ends_m[1]);
            let told = energy_j(&coarse, &robot, way, &relief);
            let Some((told, took)) = told.zip(energy_j(&fine, &robot, way, &relief)) else { continue };
            assert!(took.p05 == took.p95, "cells of a metre hide nothing from a robot of this size");
            let without = energy_j(&coarse, &robot, way, &Doubt::NONE).unwrap();
            assert!(without.p05 == without.p95 && told.p05 > without.p05, "{told:?} {without:?}");
            println!("row {row}: {:.0} to {:.0} J, took {:.0} J", told.p05, told.p95, took.p50);
            asked += 1;
            held += usize::from((told.p05..=told.p95).contains(&took.p50));
            held_without += usize::from((without.p05..=without.p95).contains(&took.p50));
        }
    }
    assert!(
        asked >= 8 && held * 4 >= asked * 3,
        "{held} of {asked} intervals hold what the fine ground takes"
    );
    assert_eq!(held_without, 0);
}
