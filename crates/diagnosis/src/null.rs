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
    parts::one_and_others,
    series::Series,
    weigh::{Weighed, weigh_all},
};

/// Factors by which evidence is discounted, at least 1.
#[derive(Clone, Debug, Default)]
pub(crate) struct Null {
    /// Surplus over 1 for each block, by mechanism.
    own: BTreeMap<&'static str, f64>,
    /// The same over all mechanisms.
    pooled: f64,
}

impl Null {
    /// Takes each healthy drive for suspect in turn. Without healthy drives nothing is discounted.
    ///
    /// # Errors
    /// A surface that the robot does not know, or that the watch breaks.
    pub(crate) fn of(robot: &Robot, healthy: Option<&Recording>, watch: &Watch) -> Result<Self, Error> {
        let Some(healthy) = healthy else { return Ok(Null::default()) };
        let mut surplus: BTreeMap<&'static str, Vec<f64>> = BTreeMap::new();
        for (suspect, others) in one_and_others(healthy) {
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
                let name = candidate.applied.mechanism.name();
                surplus.entry(name).or_default().push((factor - 1.0).max(0.0) / blocks as f64);
            }
        }
        let own: BTreeMap<&'static str, f64> = surplus
            .into_iter()
            .map(|(name, surplus)| (name, surplus.iter().sum::<f64>() / surplus.len() as f64))
            .collect();
        let pooled = own.values().sum::<f64>() / own.len().max(1) as f64;
        Ok(Null { own, pooled })
    }

    /// What a mechanism's evidence over so many blocks is divided by: half its own surplus, half that of all, since few
    /// drives tell either.
    pub(crate) fn discount(&self, name: &str, blocks: usize) -> f64 {
        let own = self.own.get(name).copied().unwrap_or(self.pooled);
        1.0 + 0.5 * (own + self.pooled) * blocks as f64
    }
}
