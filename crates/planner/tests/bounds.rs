//! The lower bounds that fields grow over are lower bounds, whatever the robot, the way it is driven and the ground.
//!
//! Searches with a loose bound rest on them; what they answer stays what can be driven.
//!
//! `JOULEPATH_BOUND_STEPS=10000000 cargo test --release -p joulepath-planner --test bounds` compares ten million steps.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use model::{Robot, builtin};
use planner::{CostTable, Goal, Lattice, Objective, Patience, Planner, Query, Settings, Start};
use rand::RngExt;
use terrain::{Grid, Terrain, synthetic};

mod ground;
mod whims;

/// Steps that are compared when no other number is asked for.
const STEPS: u64 = 400_000;

/// Share of the steps of a tile that is compared, so that there are many grounds.
const SHARE: f64 = 0.1;

fn steps_wanted() -> u64 {
    std::env::var("JOULEPATH_BOUND_STEPS").map_or(STEPS, |steps| steps.parse().expect("a number of steps"))
}

#[test]
fn no_bound_of_a_step_lies_above_the_cheapest_motion_that_makes_it() {
    let mut random = ground::random(47);
    let (mut compared, mut near, mut below, mut grounds, mut bounded) = (0, 0u64, 0u64, 0, 0);
    let wanted = steps_wanted();
    while compared < wanted {
        let (terrain, robot) = (whims::ground(&mut random), whims::robot(&mut random));
        let settings = whims::settings(&mut random, &robot);
        let objective =
            [Objective::Energy, Objective::Energy, Objective::Distance, Objective::Time][grounds % 4];
        let Ok(lattice) = Lattice::new(&terrain, &robot, settings) else { continue };
        let table = CostTable::lazy(&lattice, objective);
        grounds += 1;
        bounded += usize::from(table.has_bounds());
        if !table.has_bounds() {
            continue;
        }
        for _ in 0..2 {
            let cell = terrain.grid.cell(random.random_range(0..terrain.grid.cells()));
            for step in table.steps_about(cell).into_iter().filter(|_| random.random_bool(SHARE)) {
                let Some(least) = step.least_units else { continue };
                let bound = step.bound_units;
                assert!(
                    bound.is_some_and(|bound| bound <= least),
                    "{bound:?} above {least} units: {step:?} under {objective:?}, {:?}, {settings:?}",
                    robot.name
                );
                compared += 1;
                below += u64::from(bound < Some(least));
                near += u64::from(bound.is_some_and(|bound| f64::from(bound) > 0.9 * f64::from(least)));
            }
        }
    }
    println!("{compared} steps on {bounded} of {grounds} grounds: {below} below, {near} by at most a tenth");
    assert!(4 * bounded > grounds, "bounds on {bounded} of {grounds} grounds");
    assert!(below > 0 && 2 * near > compared, "{near} of {compared} bounds within a tenth of the cost");
}

fn across(terrain: &Terrain, robot: &Robot, bound: f64) -> Query {
    let place = |x: f64, y: f64| terrain.grid.at_fraction_m(x, y);
    let ([x_m, y_m], [goal_x_m, goal_y_m]) = (place(0.1, 0.15), place(0.9, 0.8));
    Query {
        start: Start { x_m, y_m, heading_rad: None },
        goal: Goal { x_m: goal_x_m, y_m: goal_y_m, heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings: Settings::of(robot),
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    }
}

#[test]
fn a_search_with_a_loose_bound_evaluates_a_fraction_of_the_motions_that_the_least_needs() {
    let grid = Grid { rows: 448, columns: 448, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let terrain = Terrain::new(grid, &synthetic::relief(grid, 5, 60.0, 12.0)).unwrap();
    let robot = builtin::husky_a200();
    let tiles_held = |bound: f64| {
        let query = across(&terrain, &robot, bound);
        let planner = Planner::new(&terrain, &robot, query.settings).unwrap();
        let found = planner.plan(&query, Objective::Energy).unwrap();
        assert!(found.search.bound.is_some_and(|proven| proven <= bound.max(1.002)), "{:?}", found.search);
        planner.table(Objective::Energy).tiles_held()
    };
    let (loose, least) = (tiles_held(1.2), tiles_held(1.0));
    assert!(2 * loose < least, "{loose} tiles at 1.2, {least} at 1");
}

#[test]
fn ground_that_bounds_lead_over_and_no_motion_does_is_told_of_as_ever() {
    // Bounds know of grades, not of the force of a side that a climb asks for.
    let grid = Grid { rows: 70, columns: 90, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let z: Vec<f64> =
        (0..grid.cells()).map(|i| 0.45 * (grid.cell(i).column as f64 - 40.0).clamp(0.0, 8.0)).collect();
    let terrain = Terrain::new(grid, &z).unwrap();
    let mut robot = builtin::husky_a200();
    robot.limits.max_side_force_n = Some(70.0);
    let refused = |bound: f64| {
        let query = across(&terrain, &robot, bound);
        let planner = Planner::new(&terrain, &robot, query.settings).unwrap();
        let found = planner.plan(&query, Objective::Energy).map(|plan| plan.route.total);
        let error = format!("{:?}", found.expect_err("the ramp asks for more force"));
        // What the path that may be steeper needs depends on the bound.
        error.split("needed").next().map(str::to_owned)
    };
    assert_eq!(refused(1.5), refused(1.0));
    assert!(refused(1.0).is_some_and(|error| error.contains("NoPath") && error.contains("SideForce")));
}
