//! Drives as a diagnosis takes them: checked, thinned, with motor currents turned into power.

use std::borrow::Cow;

use calibration::with_powers;
use recording::{PowerForm, Recording, Watch};

use crate::{
    Error, Question,
    observe::{admissible, sanity::contradictions, simulated::BesideSimulation},
};

/// The drives of a question.
pub(crate) struct Prepared<'a> {
    /// Drives under suspicion, with power.
    pub(crate) suspect: Recording,
    /// Healthy drives, with power.
    pub(crate) healthy: Option<Recording>,
    /// Drives under suspicion before motor currents became power.
    pub(crate) as_recorded: Cow<'a, Recording>,
    /// Whether power was made of motor currents.
    pub(crate) by_current: bool,
    /// By row of the drives under suspicion: power of the simulation that stands in the place of the file's prediction, less that
    /// prediction; empty without one [W].
    pub(crate) offset_w: Vec<f64>,
    /// What the drives contradict whatever the robot.
    pub(crate) contradictions: Vec<String>,
}

impl<'a> Prepared<'a> {
    /// Prepares them.
    ///
    /// # Errors
    /// Drives that cannot be diagnosed; a watch that breaks.
    pub(crate) fn new(question: &Question<'a>, watch: &Watch) -> Result<Self, Error> {
        let Question { robot, suspect, healthy, .. } = *question;
        admissible::check(suspect, healthy)?;
        // Means over angles in another unit are none.
        let contradictions = contradictions(suspect, healthy);
        let thinned = |recording: &'a Recording| {
            recording.thinned_watched(watch).map_err(|error| Error::from(calibration::Error::from(error)))
        };
        let as_recorded = thinned(suspect)?;
        let powered = |recording: &Recording| with_powers(robot, recording, watch).map_err(Error::from);
        let healthy = match healthy {
            Some(healthy) => Some(powered(&*thinned(healthy)?)?),
            None => None,
        };
        let mut suspect_w = powered(&as_recorded)?;
        let mut offset_w = Vec::new();
        if let Some(simulated) = question.simulated {
            if healthy.is_some() {
                return Err(Error::SimulatedBesideHealthy);
            }
            simulated.check_time()?;
            let simulated = powered(&*thinned(simulated)?)?;
            let beside = BesideSimulation::new(robot, &suspect_w, &simulated)?;
            (suspect_w, offset_w) = (beside.recording, beside.offset_w);
        }
        Ok(Prepared {
            suspect: suspect_w,
            offset_w,
            healthy,
            as_recorded,
            by_current: suspect.power_form() == Some(PowerForm::MotorCurrents),
            contradictions,
        })
    }
}
