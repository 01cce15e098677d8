//! Limits and trade-offs against an exhaustive search: every path that no other beats, by correcting labels until nothing changes.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::collections::BTreeMap;

use planner::{Lattice, Objective, Planner, Query, State};
use rand::RngExt;
use routing::{Error, Limits, alternatives, plan_within};

#[path = "../../planner/tests/ground/mod.rs"]
mod ground;

/// Energy [J], length [m], time [s].
type Amounts = [f64; 3];

/// Every combination of the chosen amounts, from a state of `starts` to one of `goals`, that no other beats.
///
/// Sets of amounts at every state are corrected until none changes, with nothing that prunes but the sets themselves.
/// Energies count without lifting, so that no motion takes less than nothing.
fn front(planner: &Planner, starts: &[State], goals: &[State], active: &[usize]) -> Vec<Amounts> {
    let lattice = planner.lattice();
    let no_worse = |a: &Amounts, b: &Amounts| active.iter().all(|i| a[*i] <= b[*i] + 1e-12);
    let mut sets: Vec<Vec<Amounts>> = vec![Vec::new(); lattice.states()];
    let moves: Vec<Vec<(State, Amounts)>> =
        (0..lattice.states()).map(|i| motions(planner, lattice.state(i))).collect();
    // The order does not matter for what comes out, only for how soon: positive numbers sort as their bits.
    let mut open: BTreeMap<(u64, u64), (usize, Amounts)> = BTreeMap::new();
    let mut count = 0;
    for start in starts {
        count += 1;
        sets[lattice.index(*start)].push([0.0; 3]);
        open.insert((0, count), (lattice.index(*start), [0.0; 3]));
    }
    while let Some((_, (from, before))) = open.pop_first() {
        if !sets[from].contains(&before) {
            continue;
        }
        for (end, takes) in &moves[from] {
            let sum: Amounts = std::array::from_fn(|i| before[i] + takes[i]);
            let set = &mut sets[lattice.index(*end)];
            if !set.iter().any(|other| no_worse(other, &sum)) {
                set.retain(|other| !no_worse(&sum, other));
                set.push(sum);
                count += 1;
                open.insert((sum[active[0]].to_bits(), count), (lattice.index(*end), sum));
            }
        }
    }
    let height_j = |state: &State| lattice.potential_j(state.cell);
    let start_j = height_j(&starts[0]);
    let whole = |goal: &State| {
        let lifted_j = height_j(goal) - start_j;
        sets[lattice.index(*goal)].iter().map(move |a| [a[0] + lifted_j, a[1], a[2]]).collect::<Vec<_>>()
    };
    let all: Vec<Amounts> = goals.iter().flat_map(whole).collect();
    let beaten =
        |a: &Amounts| all.iter().any(|b| no_worse(b, a) && active.iter().any(|i| b[*i] < a[*i] - 1e-9));
    let mut front: Vec<Amounts> = all.iter().filter(|a| !beaten(a)).copied().collect();
    front.sort_by(|a, b| a[active[0]].total_cmp(&b[active[0]]));
    front.dedup_by(|a, b| active.iter().all(|i| (a[*i] - b[*i]).abs() < 1e-9));
    front
}

/// Where the motions that the planner's table allows lead, in each of their variants, and what they take.
fn motions(planner: &Planner, state: State) -> Vec<(State, Amounts)> {
    let (lattice, table): (&Lattice, _) = (planner.lattice(), planner.table(Objective::Energy));
    let mut found = Vec::new();
    for motion in 0..lattice.motions_per_state() {
        let Some(end) = lattice.successor(state, motion) else { continue };
        if table.cost(state, motion).is_infinite() {
            continue;
        }
        let lifted_j = lattice.potential_j(end.cell) - lattice.potential_j(state.cell);
        for edge in lattice.variants(state.cell, state.heading, motion).flatten() {
            found.push((end, [(edge.energy_j - lifted_j).max(0.0), edge.length_m, edge.duration_s]));
        }
    }
    found
}

/// Random ground, a question over it, and the poses that its ends stand for.
fn case(random: &mut rand_pcg::Pcg64Mcg, number: usize) -> (Planner, Query, Vec<State>, Vec<State>) {
    loop {
        let terrain = ground::small_terrain(random, 5);
        let mut robot = ground::some_robot(random, [0.0, 0.5, 1.0][number % 3]);
        if number.is_multiple_of(5) {
            // Motions of a few units of the table, which are rounded up to whole ones.
            robot.surfaces.values_mut().for_each(|surface| surface.mu_roll = 1e-5);
        }
        let mut query = ground::some_query(random, &terrain, &robot);
        query.snap_radius_m = Some(0.0);
        let planner = Planner::new(&terrain, &robot, query.settings).unwrap();
        let Ok(ends) = planner.ends(&query, Objective::Energy) else { continue };
        if planner.plan(&query, Objective::Energy).is_ok() {
            return (planner, query, ends.starts, ends.goals);
        }
    }
}

fn amounts(plan: &planner::Plan) -> Amounts {
    let total = &plan.route.total;
    [total.energy_j, total.length_m, total.duration_s]
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-6 * (1.0 + a.abs())
}

