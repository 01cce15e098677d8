//! The speed that takes least energy: slow drives pay for electronics and for copper by time.

use model::Robot;
use planner::Step;

use crate::{
    Error,
    chance::Chance,
    journey::Journey,
    run::{Conditions, Outcome},
};

/// The best speed over a fixed path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestSpeed {
    /// The speed [m/s].
    pub speed_mps: f64,
    /// Energy at it [J].
    pub energy_j: f64,
    /// Time at it [s].
    pub duration_s: f64,
    /// Energy at the speed asked for, less this [J].
    pub saving_j: f64,
}

/// Speeds that are tried between a tenth of the wheels' top speed and all of it, before the best is closed in on.
const SPEEDS: usize = 19;
/// The best speed is told to this share of the top speed.
const NEAR: f64 = 0.002;

/// The speed over the drives of a journey that draws least energy, heat, hotel load and sag included.
///
/// Rolling and skidding take the same from a metre at any speed, but k1 F² and electronics count by time, so that the answer is
/// often the top speed; drag, or a battery that sags, brings it down.
pub(crate) fn best_speed(
    robot: &Robot,
    drives: &[&[Step]],
    surfaces: &[String],
    journey: &Journey,
    chance: &Chance,
    conditions: &Conditions,
) -> Result<BestSpeed, Error> {
    let at = |speed_mps: f64| -> Result<Outcome, Error> {
        let mut paced = Journey::new(journey.model);
        for steps in drives {
            paced.drive_at(robot, steps, surfaces, speed_mps)?;
        }
        Ok(paced.run(chance, conditions, |_| {}))
    };
    let top_mps = robot.max_wheel_speed_mps;
    let mut step_mps = 0.9 * top_mps / (SPEEDS - 1) as f64;
    let mut best = (top_mps, at(top_mps)?);
    let consider = |best: &mut (f64, Outcome), speed_mps: f64| -> Result<(), Error> {
        let outcome = at(speed_mps)?;
        if outcome.energy_j < best.1.energy_j {
            *best = (speed_mps, outcome);
        }
        Ok(())
    };
    for i in 0..SPEEDS - 1 {
        consider(&mut best, 0.1 * top_mps + i as f64 * step_mps)?;
    }
    while step_mps > NEAR * top_mps {
        step_mps /= 2.0;
        let middle_mps = best.0;
        for speed_mps in [middle_mps - step_mps, (middle_mps + step_mps).min(top_mps)] {
            consider(&mut best, speed_mps)?;
        }
    }
    let asked_j = journey.run(chance, conditions, |_| {}).energy_j;
    Ok(BestSpeed {
        speed_mps: best.0,
        energy_j: best.1.energy_j,
        duration_s: best.1.duration_s,
        saving_j: asked_j - best.1.energy_j,
    })
}
