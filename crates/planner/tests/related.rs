//! What one planner has worked out serves another that drives at another speed, with another load or standing power: as a lower bound, and in
//! answers whose bound is true.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::sync::Arc;

use model::{Robot, builtin};
use planner::{Error, Heading, Lattice, Objective, Patience, Planner, Relation, Settings, State};
use rand::{Rng, RngExt};
use terrain::{Grid, Terrain, synthetic};

mod ground;
mod whims;

/// The same robot and way of driving with another load, standing power and speed, some or all of them.
fn changed(random: &mut impl Rng, robot: &Robot, settings: Settings) -> (Robot, Settings) {
    let mut robot = robot.clone();
    let mut settings = settings;
    let which = random.random_range(1..8);
    if which & 1 == 1 {
        // Down to where wheels hardly turn, whose rolling resistance goes with their speed.
        let factor = if random.random_bool(0.2) { 0.001 } else { random.random_range(0.5..2.0) };
        settings.speed_mps = (settings.speed_mps * factor).clamp(0.001, robot.max_wheel_speed_mps);
    }
    if which & 2 == 2 {
        robot.mass_kg *= random.random_range(0.6..1.6);
    }
    if which & 4 == 4 {
        robot.hotel_power_w = random.random_range(0.0..80.0);
    }
    (robot, settings)
}

fn some_change(random: &mut impl Rng) -> (Terrain, [(Robot, Settings); 2]) {
    let (terrain, mut robot) = (whims::ground(random), whims::robot(random));
    if random.random_bool(0.7) {
        // With mechanisms there is no relation.
        robot.mechanisms.clear();
    }
    if random.random_bool(0.3) {
        // Motors that lose nothing, one of which gears down more than the other: what wheels are spared is spared to the full.
        (robot.motors.left.k1_w_per_n2, robot.motors.right.k1_w_per_n2) = (0.0, 0.0);
        (robot.motors.left.k2, robot.motors.right.k2) = (1.0, random.random_range(1.0..3.0));
        robot.hotel_power_w = random.random_range(0.0..1.0);
        robot.drive_electronics_w = 0.0;
    }
    let mut settings = whims::settings(random, &robot);
    if random.random_bool(0.8) {
        settings.power_model = model::PowerModel::default();
    }
    if random.random_bool(0.2) {
        // Arcs on whose inner side the wheels nearly stand.
        settings.least_radius_m =
            robot.half_slip_track_m() * (1.0 + 10f64.powf(random.random_range(-4.0..0.0)));
    }
    let other = changed(random, &robot, settings);
    (terrain, [(robot, settings), other])
}

#[test]
fn no_motion_costs_less_than_what_its_cost_under_another_load_or_speed_proves() {
    let mut random = ground::random(147);
    let (mut compared, mut related, mut near) = (0u64, 0, 0u64);
    for round in 0..200 {
        let (terrain, [known, wanted]) = some_change(&mut random);
        let lattice = |(robot, settings): &(Robot, Settings)| Lattice::new(&terrain, robot, *settings);
        let (Ok(known), Ok(wanted)) = (lattice(&known), lattice(&wanted)) else { continue };
        let objective =
            [Objective::Energy, Objective::Energy, Objective::Time, Objective::Distance][round % 4];
        let Some(Relation { share, per_m }) = Relation::between(&known, &wanted, objective) else { continue };
        related += 1;
        for _ in 0..1500 {
            let cell = terrain.grid.cell(random.random_range(0..terrain.grid.cells()));
            let state = State { cell, heading: Heading::new(random.random_range(0..16)) };
            let motion = random.random_range(0..known.motions_per_state());
            let Some(end) = known.successor(state, motion) else { continue };
            let [[x, y], [end_x, end_y]] = [cell, end.cell].map(|cell| terrain.grid.center_m(cell));
            let apart_m = (end_x - x).hypot(end_y - y);
            let variants = known.variants(cell, state.heading, motion);
            for (before, after) in variants.zip(wanted.variants(cell, state.heading, motion)) {
                let Some(after) = after else { continue };
                let before = before.expect("what drives now could be driven before");
                let cost = |lattice: &Lattice, edge| {
                    let lifted_j = lattice.potential_j(end.cell) - lattice.potential_j(cell);
                    objective.compared(edge) - if objective == Objective::Energy { lifted_j } else { 0.0 }
                };
                let (cost, known_cost) = (cost(&wanted, &after), cost(&known, &before));
                let proven = share * known_cost + per_m * apart_m;
                assert!(
                    proven <= cost + 1e-9 * (cost.abs() + 1.0),
                    "{proven} above {cost} under {objective:?}: {share}, {per_m}"
                );
                compared += 1;
                near += u64::from(proven > 0.8 * cost);
            }
        }
    }
    println!("{compared} motions on {related} grounds, {near} within a fifth");
    assert!(related > 30 && compared > 20_000, "{compared} motions on {related} grounds");
    assert!(2 * near > compared, "{near} of {compared} within a fifth");
}

