//! What a planner remembers never changes its answers.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeSet;

use model::{Robot, builtin};
use planner::{Heading, Objective, Patience, Planner, Query, plan};
use rand::{Rng, RngExt};
use terrain::{Cell, Patch, Terrain, synthetic};

mod ground;

/// Room for the table's rounding, J.
fn room_j(energy_j: f64) -> f64 {
    1e-3 * energy_j.abs() + 1.0
}

fn to_goal(random: &mut impl Rng, query: &Query, terrain: &Terrain) -> Query {
    let mut next = query.clone();
    let [x_m, y_m] =
        terrain.grid.at_fraction_m(random.random_range(0.05..0.95), random.random_range(0.05..0.95));
    (next.start.x_m, next.start.y_m) = (x_m, y_m);
    next
}

fn energies(planner: &Planner, queries: &[Query]) -> Vec<Option<f64>> {
    queries.iter().map(|q| planner.plan(q, Objective::Energy).ok().map(|p| p.route.total.energy_j)).collect()
}

fn agree(found: &[Option<f64>], fresh: &[Option<f64>]) -> usize {
    for (found, fresh) in found.iter().zip(fresh) {
        match (found, fresh) {
            (Some(a), Some(b)) => assert!((a - b).abs() <= room_j(*b), "{a} J, but afresh {b} J"),
            (a, b) => assert_eq!(a, b, "a path was found only once"),
        }
    }
    fresh.iter().flatten().count()
}

fn fresh(terrain: &Terrain, robot: &Robot, queries: &[Query]) -> Vec<Option<f64>> {
    let one = |q| plan(terrain, robot, q, Objective::Energy).ok().map(|p| p.route.total.energy_j);
    queries.iter().map(one).collect()
}

#[test]
fn kept_fields_held_goals_and_batches_answer_as_a_fresh_planner_does() {
    let mut random = ground::random(50);
    let mut reached = 0;
    for case in 0..12 {
        let terrain = ground::small_terrain(&mut random, 40);
        let robot = ground::some_robot(&mut random, [0.0, 0.5, 1.0][case % 3]);
        let mut first = ground::some_query(&mut random, &terrain, &robot);
        first.settings.reverse = case % 2 == 0;
        let queries: Vec<Query> = (0..6).map(|_| to_goal(&mut random, &first, &terrain)).collect();
        let afresh = fresh(&terrain, &robot, &queries);
        let planner = Planner::new(&terrain, &robot, first.settings).unwrap();
        reached += agree(&energies(&planner, &queries), &afresh);
        let batch: Vec<Option<f64>> = planner
            .plan_many(&queries, Objective::Energy)
            .into_iter()
            .map(|p| p.ok().map(|p| p.route.total.energy_j))
            .collect();
        agree(&batch, &afresh);
        if planner.hold_goal(&first, Objective::Energy).is_ok() {
            agree(&energies(&planner, &queries), &afresh);
            for query in &queries {
                let Ok(found) = planner.plan(query, Objective::Energy) else { continue };
                assert_eq!(found.search.expanded, 0, "a held goal needs no search");
                assert!(found.search.is_optimal());
            }
        }
    }
    assert!(reached > 30, "{reached} paths");
}

