//! Drives as a diagnosis takes them: checked, thinned, with motor currents turned into power.

use std::borrow::Cow;

use calibration::with_powers;
use recording::{PowerForm, Recording, Watch};

use crate::{
    Error, Question,
    observe::{admissible, sanity::contradictions},
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
        Ok(Prepared {
            suspect: powered(&as_recorded)?,
            healthy,
            as_recorded,
            by_current: suspect.power_form() == Some(PowerForm::MotorCurrents),
            contradictions,
        })
    }
}