#[test]
fn answers_by_another_planners_field_keep_the_bound_that_they_state() {
    let mut random = ground::random(148);
    let (mut answered, mut helped) = (0, 0);
    while answered < 60 {
        let terrain = ground::small_terrain(&mut random, 40);
        let robot = ground::some_robot(&mut random, [0.0, 0.5, 1.0][answered % 3]);
        let mut query = ground::some_query(&mut random, &terrain, &robot);
        let objective =
            [Objective::Energy, Objective::Energy, Objective::Distance, Objective::Time][answered % 4];
        let (other_robot, other_settings) = changed(&mut random, &robot, query.settings);
        let Ok(known) = Planner::new(&terrain, &robot, query.settings) else { continue };
        let [beside, alone] = [(); 2].map(|()| Planner::new(&terrain, &other_robot, other_settings).unwrap());
        let (known, beside) = (Arc::new(known), Arc::new(beside));
        beside.relate(&known);
        query.bound = [1.0, 1.05, 1.2][answered % 3];
        let first = known.plan(&query, objective);
        query.settings = other_settings;
        query.bound = [1.05, 1.2][answered % 2];
        let found = beside.plan(&query, objective);
        query.bound = 1.0;
        let best = alone.plan(&query, objective);
        match (found, best) {
            (Ok(found), Ok(best)) => {
                answered += 1;
                let relation = Relation::between(known.lattice(), beside.lattice(), objective);
                helped += usize::from(first.is_ok() && relation.is_some());
                let [amount, least] = [&found, &best].map(|plan| objective.compared(&plan.route.total));
                assert!(
                    amount - found.search.excess <= least + 1e-6 * least.abs(),
                    "{amount} less {} above {least}",
                    found.search.excess
                );
                assert!(!found.search.timed_out);
            }
            (Err(Error::NoPath { .. } | Error::NoRoomToTurn { .. }), Err(_)) => {}
            (Err(found), Err(best)) => assert_eq!(found.to_string(), best.to_string()),
            (found, best) => panic!("{found:?} beside, {best:?} alone"),
        }
    }
    assert!(2 * helped > answered, "{helped} of {answered} answers had another planner's field");
}

