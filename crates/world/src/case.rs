//! Random concealed cases: world, drive and effects from one seed.

use crate::{
    Drive, DriveKind, Effect, EffectName, Error, Family, Key, Log, RobotFile, Row, Sensors, Side, World,
    plant::GRAVITY_MPS2, random::Random, simulate, simulate_all, world::Relief,
};

/// What kind of case is drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CaseKind {
    /// The robot of the file, within its uncertainty.
    Healthy,
    /// Nothing concealed, but noisier sensors, more gaps, or friction and motors at the edge of the file's uncertainty.
    Decoy,
    /// One effect.
    One(EffectName),
    /// Two effects at once.
    Two(EffectName, EffectName),
}

/// A concealed case.
#[derive(Clone, Debug, PartialEq)]
pub struct Case {
    /// The world with what it conceals.
    pub world: World,
    /// The drive.
    pub drive: Drive,
    /// The same robot and sensors while nothing was concealed, on ground and with noise of their own.
    pub reference_world: World,
    /// Drives through it, as a reference: one of many speeds and turns, and one of the kind of the other drive.
    pub reference_drives: [Drive; 2],
}

impl Case {
    /// Draws a case. `share` is the root mean square change of power that each effect shall make over the mean power of the
    /// healthy drive; 0 leaves strengths anywhere in the effect's usual range.
    ///
    /// # Errors
    /// Those of [`simulate`].
    pub fn draw(seed: u64, kind: CaseKind, share: f64, robot: &RobotFile) -> Result<Self, Error> {
        let mut random = Random::new(seed, "case");
        let names = match kind {
            CaseKind::Healthy | CaseKind::Decoy => Vec::new(),
            CaseKind::One(name) => vec![name],
            CaseKind::Two(first, second) => vec![first, second],
        };
        let drive = drive(&mut random, &names, robot);
        let varied = Drive::new(DriveKind::Rich, HEALTHY_S, random.seed());
        let mut world = world(&mut random, &names, robot);
        if kind == CaseKind::Decoy {
            disguise(&mut world, &mut random);
        }
        let mut reference_world = World { seed: random.seed(), ..world.clone() };
        if let Relief::Rolling { seed, .. } = &mut reference_world.terrain {
            *seed = random.seed();
        }
        for name in names {
            let mut effect = effect(&mut random, name, drive.duration_s);
            if share > 0.0 {
                effect.strength = strength_of_share(&world, robot, &drive, &effect, share)?;
            }
            world.effects.push(effect);
        }
        let alike = Drive { duration_s: HEALTHY_S, seed: random.seed(), ..drive.clone() };
        Ok(Case { world, drive, reference_world, reference_drives: [varied, alike] })
    }

    /// Any kind: 20 % healthy, 10 % decoys, 45 % one effect, 15 % two, 10 % one that has no name.
    pub fn any_kind(seed: u64) -> CaseKind {
        let mut random = Random::new(seed, "kind of case");
        let listed: Vec<EffectName> = EffectName::all().filter(|n| n.family() != Family::Unlisted).collect();
        let unlisted: Vec<EffectName> =
            EffectName::all().filter(|n| n.family() == Family::Unlisted).collect();
        match random.between(0.0, 1.0) {
            x if x < 0.20 => CaseKind::Healthy,
            x if x < 0.30 => CaseKind::Decoy,
            x if x < 0.75 => CaseKind::One(random.pick(&listed)),
            x if x < 0.90 => {
                let first = random.pick(&listed);
                let others: Vec<EffectName> = listed.into_iter().filter(|name| *name != first).collect();
                CaseKind::Two(first, random.pick(&others))
            }
            _ => CaseKind::One(random.pick(&unlisted)),
        }
    }

    /// What the reference drives recorded.
    ///
    /// # Errors
    /// Those of [`simulate`].
    pub fn reference(&self, robot: &RobotFile) -> Result<Log, Error> {
        simulate_all(&self.reference_world, robot, &self.reference_drives)
    }

    /// The same drive, robot and noise with nothing concealed.
    #[must_use]
    pub fn twin(&self) -> Self {
        Case { world: self.world.without_effects(), ..self.clone() }
    }

    /// What is true of it.
    ///
    /// # Errors
    /// Those of [`simulate`].
    pub fn key(&self, robot: &RobotFile) -> Result<Key, Error> {
        Key::of(&self.world, robot, &self.drive)
    }
}

/// How long drives are, and healthy ones of a reference each [s].
const DRIVE_S: f64 = 900.0;
const HEALTHY_S: f64 = 450.0;

/// A drive on which the effects can show at all.
fn drive(random: &mut Random, names: &[EffectName], robot: &RobotFile) -> Drive {
    use EffectName as E;
    let needs = |some: &[EffectName]| names.iter().any(|name| some.contains(name));
    let kinds: &[DriveKind] = if needs(&[E::Inertia, E::ClockOffset, E::StickyStart]) {
        &[DriveKind::StopAndGo, DriveKind::Rich]
    } else {
        &[DriveKind::Rich, DriveKind::Rich, DriveKind::LawnMower]
    };
    Drive {
        speed_mps: Some(random.between(0.7, 0.9) * robot.max_wheel_speed_mps),
        ..Drive::new(random.pick(kinds), DRIVE_S, random.seed())
    }
}

