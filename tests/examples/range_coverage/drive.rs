//! One mission: planned, predicted, and driven in the world.

use std::path::PathBuf;

use mission::{Doubt, Question, range};
use model::{Robot, builtin};
use planner::{Goal, Objective, Patience, Planner, Query, Settings, Start};
use rand::{RngExt, SeedableRng};
use rand_distr::StandardNormal;
use rand_pcg::Pcg64Mcg;
use terrain::{Grid, Terrain, synthetic};
use world::{Drive, DriveKind, MapPath, Relief, RobotFile, Waypoint, World, simulate_closely};

/// Cells a side of the ground of a mission, 1 m each.
const SIDE: usize = 80;
/// The pilot of the world drives paths at this share of the speed that it is given.
const PILOT_SHARE: f64 = 0.6;
/// Draws of a prediction.
const SAMPLES: usize = 1000;

/// A mission drawn from a seed.
pub(crate) struct Case {
    planner: Planner,
    query: Query,
    heights_m: Vec<f64>,
    grid: Grid,
    scatter: f64,
    seed: u64,
    random: Pcg64Mcg,
}

/// What was predicted and what became of it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Scored {
    /// Driven energy at the battery's terminals [J].
    pub(crate) driven_j: f64,
    /// As files say [J].
    pub(crate) nominal_j: f64,
    /// Ends of the predicted interval [J].
    pub(crate) p05_j: f64,
    /// See `p05_j` [J].
    pub(crate) p95_j: f64,
    /// Predicted.
    pub(crate) success_probability: f64,
    /// Whether the world's battery kept the reserve.
    pub(crate) succeeded: bool,
    /// What the drives draw and return together, as planned [J].
    pub(crate) gross_j: f64,
}

/// A Husky whose file says of the battery what the world's is like: no Peukert loss, which the world does not have.
fn husky() -> Robot {
    let mut robot = builtin::husky_a200();
    if let Some(battery) = &mut robot.battery {
        battery.peukert_exponent = 1.0;
        battery.full_voltage_v = Some(1.06 * battery.nominal_voltage_v);
        battery.empty_voltage_v = Some(0.96 * battery.nominal_voltage_v);
        battery.charge_efficiency = 1.0;
        battery.charge_acceptance_per_h = 100.0;
    }
    robot
}

