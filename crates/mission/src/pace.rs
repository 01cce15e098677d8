//! The speed that takes least energy: slow drives pay for electronics and for copper by time.

use model::Robot;
use planner::{Patience, Step};

use crate::{
    Error,
    chance::Chance,
    journey::Journey,
    meter::Meter,
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
/// How often the step between speeds is halved around the best of them: from a twentieth of the top speed to 0.2 % of it.
const HALVINGS: usize = 5;

/// What is driven at other speeds.
pub(crate) struct Paced<'a> {
    pub(crate) robot: &'a Robot,
    /// Steps of each way.
    pub(crate) drives: &'a [&'a [Step]],
    /// Names of the surfaces that steps index.
    pub(crate) surfaces: &'a [String],
    /// The same at the speed asked for.
    pub(crate) journey: &'a Journey,
}

/// The speed over the drives of a journey that draws least energy, heat, hotel load and sag included.
///
/// Rolling and skidding take the same from a metre at any speed, but k1 F² and electronics count by time, so that the answer is
/// often the top speed; drag, or a battery that sags, brings it down.
///
/// # Errors
/// Patience that ends first.
pub(crate) fn best_speed(
    paced: &Paced<'_>,
    chance: &Chance,
    conditions: &Conditions,
    patience: &Patience,
) -> Result<BestSpeed, Error> {
    let Paced { robot, drives, surfaces, journey } = paced;
    let mut meter = Meter::new(patience, "looking for the best speed");
    let mut at = |speed_mps: f64| -> Result<Outcome, Error> {
        let mut paced = Journey::new(journey.model);
        for steps in *drives {
            meter.spend(steps.len())?;
            paced.drive_at(robot, steps, surfaces, speed_mps)?;
        }
        paced.run(chance, conditions, &mut meter, |_| {})
    };
    let top_mps = robot.max_wheel_speed_mps;
    let mut step_mps = 0.9 * top_mps / (SPEEDS - 1) as f64;
    let mut best = (top_mps, at(top_mps)?);
    let mut consider = |best: &mut (f64, Outcome), speed_mps: f64| -> Result<(), Error> {
        let outcome = at(speed_mps)?;
        if outcome.energy_j < best.1.energy_j {
            *best = (speed_mps, outcome);
        }
        Ok(())
    };
    for i in 0..SPEEDS - 1 {
        consider(&mut best, 0.1 * top_mps + i as f64 * step_mps)?;
    }
    for _ in 0..HALVINGS {
        step_mps /= 2.0;
        let middle_mps = best.0;
        for speed_mps in [middle_mps - step_mps, (middle_mps + step_mps).min(top_mps)] {
            consider(&mut best, speed_mps)?;
        }
    }
    let asked_j = journey.run(chance, conditions, &mut meter, |_| {})?.energy_j;
    Ok(BestSpeed {
        speed_mps: best.0,
        energy_j: best.1.energy_j,
        duration_s: best.1.duration_s,
        saving_j: asked_j - best.1.energy_j,
    })
}
