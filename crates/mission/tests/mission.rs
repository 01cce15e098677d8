//! Missions against brute force, and in cases that can be worked out by hand.

#![allow(clippy::unwrap_used)]

mod ground;

use approx::assert_relative_eq;
use ground::{ground as hills, ideal_husky, level, planner};
use mission::{Doubt, Error, MOST_WAYPOINTS, MissionError, MissionQuestion, Role, Site, Stop, mission};
use planner::{Goal, Objective, Patience, Planner, Query, Start};
use routing::Waypoint;
use terrain::Terrain;

fn place(x_m: f64, y_m: f64) -> Waypoint {
    Waypoint { x_m, y_m, heading_rad: None }
}

fn site(x_m: f64, y_m: f64) -> Site {
    Site { place: place(x_m, y_m), stops: Vec::new() }
}

fn question(start: [f64; 2], waypoints: Vec<Site>) -> MissionQuestion {
    MissionQuestion {
        start: place(start[0], start[1]),
        waypoints,
        chargers: Vec::new(),
        in_order: false,
        back: false,
        deadline_s: f64::INFINITY,
        charge: 1.0,
        ambient_c: 20.0,
        doubt: Doubt::NONE,
        samples: 20,
        seed: 1,
        snap_radius_m: None,
        patience: Patience::default(),
    }
}

fn rolling() -> Terrain {
    hills(14, 14, |x_m, y_m| (x_m / 3.0).sin() + 0.7 * (y_m / 2.5).cos() + 0.05 * x_m)
}

/// Every order of the visits.
fn orders(count: usize) -> Vec<Vec<usize>> {
    if count == 0 {
        return vec![Vec::new()];
    }
    let mut all = Vec::new();
    for shorter in orders(count - 1) {
        for place in 0..=shorter.len() {
            let mut order = shorter.clone();
            order.insert(place, count - 1);
            all.push(order);
        }
    }
    all
}

/// Least energies of the ways of each order in which headings join, by plans from heading to heading.
fn by_plans(planner: &Planner, places: &[[f64; 2]], back: bool) -> impl Fn(&[usize]) -> f64 {
    let headings: Vec<f64> = planner::Heading::all().map(|h| h.angle_rad()).collect();
    let energy = |from: usize, h: f64, to: usize, k: f64| {
        let query = Query {
            start: Start { x_m: places[from][0], y_m: places[from][1], heading_rad: Some(h) },
            goal: Goal {
                x_m: places[to][0],
                y_m: places[to][1],
                heading_rad: Some(k),
                either_way: false,
                tolerance_m: 0.0,
            },
            settings: planner.lattice().settings,
            other_goals: Vec::new(),
            snap_radius_m: Some(0.0),
            bound: 1.0,
            refine: false,
            exact_ends: false,
            patience: Patience::default(),
        };
        planner.plan(&query, Objective::Energy).map_or(f64::INFINITY, |plan| plan.route.total.energy_j)
    };
    let n = places.len();
    let mut cost = vec![vec![[[0.0; 16]; 16]; n]; n];
    for (from, to) in (0..n).flat_map(|a| (0..n).map(move |b| (a, b))).filter(|(a, b)| a != b) {
        for (i, &h) in headings.iter().enumerate() {
            for (j, &k) in headings.iter().enumerate() {
                cost[from][to][i][j] = energy(from, h, to, k);
            }
        }
    }
    move |order: &[usize]| {
        let mut least = [0.0; 16];
        let mut at = 0;
        let home = back.then_some(0);
        for next in order.iter().map(|i| i + 1).chain(home) {
            let row = &cost[at][next];
            least =
                std::array::from_fn(|j| (0..16).map(|i| least[i] + row[i][j]).fold(f64::INFINITY, f64::min));
            at = next;
        }
        least.into_iter().fold(f64::INFINITY, f64::min)
    }
}

