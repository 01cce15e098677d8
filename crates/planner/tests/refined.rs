//! What refinement must and must not do to a route.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use approx::assert_relative_eq;
use model::{Attitude, Motion, Robot, Sides, builtin, power, robot::Surface};
use planner::{
    Footprint, HEADINGS, Heading, Lattice, Objective, Patience, Pose, Query, Route, Settings, State, plan,
    refine,
};
use rand::RngExt;
use terrain::{Cell, Grid, Terrain};

mod circles;
mod ground;

/// Random ground with obstacles, unknown cells, surfaces and whims, and routes over it that exist.
fn routes(objective: Objective, mut check: impl FnMut(&Lattice, &Query, &Route, &Route)) {
    let mut found = 0;
    for seed in 0..60 {
        let mut random = ground::random(4000 + seed);
        let side = 12 + 4 * (seed as usize % 4);
        let terrain = ground::small_terrain(&mut random, side);
        let robot = ground::some_robot(&mut random, [0.0, 0.5, 1.0][seed as usize % 3]);
        let query = ground::some_query(&mut random, &terrain, &robot);
        let Ok(answer) = plan(&terrain, &robot, &query, objective) else { continue };
        let lattice = Lattice::new(&terrain, &robot, query.settings).unwrap();
        let refined = refine(&lattice, objective, &answer.route, &Patience::default());
        assert!(refined.finished);
        check(&lattice, &query, &answer.route, &refined.route);
        found += 1;
    }
    assert!(found >= 25, "only {found} of 60 pairs have a route");
}

fn amount(objective: Objective, route: &Route) -> f64 {
    match objective {
        Objective::Energy => route.total.energy_j,
        Objective::Distance => route.total.length_m,
        Objective::Time => route.total.duration_s,
    }
}

#[test]
fn a_refined_route_is_never_worse_and_often_better() {
    for objective in [Objective::Energy, Objective::Distance, Objective::Time] {
        let (mut better, mut all) = (0, 0);
        routes(objective, |_, _, route, refined| {
            let (before, after) = (amount(objective, route), amount(objective, refined));
            // Length and time count a little energy in, to choose between equals.
            let tie = if objective == Objective::Energy { 0.0 } else { 1e-4 * before.abs() };
            assert!(after <= before + tie, "{objective:?}: {after} after {before}");
            better += usize::from(after < 0.99 * before);
            all += 1;
        });
        assert!(better * 3 > all, "{objective:?}: better by a hundredth on {better} of {all}");
    }
}

#[test]
fn a_refined_route_begins_and_ends_in_the_very_poses_of_the_route() {
    routes(Objective::Energy, |_, _, route, refined| {
        let ends = |route: &Route| {
            [route.poses.first(), route.poses.last()].map(|pose| pose.map(|p| (p.x_m, p.y_m, p.heading_rad)))
        };
        assert_eq!(ends(refined), ends(route));
        let (z, wanted) = (refined.poses.last().unwrap().z_m, route.poses.last().unwrap().z_m);
        assert_relative_eq!(z, wanted, epsilon = 1e-4);
    });
}

/// Poses along the stretch between two poses, so dense that nothing fits between them.
fn between(a: &Pose, b: &Pose) -> Vec<[f64; 3]> {
    let turn = wrapped(b.heading_rad - a.heading_rad);
    let reach_m = (b.x_m - a.x_m).hypot(b.y_m - a.y_m) + turn.abs();
    let count = 2 * (reach_m / 0.02).ceil().max(1.0) as usize;
    let chord_rad = (b.y_m - a.y_m).atan2(b.x_m - a.x_m);
    let chord_m = (b.x_m - a.x_m).hypot(b.y_m - a.y_m);
    (0..=count)
        .map(|i| {
            let share = i as f64 / count as f64;
            // On a circle a chord is as its half turn's sine, and points half way between the headings.
            let (length_m, off_rad) = if turn.abs() < 1e-9 {
                (chord_m * share, 0.0)
            } else {
                let half = turn / 2.0;
                (chord_m * (half * share).sin() / half.sin(), half * share - half)
            };
            let way = chord_rad + off_rad;
            [a.x_m + length_m * way.cos(), a.y_m + length_m * way.sin(), a.heading_rad + turn * share]
        })
        .collect()
}

fn wrapped(angle: f64) -> f64 {
    (angle + std::f64::consts::PI).rem_euclid(std::f64::consts::TAU) - std::f64::consts::PI
}

