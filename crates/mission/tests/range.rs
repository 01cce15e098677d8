//! Range in cases that can be worked out by hand, and against searches by brute force.

#![allow(clippy::unwrap_used)]

mod ground;

use approx::assert_relative_eq;
use ground::{ground as hills, ideal_husky, level, planner, query, question};
use mission::{Doubt, Error, Question, Spread, range};
use model::{Robot, robot::Uncertainty};
use planner::{Objective, Planner, Query};

/// Force of each side of a Husky on level marble: 0.063 · 90 kg · g / 2 [N].
const SIDE_N: f64 = 0.063 * 90.0 * 9.80665 / 2.0;

/// Power of a Husky on level marble at a speed, by eq. 2 with the constants of Table I [W].
fn level_w(speed_mps: f64) -> f64 {
    (0.0023 + 0.0016) * SIDE_N * SIDE_N + (1.7158 + 1.7723) * SIDE_N * speed_mps
}

/// A robot about which there is no doubt at all.
fn certain(mut robot: Robot) -> Robot {
    robot.uncertainty =
        Uncertainty { mu_roll: 0.0, mu_skid: 0.0, k1: 0.0, k2: 0.0, mass_kg: 0.0, hotel_power_w: 0.0 };
    let battery = robot.battery.as_mut().unwrap();
    (battery.capacity_sigma, battery.charge_sigma) = (0.0, 0.0);
    robot
}

/// Twenty metres straight ahead over level ground.
fn straight(robot: &Robot) -> (Planner, Question) {
    let planner = planner(&level(9, 30), robot);
    let query = query(&planner, [4.5, 4.5], [24.5, 4.5]);
    (planner, question(query))
}

#[test]
fn level_ground_takes_what_eq_2_says_and_the_charge_falls_by_it() {
    let (planner, question) = straight(&certain(ideal_husky(480.0)));
    let found = range(&planner, &question).unwrap();
    // 51.5 W for 40 s.
    assert_relative_eq!(found.planned_j, 40.0 * level_w(0.5), epsilon = 1e-6);
    assert_relative_eq!(found.planned_j, 2060.1, epsilon = 0.05);
    // Motors warm by less than a kelvin meanwhile.
    assert!(found.nominal.energy_j >= found.planned_j && found.nominal.energy_j < 1.001 * found.planned_j);
    let capacity_j = 480.0 * 3600.0;
    assert_relative_eq!(
        found.nominal.arrival_charge,
        1.0 - found.nominal.energy_j / capacity_j,
        epsilon = 1e-9
    );
    let likely = &found.likely;
    assert_eq!((likely.success_probability, likely.missing_j, likely.samples), (1.0, 0.0, 200));
    let Spread { p05, p50, p95 } = likely.energy_j;
    assert!(p05 == p50 && p50 == p95 && (p50 - found.nominal.energy_j).abs() < 1e-9, "nothing is in doubt");
}

#[test]
fn hotel_load_and_drive_electronics_count_by_time() {
    let (plain, question) = straight(&certain(ideal_husky(480.0)));
    let mut loaded = certain(ideal_husky(480.0));
    (loaded.hotel_power_w, loaded.drive_electronics_w) = (30.0, 5.0);
    let (planner, _) = straight(&loaded);
    let more_j = range(&planner, &question).unwrap().nominal.energy_j
        - range(&plain, &question).unwrap().nominal.energy_j;
    assert_relative_eq!(more_j, (30.0 + 2.0 * 5.0) * 40.0, epsilon = 1e-6);
}

#[test]
fn a_battery_that_does_not_suffice_is_an_answer_with_what_is_missing() {
    // 0.4 Wh are 1440 J, of which 80 % may be drawn; the way takes 2060 J.
    let (planner, question) = straight(&certain(ideal_husky(0.4)));
    let found = range(&planner, &question).unwrap();
    assert!(!found.likely.is_reachable() && found.likely.success_probability == 0.0);
    assert_relative_eq!(found.likely.missing_j, found.nominal.energy_j - 0.8 * 1440.0, epsilon = 1.0);
    assert_eq!(found.likely.arrival_charge.p50, 0.0, "empty before it got there");
}

