//! The procedures that a robot can be fitted by, as a person chooses between them.

use model::Robot;
use recording::{Recording, Watch, unwatched};
use serde::{Deserialize, Serialize};

use crate::{Calibration, Error, Options, calibrate, calibrate_watched, dogru_marques};

/// A procedure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// A fit of everything at once.
    #[default]
    Fit,
    /// The paper's own: friction from steady seconds, speed by speed.
    DogruMarques,
}

impl Method {
    /// Fits a robot to recordings by the procedure.
    ///
    /// # Errors
    /// As [`calibrate`] and [`dogru_marques::calibrate`].
    pub fn calibrate(
        self,
        robot: &Robot,
        recording: &Recording,
        options: &Options,
    ) -> Result<Calibration, Error> {
        match self {
            Method::Fit => calibrate(robot, recording, options),
            Method::DogruMarques => dogru_marques::calibrate(robot, recording, &unwatched()),
        }
    }

    /// Fits a robot as [`Method::calibrate`] does, followed by a watch.
    ///
    /// # Errors
    /// As [`Method::calibrate`], and [`Error::Stopped`] soon after the watch breaks.
    pub fn calibrate_watched(
        self,
        robot: &Robot,
        recording: &Recording,
        options: &Options,
        watch: &Watch,
    ) -> Result<Calibration, Error> {
        match self {
            Method::Fit => calibrate_watched(robot, recording, options, watch),
            Method::DogruMarques => dogru_marques::calibrate(robot, recording, watch),
        }
    }
}
