//! A journey driven many times over: what is likely to come of it.

use planner::Patience;
use rayon::prelude::*;

use crate::{
    Error,
    chance::Drawn,
    journey::Journey,
    meter::Meter,
    run::{Conditions, Outcome},
};

/// Median and central 90 %.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spread {
    /// One in twenty is below.
    pub p05: f64,
    /// Half are below.
    pub p50: f64,
    /// One in twenty is above.
    pub p95: f64,
}

impl Spread {
    /// Of values in any order, at least one; quantiles are interpolated linearly between order statistics.
    pub fn of(mut values: Vec<f64>) -> Self {
        values.sort_unstable_by(f64::total_cmp);
        let at = |share: f64| {
            let place = share * values.len().saturating_sub(1) as f64;
            let (below, above) = (place.floor() as usize, place.ceil() as usize);
            let [low, high] = [below, above].map(|i| values.get(i).copied().unwrap_or(f64::NAN));
            low + (high - low) * place.fract()
        };
        Spread { p05: at(0.05), p50: at(0.50), p95: at(0.95) }
    }
}

/// What is likely.
#[derive(Clone, Debug, PartialEq)]
pub struct Likely {
    /// Drawn from the battery, less what it took back [J].
    pub energy_j: Spread,
    /// Charge at the end; 0 where the battery was empty before.
    pub arrival_charge: Spread,
    /// Share of the draws that got there with their reserve.
    pub success_probability: f64,
    /// Median of the energy that is missing; 0 where at least half of the draws succeed [J].
    pub missing_j: f64,
    /// How many draws there were.
    pub samples: usize,
}

impl Likely {
    /// Whether at least half of the draws get there with their reserve.
    pub fn is_reachable(&self) -> bool {
        self.success_probability >= 0.5
    }

    pub(crate) fn of(outcomes: &[Outcome]) -> Self {
        let each = |value: fn(&Outcome) -> f64| Spread::of(outcomes.iter().map(value).collect());
        let succeeded = outcomes.iter().filter(|outcome| outcome.succeeds()).count();
        Likely {
            energy_j: each(|outcome| outcome.energy_j),
            arrival_charge: each(|outcome| outcome.arrival_charge.clamp(0.0, 1.0)),
            success_probability: succeeded as f64 / outcomes.len().max(1) as f64,
            missing_j: each(|outcome| outcome.missing_j).p50,
            samples: outcomes.len(),
        }
    }
}

/// Draws that are worth a task of their own: some 100 µs over a path of a few hundred poses.
pub(crate) const LEAST_DRAWS: usize = 4;

/// Drives a journey `samples` times, each time as a robot, battery and ground that may be; on all cores, in the order of draws.
///
/// # Errors
/// A map error that changes too often along the way, or patience that ends first.
pub fn draws(
    journey: &Journey,
    drawn: &Drawn<'_>,
    conditions: &Conditions,
    samples: usize,
    patience: &Patience,
) -> Result<Vec<Outcome>, Error> {
    drawn.doubt.check_length(journey.length_m())?;
    let one = |number: usize| {
        let mut meter = Meter::new(patience, "drawing samples");
        journey.run(&drawn.chance(journey.length_m(), number as u64), conditions, &mut meter, |_| {})
    };
    (0..samples).into_par_iter().with_min_len(LEAST_DRAWS).map(one).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{chance::Doubt, journey::Stop, meter::WORK_PER_LOOK};
    use model::{PowerModel, builtin};

    const SAMPLES: usize = 20;

    fn outcomes(patience: &Patience, stops: usize, doubt: &Doubt) -> Result<Vec<Outcome>, Error> {
        let robot = builtin::husky_a200();
        let battery = robot.battery.as_ref().unwrap();
        let drawn = Drawn { robot: &robot, battery, charge: 1.0, doubt, seed: 1 };
        let conditions = Conditions { ambient_c: 20.0, motor_c: 20.0, reserve: 0.2 };
        let mut journey = Journey::new(PowerModel::default());
        (0..stops).for_each(|_| journey.stop(Stop::Work { duration_s: 1.0, power_w: 1.0 }));
        draws(&journey, &drawn, &conditions, SAMPLES, patience)
    }

    #[test]
    fn the_deadline_is_looked_at_in_every_draw_and_within_long_ones() {
        let doubt = Doubt::NONE;
        assert!(outcomes(&Patience::for_looks(SAMPLES as u64), 1, &doubt).is_ok());
        assert!(outcomes(&Patience::for_looks(SAMPLES as u64 - 1), 1, &doubt).is_err());
        let stops = 10_000;
        let looks = (SAMPLES * stops / WORK_PER_LOOK) as u64;
        let late = outcomes(&Patience::for_looks(looks), stops, &doubt);
        assert_eq!(late, Err(Error::Timeout { step: "drawing samples" }));
    }

    #[test]
    fn a_map_error_that_changes_too_often_is_refused_with_the_scale_that_will_do() {
        let doubt = Doubt { elevation_sigma_m: 0.1, elevation_scale_m: 0.01, ..Doubt::NONE };
        assert_eq!(doubt.check_length(1000.0), Ok(()));
        let refused = doubt.check_length(1e5).unwrap_err();
        assert!(
            refused.to_string().contains("elevation_scale_m") && refused.to_string().contains("0.5"),
            "{refused}"
        );
        let certain = Doubt { elevation_sigma_m: 0.0, ..doubt };
        assert_eq!(certain.check_length(1e9), Ok(()), "nothing is drawn");
    }
}
