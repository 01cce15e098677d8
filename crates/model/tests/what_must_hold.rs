//! The claims that the power model stands on, each tested against the paper or against energy itself.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use approx::assert_relative_eq;
use model::{
    Attitude, Motion, PowerModel, Robot, STANDARD_GRAVITY_MPS2, Sides, builtin,
    paper::{turning_friction, turning_friction_columns},
    power,
    robot::Surface,
    rolling,
};
use proptest::prelude::*;

mod paper_tables;

fn marble() -> Surface {
    builtin::husky_a200().surfaces["marble"].clone()
}

fn coulomb() -> Surface {
    Surface { slip_angle_scale_rad: 0.0, ..marble() }
}

fn at(robot: &Robot, surface: &Surface, v: f64, w: f64, attitude: Attitude) -> model::Power {
    power(PowerModel::ForceBalance, robot, surface, Motion::of_body(robot, v, w), attitude, Sides::both(20.0))
}

/// Friction that eqs. 15 and 16 speak of: mechanical power over outer rim speed and weight.
fn effective_friction(robot: &Robot, surface: &Surface, radius_m: f64, v: f64) -> f64 {
    let p = at(robot, surface, v, v / radius_m, Attitude::LEVEL);
    let outer_mps = v * (1.0 + robot.track_m / 2.0 / radius_m);
    p.mechanical_w.sum() / (outer_mps * robot.mass_kg * STANDARD_GRAVITY_MPS2)
}

proptest! {
    #[test]
    fn coulomb_skid_reproduces_eq_15_but_turns_about_the_heavier_axle(
        forward in -0.25f64..0.25, left in -0.25f64..0.25, radius in 0.31f64..20.0,
    ) {
        let mut robot = builtin::husky_a200();
        robot.center_of_mass.forward_m = forward;
        robot.center_of_mass.left_m = left;
        // Turning left, the right side is the outer one.
        let (roll, skid) = turning_friction_columns(&robot, radius, -left, 1.0);
        // Eq. 15's loads and arms, 2a (1/4 − (δx/a)²), against what the lighter axle holds over the wheelbase.
        let share = forward.abs() / robot.wheelbase_m;
        let balanced = (0.5 - share) / (2.0 * (0.25 - share * share));
        let expected = 0.063 * roll + 0.29 * balanced * skid;
        let found = effective_friction(&robot, &coulomb(), radius, 0.9);
        prop_assert!((found - expected).abs() < 1e-6, "{found} against {expected}");
    }

    #[test]
    fn the_printed_model_reproduces_eq_16_for_any_centre_of_mass(
        forward in -0.25f64..0.25, left in -0.25f64..0.25, radius in 0.31f64..20.0,
    ) {
        let mut robot = builtin::husky_a200();
        robot.center_of_mass.forward_m = forward;
        robot.center_of_mass.left_m = left;
        let (surface, correction) = (coulomb(), rolling::center_of_mass_correction(&robot));
        let motion = Motion::of_body(&robot, 0.9, 0.9 / radius);
        let p = power(PowerModel::DogruMarques, &robot, &surface, motion, Attitude::LEVEL, Sides::both(20.0));
        let outer_mps = 0.9 * (1.0 + robot.track_m / 2.0 / radius);
        let found = p.mechanical_w.right / (outer_mps * robot.mass_kg * STANDARD_GRAVITY_MPS2);
        let eq_16 = turning_friction(&robot, radius, -left, correction, (surface.mu_roll, surface.mu_skid));
        prop_assert!((found - eq_16).abs() < 1e-6, "{found} against eq. 16's {eq_16}");
    }

    #[test]
    fn no_motion_on_any_slope_yields_more_than_the_hill_holds(
        v in -1.0f64..1.0, w in -2.0f64..2.0, pitch in -0.5f64..0.5, roll in -0.4f64..0.4, r in 0.0f64..=1.0,
        left in -0.2f64..0.2, slip_track in 0.54f64..1.0,
    ) {
        let mut robot = builtin::husky_a200();
        robot.motors.regeneration = r;
        robot.center_of_mass.left_m = left;
        robot.slip_track_m = slip_track;
        let p = at(&robot, &marble(), v, w, Attitude { pitch_rad: pitch, roll_rad: roll });
        let gravity_w = robot.mass_kg * STANDARD_GRAVITY_MPS2 * pitch.sin() * v;
        prop_assert!(p.mechanical_w.sum() >= gravity_w - 1e-9, "friction must not push");
        // The potential that keeps A* exact: P ≥ κ · gravity power, κ the smaller k2.
        let kappa = robot.motors.left.k2.min(robot.motors.right.k2);
        prop_assert!(p.bus_w >= kappa * gravity_w - 1e-9);
        let motion = Motion::of_body(&robot, v, w);
        let attitude = Attitude { pitch_rad: pitch, roll_rad: roll };
        let printed = power(PowerModel::DogruMarques, &robot, &marble(), motion, attitude, Sides::both(20.0));
        prop_assert!(printed.bus_w >= kappa * gravity_w - 1e-9, "and so does the printed form");
        prop_assert!(p.bus_w >= gravity_w.min(0.0) - 1e-9, "more than m g dh came back");
    }

    #[test]
    fn power_mirrors_when_turning_the_other_way(v in -1.0f64..1.0, w in -2.0f64..2.0, pitch in -0.4f64..0.4) {
        let mut robot = builtin::husky_a200();
        robot.motors.right = robot.motors.left;
        let attitude = Attitude { pitch_rad: pitch, roll_rad: 0.0 };
        let (a, b) = (at(&robot, &marble(), v, w, attitude), at(&robot, &marble(), v, -w, attitude));
        prop_assert!((a.side_w.left - b.side_w.right).abs() < 1e-9);
        prop_assert!((a.bus_w - b.bus_w).abs() < 1e-9);
    }
}