#[test]
fn a_patched_map_plans_as_if_it_had_been_made_so() {
    let mut random = ground::random(51);
    let mut reached = 0;
    for _ in 0..4 {
        let terrain = ground::small_terrain(&mut random, 150);
        let robot = builtin::husky_a200();
        let first = ground::some_query(&mut random, &terrain, &robot);
        let queries: Vec<Query> = (0..3).map(|_| to_goal(&mut random, &first, &terrain)).collect();
        let before = Planner::new(&terrain, &robot, first.settings).unwrap();
        energies(&before, &queries);
        let held = before.table(Objective::Energy).tiles_held();
        let (rows, columns) = (random.random_range(1..12), random.random_range(1..12));
        let patch = Patch {
            areas: None,
            row: random.random_range(0..150 - rows as u64),
            column: random.random_range(0..150 - columns as u64),
            elevation_m: Some(vec![vec![Some(random.random_range(0.0..2.0)); columns]; rows]),
            obstacle: random.random_bool(0.5).then(|| vec![vec![true; columns]; rows]),
            surface: None,
        };
        let (changed, cells) = terrain.patched(&patch).unwrap();
        let after = before.patched(&changed, &cells, &Patience::default()).unwrap();
        let kept = after.table(Objective::Energy).tiles_held();
        assert!(kept + 4 >= held && (held < 5 || kept > 0), "{kept} of {held} tiles were kept");
        reached += agree(&energies(&after, &queries), &fresh(&changed, &robot, &queries));
        // Every cost is that of a planner that never saw the ground before.
        let other = Planner::new(&changed, &robot, first.settings).unwrap();
        for _ in 0..4000 {
            let cell = Cell { row: random.random_range(0..150), column: random.random_range(0..151) };
            let state = planner::State { cell, heading: Heading::new(random.random_range(0..16)) };
            let motion = random.random_range(0..after.lattice().motions_per_state());
            let cost = |p: &Planner| p.table(Objective::Energy).cost(state, motion);
            assert_eq!(cost(&after), cost(&other), "{state:?}, motion {motion}");
        }
    }
    assert!(reached > 4, "{reached} paths");
}

#[test]
fn a_goal_is_at_hand_on_a_changed_map_where_the_change_lies_far_from_it_and_only_there() {
    let mut random = ground::random(53);
    let robot = builtin::husky_a200();
    let mut spared = 0;
    for case in 0..4 {
        let terrain = synthetic::mirrored(&ground::small_terrain(&mut random, 40), 500, 500).unwrap();
        let mut query = ground::some_query(&mut random, &terrain, &robot);
        [query.start.x_m, query.start.y_m] = terrain.grid.at_fraction_m(0.04, 0.05);
        [query.goal.x_m, query.goal.y_m] = terrain.grid.at_fraction_m(0.12, 0.1);
        query.bound = [1.0, 1.05][case % 2];
        let before = Planner::new(&terrain, &robot, query.settings).unwrap();
        if before.plan(&query, Objective::Energy).is_err() {
            continue;
        }
        let worked = |planner: &Planner| {
            let (patience, meter) = Patience::default().metered();
            let found = planner.plan(&Query { patience, ..query.clone() }, Objective::Energy);
            (found.ok().map(|plan| (plan.route.total.energy_j, plan.search.expanded)), meter.total())
        };
        for row in [400, 30] {
            let patch = Patch {
                areas: None,
                row,
                column: 30,
                elevation_m: Some(vec![vec![Some(random.random_range(0.0..1.0)); 9]; 6]),
                obstacle: None,
                surface: None,
            };
            let (changed, cells) = terrain.patched(&patch).unwrap();
            let after = before.patched(&changed, &cells, &Patience::default()).unwrap();
            let (found, work) = worked(&after);
            let (afresh, all_work) = worked(&Planner::new(&changed, &robot, query.settings).unwrap());
            assert_eq!(found, afresh, "row {row}");
            if row == 400 {
                assert!(4 * work < all_work, "{work} of {all_work}");
                spared += 1;
            }
        }
    }
    assert!(spared > 1, "{spared}");
}

#[test]
fn a_search_leaves_nothing_behind_in_the_memory_it_shares() {
    let mut random = ground::random(52);
    let terrain = synthetic::mirrored(&ground::small_terrain(&mut random, 30), 140, 140).unwrap();
    let robot = builtin::husky_a200();
    let first = ground::some_query(&mut random, &terrain, &robot);
    let planner = Planner::new(&terrain, &robot, first.settings).unwrap();
    // Searches that end early, late and not at all follow each other.
    let mut answers = BTreeSet::new();
    for round in 0..12 {
        let mut other = to_goal(&mut random, &first, &terrain);
        other.patience = if round % 3 == 0 { Patience::for_looks(30) } else { Patience::default() };
        other.bound = [1.0, 1.2][round % 2];
        let _ = planner.plan(&other, Objective::Energy);
        if let Ok(found) = planner.plan(&first, Objective::Energy) {
            answers.insert(format!("{:.3}", found.route.total.energy_j));
        }
    }
    assert!(answers.len() <= 1, "the same question had answers {answers:?}");
}