/// The first cell that the robot touches in a pose and must not, by corners and edges of cells and robot.
fn touched(terrain: &Terrain, robot: &Robot, [x, y, heading]: [f64; 3]) -> Option<String> {
    let grid = &terrain.grid;
    let outline = Footprint::of(robot);
    let (half_l, half_w) = (outline.length_m / 2.0, outline.width_m / 2.0);
    let (sin, cos) = heading.sin_cos();
    // Points on the outline and within it, closer together than anything that matters.
    let steps = 24;
    let share = |i: i32| f64::from(i) / f64::from(steps) * 2.0 - 1.0;
    (0..=steps).flat_map(|i| (0..=steps).map(move |j| (share(i), share(j)))).find_map(|(i, j)| {
        let (along, across) = (i * half_l, j * half_w);
        let (px, py) = (x + along * cos - across * sin, y + along * sin + across * cos);
        match grid.cell_at(px, py) {
            None => Some(format!("off the map at {px} {py}")),
            Some(cell) => terrain.is_blocked(cell).then(|| format!("{cell:?} from {x} {y} {heading}")),
        }
    })
}

#[test]
fn a_refined_route_touches_no_obstacle_and_no_unknown_ground() {
    routes(Objective::Energy, |lattice, _, route, refined| {
        let given: Vec<(f64, f64)> = route.poses.iter().map(|p| (p.x_m, p.y_m)).collect();
        for pair in refined.poses.windows(2) {
            // Steps that the lattice made are checked where lattices are.
            let steps_of_route = |p: &Pose| given.contains(&(p.x_m, p.y_m));
            if steps_of_route(&pair[0]) && steps_of_route(&pair[1]) {
                continue;
            }
            for pose in between(&pair[0], &pair[1]) {
                assert_eq!(touched(&lattice.terrain, &lattice.robot, pose), None);
            }
        }
    });
}

#[test]
fn limits_hold_along_a_refined_route() {
    let mut steeper = 0;
    routes(Objective::Distance, |lattice, query, route, _| {
        let mut robot = lattice.robot.clone();
        // As tight as this route allows, so that there are shortcuts to be refused.
        let largest = |of: fn(&Pose) -> f64| route.poses.iter().map(|p| of(p).abs()).fold(0.0, f64::max);
        robot.limits.max_pitch_rad = (largest(|p| p.pitch_rad) + 1e-6).max(0.01);
        robot.limits.max_roll_rad = (largest(|p| p.roll_rad) + 1e-6).max(0.01);
        let bound = Lattice::new(&lattice.terrain, &robot, query.settings).unwrap();
        let refined = refine(&bound, Objective::Distance, route, &Patience::default()).route;
        for (pair, step) in refined.poses.windows(2).zip(&refined.steps) {
            let run_m =
                (pair[1].distance_m - pair[0].distance_m).powi(2) - (pair[1].z_m - pair[0].z_m).powi(2);
            let grade = if run_m > 1e-9 { (pair[1].z_m - pair[0].z_m) / run_m.sqrt() } else { 0.0 };
            assert!(grade.abs() <= robot.limits.max_pitch_rad.tan() + 1e-6, "{grade} up");
            let dense = between(&pair[0], &pair[1]);
            let [x, y, heading] = dense[dense.len() / 2];
            let cell = bound.terrain.grid.cell_at(x, y).unwrap();
            // Within rounding of a cell's edge either neighbour may be meant.
            let [cx, cy] = bound.terrain.grid.center_m(cell);
            if (x - cx).abs().max((y - cy).abs()) < 0.49 && dense.len() % 2 == 1 {
                // The contacts are those of the nearest heading, the slope across is that of the robot's own; half way between
                // two headings either may be meant.
                let nearest_rad = Heading::nearest(heading).angle_rad();
                let off_rad = wrapped(heading - nearest_rad);
                let grades = ground::wheel_grades(&bound.terrain, &robot, cell, nearest_rad);
                if let Some((along, across)) = grades.filter(|_| off_rad.abs() < 0.15) {
                    let side = across * off_rad.cos() - along * off_rad.sin();
                    assert!(side.abs() <= robot.limits.max_roll_rad.tan() + 2e-3, "{side} across");
                }
            }
            assert!(step.motion.rim_speeds_mps.left.abs() <= robot.max_wheel_speed_mps + 1e-9);
            assert!(step.motion.rim_speeds_mps.right.abs() <= robot.max_wheel_speed_mps + 1e-9);
        }
        steeper +=
            usize::from(refine(lattice, Objective::Distance, route, &Patience::default()).route != refined);
    });
    assert!(steeper >= 5, "the limits must matter on this ground, and do on {steeper} routes");
}

