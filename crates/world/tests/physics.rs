//! What physics says of a healthy robot, whatever the code is like.

#![allow(clippy::unwrap_used)]

use world::{
    Drive, DriveKind, Log, RobotFile, Row, Sensors, World, example_robot, simulate, simulate_closely,
};

const GRAVITY_MPS2: f64 = 9.806_65;

fn world(terrain: &str) -> World {
    let text = format!(r#"{{"terrain": {terrain}}}"#);
    World { sensors: Sensors::perfect(), ..World::from_json(&text).unwrap() }
}

/// A straight drive along x at 0.6 of a top speed of 1 m/s, on a slope that climbs along `x` when it climbs.
fn along(x_m: f64) -> Drive {
    let poses = format!(r#"[{{"x_m": 0, "y_m": 0}}, {{"x_m": {x_m}, "y_m": 0}}]"#);
    Drive::from_json(&format!(
        r#"{{"kind": "path", "duration_s": 40, "speed_mps": 1.0, "start": {{"x_m": 0, "y_m": 0, "heading_rad": {}}}, "poses": {poses}}}"#,
        if x_m > 0.0 { 0.0 } else { std::f64::consts::PI }
    ))
    .unwrap()
}

/// Rows in the middle of a straight drive.
fn steady(log: &Log) -> Vec<Row> {
    log.rows.iter().copied().filter(|row| (15.0..30.0).contains(&row.t_s)).collect()
}

fn mean(rows: &[Row], value: impl Fn(&Row) -> f64) -> f64 {
    rows.iter().map(value).sum::<f64>() / rows.len() as f64
}

/// Power of the example robot's sides by its file's constants, at a force on each side and a speed.
fn by_constants_w(robot: &RobotFile, force_n: f64, rim_mps: f64) -> f64 {
    let side = |k1: f64, k2: f64| k1 * force_n * force_n + k2 * rim_mps * force_n;
    let (left, right) = (robot.motors.left, robot.motors.right);
    side(left.k1_w_per_n2, left.k2) + side(right.k1_w_per_n2, right.k2)
}

#[test]
fn what_the_cells_give_is_found_again_as_heat_and_height() {
    let mut climbs = world(
        r#"{"rolling": {"grade": 0.08, "seed": 4}}, "wind": {"speed_mps": 8, "toward_rad": 1}, "effects": [
            {"effect": "payload", "strength": 20, "onset_s": 100}, {"effect": "inertia", "strength": 30},
            {"effect": "towed_load", "strength": 15}, {"effect": "turn_on_slope", "strength": 300}]"#,
    );
    climbs.step_s = 0.0005;
    for kind in [DriveKind::Rich, DriveKind::StopAndGo, DriveKind::Hill] {
        let ledger = simulate_closely(&climbs, &example_robot(), &Drive::new(kind, 300.0, 2)).unwrap().ledger;
        let missing = (ledger.given_j - ledger.spent_j()) / ledger.given_j;
        assert!(missing.abs() < 0.005, "{kind:?}: {missing} of {ledger:?}");
        for heat_j in
            [ledger.battery_j, ledger.copper_j, ledger.conversion_j, ledger.gears_j, ledger.sliding_j]
        {
            assert!(heat_j > 0.0, "heat only grows: {ledger:?}");
        }
    }
}

#[test]
fn a_straight_level_drive_costs_rolling_resistance() {
    let robot = example_robot();
    let rows = steady(&simulate(&world(r#""level""#), &robot, &along(60.0)).unwrap());
    let rim_mps = mean(&rows, |row| (row.rim_mps[0] + row.rim_mps[1]) / 2.0);
    let drawn_w = mean(&rows, |row| row.side_w[0] + row.side_w[1]);
    let hand_w = by_constants_w(&robot, 0.063 * 90.0 * GRAVITY_MPS2 / 2.0, rim_mps);
    assert!((rim_mps - 0.6).abs() < 0.01, "{rim_mps}");
    assert!((drawn_w / hand_w - 1.0).abs() < 0.03, "{drawn_w} W for {hand_w} W");
}

#[test]
fn a_spin_costs_the_skid_of_all_wheels() {
    let robot = example_robot();
    let log = simulate(&world(r#""level""#), &robot, &Drive::new(DriveKind::Rich, 900.0, 8)).unwrap();
    let spins: Vec<Row> = log
        .rows
        .windows(9)
        .filter(|w| {
            w.iter().all(|row| {
                let (sum, difference) = (row.rim_mps[0] + row.rim_mps[1], row.rim_mps[1] - row.rim_mps[0]);
                sum.abs() < 0.01
                    && difference.abs() > 0.2
                    && (difference - w[0].rim_mps[1] + w[0].rim_mps[0]).abs() < 0.01
            })
        })
        .map(|w| w[8])
        .collect();
    assert!(spins.len() > 50, "{}", spins.len());
    // Each side drives with half of the skid moment over half of the track, and rolls.
    let force_n = (0.29 * 0.54 / 0.54 + 0.063) * 90.0 * GRAVITY_MPS2 / 2.0;
    let ratio = mean(&spins, |row| {
        (row.side_w[0] + row.side_w[1])
            / by_constants_w(&robot, force_n, (row.rim_mps[1] - row.rim_mps[0]).abs() / 2.0)
    });
    assert!((ratio - 1.0).abs() < 0.06, "{ratio}");
    let track = mean(&spins, |row| (row.rim_mps[1] - row.rim_mps[0]) / row.yaw_rate_radps);
    assert!((0.54..0.57).contains(&track), "wheels slip a little: {track}");
}

#[test]
fn climbing_costs_more_than_descending_returns() {
    let robot = example_robot();
    let slope = world(r#"{"plane": {"grade": 0.1}}"#);
    let watts = |world: &World, x_m: f64| {
        let rows = steady(&simulate(world, &robot, &along(x_m)).unwrap());
        (mean(&rows, |row| row.side_w[0] + row.side_w[1]), mean(&rows, |row| row.pitch_rad))
    };
    let ((up_w, up_rad), (down_w, down_rad)) = (watts(&slope, 60.0), watts(&slope, -60.0));
    let (level_w, _) = watts(&world(r#""level""#), 60.0);
    assert!(
        (up_rad - 0.1f64.atan()).abs() < 1e-3 && (down_rad + 0.1f64.atan()).abs() < 1e-3,
        "pitch is positive uphill"
    );
    let lift_w = 90.0 * GRAVITY_MPS2 * up_rad.sin() * 0.6;
    assert!(up_w - level_w > 1.6 * lift_w, "gears and copper take their share: {up_w} {level_w} {lift_w}");
    assert!(down_w < 0.0 && -down_w < lift_w, "less comes back than the hill holds: {down_w} {lift_w}");
    assert!(up_w - level_w > 1.3 * (level_w - down_w), "{up_w} {level_w} {down_w}");
}

#[test]
fn finer_steps_change_little_and_less_and_less() {
    let mean_w = |step_s: f64| {
        let world = World { step_s, ..world(r#"{"rolling": {"grade": 0.05}}"#) };
        let drive = Drive::from_json(
            r#"{"kind": "path", "duration_s": 60, "poses": [{"x_m": 0, "y_m": 0}, {"x_m": 6, "y_m": 0},
                {"x_m": 6, "y_m": 6}, {"x_m": 0, "y_m": 6}, {"x_m": 0, "y_m": 0}]}"#,
        );
        let log = simulate(&world, &example_robot(), &drive.unwrap()).unwrap();
        mean(&log.rows, |row| row.battery_w)
    };
    let (coarse, fine, finest) = (mean_w(0.001), mean_w(0.000_5), mean_w(0.000_125));
    assert!((coarse / finest - 1.0).abs() < 0.01, "{coarse} {fine} {finest}");
    assert!((fine - finest).abs() <= (coarse - finest).abs() + 0.02, "{coarse} {fine} {finest}");
}

#[test]
fn robots_from_ten_to_six_hundred_kilograms_drive() {
    let husky = example_robot();
    for (mass_kg, size, speed_mps) in [(12.0, 0.5, 0.6), (600.0, 2.2, 4.0)] {
        let mut robot =
            RobotFile { mass_kg, max_wheel_speed_mps: speed_mps, yaw_inertia_kgm2: None, ..husky.clone() };
        for length in [&mut robot.wheelbase_m, &mut robot.track_m, &mut robot.wheel_radius_m] {
            *length *= size;
        }
        for motor in [&mut robot.motors.left, &mut robot.motors.right] {
            motor.k1_w_per_n2 *= (90.0 / mass_kg).powi(2) * speed_mps * mass_kg / 90.0;
        }
        let world = world(r#"{"rolling": {"grade": 0.05, "length_m": 40}}"#);
        let simulation = simulate_closely(&world, &robot, &Drive::new(DriveKind::Rich, 200.0, 1)).unwrap();
        let ledger = simulation.ledger;
        let missing = (ledger.given_j - ledger.spent_j()) / ledger.given_j;
        assert!(missing.abs() < 0.01, "{mass_kg} kg: {missing} of {ledger:?}");
        assert!(simulation.log.rows.iter().all(|row| row.battery_w.is_finite()));
        let fastest = simulation.log.rows.iter().map(|row| row.rim_mps[0].abs()).fold(0.0, f64::max);
        assert!(fastest < 1.1 * speed_mps, "{fastest}");
    }
}

#[test]
fn a_finer_step_changes_nothing_where_a_light_robot_starts_and_stops() {
    let mut robot = RobotFile { mass_kg: 17.0, yaw_inertia_kgm2: Some(0.45), ..example_robot() };
    let soft = robot.surfaces.values_mut();
    soft.for_each(|surface| surface.mu_roll = 0.10);
    let power_w = |step_s: f64| -> Vec<f64> {
        let world = World { step_s, ..world(r#""level""#) };
        let rows = simulate(&world, &robot, &Drive::new(DriveKind::StopAndGo, 120.0, 5)).unwrap().rows;
        rows.iter().map(|row| row.side_w[0] + row.side_w[1]).collect()
    };
    let (coarse_w, fine_w) = (power_w(0.001), power_w(0.0002));
    let square = |values: &mut dyn Iterator<Item = f64>| values.map(|w| w * w).sum::<f64>();
    let between = square(&mut coarse_w.iter().zip(&fine_w).map(|(a, b)| a - b));
    let share = (between / square(&mut fine_w.iter().copied())).sqrt();
    assert!(share < 0.03, "{share}");
}

#[test]
fn a_fast_robot_slows_down_before_it_turns_into_the_next_lane() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/robots/large.json"));
    let robot = RobotFile::from_json(&text.unwrap()).unwrap();
    let lanes = Drive::new(DriveKind::LawnMower, 240.0, 5);
    let log =
        simulate(&World { sensors: Sensors::perfect(), ..world(r#""level""#) }, &robot, &lanes).unwrap();
    let speed_mps = |row: &Row| (row.rim_mps[0] + row.rim_mps[1]) / 2.0;
    let sideways_mps2 = log.rows.iter().map(|row| (speed_mps(row) * row.yaw_rate_radps).abs());
    assert!(
        log.rows.iter().any(|row| speed_mps(row) > 1.5)
            && log.rows.iter().any(|row| row.yaw_rate_radps > 0.3)
    );
    // What brings it back to its lane comes on top of what its driver wants.
    let most_mps2 = sideways_mps2.fold(0.0, f64::max);
    assert!(most_mps2 < 0.3, "{most_mps2}");
}

#[test]
fn wheels_go_where_they_roll() {
    let robot = example_robot();
    let log = simulate(&world(r#""level""#), &robot, &along(60.0)).unwrap();
    let last = log.rows.last().unwrap();
    let rolled_m: f64 =
        log.rows.iter().map(|row| (row.rim_mps[0] + row.rim_mps[1]) / 2.0 / log.sensors.rate_hz).sum();
    assert!((last.position_m[0] / rolled_m - 1.0).abs() < 0.01, "{:?} {rolled_m}", last.position_m);
    assert!(last.position_m[1].abs() < 0.05, "straight ahead: {:?}", last.position_m);
}

#[test]
fn ground_that_the_map_does_not_know_and_surfaces_that_the_robot_does_not_are_refused_by_place() {
    let folder = std::env::temp_dir().join(format!("joulepath-world-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let refused = |map: &str| {
        std::fs::write(folder.join("map.json"), map).unwrap();
        let world = World::from_json(r#"{"terrain": {"map": "map.json"}}"#).unwrap().beside(&folder);
        simulate(&world, &example_robot(), &Drive::new(DriveKind::Rich, 20.0, 1)).unwrap_err().to_string()
    };
    let unknown =
        refused(r#"{"cell_size_m": 9, "rows": 2, "columns": 2, "elevation_m": [[0, null], [0, 0]]}"#);
    assert!(unknown.contains("unknown") && unknown.contains("(9."), "{unknown}");
    let moss = refused(
        r#"{"cell_size_m": 9, "rows": 1, "columns": 2, "elevation_m": [[0, 0]], "surface": [["moss", "moss"]]}"#,
    );
    assert!(moss.contains("surface") && moss.contains("moss") && moss.contains("marble"), "{moss}");
    std::fs::remove_file(folder.join("map.json")).unwrap();
    let world = World::from_json(r#"{"terrain": {"map": "map.json"}}"#).unwrap().beside(&folder);
    let absent = simulate(&world, &example_robot(), &Drive::new(DriveKind::Rich, 20.0, 1)).unwrap_err();
    assert_eq!(absent.field(), Some("terrain.map"));
    std::fs::remove_dir_all(folder).unwrap();
}
