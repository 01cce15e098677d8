//! A journey driven many times over: what is likely to come of it.

use rayon::prelude::*;

use crate::{
    chance::Drawn,
    journey::Journey,
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
        values.sort_by(f64::total_cmp);
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
pub fn draws(journey: &Journey, drawn: &Drawn<'_>, conditions: &Conditions, samples: usize) -> Vec<Outcome> {
    let one = |number: u64| journey.run(&drawn.chance(journey.length_m(), number), conditions, |_| {});
    (0..samples).into_par_iter().with_min_len(LEAST_DRAWS).map(|i| one(i as u64)).collect()
}
