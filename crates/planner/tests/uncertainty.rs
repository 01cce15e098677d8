//! The interval of a path's energy: where it may lie, and that one doubt alone gives its own quantiles.

#![allow(clippy::unwrap_used)]

use std::path::Path;

use approx::assert_relative_eq;
use model::{Robot, builtin, robot::Uncertainty};
use planner::{Goal, Objective, Patience, Plan, Query, Settings, Start, plan};
use proptest::prelude::*;
use terrain::{Grid, Terrain, synthetic::coarsened};

const CERTAIN: Uncertainty =
    Uncertainty { mu_roll: 0.0, mu_skid: 0.0, k1: 0.0, k2: 0.0, mass_kg: 0.0, hotel_power_w: 0.0 };

/// From one corner to the other over ground of 1 m cells.
fn across(robot: &Robot, height_m: impl Fn(f64, f64) -> f64) -> Plan {
    over(robot, 10.5, height_m)
}

/// Straight ahead over level ground, which is the best way whatever the robot.
fn ahead(robot: &Robot) -> Plan {
    over(robot, 2.5, |_, _| 0.0)
}

#[test]
fn the_interval_over_coarse_cells_holds_what_the_fine_ground_takes() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../maps/minnesota.tif");
    let fine = terrain::io::read_path(&path).unwrap();
    let coarse = coarsened(&fine, 20).unwrap();
    let mut robot = builtin::husky_a200();
    robot.uncertainty = CERTAIN;
    let [west_m, south_m] = fine.grid.origin_m;
    let shortest = |terrain: &Terrain, row: usize, is_east: bool| {
        let (y_m, ends_m) = (south_m + 20.0 * row as f64 + 10.0, [west_m + 50.0, west_m + 350.0]);
        let [from_m, to_m] = if is_east { ends_m } else { [ends_m[1], ends_m[0]] };
        let query = Query {
            start: Start { x_m: from_m, y_m, heading_rad: None },
            goal: Goal { x_m: to_m, y_m, heading_rad: None, either_way: false, tolerance_m: 0.0 },
            settings: Settings::of(&robot),
            other_goals: Vec::new(),
            snap_radius_m: None,
            bound: 1.0,
            refine: false,
            exact_ends: false,
            patience: Patience::default(),
        };
        plan(terrain, &robot, &query, Objective::Distance).ok()
    };
    let (mut held, mut asked) = (0, 0);
    for row in (2..18).step_by(3) {
        for is_east in [true, false] {
            let (Some(told), Some(true_one)) =
                (shortest(&coarse, row, is_east), shortest(&fine, row, is_east))
            else {
                continue;
            };
            let ([low_j, high_j], took_j) = (told.energy_interval_j, true_one.route.total.energy_j);
            assert_relative_eq!(low_j, told.route.total.energy_j, max_relative = 1e-12);
            assert!(high_j > low_j, "coarse cells are a doubt");
            asked += 1;
            held += usize::from((low_j * 0.98..=high_j).contains(&took_j));
            println!("row {row}: told {low_j:.0} to {high_j:.0} J, took {took_j:.0} J");
        }
    }
    assert!(
        asked >= 8 && held * 6 >= asked * 5,
        "{held} of {asked} intervals hold what the fine ground takes"
    );
}

