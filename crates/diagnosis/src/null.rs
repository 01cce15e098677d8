//! How much mechanisms seem to explain between healthy drives, where nothing is to be explained.
//!
//! No model is right, and what it misses of one drive and of another differs. That difference looks like evidence. Between
//! healthy drives it is all there is, so it tells by how much evidence has to be discounted, mechanism by mechanism.

use std::collections::BTreeMap;

use model::Robot;
use recording::{Recording, Watch};

use crate::{
    Error,
    baseline::Baseline,
    diagnose::NEEDED_S,
    foremost::Foremost,
    parts::one_and_others,
    series::{Look, Series},
    weigh::Weighed,
};

/// What healthy drives show of each other.
#[derive(Clone, Debug, Default)]
pub(crate) struct Null {
    own: BTreeMap<&'static str, Seen>,
    /// Surplus over all mechanisms.
    pooled: f64,
}

/// What one mechanism seems to explain, mean of all pairs of healthy drives.
#[derive(Clone, Debug, Default)]
struct Seen {
    /// Evidence over what chance makes of it, less 1, for each block.
    surplus: f64,
    /// Variance of each linear parameter, over one block.
    variance: Vec<f64>,
}

impl Null {
    /// Takes each healthy drive for suspect in turn. Without healthy drives nothing is discounted.
    ///
    /// # Errors
    /// A surface that the robot does not know, or that the watch breaks.
    pub(crate) fn of(
        robot: &Robot,
        healthy: Option<&Recording>,
        (watch, look): (&Watch, Look),
    ) -> Result<Self, Error> {
        let Some(healthy) = healthy else { return Ok(Null::default()) };
        let mut seen: BTreeMap<&'static str, Vec<Seen>> = BTreeMap::new();
        for (suspect, others) in one_and_others(healthy, NEEDED_S as f64) {
            let mut series = match Series::watched(robot, &suspect, Some(&others), watch) {
                Ok(series) => series,
                Err(Error::Calibration(calibration::Error::Stopped)) => {
                    return Err(calibration::Error::Stopped.into());
                }
                Err(_) => continue,
            };
            series.look = look;
            let base = Baseline::fit(&series, robot, &[])?;
            let Foremost { surest, blocks, .. } = Foremost::of(&series, &base, &[], &Null::default())?;
            for Weighed { candidate, evidence, tried, .. } in surest.iter().filter(|one| !one.is_in_place()) {
                // The largest of so many χ² of q degrees of freedom is about q + 2 ln(number).
                let expected = evidence.values.len() as f64 + 2.0 * f64::from(*tried).ln();
                let factor = evidence.wald / expected;
                let variance = evidence.covariance.diagonal().iter().map(|v| v * blocks as f64).collect();
                let surplus = (factor - 1.0) / blocks as f64;
                seen.entry(candidate.applied.mechanism.name()).or_default().push(Seen { surplus, variance });
            }
        }
        let own: BTreeMap<&'static str, Seen> =
            seen.into_iter().map(|(name, seen)| (name, mean(&seen))).collect();
        // A delay is weighed beside less than the others, and what it seems to be is the sensors' business.
        let judged = || own.iter().filter(|(name, _)| **name != "clock_offset");
        let pooled = judged().map(|(_, seen)| seen.surplus).sum::<f64>() / judged().count().max(1) as f64;
        Ok(Null { own, pooled: pooled.max(0.0) })
    }

    /// What a mechanism's numbers seem to be where there is nothing, one sigma squared of each: misfit of models, which no length
    /// of driving makes less. `None` where healthy drives told nothing of it.
    pub(crate) fn variance(&self, name: &str, parameters: usize) -> Option<Vec<f64>> {
        let seen = self.own.get(name).filter(|seen| seen.variance.len() == parameters)?;
        Some(seen.variance.iter().map(|v| self.surplus(name) * v).collect())
    }

    /// What any mechanism's evidence over so many blocks is divided by.
    pub(crate) fn common_discount(&self, blocks: usize) -> f64 {
        1.0 + self.pooled * blocks as f64
    }

    /// What a mechanism's evidence over so many blocks is divided by.
    pub(crate) fn discount(&self, name: &str, blocks: usize) -> f64 {
        1.0 + self.surplus(name) * blocks as f64
    }

    /// Surplus of a mechanism: that of all, and a part of what its own is beyond, since few drives tell it.
    fn surplus(&self, name: &str) -> f64 {
        let own = self.own.get(name).map_or(self.pooled, |seen| seen.surplus);
        let own = own.max(0.0) - self.pooled;
        self.pooled + if own > 0.0 { MORE * own } else { LESS * own }
    }
}

/// Shares of what a mechanism's own surplus is beyond that of all, or less, that count: few drives tell it. A single pair of drives
/// makes it 4 and more by chance in one of twenty mechanisms.
const MORE: f64 = 0.25;
const LESS: f64 = 0.5;

fn mean(seen: &[Seen]) -> Seen {
    let count = seen.len().max(1) as f64;
    let parameters = seen.iter().map(|one| one.variance.len()).min().unwrap_or(0);
    Seen {
        surplus: seen.iter().map(|one| one.surplus).sum::<f64>() / count,
        variance: (0..parameters)
            .map(|j| seen.iter().map(|one| one.variance[j]).sum::<f64>() / count)
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn null(surpluses: &[(&'static str, f64)]) -> Null {
        let seen = |surplus: f64| Seen { surplus, variance: vec![4.0] };
        let own: BTreeMap<&'static str, Seen> =
            surpluses.iter().map(|(name, surplus)| (*name, seen(*surplus))).collect();
        let pooled = own.values().map(|seen| seen.surplus).sum::<f64>() / own.len() as f64;
        Null { own, pooled: pooled.max(0.0) }
    }

    #[test]
    fn evidence_counts_in_full_where_healthy_drives_agree_as_far_as_chance_lets_them() {
        let null = null(&[("payload", 0.02), ("wind", -0.01), ("inertia", -0.01)]);
        assert!((null.discount("wind", 100) - 1.0).abs() < 1e-12);
        assert!((null.common_discount(100) - 1.0).abs() < 1e-12);
        assert!((null.discount("payload", 100) - 1.5).abs() < 1e-12, "a quarter of its own counts");
    }

    #[test]
    fn what_all_mechanisms_seem_to_explain_is_held_against_all() {
        let null = null(&[("payload", 0.06), ("wind", 0.02), ("inertia", 0.01)]);
        assert!((null.common_discount(100) - 4.0).abs() < 1e-12);
        assert!((null.discount("payload", 100) - 4.75).abs() < 1e-12);
        assert!((null.discount("wind", 100) - 3.5).abs() < 1e-12);
        let variance = null.variance("wind", 1).unwrap()[0];
        assert!((variance - 0.1).abs() < 1e-12, "{variance}: no length of driving makes it less");
        assert_eq!(null.variance("regeneration", 1), None, "healthy drives told nothing of it");
    }
}