impl Case {
    /// Gentle ground, on which the world's pilot keeps to the path within decimetres (on rougher ground it cuts the windings of an
    /// energy-minimal path, and what it draws is that of another way), and a way of 20 to 70 m over it; `None` where no path leads.
    pub(crate) fn draw(seed: u64, scatter: f64) -> Option<Self> {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let grid = Grid { rows: SIDE, columns: SIDE, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        let (longest_m, height_m) = (random.random_range(30.0..60.0), random.random_range(0.2..1.5));
        let heights_m = synthetic::relief(grid, random.random(), longest_m, height_m);
        let terrain = Terrain::new(grid, &heights_m).ok()?;
        let robot = husky();
        let planner = Planner::new(&terrain, &robot, Settings::of(&robot)).ok()?;
        let mut place = || -> [f64; 2] { [random.random_range(8.0..72.0), random.random_range(8.0..72.0)] };
        let mut ends = std::iter::repeat_with(|| (place(), place()));
        let ([sx, sy], [gx, gy]) =
            ends.find(|(s, g)| (20.0..70.0).contains(&(s[0] - g[0]).hypot(s[1] - g[1])))?;
        let query = Query {
            start: Start { x_m: sx, y_m: sy, heading_rad: None },
            goal: Goal { x_m: gx, y_m: gy, heading_rad: None, either_way: false, tolerance_m: 0.0 },
            settings: planner.lattice().settings,
            other_goals: Vec::new(),
            snap_radius_m: None,
            bound: 1.0,
            refine: false,
            exact_ends: false,
            patience: Patience::default(),
        };
        Some(Case { planner, query, heights_m, grid, scatter, seed, random })
    }
}

/// Predicts and drives; `None` where no path leads or the world's pilot does not get there.
pub(crate) fn score(case: &Case) -> Option<Scored> {
    let mut random = case.random.clone();
    let robot = &case.planner.lattice().robot;
    let battery = robot.battery?;
    let route = case.planner.plan(&case.query, Objective::Energy).ok()?.route;
    let truth = driven(case, &route.poses)?;
    // A battery so small that the way takes some half of it, and a charge that may or may not suffice.
    let mut small = robot.clone();
    let capacity_wh = route.total.energy_j.max(500.0) / 3600.0 * 2.0;
    if let Some(b) = &mut small.battery {
        // The same cells, so that the voltage sags as the world's does.
        b.internal_resistance_ohm = Some(battery.resistance_ohm());
        b.capacity_wh = capacity_wh;
    }
    let doubt = Doubt { elevation_sigma_m: 0.0, ..Doubt::default() };
    let charge = random.random_range(0.5..0.95);
    let planner = Planner::new(&case.planner.lattice().terrain, &small, case.query.settings).ok()?;
    let question = Question {
        query: case.query.clone(),
        farthest: false,
        back: false,
        charge,
        ambient_c: robot.motors.reference_temperature_c,
        doubt,
        samples: SAMPLES,
        replanned: 0,
        seed: case.seed ^ 0x5EED,
    };
    let found = range(&planner, &question).ok()?;
    // What the file does not know of this battery.
    let capacity_j =
        capacity_wh * 3600.0 * (battery.capacity_sigma * random.sample::<f64, _>(StandardNormal)).exp();
    let true_charge = charge + battery.charge_sigma * random.sample::<f64, _>(StandardNormal);
    let left = true_charge - truth.given_j / capacity_j;
    Some(Scored {
        driven_j: truth.drawn_j,
        nominal_j: found.nominal.energy_j,
        p05_j: found.likely.energy_j.p05,
        p95_j: found.likely.energy_j.p95,
        success_probability: found.likely.success_probability,
        gross_j: route.total.energy_j + 2.0 * route.total.recovered_j,
        succeeded: left >= battery.reserve_fraction,
    })
}

/// Energies of a drive.
struct Driven {
    drawn_j: f64,
    given_j: f64,
}

/// Drives a path in the world, up to the moment of arrival.
fn driven(case: &Case, poses: &[planner::Pose]) -> Option<Driven> {
    let robot = RobotFile::from_json(&serde_json::to_string(&case.planner.lattice().robot).ok()?).ok()?;
    let path = map_file(case)?;
    let world = World {
        terrain: Relief::Map(MapPath(path.clone())),
        scatter: case.scatter,
        seed: case.seed,
        ..World::from_json(r#"{"terrain": "level"}"#).ok()?
    };
    let waypoint = |p: &planner::Pose| Waypoint { x_m: p.x_m, y_m: p.y_m, heading_rad: Some(p.heading_rad) };
    let last = poses.last()?;
    let drive = Drive {
        speed_mps: Some(case.query.settings.speed_mps / PILOT_SHARE),
        poses: poses.iter().map(waypoint).collect(),
        ..Drive::new(DriveKind::Path, (1.6 * last.t_s + 20.0).ceil(), case.seed)
    };
    let simulated = simulate_closely(&world, &robot, &drive);
    std::fs::remove_file(&path).ok()?;
    let simulated = simulated.ok()?;
    let instants = simulated.truth.first()?;
    /// The pilot stops within 0.15 m; its robot lies some centimetres beside.
    const THERE_M: f64 = 0.4;
    let arrived = instants.iter().find(|now| {
        (now.x_m - last.x_m).hypot(now.y_m - last.y_m) < THERE_M
            && now.speed_mps.abs() < 0.01
            && now.t_s > 2.0
    })?;
    // After arrival the robot stands and draws nothing, so that the ledger is that of the drive.
    Some(Driven { drawn_j: arrived.drawn_j[2], given_j: simulated.ledger.given_j })
}

/// The ground as a map file, which is how a world reads it.
fn map_file(case: &Case) -> Option<PathBuf> {
    let rows: Vec<&[f64]> = case.heights_m.chunks(case.grid.columns).collect();
    let document = serde_json::json!({
        "cell_size_m": case.grid.cell_size_m, "rows": case.grid.rows, "columns": case.grid.columns, "elevation_m": rows,
    });
    let name = format!("joulepath-coverage-{}-{}-{}.json", std::process::id(), case.seed, case.scatter);
    let path = std::env::temp_dir().join(name);
    std::fs::write(&path, document.to_string()).ok()?;
    Some(path)
}
