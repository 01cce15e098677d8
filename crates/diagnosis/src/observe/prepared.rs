//! Drives as a diagnosis takes them: checked and thinned, and beside another simulation where there is one.

use calibration::with_powers;
use recording::{Recording, Watch};

use crate::{
    Error, Question,
    observe::{admissible, sanity::contradictions, simulated::BesideSimulation},
};

/// The drives of a question.
pub(crate) struct Prepared {
    /// Drives under suspicion.
    pub(crate) suspect: Recording,
    /// Healthy drives.
    pub(crate) healthy: Option<Recording>,
    /// By row of the drives under suspicion: power of the simulation that stands in the place of the file's prediction, less that
    /// prediction; empty without one [W].
    pub(crate) offset_w: Vec<f64>,
    /// What the drives contradict whatever the robot.
    pub(crate) contradictions: Vec<String>,
}

impl Prepared {
    /// Prepares them.
    ///
    /// # Errors
    /// Drives that cannot be diagnosed; a watch that breaks.
    pub(crate) fn new(question: &Question<'_>, watch: &Watch) -> Result<Self, Error> {
        let Question { robot, suspect, healthy, .. } = *question;
        admissible::check(suspect, healthy)?;
        // Means over angles in another unit are none.
        let contradictions = contradictions(suspect, healthy);
        let thinned = |recording: &Recording| -> Result<Recording, Error> {
            let thinned = recording.thinned_watched(watch).map_err(calibration::Error::from)?;
            Ok(thinned.into_owned())
        };
        let mut drives = thinned(suspect)?;
        let powered = |recording: &Recording| with_powers(robot, recording, watch).map_err(Error::from);
        let healthy = match healthy {
            Some(healthy) => Some(thinned(healthy)?),
            None => None,
        };
        let mut offset_w = Vec::new();
        if let Some(simulated) = question.simulated {
            if healthy.is_some() {
                return Err(Error::SimulatedBesideHealthy);
            }
            simulated.check_time()?;
            let simulated = powered(&thinned(simulated)?)?;
            let beside = BesideSimulation::new(robot, &powered(&drives)?, &simulated)?;
            (drives, offset_w) = (beside.recording, beside.offset_w);
        }
        Ok(Prepared { suspect: drives, offset_w, healthy, contradictions })
    }
}