#[test]
fn one_constant_set_reproduces_the_shape_of_table_ii() {
    let table = paper_tables::table_ii();
    let close = |found: f64, claimed: f64, tolerance: f64| {
        assert!((found - claimed).abs() <= tolerance, "{found} is not {claimed}");
    };
    close(table.spin.left, 0.175, 0.001);
    close(table.spin.right, 0.175, 0.001);
    close(table.straight.left, 0.0315, 1e-4);
    close(table.outer_mean, 0.133, 0.002);
    close(table.outer_max, 0.170, 0.002);
    close(table.inner_min, -0.107, 0.002);
    // And the paper's own figures, to the accuracy that one set of constants can have.
    close(table.spin.left, 0.1734, 0.003);
    close(table.spin.right, 0.1703, 0.006);
    close(table.straight.sum(), 0.0381 + 0.0248, 0.001);
    close(table.outer_mean, 0.1340, 0.005);
    close(table.outer_max, 0.1787, 0.010);
    close(table.inner_min, -0.0973, 0.012);
}

#[test]
fn the_speed_trend_of_fig_13_appears_without_any_speed_dependence() {
    let fits = paper_tables::fig_13();
    assert!(fits.len() >= 6);
    for pair in fits.windows(2) {
        assert!(pair[1].mu_roll < pair[0].mu_roll, "mu_R must fall with speed: {fits:?}");
        assert!(pair[1].mu_skid > pair[0].mu_skid, "mu_S must rise with speed: {fits:?}");
    }
    let (slowest, fastest) = (fits.first().unwrap(), fits.last().unwrap());
    assert!(slowest.mu_roll > 2.0 * fastest.mu_roll && fastest.mu_skid > 1.5 * slowest.mu_skid, "{fits:?}");
    // The reason: slow runs sit in R ≤ R_c, where both sides drive and eq. 16 is not the right split.
    assert!(slowest.share_inside > 0.8 && fastest.share_inside == 0.0, "{fits:?}");
}

#[test]
fn spinning_on_marble_draws_what_the_paper_measured_cold_and_warm() {
    // §V-B: 1 rad/s, 20 °C → 76 °C at the case: 106 → 150 W (M1, left) and 116 → 193 W (M2, right).
    let robot = builtin::husky_a200();
    let spin = |t: f64| {
        let motion = Motion::of_body(&robot, 0.0, 1.0);
        power(PowerModel::ForceBalance, &robot, &marble(), motion, Attitude::LEVEL, Sides::both(t)).side_w
    };
    let (cold, hot) = (spin(20.0), spin(76.0));
    let within = |found: f64, paper: f64, share: f64| {
        assert!((found / paper - 1.0).abs() <= share, "{found} W against the paper's {paper} W");
    };
    within(cold.left, 106.0, 0.20);
    within(cold.right, 116.0, 0.05);
    within(hot.left, 150.0, 0.08);
    within(hot.right, 193.0, 0.30);
    within(cold.sum(), 106.0 + 116.0, 0.10);
    within(hot.sum(), 150.0 + 193.0, 0.15);
}

#[test]
fn a_heavier_robot_spins_for_less_where_the_load_lies_over_the_rear_axle() {
    // §V-B: up to 250 W with 14 kg on the front, which bring the centre of mass to the middle; only up to 200 W with 28 kg on the back,
    // "even when rotating faster".
    let spin_w = |model: PowerModel, robot: &Robot| {
        let motion = Motion::of_body(robot, 0.0, 1.0);
        power(model, robot, &marble(), motion, Attitude::LEVEL, Sides::both(20.0)).side_w.sum()
    };
    let share =
        |model| spin_w(model, &builtin::configuration_c()) / spin_w(model, &builtin::configuration_b());
    let (balanced, printed) = (share(PowerModel::ForceBalance), share(PowerModel::DogruMarques));
    assert!(balanced < 0.8, "{balanced} at the same rate");
    // Eq. 16, whose centre of turning stays abreast of the centre of mass, would have the robot turn no faster at 200 W.
    assert!(printed > 0.8, "{printed} at the same rate");
}

