//! Ground, robots and ways of driving of every kind.

use model::{
    KnownMechanism, PowerModel, Robot, builtin,
    mechanism::{self, Mechanism},
};
use planner::{Prices, Settings};
use rand::{Rng, RngExt};
use serde_json::json;
use terrain::{Grid, Surfaces, Terrain, areas::Areas, synthetic};

/// Hills of some height far above the sea, with unknown cells, obstacles, surfaces and areas on some of them.
pub(crate) fn ground(random: &mut impl Rng) -> Terrain {
    if random.random_bool(0.15) {
        return crate::ground::rough_terrain(random, 60);
    }
    let cell_size_m = [0.25, 0.5, 1.0, 1.0, 2.0, 5.0][random.random_range(0..6)];
    let grid = Grid { rows: 70, columns: 90, cell_size_m, origin_m: [0.0, 0.0] };
    let hill_m = cell_size_m * random.random_range(4.0..60.0);
    let height_m = hill_m * random.random_range(0.0..0.5);
    let sea_m = random.random_range(0.0..2000.0);
    let noise_m = if random.random_bool(0.5) { 0.02 * cell_size_m } else { 0.0 };
    let mut z = synthetic::relief(grid, random.random(), hill_m, height_m);
    for z in &mut z {
        *z += sea_m + noise_m * random.random_range(-1.0..1.0);
    }
    if random.random_bool(0.3) {
        z.iter_mut().filter(|_| random.random_bool(0.01)).for_each(|z| *z = f64::NAN);
    }
    let mut terrain = Terrain::new(grid, &z).unwrap();
    if random.random_bool(0.4) {
        let border = random.random_range(0..grid.columns);
        let class = (0..grid.cells()).map(|i| u8::from(grid.cell(i).column > border)).collect();
        let names = vec!["marble".into(), "sandy_loam".into()];
        terrain = terrain.with_surfaces(Surfaces { names, class });
    }
    if random.random_bool(0.3) {
        let [[ax, ay], [bx, by]] = [[0.1, 0.2], [0.6, 0.9]].map(|[x, y]| grid.at_fraction_m(x, y));
        let properties = [
            json!({"cost_factor": random.random_range(0.1..6.0)}),
            json!({"max_speed_mps": random.random_range(0.1..0.6)}),
            json!({"one_way_rad": random.random_range(-3.1..3.1)}),
        ];
        let area = json!({
            "type": "Feature",
            "geometry": {"type": "Polygon", "coordinates": [[[ax, ay], [bx, ay], [bx, by], [ax, by], [ax, ay]]]},
            "properties": properties[random.random_range(0..3)],
        });
        let areas = json!({"type": "FeatureCollection", "features": [area]});
        terrain = terrain.clone().with_areas(Areas::of(&areas, &terrain).unwrap());
    }
    let share = if random.random_bool(0.4) { 0.02 } else { 0.0 };
    synthetic::scatter_obstacles(terrain, random.random(), share)
}

/// A built-in robot or a Husky with whims, often with a mechanism or two.
pub(crate) fn robot(random: &mut impl Rng) -> Robot {
    let mut robot = if random.random_bool(0.6) {
        crate::ground::some_robot(random, 1.0)
    } else {
        let all = builtin::all();
        let surfaces = builtin::husky_a200().surfaces;
        let mut robot = all[random.random_range(0..all.len())].clone();
        robot.surfaces.extend(surfaces);
        robot
    };
    robot.motors.regeneration = [0.0, 0.4, 1.0][random.random_range(0..3)];
    robot.center_of_mass.forward_m =
        if random.random_bool(0.3) { random.random_range(-0.05..0.05) } else { 0.0 };
    robot.center_of_mass.height_m = if random.random_bool(0.3) { random.random_range(0.0..0.4) } else { 0.0 };
    if random.random_bool(0.2) {
        robot.surfaces.values_mut().for_each(|surface| surface.mu_roll *= 0.1);
    }
    // Others push or pull on level ground, where a table sets its scale.
    let names = ["payload", "load_transfer", "grade_dependent_friction", "motor_heating"];
    let physics: Vec<&'static dyn Mechanism> = mechanism::ALL
        .into_iter()
        .filter(|m| KnownMechanism::fits_file(*m) && names.contains(&m.name()))
        .collect();
    for _ in 0..[0, 0, 1, 2][random.random_range(0..4)] {
        let mechanism = physics[random.random_range(0..physics.len())];
        let values = mechanism.parameters().iter().map(|parameter| {
            let [low, high] = parameter.bounds_of(&robot);
            random.random_range(low..=high) * random.random_range(0.0..1.0)
        });
        let values = values.collect();
        robot.mechanisms.push(KnownMechanism::new(mechanism, values));
    }
    robot
}

pub(crate) fn settings(random: &mut impl Rng, robot: &Robot) -> Settings {
    let prices = Prices {
        reverse_j_per_m: random.random_range(0.0..200.0),
        spin_j_per_rad: random.random_range(0.0..200.0),
        ..Prices::default()
    };
    Settings {
        speed_mps: robot.max_wheel_speed_mps * random.random_range(0.05..1.0),
        reverse: random.random_bool(0.3),
        power_model: if random.random_bool(0.2) {
            PowerModel::DogruMarques
        } else {
            PowerModel::ForceBalance
        },
        prices: if random.random_bool(0.2) { prices } else { Prices::default() },
        least_radius_m: if random.random_bool(0.1) { 1.2 } else { 0.0 },
        ..Settings::of(robot)
    }
}