#[test]
fn the_order_is_that_of_plans_by_brute_force_with_headings_that_join() {
    let planner = planner(&rolling(), &ideal_husky(480.0));
    for (places, back) in [
        (vec![[2.5, 2.5], [10.5, 3.5], [4.5, 10.5], [11.5, 11.5]], false),
        (vec![[6.5, 6.5], [2.5, 11.5], [11.5, 2.5], [2.5, 2.5]], true),
    ] {
        let waypoints = places[1..].iter().map(|p| site(p[0], p[1])).collect();
        let found = mission(&planner, &MissionQuestion { back, ..question(places[0], waypoints) }).unwrap();
        let energy = by_plans(&planner, &places, back);
        let best_j = orders(places.len() - 1).iter().map(|order| energy(order)).fold(f64::INFINITY, f64::min);
        // Costs of the search are rounded up by at most 1/2048.
        assert!((found.ways_j - best_j).abs() < 1e-3 * best_j.abs(), "{} for {best_j}", found.ways_j);
        for pair in found.routes.windows(2) {
            let (end, begin) = (pair[0].poses.last().unwrap(), &pair[1].poses[0]);
            assert_eq!((end.x_m, end.y_m, end.heading_rad), (begin.x_m, begin.y_m, begin.heading_rad));
        }
    }
}

#[test]
fn seven_waypoints_in_the_order_of_brute_force_over_the_matrix() {
    let planner = planner(&rolling(), &ideal_husky(480.0));
    let places =
        [[7.5, 7.5], [2.5, 2.5], [11.5, 2.5], [2.5, 11.5], [11.5, 11.5], [7.5, 2.5], [3.5, 7.5], [9.5, 5.5]];
    let waypoints = places[1..].iter().map(|p| site(p[0], p[1])).collect();
    let found = mission(&planner, &question(places[0], waypoints)).unwrap();
    // Brute force over orders, headings joined by one exact chain each: the mission in a given order.
    let given = |order: &[usize]| {
        let waypoints = order.iter().map(|i| site(places[i + 1][0], places[i + 1][1])).collect();
        let asked = MissionQuestion { in_order: true, ..question(places[0], waypoints) };
        mission(&planner, &asked).unwrap().ways_j
    };
    // All 5040 take minutes: those whose matrix, a lower bound, does not rule them out.
    let all: Vec<Waypoint> = places.iter().map(|p| place(p[0], p[1])).collect();
    let asked = routing::Question { objective: Objective::Energy, ..Default::default() };
    let matrix = routing::matrix(&planner, &all, &all, &asked).unwrap();
    let bound = |order: &[usize]| {
        let mut at = 0;
        let legs = order.iter().map(|i| matrix.energy_j[std::mem::replace(&mut at, i + 1)][i + 1].unwrap());
        legs.sum::<f64>()
    };
    let mut looked_at = 0;
    for order in orders(7) {
        if bound(&order) < found.ways_j * 0.999 {
            looked_at += 1;
            let energy_j = given(&order);
            assert!(energy_j > found.ways_j - 1e-3 * energy_j.abs(), "{order:?} takes {energy_j}");
        }
    }
    assert!(looked_at > 0, "the bound alone must not decide");
}

#[test]
fn service_counts_by_time_and_power_and_charge_is_told_at_every_stop() {
    let mut robot = ideal_husky(480.0);
    robot.hotel_power_w = 10.0;
    let planner = planner(&level(9, 30), &robot);
    let mut there = site(14.5, 4.5);
    there.stops.push(Stop::Work { duration_s: 600.0, power_w: 50.0 });
    let plain = mission(&planner, &question([4.5, 4.5], vec![site(14.5, 4.5), site(24.5, 4.5)])).unwrap();
    let found = mission(&planner, &question([4.5, 4.5], vec![there, site(24.5, 4.5)])).unwrap();
    assert_relative_eq!(found.nominal.energy_j - plain.nominal.energy_j, 600.0 * 60.0, epsilon = 1.0);
    assert_relative_eq!(found.nominal.duration_s - plain.nominal.duration_s, 600.0, epsilon = 1e-6);
    let call = &found.calls[1];
    assert_eq!(call.role, Role::Waypoint(0));
    assert_relative_eq!(call.departure_s - call.arrival_s, 600.0, epsilon = 1e-6);
    assert_relative_eq!(
        call.arrival_charge - call.departure_charge,
        36_000.0 / (480.0 * 3600.0),
        epsilon = 1e-9
    );
    assert_eq!((found.feasible, found.weakest_leg), (true, 1));
}