#[test]
fn the_best_path_within_a_limit_is_that_of_an_exhaustive_search() {
    let mut random = ground::random(80);
    let (mut limited, mut number) = (0, 0);
    while limited < 40 {
        number += 1;
        let (planner, query, starts, goals) = case(&mut random, number);
        let (objective, other) = [(0, 2), (0, 1), (2, 0), (1, 0)][number % 4];
        let named = [Objective::Energy, Objective::Distance, Objective::Time][objective];
        let front = front(&planner, &starts, &goals, &[objective, other]);
        for pair in front.windows(2) {
            // Between what the better path takes of the other amount and what the next one does.
            let most = pair[1][other] + random.random_range(0.0..0.9) * (pair[0][other] - pair[1][other]);
            let limits = match other {
                0 => Limits { max_energy_j: Some(most), ..Limits::default() },
                1 => Limits { max_distance_m: Some(most), ..Limits::default() },
                _ => Limits { max_time_s: Some(most), ..Limits::default() },
            };
            let plan = plan_within(&planner, &query, named, &limits).unwrap();
            assert!(limits.hold(&plan.route.total), "{limits:?}: {:?}", plan.route.total);
            let found = amounts(&plan)[objective];
            assert!(near(found, pair[1][objective]), "case {number}: {found}, not {}", pair[1][objective]);
            assert!(plan.search.is_optimal());
            limited += 1;
        }
        let least = front.last().unwrap()[other];
        // However the table rounds, what a path keeps exactly is no contradiction.
        let just = least + 1e-9 * (1.0 + least.abs());
        let exact = match other {
            0 => Limits { max_energy_j: Some(just), ..Limits::default() },
            1 => Limits { max_distance_m: Some(just), ..Limits::default() },
            _ => Limits { max_time_s: Some(just), ..Limits::default() },
        };
        assert!(plan_within(&planner, &query, named, &exact).is_ok(), "case {number}: {exact:?} is kept");
        let below = least - 1e-3 * (1.0 + least.abs());
        let limits = match other {
            0 => Limits { max_energy_j: Some(below), ..Limits::default() },
            1 => Limits { max_distance_m: Some(below), ..Limits::default() },
            _ => Limits { max_time_s: Some(below), ..Limits::default() },
        };
        match plan_within(&planner, &query, named, &limits) {
            Err(Error::Contradiction(c)) => {
                let named = [c.least_energy_j, c.least_distance_m, c.least_duration_s][other];
                assert!(
                    (named - least).abs() <= 2e-3 * (1.0 + least.abs()),
                    "{named} named, {least} is least"
                );
            }
            other => panic!("{limits:?} cannot be kept, but {other:?}"),
        }
    }
}

#[test]
fn the_best_path_within_two_limits_at_once_is_that_of_an_exhaustive_search() {
    let mut random = ground::random(81);
    let mut kept = 0;
    for number in 0..12 {
        let (planner, query, starts, goals) = case(&mut random, number);
        let front = front(&planner, &starts, &goals, &[0, 1, 2]);
        for _ in 0..4 {
            let some = |at: usize, random: &mut rand_pcg::Pcg64Mcg| {
                let values = || front.iter().map(|a| a[at]);
                let (low, high) =
                    (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max));
                low + random.random_range(0.01..1.0) * (high - low) + 1e-6
            };
            let (most_m, most_s) = (some(1, &mut random), some(2, &mut random));
            let limits =
                Limits { max_energy_j: None, max_time_s: Some(most_s), max_distance_m: Some(most_m) };
            let best = front
                .iter()
                .filter(|a| a[1] <= most_m && a[2] <= most_s)
                .map(|a| a[0])
                .fold(f64::INFINITY, f64::min);
            match plan_within(&planner, &query, Objective::Energy, &limits) {
                Ok(plan) => {
                    // A plan that needs no labels has the least cost of the table, which rounds.
                    let room = 1e-3 * (1.0 + best.abs());
                    let energy_j = plan.route.total.energy_j;
                    assert!(energy_j >= best - 1e-6 && energy_j <= best + room, "{energy_j}, not {best}");
                    assert!(limits.hold(&plan.route.total));
                    kept += 1;
                }
                Err(Error::Contradiction(_)) => assert!(best.is_infinite(), "{best} J keep {limits:?}"),
                Err(other) => panic!("{other}"),
            }
        }
    }
    assert!(kept > 10, "only {kept} questions had an answer");
}

#[test]
fn a_trade_off_that_is_complete_is_the_whole_front_and_none_is_beaten_in_any() {
    let mut random = ground::random(82);
    let mut complete = 0;
    for number in 0..16 {
        let (planner, query, starts, goals) = case(&mut random, number);
        let (against, other) = [(Objective::Time, 2), (Objective::Distance, 1)][number % 2];
        let truth = front(&planner, &starts, &goals, &[0, other]);
        let found = alternatives(&planner, &query, against, &Limits::default(), 40).unwrap();
        assert!(!found.timed_out);
        for plan in &found.plans {
            let a = amounts(plan);
            assert!(
                truth.iter().any(|b| near(a[0], b[0]) && near(a[other], b[other])),
                "{a:?} is beaten: {truth:?}"
            );
        }
        if found.complete {
            complete += 1;
            assert_eq!(found.plans.len(), truth.len(), "{truth:?}");
        } else {
            assert_eq!(found.plans.len(), 40);
        }
    }
    assert!(complete >= 10, "only {complete} fronts were small enough");
}
