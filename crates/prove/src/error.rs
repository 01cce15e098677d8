//! What can go wrong with a trial; what goes wrong with a diagnosis is a score, not an error.

use std::path::PathBuf;

/// An error of the prove crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file or folder that cannot be read or written.
    #[error("{path}: {source}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The world refused to draw a case.
    #[error("case {case}: {source}")]
    World {
        /// Which.
        case: String,
        /// Why.
        source: world::Error,
    },
    /// The robot file is not one.
    #[error("robot: {0}")]
    Robot(world::Error),
    /// A key is not the one that was committed to.
    #[error("{path}: its SHA-256 is {found}, but {committed} was committed to; the trial proves nothing")]
    ChangedKey {
        /// The key.
        path: PathBuf,
        /// Published before the diagnosis.
        committed: String,
        /// Of the file as it is now.
        found: String,
    },
    /// A key without a commitment.
    #[error("{path}: nothing was committed to for it")]
    Uncommitted {
        /// The key.
        path: PathBuf,
    },
    /// A file of a case is not the one that its key speaks of.
    #[error("{path}: it has changed since its key was sealed; the trial proves nothing")]
    ChangedCase {
        /// The file.
        path: PathBuf,
    },
    /// A file that does not hold what it should.
    #[error("{path}: {source}")]
    Content {
        /// Which.
        path: PathBuf,
        /// What is wrong with it.
        source: serde_json::Error,
    },
    /// A trial that is added up twice.
    #[error("{path}: this trial is among the folders before already; name each once")]
    Twice {
        /// Its scoreboard.
        path: PathBuf,
    },
    /// A recording of real drives that cannot be read.
    #[error("{path}: {source}")]
    Recording {
        /// Which.
        path: PathBuf,
        /// Why.
        source: Box<recording::Error>,
    },
    /// A recording with too few runs to keep some apart.
    #[error("{path}: a ground needs three runs or more, two to fit the robot on and one to diagnose")]
    FewRuns {
        /// Which.
        path: PathBuf,
    },
    /// Real drives that no case could be made of.
    #[error("case {case}, on {ground}: {source}")]
    Drawing {
        /// Which.
        case: String,
        /// The ground of its drives.
        ground: String,
        /// Why the last try failed.
        source: Box<Error>,
    },
    /// Drives that no robot can be fitted to, or whose currents cannot be read.
    #[error(transparent)]
    Calibration(#[from] calibration::Error),
    /// A run that cannot go on over another ground from this time on.
    #[error("no run can go on over another ground at {border_s} s")]
    NoBorder {
        /// After the beginning of the run [s].
        border_s: f64,
    },
    /// No threads could be had.
    #[error("threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
}

impl Error {
    pub(crate) fn file(path: impl Into<PathBuf>) -> impl FnOnce(std::io::Error) -> Error {
        let path = path.into();
        move |source| Error::File { path, source }
    }
}
