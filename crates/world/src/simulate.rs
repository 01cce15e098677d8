//! A drive through a world, from the first step to the last row.

use std::borrow::Cow;

use crate::{
    Drive, Error, Instant, Ledger, Log, RobotFile, World, ground::Ground, observe::observe, pilot::Pilot,
    plant::Plant, random::Random,
};

/// How often the pilot looks up [s].
const PILOT_S: f64 = 0.02;
/// Truths per row of the recording.
pub(crate) const INSTANTS_PER_ROW: usize = 5;

/// Everything about a simulated drive: what was recorded, and what only the world knows.
#[derive(Clone, Debug)]
pub struct Simulation {
    /// The recording.
    pub log: Log,
    /// The truth, five times as often as rows, run by run.
    pub truth: Vec<Vec<Instant>>,
    /// Where the energy went.
    pub ledger: Ledger,
    /// The healthy robot as it was: its file, scattered as the world says.
    pub robot: RobotFile,
}

/// Drives a robot through a world and returns what its sensors recorded.
///
/// The same world, robot and drive give the same recording, bit by bit; noise depends on the world's seed alone, so that two
/// worlds that differ in their effects differ in nothing else.
///
/// # Errors
/// What is wrong with world, robot or drive; ground that a map does not know.
pub fn simulate(world: &World, robot: &RobotFile, drive: &Drive) -> Result<Log, Error> {
    simulate_closely(world, robot, drive).map(|simulation| simulation.log)
}

/// Drives a robot through a world several times and returns all of it as one recording, drive after drive, each with noise of its own.
///
/// # Errors
/// Those of [`simulate`].
pub fn simulate_all(world: &World, robot: &RobotFile, drives: &[Drive]) -> Result<Log, Error> {
    let mut random = Random::new(world.seed, "drives");
    let mut all: Option<Log> = None;
    for drive in drives {
        let world = World { seed: random.seed(), robot_seed: Some(world.robot_seed()), ..world.clone() };
        let next = simulate(&world, robot, drive)?;
        match &mut all {
            Some(all) => all.go_on(next),
            None => all = Some(next),
        }
    }
    let nothing = || Log { sensors: world.sensors.clone(), surfaces: Vec::new(), rows: Vec::new() };
    Ok(all.unwrap_or_else(nothing))
}

/// The same as [`simulate`] with the truth behind it.
///
/// # Errors
/// Those of [`simulate`].
pub fn simulate_closely(world: &World, robot: &RobotFile, drive: &Drive) -> Result<Simulation, Error> {
    world.check()?;
    drive.check()?;
    check_length(world, drive)?;
    let robot = scattered(robot, world);
    let ground = Ground::new(world, &robot)?;
    let (instant_s, steps) = rhythm(world);
    let mut plant = Plant::new(&robot, world, &ground, instant_s / f64::from(steps));
    let mut truth = Vec::with_capacity(drive.runs);
    for run in 0..drive.runs {
        truth.push(one_run(&mut plant, world, &robot, &ground, drive, run)?);
    }
    let names = ground.surfaces.iter().map(|surface| surface.name.clone()).collect();
    let log = observe(world, &truth, names);
    Ok(Simulation { log, truth, ledger: plant.ledger(), robot: robot.into_owned() })
}

fn one_run(
    plant: &mut Plant<'_>,
    world: &World,
    robot: &RobotFile,
    ground: &Ground,
    drive: &Drive,
    run: usize,
) -> Result<Vec<Instant>, Error> {
    let mut pilot = Pilot::new(drive, robot, ground, run);
    let (place_m, heading_rad) = pilot.start();
    plant.place(place_m, heading_rad)?;
    let rows = (drive.duration_s * world.sensors.rate_hz).round() as usize;
    let instants = rows * INSTANTS_PER_ROW;
    let (instant_s, steps) = rhythm(world);
    let pilot_steps = (PILOT_S * f64::from(steps) / instant_s).round().max(1.0) as u64;
    let pilot_s = pilot_steps as f64 * instant_s / f64::from(steps);
    let mut truth = Vec::with_capacity(instants + 1);
    truth.push(plant.instant());
    let begin_s = run as f64 * drive.duration_s;
    let (mut command_mps, mut step) = ([0.0; 2], 0_u64);
    for k in 1..=instants {
        for _ in 0..steps {
            if step.is_multiple_of(pilot_steps) {
                let (place_m, heading_rad) = plant.pose();
                command_mps = pilot.command_mps(place_m, heading_rad, pilot_s);
            }
            plant.step(command_mps)?;
            step += 1;
        }
        // The clock of the recording does not add up rounding.
        truth.push(Instant { t_s: begin_s + k as f64 * instant_s, ..plant.instant() });
    }
    Ok(truth)
}

/// Most rows of a drive: each takes a kilobyte of truth.
const MOST_ROWS: f64 = 2e6;

/// Refuses a drive whose recording would fill the memory.
fn check_length(world: &World, drive: &Drive) -> Result<(), Error> {
    let rows = drive.runs as f64 * drive.duration_s * world.sensors.rate_hz;
    if rows <= MOST_ROWS {
        return Ok(());
    }
    Err(Error::TooLong { rows, most_rows: MOST_ROWS })
}

/// Time between two truths and the whole steps that it is made of, each no longer than the world asks.
fn rhythm(world: &World) -> (f64, u32) {
    let instant_s = 1.0 / (world.sensors.rate_hz * INSTANTS_PER_ROW as f64);
    // A step that fits but for rounding fits.
    (instant_s, (instant_s / world.step_s - 1e-6).ceil().max(1.0) as u32)
}

/// The robot as far from its file as the world says, each parameter by its own uncertainty.
fn scattered<'a>(robot: &'a RobotFile, world: &World) -> Cow<'a, RobotFile> {
    if world.scatter == 0.0 {
        return Cow::Borrowed(robot);
    }
    let mut random = Random::new(world.robot_seed(), "scatter");
    let mut robot = robot.clone();
    let u = robot.uncertainty;
    let mut factor = |sigma: f64| (world.scatter * sigma * random.normal()).clamp(-0.5, 0.5).exp();
    robot.mass_kg *= factor(u.mass_kg);
    for motor in [&mut robot.motors.left, &mut robot.motors.right] {
        motor.k1_w_per_n2 *= factor(u.k1);
        motor.k2 = (motor.k2 * factor(u.k2)).max(1.0);
    }
    for surface in robot.surfaces.values_mut() {
        surface.mu_roll *= factor(u.mu_roll);
        surface.mu_skid *= factor(u.mu_skid);
    }
    robot.hotel_power_w *= factor(u.hotel_power_w);
    Cow::Owned(robot)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_drive_of_more_rows_than_fit_in_memory_is_refused_before_it_begins() {
        let world = World::from_json(r#"{"terrain": "level", "sensors": {"rate_hz": 50}}"#).unwrap();
        let drive = Drive { runs: 1000, ..Drive::new(crate::DriveKind::Rich, 1e5, 0) };
        let message = check_length(&world, &drive).unwrap_err().to_string();
        assert!(message.contains("5000000000 rows") && message.contains("duration_s"), "{message}");
        assert!(check_length(&world, &Drive::new(crate::DriveKind::Rich, 4e4, 0)).is_ok());
    }
}
