//! What areas, prices and bans do to a path, by looking at the path alone.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::needless_pass_by_value)]

use std::f64::consts::PI;

use model::{Robot, builtin};
use planner::{
    Blocked, Error, Footprint, Goal, Objective, Patience, Plan, Prices, Query, Settings, Start, plan,
};
use serde_json::{Value, json};
use terrain::{Grid, Terrain, areas::Areas};

const SIDE_M: f64 = 20.0;

/// Level ground with areas.
fn level(features: Value) -> Terrain {
    let grid = Grid { rows: 40, columns: 40, cell_size_m: 0.5, origin_m: [0.0, 0.0] };
    let terrain = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap();
    let areas = Areas::of(&json!({"type": "FeatureCollection", "features": features}), &terrain).unwrap();
    terrain.with_areas(areas)
}

fn rectangle([west, south, east, north]: [f64; 4], properties: Value) -> Value {
    json!({"type": "Feature", "properties": properties, "geometry": {"type": "Polygon", "coordinates":
        [[[west, south], [east, south], [east, north], [west, north], [west, south]]]}})
}

fn husky() -> Robot {
    Robot { hotel_power_w: 20.0, ..builtin::husky_a200() }
}

fn settings() -> Settings {
    Settings::of(&husky())
}

/// A path from west to east, or as its ends say.
fn planned(
    terrain: &Terrain,
    [start, goal]: [[f64; 2]; 2],
    settings: Settings,
    refine: bool,
) -> Result<Plan, Error> {
    let query = Query {
        start: Start { x_m: start[0], y_m: start[1], heading_rad: Some(0.0) },
        goal: Goal { x_m: goal[0], y_m: goal[1], heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings,
        other_goals: Vec::new(),
        snap_radius_m: Some(0.0),
        bound: 1.0,
        refine,
        exact_ends: false,
        patience: Patience::default(),
    };
    plan(terrain, &husky(), &query, Objective::Energy)
}

const ACROSS: [[f64; 2]; 2] = [[2.25, 10.25], [17.75, 10.25]];

/// Both forms of a path.
fn routes(plan: &Plan) -> Vec<&planner::Route> {
    plan.routes().collect()
}

#[test]
fn no_part_of_the_robot_enters_a_keep_out_nor_crosses_a_fence() {
    let fence = json!({"type": "Feature", "properties": {"keep_out": true},
        "geometry": {"type": "LineString", "coordinates": [[12.0, 20.0], [12.0, 4.0]]}});
    let terrain = level(json!([rectangle([7.0, 0.0, 8.0, 14.0], json!({"keep_out": true})), fence]));
    let found = planned(&terrain, ACROSS, settings(), true).unwrap();
    let outline = Footprint::of(&husky());
    for route in routes(&found) {
        assert!(route.total.length_m > 20.0, "{}", route.total.length_m);
        for pose in &route.poses {
            let (sin, cos) = pose.heading_rad.sin_cos();
            for (front, left) in [(0.5, 0.5), (0.5, -0.5), (-0.5, 0.5), (-0.5, -0.5)] {
                let (ahead, aside) = (front * outline.length_m, left * outline.width_m);
                let x = pose.x_m + ahead * cos - aside * sin;
                let y = pose.y_m + ahead * sin + aside * cos;
                assert!(!(x > 7.0 && x < 8.0 && y < 14.0), "{x}, {y} is within the keep-out");
            }
        }
        let crossed =
            route.poses.windows(2).find(|pair| (pair[0].x_m < 12.0) != (pair[1].x_m < 12.0)).unwrap();
        assert!(crossed[0].y_m < 4.0, "the fence was crossed at {}", crossed[0].y_m);
    }
}

#[test]
fn an_end_in_a_keep_out_is_told_from_one_at_an_obstacle() {
    let terrain = level(json!([rectangle([16.0, 8.0, 19.0, 12.0], json!({"keep_out": true}))]));
    match planned(&terrain, ACROSS, settings(), false) {
        Err(Error::PlaceBlocked { reason: Blocked::KeepOut { .. }, .. }) => {}
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_speed_limit_holds_where_it_lies_and_only_there() {
    let terrain = level(json!([rectangle([8.0, 0.0, 12.0, 20.0], json!({"max_speed_mps": 0.2}))]));
    let found = planned(&terrain, ACROSS, settings(), true).unwrap();
    for route in routes(&found) {
        for (pair, step) in route.poses.windows(2).zip(&route.steps) {
            let middle_m = (pair[0].x_m + pair[1].x_m) / 2.0;
            let expected_mps = if (8.0..12.0).contains(&middle_m) { 0.2 } else { 0.5 };
            let is_beside = [8.0, 12.0].iter().any(|edge: &f64| (edge - middle_m).abs() < 0.3);
            assert!(
                is_beside || (step.motion.speed_mps - expected_mps).abs() < 1e-9,
                "{middle_m}: {:?}",
                step.motion
            );
        }
        let driven_s = 4.0 / 0.2 + 11.5 / 0.5;
        // Half a step at either edge counts by the cell under its middle.
        assert!(
            (route.total.duration_s - driven_s).abs() < 2.0 * 0.5 * (1.0 / 0.2 - 1.0 / 0.5),
            "{} for {driven_s}",
            route.total.duration_s
        );
    }
}

#[test]
fn a_cost_factor_makes_a_detour_and_energy_stays_what_is_drawn() {
    // Straight through are 4 m of the area; around its end are some 6 m more.
    let with = |factor: f64| {
        let area = rectangle([8.0, 0.0, 12.0, 13.0], json!({"cost_factor": factor}));
        planned(&level(json!([area])), ACROSS, settings(), true).unwrap()
    };
    let enters = |plan: &Plan| plan.route.poses.iter().any(|p| p.x_m > 8.3 && p.x_m < 11.7 && p.y_m < 12.7);
    let (dear, cheap) = (with(4.0), with(1.05));
    assert!(!enters(&dear) && enters(&cheap));
    for plan in [&dear, &cheap] {
        for route in routes(plan) {
            let drawn_j: f64 = route.steps.iter().map(|step| step.bus_w * step.duration_s).sum();
            assert!((route.total.energy_j - drawn_j).abs() < 1e-6 * drawn_j);
        }
    }
    let inside_j: f64 = cheap
        .route
        .steps
        .iter()
        .zip(cheap.route.poses.windows(2))
        .filter_map(|(step, pair)| {
            let middle = (pair[0].x_m + pair[1].x_m) / 2.0;
            (8.0..12.0).contains(&middle).then(|| step.energy_j())
        })
        .sum();
    let added_j = cheap.route.total.surcharge.j;
    assert!((added_j - 0.05 * inside_j).abs() < 0.02 * inside_j, "{added_j} of {inside_j} J");
}

#[test]
fn a_one_way_is_driven_its_way_only() {
    let through = |way_rad: f64| {
        let area = rectangle([8.0, 6.0, 12.0, 20.0], json!({"one_way_rad": way_rad}));
        planned(&level(json!([area])), ACROSS, settings(), true).unwrap()
    };
    let (with_it, against) = (through(0.0), through(PI));
    assert!((with_it.route.total.length_m - 15.5).abs() < 0.1);
    for route in routes(&against) {
        for (pair, step) in route.poses.windows(2).zip(&route.steps) {
            let [x, y] = [(pair[0].x_m + pair[1].x_m) / 2.0, (pair[0].y_m + pair[1].y_m) / 2.0];
            let is_inside = x > 8.3 && x < 11.7 && y > 6.3 && y < SIDE_M;
            let goes_east = pair[1].x_m - pair[0].x_m > 1e-9;
            assert!(!(is_inside && goes_east && step.length_m > 0.0), "{x}, {y} against the way");
        }
    }
}

#[test]
fn bans_hold_on_the_lattice_and_off_it() {
    let terrain = level(json!([rectangle([9.0, 0.0, 10.0, 14.0], json!({"keep_out": true}))]));
    for (changed, least_m) in [
        (Settings { spin: false, ..settings() }, husky().slip_track_m / 2.0),
        (Settings { least_radius_m: 1.5, ..settings() }, 1.5),
        (Settings { least_radius_m: 1.5, reverse: true, ..settings() }, 1.5),
    ] {
        let found = planned(&terrain, [[2.25, 10.25], [17.75, 3.25]], changed, true).unwrap();
        for route in routes(&found) {
            for radius_m in route.poses.iter().filter_map(|pose| pose.radius_m) {
                assert!(radius_m.abs() >= least_m * (1.0 - 1e-9), "{radius_m} with {changed:?}");
            }
        }
    }
    let wide = Settings { least_radius_m: 1e4, ..settings() };
    match planned(&terrain, ACROSS, wide, false) {
        Err(Error::OutOfRange { field: "least_radius_m", .. }) => {}
        other => panic!("{other:?}"),
    }
}

#[test]
fn prices_buy_off_turns_on_the_spot_and_reversing() {
    let goal_behind = [[10.25, 10.25], [6.25, 10.25]];
    let spun_rad = |plan: &Plan| -> f64 {
        plan.route
            .steps
            .iter()
            .filter(|s| s.length_m == 0.0)
            .map(|s| s.motion.yaw_rate_radps.abs() * s.duration_s)
            .sum()
    };
    let backed_m = |plan: &Plan| -> f64 {
        plan.route.steps.iter().filter(|s| s.motion.speed_mps < 0.0).map(|s| s.length_m).sum()
    };
    let with = |prices: Prices, reverse: bool| {
        planned(&level(json!([])), goal_behind, Settings { prices, reverse, ..settings() }, false).unwrap()
    };
    let free = with(Prices::default(), true);
    assert!(backed_m(&free) > 3.9 && spun_rad(&free) == 0.0, "backing up is cheapest");
    let no_backing = with(Prices { reverse_j_per_m: 1000.0, ..Prices::default() }, true);
    assert!(backed_m(&no_backing) < 0.6 && spun_rad(&no_backing) > 0.0);
    let neither = with(Prices { reverse_j_per_m: 1000.0, spin_j_per_rad: 5000.0, ..Prices::default() }, true);
    assert!(spun_rad(&neither) == 0.0 && backed_m(&neither) < 2.0, "{} m", backed_m(&neither));
    match planned(
        &level(json!([])),
        goal_behind,
        Settings { prices: Prices { spin_j_per_rad: -1.0, ..Prices::default() }, ..settings() },
        false,
    ) {
        Err(Error::OutOfRange { field: "prices.spin_j_per_rad", .. }) => {}
        other => panic!("{other:?}"),
    }
}