#[test]
fn current_beyond_the_rated_one_costs_charge_by_peukerts_law() {
    // 51.5 W at 24 V are 2.146 A, of a pack rated for 0.5 A: 4.292^0.16 = 1.2626 times the charge.
    let mut robot = certain(ideal_husky(240.0));
    robot.battery.as_mut().unwrap().peukert_exponent = 1.16;
    let (planner, question) = straight(&robot);
    let outcome = range(&planner, &question).unwrap().nominal;
    assert_relative_eq!(
        (1.0 - outcome.arrival_charge) * 240.0 * 3600.0 / outcome.energy_j,
        1.2626,
        epsilon = 1e-3
    );
}

#[test]
fn a_full_battery_takes_nothing_on_a_descent_and_one_with_room_does() {
    let slope = hills(9, 40, |x_m, _| 20.0 - 0.25 * x_m);
    let planner = planner(&slope, &certain(ideal_husky(480.0)));
    let question = question(query(&planner, [4.5, 4.5], [34.5, 4.5]));
    let full = range(&planner, &question).unwrap();
    assert!(full.planned_j < 0.0, "the plan takes back all: {}", full.planned_j);
    assert!(full.nominal.energy_j.abs() < 1e-6, "{:?}", full.nominal);
    assert_relative_eq!(full.nominal.refused_j, -full.planned_j, epsilon = 0.02 * full.planned_j.abs());
    let half = range(&planner, &Question { charge: 0.5, ..question }).unwrap().nominal;
    assert!(half.refused_j.abs() < 1e-6 && half.arrival_charge > 0.5, "{half:?}");
}

#[test]
fn a_long_climb_costs_more_than_the_sum_of_its_edges() {
    let slope = hills(9, 300, |x_m, _| 0.2 * x_m);
    let planner = planner(&slope, &certain(ideal_husky(480.0)));
    let found = range(&planner, &question(query(&planner, [4.5, 4.5], [290.5, 4.5]))).unwrap();
    let share = found.nominal.energy_j / found.planned_j;
    assert!((1.02..1.3).contains(&share), "{share}");
    assert!(found.nominal.hottest_c > 35.0 && found.nominal.hottest_c < 120.0, "{:?}", found.nominal);
}

/// The least energy there and home from there, by a plan to every heading and one from it; `None` where no two join.
fn joined_j(planner: &Planner, from: [f64; 2], to: [f64; 2]) -> Option<f64> {
    let headings = planner::Heading::all().map(|heading| heading.angle_rad());
    let total_j = |query: &Query| Some(planner.plan(query, Objective::Energy).ok()?.route.total.energy_j);
    // Another cell would be another place.
    let exact = |from, to| Query { snap_radius_m: Some(0.0), ..query(planner, from, to) };
    let both_j = headings.filter_map(|heading_rad| {
        let mut out = exact(from, to);
        out.goal.heading_rad = Some(heading_rad);
        let mut home = exact(to, from);
        home.start.heading_rad = Some(heading_rad);
        Some(total_j(&out)? + total_j(&home)?)
    });
    both_j.min_by(f64::total_cmp)
}