/// Integrates the power model over nothing but poses and the map.
fn reintegrated_j(lattice: &Lattice, settings: &Settings, route: &Route) -> f64 {
    let robot = &lattice.robot;
    let stretch_j = |(i, pair): (usize, &[Pose])| {
        let (a, b) = (&pair[0], &pair[1]);
        let dt = b.t_s - a.t_s;
        let dense = between(a, b);
        let middle = dense[dense.len() / 2];
        let cell = lattice.terrain.grid.cell_at(middle[0], middle[1]).unwrap();
        let [cx, cy] = lattice.terrain.grid.center_m(cell);
        // On the edge of a cell rounding says which one is meant.
        let within = (middle[0] - cx).abs().max((middle[1] - cy).abs()) < 0.5 - 1e-6;
        let class = |s: &terrain::Surfaces| {
            if within {
                usize::from(s.class[lattice.terrain.grid.index(cell)])
            } else {
                route.steps[i].surface
            }
        };
        let surface = lattice.terrain.surfaces().map_or("marble", |s| &s.names[class(s)]);
        let ahead = (b.x_m - a.x_m) * middle[2].cos() + (b.y_m - a.y_m) * middle[2].sin();
        let speed = (b.distance_m - a.distance_m) / dt * if ahead < 0.0 { -1.0 } else { 1.0 };
        // The yaw rate is that of the map's plane, the speed that along the ground.
        let level = b.pitch_rad.cos();
        let yaw =
            wrapped(b.heading_rad - a.heading_rad) / (dt * if b.radius_m == Some(0.0) { 1.0 } else { level });
        let motion = Motion::of_body(robot, speed, yaw);
        let attitude = Attitude { pitch_rad: b.pitch_rad, roll_rad: b.roll_rad };
        let temperature = Sides::both(settings.motor_temperature_c);
        power(settings.power_model, robot, robot.surface(surface).unwrap(), motion, attitude, temperature)
            .bus_w
            * dt
    };
    route.poses.windows(2).enumerate().map(stretch_j).sum()
}

#[test]
fn integrating_the_poses_of_a_refined_route_anew_gives_the_same_energy() {
    let mut off = Vec::new();
    routes(Objective::Energy, |lattice, query, _, refined| {
        let anew_j = reintegrated_j(lattice, &query.settings, refined);
        let total_j = refined.total.energy_j;
        let gross_j: f64 = refined.steps.iter().map(|s| s.energy_j().abs()).sum();
        off.push((anew_j - total_j).abs() / gross_j);
        assert_relative_eq!(refined.poses.last().unwrap().energy_j, total_j, epsilon = 1e-9);
        let edges_j: f64 = refined.edges.iter().map(|e| e.energy_j).sum();
        assert_relative_eq!(edges_j, total_j, epsilon = 1e-9 * gross_j);
        for pose in &refined.poses {
            // Where all of the ground is known.
            if let Some(z) = ground::standing_m(&lattice.terrain, &lattice.robot, pose.x_m, pose.y_m) {
                assert_relative_eq!(pose.z_m, z, epsilon = 2e-3);
            }
        }
    });
    assert!(off.iter().all(|share| *share < 1e-6), "{off:?}");
}

#[test]
fn without_patience_the_route_itself_comes_back() {
    let patience = Patience::until(std::time::Instant::now());
    routes(Objective::Energy, |lattice, _, route, refined| {
        let kept = refine(lattice, Objective::Energy, route, &patience);
        assert!(!kept.finished && kept.route == *route);
        let again = refine(lattice, Objective::Energy, route, &Patience::default());
        assert_eq!(again.route, *refined, "and with patience always the same");
    });
}

