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
    parts::one_and_others,
    series::Series,
    weigh::{Weighed, weigh_all},
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
    pub(crate) fn of(robot: &Robot, healthy: Option<&Recording>, watch: &Watch) -> Result<Self, Error> {
        let Some(healthy) = healthy else { return Ok(Null::default()) };
        let mut seen: BTreeMap<&'static str, Vec<Seen>> = BTreeMap::new();
        for (suspect, others) in one_and_others(healthy, NEEDED_S as f64) {
            let series = match Series::watched(robot, &suspect, Some(&others), watch) {
                Ok(series) => series,
                Err(Error::Calibration(calibration::Error::Stopped)) => {
                    return Err(calibration::Error::Stopped.into());
                }
                Err(_) => continue,
            };
            let base = Baseline::fit(&series, robot, &[])?;
            let (weighed, blocks) = weigh_all(&series, &base, &[], &Null::default())?;
            for Weighed { candidate, evidence, tried, .. } in &weighed {
                // The largest of so many χ² of q degrees of freedom is about q + 2 ln(number).
                let expected = evidence.values.len() as f64 + 2.0 * f64::from(*tried).ln();
                let factor = evidence.wald / expected;
                let variance = evidence.covariance.diagonal().iter().map(|v| v * blocks as f64).collect();
                let surplus = (factor - 1.0).max(0.0) / blocks as f64;
                seen.entry(candidate.applied.mechanism.name()).or_default().push(Seen { surplus, variance });
            }
        }
        let own: BTreeMap<&'static str, Seen> =
            seen.into_iter().map(|(name, seen)| (name, mean(&seen))).collect();
        let pooled = own.values().map(|seen| seen.surplus).sum::<f64>() / own.len().max(1) as f64;
        Ok(Null { own, pooled })
    }

    /// What a mechanism's numbers seem to be where there is nothing, one sigma squared of each: misfit of models, which no length
    /// of driving makes less. `None` where healthy drives told nothing of it.
    pub(crate) fn variance(&self, name: &str, parameters: usize) -> Option<Vec<f64>> {
        let seen = self.own.get(name).filter(|seen| seen.variance.len() == parameters)?;
        Some(seen.variance.iter().map(|v| 0.5 * (seen.surplus + self.pooled) * v).collect())
    }

    /// What a mechanism's evidence over so many blocks is divided by: half its own surplus, half that of all, since few
    /// drives tell either.
    pub(crate) fn discount(&self, name: &str, blocks: usize) -> f64 {
        let own = self.own.get(name).map_or(self.pooled, |seen| seen.surplus);
        1.0 + 0.5 * (own + self.pooled) * blocks as f64
    }
}

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