fn over(robot: &Robot, to_y_m: f64, height_m: impl Fn(f64, f64) -> f64) -> Plan {
    const SIDE: usize = 14;
    let grid = Grid { rows: SIDE, columns: SIDE, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let height = |i: usize| {
        let [x_m, y_m] = grid.center_m(grid.cell(i));
        height_m(x_m, y_m)
    };
    let heights: Vec<f64> = (0..grid.cells()).map(height).collect();
    let terrain = Terrain::new(grid, &heights).unwrap();
    let query = Query {
        start: Start { x_m: 2.5, y_m: 2.5, heading_rad: Some(0.0) },
        goal: Goal { x_m: 11.5, y_m: to_y_m, heading_rad: None, either_way: false, tolerance_m: 0.0 },
        settings: Settings::of(robot),
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    };
    plan(&terrain, robot, &query, Objective::Energy).unwrap()
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, ..ProptestConfig::default() })]

    #[test]
    fn the_interval_holds_the_energy_and_nothing_is_gained_where_nothing_can_be(
        sigmas in prop::array::uniform6(0.0f64..1.0),
        slopes in prop::array::uniform2(-0.15f64..0.15),
        waves_m in 0.0f64..0.4,
        regeneration in prop_oneof![Just(0.0), Just(1.0), 0.0f64..1.0],
        mu_roll in prop_oneof![Just(0.0), Just(1e-6), 0.01f64..0.3],
        hotel_power_w in prop_oneof![Just(0.0), 0.0f64..50.0],
        is_level in any::<bool>(),
    ) {
        let [mu_roll_sigma, mu_skid, k1, k2, mass_kg, hotel_sigma] = sigmas;
        let mut robot = builtin::husky_a200();
        robot.uncertainty =
            Uncertainty { mu_roll: mu_roll_sigma, mu_skid, k1, k2, mass_kg, hotel_power_w: hotel_sigma };
        robot.motors.regeneration = regeneration;
        robot.hotel_power_w = hotel_power_w;
        robot.surfaces.values_mut().for_each(|surface| surface.mu_roll = mu_roll);
        let found = across(&robot, |x_m, y_m| {
            if is_level { 3.0 } else { slopes[0] * x_m + slopes[1] * y_m + waves_m * (x_m / 2.0).sin() }
        });
        let ([low_j, high_j], energy_j) = (found.energy_interval_j, found.route.total.energy_j);
        prop_assert!(low_j.is_finite() && high_j.is_finite());
        prop_assert!(low_j <= energy_j && energy_j <= high_j, "{low_j} {energy_j} {high_j}");
        if is_level || regeneration == 0.0 {
            let least_w = hotel_power_w * (-model::robot::NORMAL_95 * hotel_sigma).exp();
            let standing_j = least_w * found.route.total.duration_s;
            prop_assert!(low_j >= standing_j * (1.0 - 1e-9), "{low_j} below the {standing_j} of standing loads");
        }
    }
}

#[test]
fn a_doubt_in_one_parameter_gives_the_energies_at_its_quantiles() {
    type Doubted = fn(f64) -> Uncertainty;
    type Scale = fn(&mut Robot, f64);
    let set: [(Doubted, Scale); 3] = [
        (
            |sigma| Uncertainty { mu_roll: sigma, ..CERTAIN },
            |robot, factor| {
                robot.surfaces.values_mut().for_each(|surface| surface.mu_roll *= factor);
            },
        ),
        (
            |sigma| Uncertainty { k1: sigma, ..CERTAIN },
            |robot, factor| {
                robot.motors.left.k1_w_per_n2 *= factor;
                robot.motors.right.k1_w_per_n2 *= factor;
            },
        ),
        (|sigma| Uncertainty { mass_kg: sigma, ..CERTAIN }, |robot, factor| robot.mass_kg *= factor),
    ];
    let mut plain = builtin::husky_a200();
    plain.uncertainty = CERTAIN;
    let certain = ahead(&plain);
    assert_eq!(certain.energy_interval_j, [certain.route.total.energy_j; 2], "nothing is in doubt");
    for (uncertainty, scale) in set {
        for sigma in [0.05, 0.3, 1.0] {
            let mut doubted = plain.clone();
            doubted.uncertainty = uncertainty(sigma);
            let quantile_j = |z: f64| {
                let mut robot = plain.clone();
                scale(&mut robot, (z * sigma).exp());
                ahead(&robot).route.total.energy_j
            };
            let [low_j, high_j] = ahead(&doubted).energy_interval_j;
            assert_relative_eq!(low_j, quantile_j(-1.959_964), max_relative = 1e-6);
            assert_relative_eq!(high_j, quantile_j(1.959_964), max_relative = 1e-6);
        }
    }
}

#[test]
fn small_independent_doubts_add_up_as_variances() {
    let half_j = |uncertainty: Uncertainty| {
        let mut robot = builtin::husky_a200();
        robot.uncertainty = uncertainty;
        let [low_j, high_j] = ahead(&robot).energy_interval_j;
        (high_j - low_j) / 2.0
    };
    let roll_j = half_j(Uncertainty { mu_roll: 0.01, ..CERTAIN });
    let mass_j = half_j(Uncertainty { mass_kg: 0.01, ..CERTAIN });
    let both_j = half_j(Uncertainty { mu_roll: 0.01, mass_kg: 0.01, ..CERTAIN });
    assert_relative_eq!(both_j, roll_j.hypot(mass_j), max_relative = 5e-3);
}