fn world(random: &mut Random, names: &[EffectName], robot: &RobotFile) -> World {
    use EffectName as E;
    let steep = [
        E::GradeDependentFriction,
        E::LoadTransfer,
        E::Regeneration,
        E::LooseLoad,
        E::TurnOnSlope,
        E::Puddles,
    ];
    let needs_slopes = names.iter().any(|name| steep.contains(name));
    let grade = if needs_slopes { random.between(0.04, 0.06) } else { random.between(0.01, 0.03) };
    let relief = Relief::Rolling { grade, length_m: random.between(14.0, 30.0), seed: random.seed() };
    World {
        terrain: relief,
        surface: None,
        patches: Vec::new(),
        ambient_temp_c: None,
        wind: None,
        sensors: Sensors::of(robot),
        scatter: 0.5,
        seed: random.seed(),
        robot_seed: Some(random.seed()),
        step_s: 0.001,
        effects: Vec::new(),
    }
}

/// What looks like an effect and is none.
fn disguise(world: &mut World, random: &mut Random) {
    match random.between(0.0, 3.0) as u32 {
        0 => world.scatter = random.between(1.0, 1.5),
        1 => {
            world.sensors.power_noise_w *= random.between(2.0, 4.0);
            world.sensors.power_noise_memory_s = random.between(0.3, 2.0);
        }
        _ => {
            world.sensors.dropouts = random.between(0.02, 0.10);
            world.sensors.dropout_rows = random.between(2.0, 20.0);
        }
    }
}

fn effect(random: &mut Random, name: EffectName, duration_s: f64) -> Effect {
    let [low, high] = name.typical();
    let late = random.chance(0.4) && name != EffectName::MotorHeating;
    Effect {
        onset_s: if late { (duration_s * random.between(0.2, 0.6)).round() } else { 0.0 },
        side: Some(if random.chance(0.5) { Side::Left } else { Side::Right }),
        direction_rad: random.between(-3.1, 3.1),
        ..Effect::new(name, random.log_between(low, high))
    }
}

/// The strength at which an effect changes power by a share, found by driving; the end of its range where that is not enough.
fn strength_of_share(
    world: &World,
    robot: &RobotFile,
    drive: &Drive,
    effect: &Effect,
    share: f64,
) -> Result<f64, Error> {
    /// Close enough to the share asked for.
    const NEAR: f64 = 0.05;
    let quiet = World { sensors: Sensors::perfect(), effects: Vec::new(), ..world.clone() };
    let plain = simulate(&quiet, robot, drive)?;
    let mean_w = plain.rows.iter().map(|r| r.battery_w).sum::<f64>() / plain.rows.len().max(1) as f64;
    let [_, most] = effect.effect.range();
    if let Some(strength) = unseen_by_power(effect.effect, robot, &plain, share * mean_w.abs()) {
        return Ok(strength.min(most));
    }
    let (mut strength, mut before) = (effect.strength, None::<[f64; 2]>);
    let [least, _] = effect.effect.typical();
    // How steeply the share grows with strength on logarithmic scales: wind by its square, most effects in proportion.
    let mut steepness = 1.0;
    for _ in 0..8 {
        let acting = World { effects: vec![Effect { strength, ..effect.clone() }], ..quiet.clone() };
        let log = match simulate(&acting, robot, drive) {
            Ok(log) => log,
            // As much of it makes a robot tip over, or cannot be for another reason: no more than what could be driven.
            Err(_) if before.is_some() => {
                strength = before.map_or(strength, |[driven, _]| driven);
                break;
            }
            // Nor at the strength that was begun with.
            Err(_) if strength > least => {
                strength = (strength / 2.0).max(least);
                continue;
            }
            Err(error) => return Err(error),
        };
        let pairs = log.rows.iter().zip(&plain.rows).filter(|(row, _)| row.t_s >= effect.onset_s);
        let squares: Vec<f64> = pairs.map(|(a, b)| (a.battery_w - b.battery_w).powi(2)).collect();
        let found =
            (squares.iter().sum::<f64>() / squares.len().max(1) as f64).sqrt() / mean_w.abs().max(1e-9);
        let factor = share / found.max(1e-6);
        if (factor - 1.0).abs() < NEAR {
            break;
        }
        if let Some([earlier, earlier_found]) = before {
            let (rise, run) = ((found / earlier_found).ln(), f64::ln(strength / earlier));
            steepness = if run.abs() > 1e-9 { (rise / run).clamp(0.5, 3.0) } else { 1.0 };
        }
        before = Some([strength, found.max(1e-6)]);
        strength = (strength * factor.clamp(0.1, 10.0).powf(1.0 / steepness)).min(most);
    }
    // A delay below one row cannot be told from none.
    let one_row_s = if effect.effect == EffectName::ClockOffset { 1.0 / world.sensors.rate_hz } else { 0.0 };
    Ok(strength.max(one_row_s))
}

/// The strength of a fault that leaves power alone and misleads who computes it by so much [W], root mean square.
fn unseen_by_power(name: EffectName, robot: &RobotFile, plain: &Log, mislead_w: f64) -> Option<f64> {
    let speed_mps = |row: &Row| (row.rim_mps[0] + row.rim_mps[1]) / 2.0;
    let root_mean_square = |value: &dyn Fn(&Row) -> f64| {
        let sum: f64 = plain.rows.iter().map(|row| value(row).powi(2)).sum();
        (sum / plain.rows.len().max(1) as f64).sqrt().max(1e-9)
    };
    let k2 = (robot.motors.left.k2 + robot.motors.right.k2) / 2.0;
    match name {
        // A slope that is not there costs m g v per radian, through the gears.
        EffectName::PitchBias => {
            Some(mislead_w / (k2 * robot.mass_kg * GRAVITY_MPS2 * root_mean_square(&speed_mps)))
        }
        // Speeds that are too large by a fraction make the power that goes with speed too large by it.
        EffectName::WheelRadius => Some(mislead_w / root_mean_square(&|row| SPEED_SHARE * row.battery_w)),
        _ => None,
    }
}

/// Share of the power that goes with speed; copper takes the rest.
const SPEED_SHARE: f64 = 0.7;