/// Level ground, a Husky that gets nothing back, and what it is driven on.
fn flat(side: usize, slip_angle_scale_rad: f64) -> (Terrain, Robot) {
    let grid = Grid { rows: side, columns: side, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
    let mut robot = builtin::husky_a200();
    robot.motors.regeneration = 0.0;
    let marble = robot.surfaces["marble"].clone();
    robot.surfaces.insert("marble".into(), Surface { slip_angle_scale_rad, ..marble });
    (Terrain::new(grid, &vec![0.0; grid.cells()]).unwrap(), robot)
}

fn between_states(terrain: &Terrain, robot: &Robot, [from, to]: [State; 2]) -> Query {
    let [sx, sy] = terrain.grid.center_m(from.cell);
    let [gx, gy] = terrain.grid.center_m(to.cell);
    Query {
        start: planner::Start { x_m: sx, y_m: sy, heading_rad: Some(from.heading.angle_rad()) },
        goal: planner::Goal {
            x_m: gx,
            y_m: gy,
            heading_rad: Some(to.heading.angle_rad()),
            either_way: false,
            tolerance_m: 0.0,
        },
        settings: Settings::of(robot),
        other_goals: Vec::new(),
        snap_radius_m: None,
        bound: 1.0,
        refine: false,
        exact_ends: false,
        patience: Patience::default(),
    }
}

/// Refined over best circle-line-circle energies of random pose pairs, sorted.
fn ratios(slip_angle_scale_rad: f64, pairs: usize, seed: u64) -> Vec<f64> {
    let side = 40;
    let (terrain, robot) = flat(side, slip_angle_scale_rad);
    let lattice = Lattice::new(&terrain, &robot, Settings::of(&robot)).unwrap();
    let mut random = ground::random(seed);
    let rates = circles::Rates::new(&robot, &Settings::of(&robot));
    let mut ratios: Vec<f64> = (0..pairs)
        .map(|_| {
            // Away from the map's edge, which the best curves do not know of.
            let mut state = || State {
                cell: Cell { row: random.random_range(12..28), column: random.random_range(12..28) },
                heading: Heading::new(random.random_range(0..HEADINGS)),
            };
            let ends = [state(), state()];
            let answer =
                plan(&terrain, &robot, &between_states(&terrain, &robot, ends), Objective::Energy).unwrap();
            let refined = refine(&lattice, Objective::Energy, &answer.route, &Patience::default()).route;
            let pose = |state: State| {
                let [x, y] = terrain.grid.center_m(state.cell);
                [x, y, state.heading.angle_rad()]
            };
            let best_j = rates.best_j(pose(ends[0]), pose(ends[1]));
            if best_j == 0.0 { 1.0 } else { refined.total.energy_j / best_j }
        })
        .collect();
    ratios.sort_by(f64::total_cmp);
    let at = |share: f64| ratios[((pairs - 1) as f64 * share) as usize];
    println!(
        "scale {slip_angle_scale_rad}: least {:.4}, 5 % {:.4}, median {:.4}, 95 % {:.4}, most {:.4}",
        at(0.0),
        at(0.05),
        at(0.5),
        at(0.95),
        at(1.0)
    );
    ratios
}

#[test]
fn on_flat_ground_a_refined_route_is_within_two_percent_of_the_best_circle_line_circle() {
    // Marble as it is, and with the paper's Coulomb skid.
    for (slip_angle_scale_rad, seed) in [(0.30, 1), (0.0, 2)] {
        let ratios = ratios(slip_angle_scale_rad, 200, seed);
        assert!(ratios.iter().all(|r| *r <= 1.02), "{:?}", ratios.iter().rev().take(5).collect::<Vec<_>>());
    }
}

#[test]
fn tight_turns_are_best_at_half_the_slip_track_to_within_one_primitive_step() {
    // A step from that radius to the next: down to the spot, up to the widest arc round a corner of one cell's legs.
    for slip_track_m in [0.54, 0.7] {
        let (terrain, mut robot) = flat(8, 0.0);
        robot.slip_track_m = slip_track_m;
        let half_m = slip_track_m / 2.0;
        let settings = Settings::of(&robot);
        let lattice = Lattice::new(&terrain, &robot, settings).unwrap();
        let radii_m = lattice.motions.iter().flatten().flat_map(|m| &m.variants).flatten();
        let radii_m =
            radii_m.filter_map(planner::Piece::radius_m).map(f64::abs).filter(|r| *r > half_m + 1e-6);
        let next_m = radii_m.fold(f64::INFINITY, f64::min);
        let step_m = half_m.min(next_m - half_m);
        // With Coulomb skid over all radii; on marble, whose skid fades in arcs of many metres, among tight turns.
        for (slip_angle_scale_rad, widest_m) in [(0.0, 50.0), (0.30, 2.0 * half_m)] {
            let robot = Robot { surfaces: flat(8, slip_angle_scale_rad).1.surfaces, ..robot.clone() };
            let rates = circles::Rates::new(&robot, &settings);
            for sign in [1.0, -1.0] {
                // A right angle between two straights: the arc replaces a tangent's length of each.
                let corner_j = |radius_m: f64| {
                    let quarter = std::f64::consts::FRAC_PI_2;
                    rates.turn_j_per_rad(radius_m, sign) * quarter - 2.0 * radius_m * rates.straight_j_per_m
                };
                let radii = (0..10_000).map(|i| f64::from(i) * 0.005).filter(|r| *r <= widest_m);
                let best_m = radii.min_by(|a, b| corner_j(*a).total_cmp(&corner_j(*b))).unwrap();
                println!(
                    "scale {slip_angle_scale_rad}, slip track {slip_track_m}: best {best_m} m, step {step_m} m"
                );
                assert!(
                    (best_m - half_m).abs() <= step_m,
                    "{best_m} m is not within {step_m} m of {half_m} m"
                );
            }
        }
    }
}