#[test]
fn there_and_back_is_the_least_of_both_together_over_all_headings() {
    // Along the edges of the map a robot can stand in some headings only, so that there is no room to turn.
    let slope = hills(12, 12, |x_m, y_m| 0.1 * x_m + (y_m / 3.0).sin());
    let planner = planner(&slope, &certain(ideal_husky(480.0)));
    let from = [4.5, 4.5];
    let (mut dead_ends, mut ways) = (0, 0);
    for to in [[0.5, 0.5], [5.5, 0.5], [11.5, 5.5], [11.5, 11.5], [0.5, 11.5], [8.5, 8.5], [10.5, 11.5]] {
        let out = Query { snap_radius_m: Some(0.0), ..query(&planner, from, to) };
        let found = range(&planner, &Question { back: true, samples: 1, ..question(out.clone()) });
        match (joined_j(&planner, from, to), found) {
            (Some(least_j), Ok(found)) => {
                ways += 1;
                assert_relative_eq!(found.planned_j, least_j, max_relative = 1e-3);
                let [out, back] = [0, 1].map(|leg| &found.legs[leg].plan.route.poses);
                let (end, begin) = (out.last().unwrap(), back.first().unwrap());
                let apart_m = (end.x_m - begin.x_m).hypot(end.y_m - begin.y_m);
                let turned_rad = (end.heading_rad - begin.heading_rad).cos();
                assert!(
                    apart_m < 1e-9 && turned_rad > 1.0 - 1e-9,
                    "the way home begins where the way there ends: {end:?} {begin:?}"
                );
            }
            (None, Err(error)) => {
                dead_ends += 1;
                let there = planner.plan(&out, Objective::Energy).is_ok();
                assert_eq!(matches!(error, Error::NoWayBack { .. }), there, "{error}");
            }
            (joined, found) => panic!("{to:?}: {joined:?} by brute force, {:?}", found.map(|f| f.planned_j)),
        }
    }
    assert!(ways >= 2 && dead_ends >= 1, "{ways} ways, {dead_ends} dead ends: the ground tells nothing");
}

#[test]
fn the_farthest_place_is_one_that_a_way_leads_back_from() {
    let planner = planner(&level(30, 30), &certain(ideal_husky(480.0)));
    let asked = question(query(&planner, [4.5, 4.5], [4.5, 4.5]));
    let found = range(&planner, &Question { farthest: true, back: true, ..asked.clone() }).unwrap();
    let end = found.legs[0].plan.route.poses.last().unwrap();
    let farthest_m = (end.x_m - 4.5).hypot(end.y_m - 4.5);
    // The cell next to the far corner is 33.9 m away and leads back.
    assert!(found.legs.len() == 2 && farthest_m > 33.0, "{farthest_m}");
    assert!(found.carries.unwrap().whole_map && found.likely.is_reachable());
    let oneway = range(&planner, &Question { farthest: true, ..asked }).unwrap();
    let end = oneway.legs[0].plan.route.poses.last().unwrap();
    assert!((end.x_m - 4.5).hypot(end.y_m - 4.5) >= farthest_m, "no farther with a way back");
}

#[test]
fn a_way_of_no_length_arrives_as_it_set_out() {
    let planner = planner(&level(9, 9), &certain(ideal_husky(480.0)));
    for back in [false, true] {
        let asked = question(query(&planner, [4.5, 4.5], [4.5, 4.5]));
        let found = range(&planner, &Question { back, charge: 0.5, ..asked }).unwrap();
        assert_eq!((found.nominal.arrival_charge, found.charge, found.planned_j), (0.5, 0.5, 0.0));
        assert_eq!(found.likely.arrival_charge.p50, 0.5);
    }
}

/// The right answer, or an error that says that time ran out: whatever the look at the deadline at which it ends.
#[test]
fn a_deadline_anywhere_gives_the_right_answer_or_says_that_time_ran_out() {
    let slope = hills(12, 12, |x_m, y_m| 0.1 * x_m + (y_m / 3.0).sin());
    let planner = planner(&slope, &certain(ideal_husky(480.0)));
    for (farthest, back) in [(false, false), (false, true), (true, false), (true, true)] {
        let asked =
            Question { farthest, back, samples: 9, ..question(query(&planner, [4.5, 4.5], [9.5, 8.5])) };
        let whole = range(&planner, &asked).unwrap();
        let (mut late, mut looks) = (0, 0_u64);
        loop {
            let mut hurried = asked.clone();
            hurried.query.patience = planner::Patience::for_looks(looks);
            match range(&planner, &hurried) {
                Ok(found) => {
                    assert_eq!((found.nominal, found.planned_j), (whole.nominal, whole.planned_j));
                    assert_eq!(found.likely, whole.likely);
                    break;
                }
                Err(Error::Timeout { .. } | Error::Plan(planner::Error::Timeout { .. })) => late += 1,
                Err(other) => panic!("{other}"),
            }
            looks += 1 + looks / 8;
        }
        assert!(late > 5, "the deadline is looked at again and again, not {late} times");
    }
}

