//! Cases of a world that is the model's own.

use crate::logs::read_back;
use diagnosis::{Applied, Span, imitate};
use model::{Robot, mechanism::Mechanism};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;
use recording::{Channel, Recording};
use world::{CaseKind, EffectName, RobotFile, Sensors, simulate};

/// What a case is to conceal.
pub(crate) enum Kind {
    Healthy,
    Decoy,
    Conceals(Vec<&'static dyn Mechanism>),
}

/// A case.
pub(crate) struct Case {
    pub(crate) name: String,
    /// The robot as its file has it.
    pub(crate) robot: Robot,
    pub(crate) suspect: Recording,
    pub(crate) healthy: Recording,
    pub(crate) truths: Vec<Applied>,
}

/// Rows of an average, of a second.
const ROWS: usize = 10;
/// Shares of a file's uncertainty by which robots differ from it, healthy ones and decoys.
const SCATTER: [f64; 2] = [0.5, 1.5];

/// Draws a case whose effects have a strength of z each.
pub(crate) fn draw(seed: u64, kind: &Kind, z: f64) -> Case {
    let mut random = Pcg64Mcg::seed_from_u64(seed);
    let file = model::builtin::husky_a200();
    let json = serde_json::to_string(&file).unwrap();
    let world_file = RobotFile::from_json(&json).unwrap();
    let (names, is_decoy): (&[&'static dyn Mechanism], bool) = match kind {
        Kind::Healthy => (&[], false),
        Kind::Decoy => (&[], true),
        Kind::Conceals(all) => (all, false),
    };
    // Ground and drives on which the effects can show.
    let shows = names.iter().find_map(|one| EffectName::all().find(|effect| effect.name() == one.name()));
    let drawn = shows.map_or(CaseKind::Healthy, CaseKind::One);
    let case = world::Case::draw(random.random::<u64>() >> 12, drawn, 0.0, &world_file).unwrap();
    let scatter = SCATTER[usize::from(is_decoy && random.random_bool(0.5))];
    let robot = scattered(&file, scatter, &mut random);
    let noise = if is_decoy { random.random_range(1.0..4.0) } else { 1.0 };
    let suspect =
        read_back(&simulate(&case.world.without_effects(), &world_file, &case.drive).unwrap()).recording;
    let healthy = read_back(&case.reference(&world_file).unwrap()).recording;
    // The way that the model goes, which its headings belong to.
    let plain = imitate(&robot, &suspect, &[]).unwrap();
    let truths: Vec<Applied> =
        names.iter().map(|one| of_strength(*one, &robot, &plain, z, &mut random)).collect();
    Case {
        name: format!("{seed} {:?}", case.drive.kind),
        suspect: noisy(imitate(&robot, &plain, &truths).unwrap(), noise, &mut random),
        healthy: noisy(imitate(&robot, &healthy, &[]).unwrap(), noise, &mut random),
        truths,
        robot: file,
    }
}

/// A robot that differs from its file by shares of the file's uncertainty.
fn scattered(file: &Robot, scatter: f64, random: &mut Pcg64Mcg) -> Robot {
    let mut robot = file.clone();
    let mut factor = |sigma: f64| -> f64 {
        let normal: f64 = StandardNormal.sample(random);
        (1.0 + scatter * sigma * normal).max(0.3)
    };
    let u = file.uncertainty;
    for surface in robot.surfaces.values_mut() {
        surface.mu_roll *= factor(u.mu_roll);
        surface.mu_skid *= factor(u.mu_skid);
    }
    for motor in [&mut robot.motors.left, &mut robot.motors.right] {
        motor.k1_w_per_n2 *= factor(u.k1);
        motor.k2 = (motor.k2 * factor(u.k2)).max(1.0);
    }
    robot
}

/// A mechanism in a random direction of its parameters, from a random time on, and so large that an ideal detector sees it at z.
fn of_strength(
    mechanism: &'static dyn Mechanism,
    robot: &Robot,
    plain: &Recording,
    z: f64,
    random: &mut Pcg64Mcg,
) -> Applied {
    let (direction, fixed) = direction(mechanism, random);
    let is_late = random.random_bool(0.4) && sets_in(mechanism.name());
    let longest_s = plain.t_s.last().unwrap() - plain.t_s[0];
    let from_s = if is_late { (longest_s * random.random_range(0.2..0.6)).round() } else { 0.0 };
    let at = |size: f64| {
        let value = |(i, by): (usize, &f64)| {
            let [low, high] = mechanism.bounds(robot, i);
            fixed.iter().find(|(j, _)| *j == i).map_or((size * by).clamp(low, high), |(_, value)| *value)
        };
        Applied {
            mechanism,
            values: direction.iter().enumerate().map(value).collect(),
            span: Span::EachDrive(from_s),
        }
    };
    let mut size = 1.0;
    for _ in 0..12 {
        if direction.len() == fixed.len() {
            break;
        }
        let seen = imitate(robot, plain, &[at(size)]).unwrap();
        let found = strength(&seen, plain).max(1e-9);
        // A mechanism on a slope of strengths: wind by its square, most in proportion.
        let step = (z / found).clamp(0.05, 20.0);
        size *= step.powf(0.8);
        if (step - 1.0).abs() < 0.02 {
            break;
        }
    }
    let mut found = at(size);
    if mechanism.name() == "clock_offset" {
        // A delay of less than a row cannot be told from none.
        found.values[0] =
            found.values[0].signum() * found.values[0].abs().max(1.0 / Sensors::default().rate_hz);
    }
    found
}

/// Signs and proportions of parameters at one probe, and those that strength leaves alone.
fn direction(mechanism: &dyn Mechanism, random: &mut Pcg64Mcg) -> (Vec<f64>, Vec<(usize, f64)>) {
    let mut direction: Vec<f64> = mechanism
        .parameters()
        .iter()
        .map(|p| {
            let normal: f64 = StandardNormal.sample(random);
            if p.bounds[0] < 0.0 { normal * p.probe } else { normal.abs() * p.probe }
        })
        .collect();
    let mut fixed = Vec::new();
    match mechanism.name() {
        "motor_heating" => fixed.push((1, random.random_range(200.0..1800.0))),
        "wind" => {
            direction[0] = 0.0;
            fixed.push((0, random.random_range(0.3..0.7)));
        }
        "drivetrain_drag" => direction[usize::from(random.random_bool(0.5))] = 0.0,
        "towed_load" => direction[1] = direction[0] * random.random_range(1.0..2.0),
        // Forward and backward are alike.
        "center_of_mass" => direction[0] = direction[0].abs(),
        "payload" => direction[0] = direction[0].abs(),
        // It hardly shows in power, but in positions.
        "wheel_slip" => fixed.push((0, random.random_range(0.01..0.05))),
        _ => {}
    }
    (direction, fixed)
}

/// Whether it may set in during a drive; how a robot or its sensors are built does not.
fn sets_in(name: &str) -> bool {
    !matches!(
        name,
        "motor_heating"
            | "clock_offset"
            | "wheel_radius"
            | "center_of_mass"
            | "load_transfer"
            | "inertia"
            | "speed_dependent_friction"
            | "grade_dependent_friction"
            | "regeneration"
            | "wheel_slip"
    )
}

/// Strength of what differs, over one-second averages of every power meter, in their noise.
fn strength(seen: &Recording, plain: &Recording) -> f64 {
    let sensors = Sensors::default();
    let keep = (-1.0 / (sensors.rate_hz * sensors.power_noise_memory_s)).exp();
    let together: f64 = (1..ROWS).map(|k| 2.0 * (ROWS - k) as f64 * keep.powi(k as i32)).sum();
    let squares =
        METERS.iter().filter_map(|channel| Some((seen.channel(*channel)?, plain.channel(*channel)?)));
    let sum: f64 = squares
        .map(|(seen, plain)| {
            let pairs = seen.chunks_exact(ROWS).zip(plain.chunks_exact(ROWS));
            let square = |(a, b): (&[f64], &[f64])| {
                let mean = |values: &[f64]| values.iter().sum::<f64>() / ROWS as f64;
                let one_w = sensors.power_noise_w.hypot(sensors.power_gain_noise * mean(b));
                let sigma_w = one_w * (ROWS as f64 + together).sqrt() / ROWS as f64;
                ((mean(a) - mean(b)) / sigma_w).powi(2)
            };
            pairs.map(square).filter(|x| x.is_finite()).sum::<f64>()
        })
        .sum();
    sum.sqrt()
}

const METERS: [Channel; 3] = [Channel::LeftPower, Channel::RightPower, Channel::Power];

/// Adds the noise of the independent world's sensors, so many times.
fn noisy(mut recording: Recording, times: f64, random: &mut Pcg64Mcg) -> Recording {
    let sensors = Sensors::default();
    let mut noise = |values: &mut Vec<f64>, sigma: &dyn Fn(f64) -> f64, memory_s: f64| {
        let keep = (-1.0 / (sensors.rate_hz * memory_s)).exp();
        let mut state: f64 = StandardNormal.sample(random);
        for value in values {
            let fresh: f64 = StandardNormal.sample(random);
            state = keep * state + (1.0 - keep * keep).sqrt() * fresh;
            *value += sigma(*value) * state;
        }
    };
    for (channel, values) in &mut recording.channels {
        match channel {
            Channel::LeftPower | Channel::RightPower | Channel::Power => {
                let sigma = |w: f64| times * sensors.power_noise_w.hypot(sensors.power_gain_noise * w);
                noise(values, &sigma, sensors.power_noise_memory_s);
            }
            Channel::YawRate => noise(values, &|_| sensors.yaw_rate_noise_radps, 1e-3),
            Channel::X | Channel::Y => noise(values, &|_| sensors.position_noise_m, 30.0),
            _ => {}
        }
    }
    recording
}