#[test]
fn power_and_side_forces_have_no_jump_anywhere_from_spin_to_straight() {
    let robot = builtin::husky_a200();
    // Sweep the angle of (v, ω b/2) right round the circle: it passes R = 0, ±R_c and ±∞ twice each.
    let steps = 200_000;
    let outer_mps = 0.5;
    let sample = |i: i32| {
        let angle = std::f64::consts::TAU * f64::from(i) / f64::from(steps);
        let (v, w) = (outer_mps * angle.cos(), outer_mps * angle.sin() / (robot.track_m / 2.0));
        at(&robot, &marble(), v, w, Attitude { pitch_rad: 0.05, roll_rad: 0.0 })
    };
    let mut before = sample(0);
    let (mut force_step_n, mut power_step_w) = (0.0f64, 0.0f64);
    for i in 1..=steps {
        let now = sample(i);
        force_step_n = force_step_n.max((now.force_n.left - before.force_n.left).abs());
        force_step_n = force_step_n.max((now.force_n.right - before.force_n.right).abs());
        power_step_w = power_step_w.max((now.bus_w - before.bus_w).abs());
        before = now;
    }
    // The steepest place is a wheel turning round within 0.001 m/s; the jump of Coulomb friction there would be 56 N.
    assert!(force_step_n < 1.0, "{force_step_n} N in one step of {steps}");
    assert!(power_step_w < 1.0, "{power_step_w} W in one step of {steps}");
}

#[test]
fn the_printed_form_does_jump_at_r_c() {
    let robot = builtin::husky_a200();
    let at = |radius_m: f64| {
        let motion = Motion::of_body(&robot, 0.3, 0.3 / radius_m);
        power(PowerModel::DogruMarques, &robot, &marble(), motion, Attitude::LEVEL, Sides::both(20.0)).bus_w
    };
    assert!((at(0.27 * 0.999) - at(0.27 * 1.001)).abs() > 10.0);
}

#[test]
fn the_cheapest_radius_to_turn_at_is_near_half_the_slip_track() {
    // What a turn at a given yaw rate costs beyond the straight driving that its arc saves, per radian, on the
    // flat without regeneration; Effati & Skonieczny (IJRR, 2023) find the same optimum for their rover.
    for slip_track_m in [0.54, 0.7] {
        let mut robot = builtin::husky_a200();
        robot.motors.regeneration = 0.0;
        robot.motors.right = robot.motors.left;
        robot.slip_track_m = slip_track_m;
        let w = 1.0;
        let turn_j_per_rad = |surface: &Surface, radius_m: f64| {
            let straight_j_per_m = at(&robot, surface, 0.5, 0.0, Attitude::LEVEL).bus_w / 0.5;
            at(&robot, surface, w * radius_m, w, Attitude::LEVEL).bus_w / w - straight_j_per_m * radius_m
        };
        // Coulomb skid over all radii; with a slip angle scale arcs of many metres skid less and less, so the
        // optimum is the best of the tight turns.
        for (surface, widest_m) in [(coulomb(), 20.0), (marble(), 0.6)] {
            let radii = (0..4000).map(|i| f64::from(i) * 0.005).filter(|r| *r < widest_m);
            let cost = |r: f64| turn_j_per_rad(&surface, r);
            let best = radii.min_by(|a, b| cost(*a).total_cmp(&cost(*b))).unwrap();
            assert_relative_eq!(best, slip_track_m / 2.0, epsilon = 0.03);
        }
    }
}

#[test]
fn a_load_at_the_back_eases_turning_and_one_at_the_side_makes_it_dearer() {
    // §V-C, Fig. 11: configuration C turns with the least power despite its weight, D with the most.
    let spin = |robot: &Robot| at(robot, &robot.surfaces["marble"], 0.0, 1.0, Attitude::LEVEL).bus_w;
    let (b, c) = (spin(&builtin::configuration_b()), spin(&builtin::configuration_c()));
    assert!(c < b, "C {c} W, B {b} W");
    let arc = |robot: &Robot| at(robot, &robot.surfaces["marble"], 0.5, 0.6, Attitude::LEVEL).bus_w;
    let (b, d) = (arc(&builtin::configuration_b()), arc(&builtin::configuration_d()));
    assert!(d > b, "D {d} W, B {b} W");
}