#[test]
fn the_last_turning_point_is_the_last_pose_from_which_a_plan_home_leaves_the_reserve() {
    let slope = hills(20, 40, |x_m, y_m| (x_m / 6.0).sin() + 0.5 * (y_m / 4.0).cos());
    // Some 70 % of the way out and back.
    let planner = planner(&slope, &certain(ideal_husky(1.5)));
    let out = query(&planner, [4.5, 4.5], [34.5, 14.5]);
    let asked = question(out.clone());
    let found = range(&planner, &asked).unwrap();
    let turning = found.turning.unwrap();
    let route = &found.legs[0].plan.route;
    assert!(turning.pose > 0 && turning.pose + 1 < route.poses.len(), "{turning:?}");
    // By brute force: a plan home from every pose that lies on the lattice.
    let budget_j = 0.8 * 1.5 * 3600.0;
    let enough = |pose: &planner::Pose| {
        let mut home = query(&planner, [pose.x_m, pose.y_m], [4.5, 4.5]);
        home.start.heading_rad = Some(pose.heading_rad);
        let back = planner.plan(&home, Objective::Energy).unwrap().route.total;
        // On this ground nothing comes back while the battery is full.
        pose.energy_j + back.energy_j < budget_j
    };
    let on_lattice = |pose: &&planner::Pose| {
        let off = |v: f64| (v - v.floor() - 0.5).abs();
        off(pose.x_m) < 1e-6 && off(pose.y_m) < 1e-6
    };
    let latest = route.poses.iter().filter(on_lattice).rfind(|pose| enough(pose)).unwrap();
    // Warming motors take half a per cent more than the sum of edges: a pose or two earlier.
    assert!(
        latest.distance_m - turning.distance_m < 3.0 && latest.distance_m >= turning.distance_m,
        "{latest:?} {turning:?}"
    );
    assert!(turning.charge_at_home >= 0.2, "{turning:?}");
}

#[test]
fn the_best_speed_saves_what_copper_and_hotel_load_take_by_time() {
    let mut robot = certain(ideal_husky(480.0));
    robot.hotel_power_w = 20.0;
    let (planner, question) = straight(&robot);
    let best = range(&planner, &question).unwrap().best_speed;
    assert_relative_eq!(best.speed_mps, 1.0, epsilon = 1e-9);
    let per_time_w = 20.0 + (0.0023 + 0.0016) * SIDE_N * SIDE_N;
    assert_relative_eq!(best.saving_j, per_time_w * 20.0 * (1.0 / 0.5 - 1.0 / 1.0), epsilon = 2.0);
    assert_relative_eq!(best.duration_s, 20.0, epsilon = 1e-6);
}

#[test]
fn a_doubt_in_rolling_resistance_alone_spreads_the_energy_as_it_says() {
    let mut robot = certain(ideal_husky(480.0));
    robot.uncertainty.mu_roll = 0.10;
    let (planner, question) = straight(&robot);
    let likely = range(&planner, &Question { samples: 4000, ..question }).unwrap().likely;
    // P = a F² + b F with F = F0 e^(0.1 z): at the quantiles z = ∓1.645.
    let energy_j = |z: f64| {
        let n = SIDE_N * (0.10 * z).exp();
        40.0 * ((0.0023 + 0.0016) * n * n + (1.7158 + 1.7723) * n * 0.5)
    };
    for (found, z) in
        [(likely.energy_j.p05, -1.645), (likely.energy_j.p50, 0.0), (likely.energy_j.p95, 1.645)]
    {
        assert_relative_eq!(found, energy_j(z), max_relative = 0.01);
    }
}