#[test]
fn a_charger_is_driven_to_only_where_the_charge_does_not_suffice() {
    // 100 J a metre: 40 m there and 40 m back take some 8.3 kJ; 2.5 Wh hold 9 kJ, of which 7.2 kJ may be drawn.
    let charger = Site { place: place(24.5, 8.5), stops: vec![Stop::Charge { level: 0.9, power_w: 100.0 }] };
    let asked = |capacity_wh: f64| {
        let planner = planner(&level(13, 54), &ideal_husky(capacity_wh));
        let base = question([4.5, 4.5], vec![site(44.5, 4.5)]);
        mission(&planner, &MissionQuestion { back: true, chargers: vec![charger.clone()], ..base }).unwrap()
    };
    let roles = |found: &mission::Mission| found.calls.iter().map(|call| call.role).collect::<Vec<_>>();
    let ample = asked(48.0);
    assert_eq!(roles(&ample), [Role::Start, Role::Waypoint(0), Role::Home]);
    let scarce = asked(2.5);
    assert!(scarce.feasible, "{:?}", scarce.calls);
    assert!(roles(&scarce).contains(&Role::Charger(0)), "{:?}", scarce.calls);
    assert!(scarce.calls.iter().all(|call| call.arrival_charge >= 0.2));
    assert!(scarce.nominal.charged_j > 0.0 && scarce.nominal.duration_s > ample.nominal.duration_s);
    // Without the charger it is an answer that says what is missing.
    let planner = planner(&level(13, 54), &ideal_husky(2.5));
    let alone = question([4.5, 4.5], vec![site(44.5, 4.5)]);
    let found = mission(&planner, &MissionQuestion { back: true, ..alone }).unwrap();
    assert!(!found.feasible && found.nominal.missing_j > 500.0 && found.likely.success_probability == 0.0);
}

#[test]
fn a_deadline_that_no_order_keeps_is_refused_with_the_least_time() {
    let planner = planner(&level(9, 30), &ideal_husky(480.0));
    let asked = question([4.5, 4.5], vec![site(24.5, 4.5)]);
    let error = mission(&planner, &MissionQuestion { deadline_s: 10.0, ..asked.clone() }).unwrap_err();
    // Twenty metres at half a metre a second.
    let MissionError::DeadlineTooShort { deadline_s, least_s } = error else { unreachable!("{error:?}") };
    assert_eq!((deadline_s, least_s.round()), (10.0, 40.0));
    assert!(mission(&planner, &MissionQuestion { deadline_s: 41.0, ..asked }).unwrap().feasible);
}

#[test]
fn beyond_twelve_waypoints_the_gap_is_stated() {
    let planner = planner(&rolling(), &ideal_husky(480.0));
    let waypoints: Vec<Site> =
        (0..14).map(|i| site(2.5 + f64::from(i % 4) * 3.0, 2.5 + f64::from(i / 4) * 3.0)).collect();
    let found = mission(&planner, &question([7.5, 6.5], waypoints)).unwrap();
    assert!(found.bound_j <= found.ways_j + 1e-6, "{} {}", found.bound_j, found.ways_j);
    assert!(found.ways_j < 2.0 * found.bound_j, "{} {}", found.bound_j, found.ways_j);
    assert_eq!(found.calls.len(), 15);
}

#[test]
fn what_cannot_be_asked_is_named_with_its_place() {
    let mut obstacle = vec![false; 14 * 14];
    for row in 0..14 {
        obstacle[row * 14 + 9] = true;
    }
    let planner = planner(&level(14, 14).with_obstacles(obstacle), &ideal_husky(480.0));
    let refused = |question: &MissionQuestion| mission(&planner, question).unwrap_err();
    let walled = refused(&question([3.5, 3.5], vec![site(5.5, 5.5), site(12.5, 3.5)]));
    assert!(matches!(walled, MissionError::Unreachable { waypoint: 1, .. }), "{walled}");
    let outside = refused(&question([3.5, 3.5], vec![site(5.5, 5.5), site(99.0, 3.5)]));
    assert!(outside.to_string().contains("waypoints[1]"), "{outside}");
    let many = refused(&question([3.5, 3.5], vec![site(5.5, 5.5); MOST_WAYPOINTS + 1]));
    assert!(matches!(many, MissionError::Count { list: "waypoints", count: 41, most: 40, .. }), "{many}");
    let mut odd = site(5.5, 5.5);
    odd.stops.push(Stop::Work { duration_s: -1.0, power_w: 0.0 });
    let field = refused(&question([3.5, 3.5], vec![odd]));
    assert!(
        matches!(&field, MissionError::Question(Error::OutOfRange { field, .. }) if field == "waypoints[0].service_s"),
        "{field}"
    );
    let low = refused(&MissionQuestion { charge: 0.1, ..question([3.5, 3.5], vec![site(5.5, 5.5)]) });
    assert!(matches!(low, MissionError::Question(Error::ReserveAboveCharge { .. })), "{low}");
}