#[test]
fn a_change_of_speed_load_or_standing_power_takes_no_field_of_its_own() {
    let grid = Grid { rows: 448, columns: 448, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let terrain = Terrain::new(grid, &synthetic::relief(grid, 5, 60.0, 12.0)).unwrap();
    let robot = builtin::by_name("husky-a200-field").unwrap();
    let mut query = ground::some_query(&mut ground::random(1), &terrain, &robot);
    let [x_m, y_m] = grid.at_fraction_m(0.1, 0.15);
    let [goal_x_m, goal_y_m] = grid.at_fraction_m(0.9, 0.8);
    (query.start.x_m, query.start.y_m, query.goal.x_m, query.goal.y_m) = (x_m, y_m, goal_x_m, goal_y_m);
    query.settings = Settings::of(&robot);
    let first = Arc::new(Planner::new(&terrain, &robot, query.settings).unwrap());
    first.plan(&query, Objective::Energy).unwrap();
    let faster = Settings { speed_mps: 1.1 * query.settings.speed_mps, ..query.settings };
    let loaded = Robot { mass_kg: robot.mass_kg + 10.0, ..robot.clone() };
    let busy = Robot { hotel_power_w: robot.hotel_power_w + 20.0, ..robot.clone() };
    let other_ground = Robot { default_surface: "marble".into(), ..robot.clone() };
    query.bound = 1.05;
    let mut work_beside = |robot: &Robot, settings, beside: bool| {
        let (patience, meter) = Patience::default().metered();
        (query.settings, query.patience) = (settings, patience);
        let planner = Arc::new(Planner::new(&terrain, robot, settings).unwrap());
        if beside {
            planner.relate(&first);
        }
        let found = planner.plan(&query, Objective::Energy).unwrap();
        assert!(found.search.bound.is_some_and(|bound| bound <= 1.05), "{:?}", found.search);
        meter.total()
    };
    let usual = Settings::of(&robot);
    let alone = work_beside(&robot, faster, false);
    for (robot, settings) in [(&robot, faster), (&loaded, usual), (&busy, usual)] {
        let beside = work_beside(robot, settings, true);
        assert!(4 * beside < alone, "{beside} beside, {alone} alone");
    }
    let elsewhere = work_beside(&other_ground, usual, true);
    assert!(2 * elsewhere > alone, "{elsewhere} on other ground, {alone} alone");
}

#[test]
fn wheels_that_hardly_turn_prove_nothing_of_others() {
    // Rolling resistance sets in over some millimetres a second, so that a robot that creeps takes less over the same ground.
    let grid = Grid { rows: 24, columns: 24, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let terrain = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap();
    let mut robot = builtin::husky_a200();
    (robot.motors.left.k1_w_per_n2, robot.motors.right.k1_w_per_n2) = (0.0, 0.0);
    (robot.motors.left.k2, robot.motors.right.k2) = (1.0, 3.0);
    let usual = Settings::of(&robot);
    let lattice = |speed_mps: f64| Lattice::new(&terrain, &robot, Settings { speed_mps, ..usual }).unwrap();
    let relation = |speed_mps| Relation::between(&lattice(0.5), &lattice(speed_mps), Objective::Energy);
    assert_eq!(relation(0.001), None);
    assert!(relation(0.1).is_some_and(|relation| relation.share > 0.5));
}

#[test]
fn no_search_is_made_twice_where_there_is_no_room_to_turn() {
    // A passage through a wall with two bends that are too tight for the least radius.
    let grid = Grid { rows: 90, columns: 90, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let passes = |row: usize, column: usize| match column {
        40..45 => (44..47).contains(&row),
        45..48 => (44..57).contains(&row),
        48..55 => (54..57).contains(&row),
        _ => true,
    };
    let z: Vec<f64> = (0..grid.cells())
        .map(|i| if passes(grid.cell(i).row, grid.cell(i).column) { 0.0 } else { f64::NAN })
        .collect();
    let terrain = Terrain::new(grid, &z).unwrap();
    let robot = builtin::husky_a200();
    let mut query = ground::some_query(&mut ground::random(1), &terrain, &robot);
    query.settings = Settings { least_radius_m: 6.0, ..Settings::of(&robot) };
    ([query.start.x_m, query.start.y_m], [query.goal.x_m, query.goal.y_m]) =
        (grid.at_fraction_m(0.15, 0.3), grid.at_fraction_m(0.85, 0.7));
    (query.start.heading_rad, query.goal.heading_rad, query.goal.tolerance_m) = (None, None, 0.0);
    let mut work = |bound: f64| {
        let (patience, meter) = Patience::default().metered();
        (query.bound, query.patience) = (bound, patience);
        let found = Planner::new(&terrain, &robot, query.settings).unwrap().plan(&query, Objective::Energy);
        assert!(matches!(found, Err(Error::NoRoomToTurn { .. })), "{found:?}");
        meter.total()
    };
    // Over costs, and over bounds, which take less, and then costs.
    let [once, twice] = [1.0, 1.2].map(&mut work);
    assert!(twice < 2 * once, "{twice} over bounds first, {once} over costs");
}

#[test]
fn a_lighter_robot_that_could_push_up_more_slopes_is_not_led_by_a_heavier_one() {
    let grid = Grid { rows: 24, columns: 24, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let terrain = Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap();
    let mut heavy = builtin::husky_a200();
    let settings = Settings::of(&heavy);
    let light = |heavy: &Robot| Robot { mass_kg: 0.8 * heavy.mass_kg, ..heavy.clone() };
    let relation = |heavy: &Robot| {
        let [known, wanted] =
            [heavy.clone(), light(heavy)].map(|robot| Lattice::new(&terrain, &robot, settings).unwrap());
        Relation::between(&known, &wanted, Objective::Energy)
    };
    assert!(relation(&heavy).is_some_and(|relation| (0.6..=0.8).contains(&relation.share)));
    heavy.limits.max_side_force_n = Some(300.0);
    assert_eq!(relation(&heavy), None);
}

#[test]
fn patience_that_ends_over_a_related_field_leaves_a_timeout() {
    let grid = Grid { rows: 320, columns: 320, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let terrain = Terrain::new(grid, &synthetic::relief(grid, 7, 50.0, 8.0)).unwrap();
    let robot = builtin::husky_a200();
    let mut query = ground::some_query(&mut ground::random(3), &terrain, &robot);
    let first = Arc::new(Planner::new(&terrain, &robot, query.settings).unwrap());
    first.plan(&query, Objective::Energy).unwrap();
    let settings = Settings { speed_mps: 0.9 * query.settings.speed_mps, ..query.settings };
    (query.settings, query.bound) = (settings, 1.2);
    let mut looks = 0;
    loop {
        let (patience, meter) = Patience::for_looks(looks).metered();
        query.patience = patience;
        let planner = Arc::new(Planner::new(&terrain, &robot, settings).unwrap());
        planner.relate(&first);
        match planner.plan(&query, Objective::Energy) {
            Ok(found) if !found.search.timed_out => break,
            Ok(_) | Err(Error::Timeout { .. }) => {}
            Err(other) => panic!("{other:?}"),
        }
        assert!(meter.largest() <= planner::work::MOST_BETWEEN_LOOKS, "{meter:?}");
        looks += 1 + looks / 8;
    }
    assert!(looks > 3, "{looks} looks");
}
