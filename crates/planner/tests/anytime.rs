//! Bounds are true, and what is at hand when patience ends is not lost.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::time::Instant;

use model::builtin;
use petgraph::{algo::dijkstra, graph::NodeIndex};
use planner::{CostTable, Error, Objective, Patience, Plan, Planner, Query, Settings, plan};
use rand::RngExt;
use terrain::{Grid, Terrain, synthetic};

mod ground;

/// Hills large enough that a search looks at the clock many times.
fn hills(side: usize, seed: u64) -> Terrain {
    let grid = Grid { rows: side, columns: side, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    Terrain::new(grid, &synthetic::relief(grid, seed, 60.0, 12.0)).unwrap()
}

fn across(terrain: &Terrain, patience: Patience, bound: f64) -> Query {
    let robot = builtin::husky_a200();
    let [gx, gy] = terrain.grid.at_fraction_m(0.9, 0.85);
    Query {
        start: planner::Start { x_m: 12.0, y_m: 15.0, heading_rad: None },
        goal: planner::Goal { x_m: gx, y_m: gy, heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings: Settings::of(&robot),
        snap_radius_m: None,
        bound,
        refine: false,
        exact_ends: false,
        other_goals: Vec::new(),
        patience,
    }
}

fn amount(plan: &Plan, objective: Objective) -> f64 {
    match objective {
        Objective::Energy => plan.route.total.energy_j,
        Objective::Distance => plan.route.total.length_m,
        Objective::Time => plan.route.total.duration_s,
    }
}

#[test]
fn a_bound_just_above_the_least_is_proven_without_searching_for_the_least() {
    let (mut bounded, mut least) = (0, 0);
    for seed in 0..4 {
        let terrain = hills(240, seed);
        let robot = builtin::husky_a200();
        let expanded = |bound| {
            let query = across(&terrain, Patience::default(), bound);
            let found = plan(&terrain, &robot, &query, Objective::Energy).unwrap();
            assert!(
                found.search.bound.is_some_and(|proven| proven <= bound.max(1.002)),
                "{bound}: {found:?}"
            );
            found.search.expanded
        };
        bounded += expanded(1.01);
        least += expanded(1.0);
    }
    assert!(2 * bounded < least, "{bounded} expansions at 1.01, {least} at 1");
}

#[test]
fn an_answer_is_within_the_bound_asked_for_and_within_the_bound_it_states() {
    let mut random = ground::random(41);
    let (mut compared, mut looser) = (0, 0);
    while compared < 80 {
        let terrain = ground::small_terrain(&mut random, 20);
        let robot = ground::some_robot(&mut random, [0.0, 0.5, 1.0][compared % 3]);
        let objective = [Objective::Energy, Objective::Distance, Objective::Time][compared % 4 % 3];
        let exact = ground::some_query(&mut random, &terrain, &robot);
        let Ok(best) = plan(&terrain, &robot, &exact, objective) else { continue };
        compared += 1;
        assert!(best.search.is_optimal() && !best.search.timed_out);
        let least = amount(&best, objective);
        for bound in [1.5, 1.2, 1.05] {
            let found = plan(&terrain, &robot, &Query { bound, ..exact.clone() }, objective).unwrap();
            let cost = amount(&found, objective);
            // The table's rounding and the weight of energy among equals stand between stated and true costs.
            let room = 2.0 * CostTable::LARGEST_ROUNDING * cost.abs().max(least.abs()) + 0.05;
            assert!(cost <= least + found.search.excess + room, "{cost} exceeds {least} by more than stated");
            assert!(cost >= least - room);
            match found.search.bound {
                Some(proven) => {
                    let asked_for = bound.max(1.002);
                    assert!(proven <= asked_for, "{proven} was proven, {bound} asked for");
                    assert!(cost <= proven * least + room, "{cost} is not within {proven} of {least}");
                }
                None => {
                    assert!(found.search.optimal || best.route.total.energy_j < 1.0, "{cost} over {least}");
                }
            }
            looser += usize::from(!found.search.is_optimal());
        }
    }
    assert!(looser > 40, "looser bounds must be made use of, {looser} of 240 were");
}

/// The least of an objective's own amount between the ends of a question, by petgraph's Dijkstra in double precision.
fn least_amount(lattice: &planner::Lattice, ends: &planner::Ends, objective: Objective) -> f64 {
    let mut graph = petgraph::graph::DiGraph::<(), f64>::new();
    for _ in 0..lattice.states() {
        graph.add_node(());
    }
    for index in 0..lattice.states() {
        let state = lattice.state(index);
        for motion in 0..lattice.motions_per_state() {
            let Some(end) = lattice.successor(state, motion) else { continue };
            let lifted_j = lattice.potential_j(end.cell) - lattice.potential_j(state.cell);
            for edge in lattice.variants(state.cell, state.heading, motion).flatten() {
                let weight = match objective {
                    Objective::Energy => (edge.energy_j - lifted_j).max(0.0),
                    _ => objective.amount(&edge),
                };
                graph.add_edge(NodeIndex::new(index), NodeIndex::new(lattice.index(end)), weight);
            }
        }
    }
    let mut least = f64::INFINITY;
    for start in &ends.starts {
        let reached = dijkstra(&graph, NodeIndex::new(lattice.index(*start)), None, |e| *e.weight());
        for goal in &ends.goals {
            let height_j = match objective {
                Objective::Energy => lattice.potential_j(goal.cell) - lattice.potential_j(start.cell),
                _ => 0.0,
            };
            if let Some(amount) = reached.get(&NodeIndex::new(lattice.index(*goal))) {
                least = least.min(amount + height_j);
            }
        }
    }
    least
}

#[test]
fn no_bound_is_claimed_below_the_ratio_to_the_least_in_double_precision() {
    let mut random = ground::random(43);
    let (mut compared, mut bounded) = (0, [0; 3]);
    while compared < 120 {
        let terrain = ground::small_terrain(&mut random, 14);
        let mut robot = ground::some_robot(&mut random, [0.0, 0.5, 1.0][compared % 3]);
        if compared % 5 == 0 {
            let friction = [0.0, 1e-4, 5e-3, 0.02][compared / 5 % 4];
            robot.surfaces.values_mut().for_each(|surface| surface.mu_roll = friction);
        }
        let objective = [Objective::Energy, Objective::Distance, Objective::Time][compared % 4 % 3];
        let query = ground::some_query(&mut random, &terrain, &robot);
        let query = Query { bound: [1.0, 1.005, 1.02, 1.2][compared % 4], ..query };
        let planner = Planner::new(&terrain, &robot, query.settings).unwrap();
        let Ok(found) = planner.plan(&query, objective) else { continue };
        let least = least_amount(planner.lattice(), &planner.ends(&query, objective).unwrap(), objective);
        if least.is_infinite() {
            // A motion at the very limit of the robot is allowed by the table alone.
            continue;
        }
        compared += 1;
        let amount = amount(&found, objective);
        let search = &found.search;
        let room = 1e-9 * (1.0 + amount.abs());
        assert!(search.excess >= amount - least - room, "{} claimed, {amount} over {least}", search.excess);
        if let Some(bound) = search.bound {
            bounded[objective as usize] += 1;
            assert!(amount <= bound * least + room, "{bound} claimed, {amount} over {least} {objective:?}");
            assert!(!search.optimal || compared % 5 == 1 || bound < 1.01, "{bound} for the best path");
        }
    }
    assert!(bounded.iter().all(|count| *count > 15), "{bounded:?} of {compared} with a bound");
}

#[test]
fn looser_bounds_expand_fewer_states() {
    let terrain = hills(300, 5);
    let robot = builtin::husky_a200();
    let expanded = |bound: f64| {
        let query = across(&terrain, Patience::default(), bound);
        plan(&terrain, &robot, &query, Objective::Energy).unwrap().search.expanded
    };
    let [loose, close, exact] = [1.2, 1.05, 1.0].map(expanded);
    assert!(loose * 4 < exact && close * 2 < exact, "{loose}, {close} and {exact} expansions");
}

#[test]
fn whenever_patience_ends_there_is_either_a_path_with_its_bound_or_none_yet() {
    let terrain = hills(200, 6);
    let robot = builtin::husky_a200();
    let best =
        plan(&terrain, &robot, &across(&terrain, Patience::default(), 1.0), Objective::Energy).unwrap();
    let least_j = best.route.total.energy_j;
    let (mut none, mut late, mut whole) = (0, 0, 0);
    for looks in (0..40).map(|i| i * 9) {
        let query = across(&terrain, Patience::for_looks(looks), 1.0);
        match plan(&terrain, &robot, &query, Objective::Energy) {
            Err(Error::Timeout { .. }) => none += 1,
            Err(other) => panic!("{other}"),
            Ok(found) if found.search.timed_out => {
                late += 1;
                let bound = found.search.bound.unwrap();
                assert!(bound > 1.0 && bound < 1.201, "{bound}");
                assert!(found.route.total.energy_j <= bound * least_j * 1.001);
                assert!(found.route.total.energy_j <= least_j + found.search.excess + 0.001 * least_j);
            }
            Ok(found) => {
                whole += 1;
                approx::assert_relative_eq!(found.route.total.energy_j, least_j, max_relative = 1e-3);
            }
        }
    }
    assert!(none > 0 && late > 0 && whole > 0, "{none} without, {late} late, {whole} whole");
}

#[test]
fn patience_that_is_over_ends_the_evaluation_of_costs_without_leaving_half_a_tile() {
    let terrain = hills(200, 7);
    let robot = builtin::husky_a200();
    let planner = Planner::new(&terrain, &robot, Settings::of(&robot)).unwrap();
    for looks in 0..12 {
        let query = across(&terrain, Patience::for_looks(looks), 1.0);
        assert!(matches!(planner.plan(&query, Objective::Energy), Err(Error::Timeout { .. })));
    }
    let query = across(&terrain, Patience::default(), 1.0);
    let found = planner.plan(&query, Objective::Energy).unwrap();
    let fresh = plan(&terrain, &robot, &query, Objective::Energy).unwrap();
    assert_eq!(found.route, fresh.route);
}

#[test]
fn a_bound_below_one_and_a_tolerance_that_snapping_defeats_are_named() {
    let terrain = hills(60, 8);
    let robot = builtin::husky_a200();
    let refused = |change: fn(&mut Query)| {
        let mut query = across(&terrain, Patience::until(Instant::now()), 1.0);
        change(&mut query);
        plan(&terrain, &robot, &query, Objective::Energy).unwrap_err().to_string()
    };
    for bound in
        [|q: &mut Query| q.bound = 0.9, |q: &mut Query| q.bound = f64::NAN, |q: &mut Query| q.bound = 99.0]
    {
        assert!(refused(bound).starts_with("bound is "), "{}", refused(bound));
    }
    let message = refused(|q| {
        q.goal.tolerance_m = 1.0;
        q.snap_radius_m = Some(3.0);
    });
    assert!(message.contains("goal.tolerance_m is 1") && message.contains("snap_radius_m 3"), "{message}");
}

#[test]
fn random_bounds_between_one_and_two_are_kept() {
    let terrain = hills(120, 9);
    let robot = builtin::husky_a200();
    let planner = Planner::new(&terrain, &robot, Settings::of(&robot)).unwrap();
    let mut random = ground::random(42);
    for _ in 0..30 {
        let bound = random.random_range(1.0..2.0);
        let found = planner.plan(&across(&terrain, Patience::default(), bound), Objective::Energy).unwrap();
        assert!(found.search.bound.unwrap() <= bound || found.search.optimal);
    }
}