#[test]
fn errors_of_the_map_cancel_over_the_way_but_for_its_ends() {
    let robot = certain(ideal_husky(480.0));
    let planner = planner(&hills(9, 120, |x_m, _| 0.05 * x_m), &robot);
    let asked = question(query(&planner, [4.5, 4.5], [114.5, 4.5]));
    let doubt = Doubt { elevation_sigma_m: 0.1, ..Doubt::NONE };
    let likely = range(&planner, &Question { doubt, samples: 2000, ..asked }).unwrap().likely;
    // Two ends that err by 0.1 m each, √2 · 0.1 m together. A newton more on both sides costs k2 + 2 k1 F/u a metre each.
    let side_n = SIDE_N + 90.0 * 9.80665 * 0.05 / 2.0;
    let per_newton = (1.7158 + 1.7723) / 2.0 + (0.0023 + 0.0016) * side_n / 0.5;
    let half_j = 1.645 * 2f64.sqrt() * 0.1 * 90.0 * 9.80665 * per_newton;
    assert_relative_eq!(likely.energy_j.p95 - likely.energy_j.p50, half_j, max_relative = 0.12);
}

#[test]
fn draws_do_not_depend_on_the_number_of_threads() {
    let planner =
        planner(&hills(20, 20, |x_m, y_m| (x_m / 3.0).sin() + (y_m / 4.0).cos()), &ideal_husky(480.0));
    let asked = Question { doubt: Doubt::default(), ..question(query(&planner, [3.5, 3.5], [16.5, 12.5])) };
    let many = range(&planner, &asked).unwrap().likely;
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    assert_eq!(pool.install(|| range(&planner, &asked).unwrap().likely), many);
}

#[test]
fn without_a_goal_level_ground_carries_as_far_as_the_charge_divides_by_the_metre() {
    let robot = certain(ideal_husky(1.0));
    let (planner, asked) = straight(&robot);
    let found = range(&planner, &Question { farthest: true, ..asked.clone() }).unwrap();
    let carries = found.carries.unwrap();
    // 0.8 · 3600 J at 103 J a metre.
    assert_relative_eq!(
        carries.level_m.unwrap().p50,
        0.8 * 3600.0 / (2.0 * level_w(0.5)),
        max_relative = 2e-3
    );
    // The farthest place of the map is reached: 25 m away.
    assert!(carries.whole_map && found.likely.is_reachable());
    let short = certain(ideal_husky(0.4));
    let (planner, _) = straight(&short);
    let found = range(&planner, &Question { farthest: true, ..asked }).unwrap();
    let end = *found.legs[0].plan.route.poses.last().unwrap();
    assert!(!found.carries.unwrap().whole_map && found.likely.is_reachable());
    // 0.8 · 1440 J carry 11.2 m.
    assert!((end.x_m - 4.5) > 9.0 && (end.x_m - 4.5) < 11.3, "{end:?}");
}

#[test]
fn plans_of_draws_are_no_worse_than_the_fixed_path_for_them() {
    let slope = hills(30, 30, |x_m, y_m| 1.5 * (x_m / 4.0).sin() * (y_m / 5.0).cos());
    let planner = planner(&slope, &ideal_husky(480.0));
    let asked = question(query(&planner, [4.5, 4.5], [24.5, 24.5]));
    let replanned = range(&planner, &Question { replanned: 5, ..asked }).unwrap().replanned.unwrap();
    assert_eq!(replanned.samples, 5);
    assert!(replanned.saving_j > -1.0, "{replanned:?}");
}

#[test]
fn what_cannot_be_asked_is_named() {
    let (planner, asked) = straight(&ideal_husky(480.0));
    let refused = |question: Question| range(&planner, &question).unwrap_err();
    for charge in [-0.1, 1.2, f64::NAN] {
        assert!(
            matches!(refused(Question { charge, ..asked.clone() }), Error::OutOfRange { field, .. } if field == "charge")
        );
    }
    let low = refused(Question { charge: 0.1, ..asked.clone() });
    assert_eq!(low, Error::ReserveAboveCharge { charge: 0.1, reserve: 0.2 });
    assert!(
        matches!(refused(Question { samples: 0, ..asked.clone() }), Error::OutOfRange { field, .. } if field == "samples")
    );
    let mut without = ideal_husky(480.0);
    without.battery = None;
    let (planner, _) = straight(&without);
    assert_eq!(range(&planner, &asked).unwrap_err(), Error::NoBattery);
}
