//! Why drives cannot be diagnosed.

use model::Robot;

/// Why drives cannot be diagnosed.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// They cannot be prepared or fitted.
    #[error(transparent)]
    Calibration(#[from] calibration::Error),
    /// Drives that tell power in different forms.
    #[error(
        "a diagnosis needs power in the same columns of all recordings: by side, of the battery, or as motor currents of both sides"
    )]
    Form,
    /// Ground that the robot does not know.
    #[error(
        "the recording names the surface {surface:?}, which the robot lacks; it knows {known}; calibrate on it first"
    )]
    Surface {
        /// What the recording calls it.
        surface: String,
        /// Surfaces of the robot.
        known: String,
    },
    /// Times that cannot be those of a drive log.
    #[error(transparent)]
    Recording(#[from] recording::Error),
    /// Rows that are too far apart to tell how fast speeds change.
    #[error("rows are {step_s:.1} s apart, and a diagnosis needs {most_s} s at most: record more often")]
    TooCoarse {
        /// Time between rows in the median \[s\].
        step_s: f64,
        /// Most that is accepted \[s\].
        most_s: f64,
    },
    /// Drives under suspicion that are among the healthy ones.
    #[error(
        "drive `{drive}` of the recording is among the healthy ones too, as `{healthy}`: held against itself it lacks nothing; name other drives as healthy"
    )]
    Same {
        /// The drive under suspicion.
        drive: String,
        /// The same among the healthy ones.
        healthy: String,
    },
    /// A simulation that is not of the recorded drives.
    #[error("the simulation cannot stand beside the recording: {0}")]
    Simulated(String),
    /// A simulation of some drives beside healthy ones, of which there is none.
    #[error(
        "a simulation of the drives cannot be held against healthy drives, which were not simulated: leave out the healthy drives, or the simulation"
    )]
    SimulatedBesideHealthy,
    /// Values that nothing can be fitted to.
    #[error(
        "nothing can be fitted to these drives: at {t_s:.1} s of drive `{drive}` the wheels of this robot would draw {power_w:.3e} W; is a row there a \
         glitch? Leave it out"
    )]
    Beyond {
        /// The drive.
        drive: String,
        /// Seconds since it began.
        t_s: f64,
        /// What the model makes of it [W].
        power_w: f64,
    },
    /// Not enough to decide anything.
    #[error(
        "{seconds} s of driving are too little for a diagnosis, which compares at least {needed} s of it"
    )]
    TooShort {
        /// Seconds that could be judged.
        seconds: usize,
        /// Seconds that are needed.
        needed: usize,
    },
}

impl Error {
    pub(crate) fn surface(name: &str, robot: &Robot) -> Self {
        let known: Vec<&str> = robot.surfaces.keys().map(String::as_str).collect();
        Error::Surface { surface: name.to_owned(), known: known.join(", ") }
    }
}
