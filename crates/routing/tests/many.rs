//! Matrices against single plans, and reachable sets against fields and plans.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use planner::{
    ExactField, Goal, Heading, Objective, Patience, Place, Planner, Query, Settings, Start, State,
};
use rand::RngExt;
use routing::{Error, Kind, Question, Waypoint, joints, matrix, reach};
use terrain::{Grid, Terrain};

#[path = "../../planner/tests/ground/mod.rs"]
mod ground;

fn query(planner: &Planner, from: &Waypoint, to: &Waypoint) -> Query {
    Query {
        start: Start { x_m: from.x_m, y_m: from.y_m, heading_rad: from.heading_rad },
        goal: Goal {
            x_m: to.x_m,
            y_m: to.y_m,
            heading_rad: to.heading_rad,
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
    }
}

/// Random ground and places on it where the robot can stand, half of them with a heading.
fn places(seed: u64, side: usize, count: usize) -> (Planner, Vec<Waypoint>) {
    let mut random = ground::random(seed);
    let terrain = ground::small_terrain(&mut random, side);
    let robot = ground::some_robot(&mut random, [0.0, 0.5, 1.0][seed as usize % 3]);
    let planner = Planner::new(&terrain, &robot, Settings::of(&robot)).unwrap();
    let mut waypoints = Vec::new();
    for _ in 0..400 {
        let [x_m, y_m] =
            terrain.grid.at_fraction_m(random.random_range(0.0..1.0), random.random_range(0.0..1.0));
        let heading_rad = random.random_bool(0.5).then(|| random.random_range(-3.1..3.1));
        let place = Place::Listed { list: "places", index: 0 };
        if planner.states_at(place, [x_m, y_m], heading_rad, Some(0.0), &Patience::default()).is_ok() {
            waypoints.push(Waypoint { x_m, y_m, heading_rad });
        }
        if waypoints.len() == count {
            break;
        }
    }
    assert!(waypoints.len() > 1, "no room on map {seed}");
    (planner, waypoints)
}

fn exact_question() -> Question {
    Question { snap_radius_m: Some(0.0), ..Question::default() }
}

/// Where a path ends that there is not; a single plan also looks into what is in the way.
fn place(error: &planner::Error) -> (f64, f64) {
    match error {
        planner::Error::NoPath { x_m, y_m, .. } | planner::Error::NoRoomToTurn { x_m, y_m } => (*x_m, *y_m),
        other => panic!("{other}"),
    }
}

#[test]
fn entries_are_those_of_single_plans_and_null_where_there_is_none() {
    let (mut found, mut missing) = (0, 0);
    for seed in 0..8 {
        let (planner, places) = places(seed, 12, 5);
        for objective in [Objective::Energy, Objective::Distance, Objective::Time] {
            let question = Question { objective, ..exact_question() };
            let all = matrix(&planner, &places, &places[..3], &question).unwrap();
            for (i, from) in places.iter().enumerate() {
                for (j, to) in places[..3].iter().enumerate() {
                    let entry = [&all.energy_j, &all.duration_s, &all.distance_m].map(|part| part[i][j]);
                    let gap = all.gaps.iter().find(|gap| (gap.source, gap.target) == (i, j));
                    match planner.plan(&query(&planner, from, to), objective) {
                        Ok(plan) => {
                            let total = &plan.route.total;
                            let own = [total.energy_j, total.duration_s, total.length_m];
                            for (entry, own) in entry.into_iter().zip(own) {
                                assert!((entry.unwrap() - own).abs() <= 1e-9 * own.abs().max(1.0));
                            }
                            assert!(gap.is_none());
                            found += 1;
                        }
                        Err(error) => {
                            assert_eq!(entry, [None; 3]);
                            assert_eq!(place(&gap.unwrap().reason), place(&error));
                            missing += 1;
                        }
                    }
                }
            }
        }
    }
    assert!(found > 150 && missing > 5, "{found} found, {missing} missing");
}

#[test]
fn uphill_and_downhill_differ() {
    let grid = Grid { rows: 12, columns: 30, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let z: Vec<f64> = (0..grid.cells()).map(|i| 0.1 * grid.cell(i).column as f64).collect();
    let robot = model::builtin::husky_a200();
    let planner = Planner::new(&Terrain::new(grid, &z).unwrap(), &robot, Settings::of(&robot)).unwrap();
    let ends = [5.5, 24.5].map(|x_m| Waypoint { x_m, y_m: 6.5, heading_rad: None });
    let all = matrix(&planner, &ends, &ends, &exact_question()).unwrap();
    assert!(all.energy_j[0][1].unwrap() > all.energy_j[1][0].unwrap() + 1000.0);
    assert_eq!((all.energy_j[0][0], all.distance_m[1][1]), (Some(0.0), Some(0.0)));
}

#[test]
fn a_place_off_the_map_is_named_by_list_and_position() {
    let (planner, mut places) = places(1, 12, 3);
    places[2].x_m = -1e6;
    let error = matrix(&planner, &places[..1], &places, &exact_question()).unwrap_err();
    let Error::Planner(planner::Error::OutsideMap { place, .. }) = error else { panic!("{error}") };
    assert_eq!(place, Place::Listed { list: "targets", index: 2 });
}

#[test]
fn chains_over_joints_cost_what_driving_them_pose_by_pose_costs_and_never_less_than_open_entries() {
    let (planner, places) = places(4, 9, 3);
    let open: Vec<Waypoint> = places.iter().map(|place| Waypoint { heading_rad: None, ..*place }).collect();
    let all = joints(&planner, &open, &exact_question()).unwrap();
    let least = matrix(&planner, &open, &open, &exact_question()).unwrap();
    let mut compared = 0;
    for (i, from) in all.poses.iter().enumerate() {
        for (j, to) in all.poses.iter().enumerate().step_by(5) {
            let plan = planner.plan(&query(&planner, &from.pose, &to.pose), Objective::Energy);
            match (plan, all.cost[i][j]) {
                (Ok(plan), Some(cost_j)) => {
                    let energy_j = plan.route.total.energy_j;
                    let room_j = 1e-3 * (energy_j.abs() + 50.0);
                    assert!((cost_j - energy_j).abs() <= room_j, "{cost_j} J, but {energy_j} J when planned");
                    let bound_j = least.energy_j[from.waypoint][to.waypoint].unwrap();
                    assert!(cost_j >= bound_j - room_j, "{cost_j} J is less than {bound_j} J");
                    compared += 1;
                }
                (Err(_), None) => {}
                (plan, cost_j) => panic!("{plan:?} and {cost_j:?}"),
            }
        }
    }
    assert!(compared > 30, "{compared}");
}

/// Least energies by cell as the whole fields have them, without any limit.
fn whole(planner: &Planner, place: &Waypoint, kind: Kind) -> Vec<f64> {
    let lattice = planner.lattice();
    let states = planner
        .states_at(Place::Start, [place.x_m, place.y_m], place.heading_rad, Some(0.0), &Patience::default())
        .unwrap();
    let home_j = lattice.potential_j(states[0].cell);
    let seeds: Vec<(State, f64)> = states.into_iter().map(|state| (state, 0.0)).collect();
    let table = planner.table(Objective::Energy);
    let patience = Patience::default();
    let out = ExactField::from_starts(table, &seeds, f64::INFINITY, &patience).unwrap();
    let back = ExactField::to_goals(table, &seeds, f64::INFINITY, &patience).unwrap();
    let grid = &lattice.terrain.grid;
    let least = |index: usize| {
        let cell = grid.cell(index);
        let rise_j = lattice.potential_j(cell) - home_j;
        let of = |heading| {
            let state = State { cell, heading };
            match kind {
                Kind::Outward => Some(out.cost(state)? + rise_j),
                Kind::Homeward => Some(back.cost(state)? - rise_j),
                Kind::OutAndBack => Some(out.cost(state)? + back.cost(state)?),
            }
        };
        Heading::all().filter_map(of).reduce(f64::min).unwrap_or(f64::NAN)
    };
    (0..grid.cells()).map(least).collect()
}

#[test]
fn sets_are_the_whole_field_cut_off_cell_by_cell_and_grow_with_the_energy() {
    for seed in 0..6 {
        let (planner, places) = places(seed, 40, 2);
        let patience = Patience::default();
        for kind in [Kind::Outward, Kind::Homeward, Kind::OutAndBack] {
            let whole = whole(&planner, &places[0], kind);
            let mut inside_before = 0;
            for most_j in [150.0, 600.0, 2500.0, 10_000.0] {
                let found = reach(&planner, &places[0], kind, most_j, Some(0.0), &patience).unwrap();
                for (index, (held_j, whole_j)) in found.energy_j.iter().zip(&whole).enumerate() {
                    if *whole_j <= most_j {
                        // Their sums are in another order.
                        assert!(
                            (held_j - whole_j).abs() <= 1e-9,
                            "cell {index}: {held_j} J, not {whole_j} J"
                        );
                    } else {
                        assert!(
                            held_j.is_nan(),
                            "cell {index}: {held_j} J, but {whole_j} J within {most_j} J"
                        );
                    }
                }
                let inside = whole.iter().filter(|energy_j| **energy_j <= most_j).count();
                let area_m2: f64 = found.within(most_j, &patience).unwrap().iter().map(area).sum();
                assert!(
                    (area_m2 - inside as f64).abs() < 1e-6
                        && found.area_m2(most_j, &patience).unwrap() == inside as f64
                );
                assert!(inside >= inside_before);
                inside_before = inside;
            }
        }
    }
}

/// Area of a polygon without its holes [m²].
fn area(polygon: &routing::Polygon) -> f64 {
    let rings = polygon.holes.iter().chain([&polygon.exterior]);
    let of = |ring: &Vec<[f64; 2]>| -> f64 {
        let [x, y] = ring[0];
        let cross =
            |pair: &[[f64; 2]]| (pair[0][0] - x) * (pair[1][1] - y) - (pair[1][0] - x) * (pair[0][1] - y);
        ring.windows(2).map(cross).sum::<f64>() / 2.0
    };
    rings.map(of).sum()
}

#[test]
fn out_and_back_is_the_best_of_two_plans_that_meet_in_one_heading() {
    let mut compared = 0;
    for seed in 0..9 {
        let (planner, places) = places(seed, 8, 2);
        let home = places[0];
        let found =
            reach(&planner, &home, Kind::OutAndBack, f64::INFINITY, Some(0.0), &Patience::default()).unwrap();
        let grid = found.grid;
        for index in (0..grid.cells()).step_by(7) {
            let [x_m, y_m] = grid.center_m(grid.cell(index));
            let both = Heading::all().filter_map(|heading| {
                let there = Waypoint { x_m, y_m, heading_rad: Some(heading.angle_rad()) };
                let out = planner.plan(&query(&planner, &home, &there), Objective::Energy).ok()?;
                let back = planner.plan(&query(&planner, &there, &home), Objective::Energy).ok()?;
                Some(out.route.total.energy_j + back.route.total.energy_j)
            });
            let (both_j, held_j) = (both.reduce(f64::min), found.energy_j[index]);
            match both_j {
                None => assert!(held_j.is_nan()),
                Some(both_j) => {
                    assert!((held_j - both_j).abs() <= 1e-3 * (both_j + 50.0), "{held_j} J, but {both_j} J");
                    compared += 1;
                }
            }
        }
    }
    assert!(compared > 20, "{compared}");
}

#[test]
fn an_energy_that_is_nothing_is_refused() {
    let (planner, places) = places(2, 8, 2);
    for most_j in [0.0, -5.0, f64::NAN] {
        let found = reach(&planner, &places[0], Kind::Outward, most_j, None, &Patience::default());
        assert!(matches!(found, Err(Error::NotPositive { .. })), "{most_j}");
    }
}
