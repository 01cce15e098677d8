//! What can be wrong with a recording that a robot is to be fitted to or judged by.

use crate::Doubt;

/// An error of the calibration crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Nothing in the recording can be used.
    #[error("the recording cannot be used: {reason}")]
    NothingToFit {
        /// Why.
        reason: &'static str,
    },
    /// No two neighbouring rows have all that an energy needs.
    #[error("the recording cannot be used: no energy comes of it: {why}")]
    NothingCounted {
        /// What of it is left out, and why.
        why: String,
    },
    /// What a fit would only explain away.
    #[error(
        "no robot was written, because the recording is doubtful: {}; if it is right as it is, calibrate {}",
        doubts.iter().map(ToString::to_string).collect::<Vec<_>>().join("; "),
        doubts.iter().map(|doubt| format!("`--despite {}`", doubt.name)).collect::<Vec<_>>().join(" ")
    )]
    Doubtful {
        /// The doubts.
        doubts: Vec<Doubt>,
    },
    /// Runs that were not fitted contradict the fit.
    #[error(
        "no robot was written: it predicts runs that it was not fitted to worse than their mean does (R² {r2:.2}, RMSE {rmse_w:.1} W); the runs differ in \
         ground, load or sensors, or hardly vary: choose runs that belong together, or calibrate `--despite held_out`"
    )]
    Contradicted {
        /// R² of held-out runs.
        r2: f64,
        /// Root mean square error \[W\].
        rmse_w: f64,
    },
    /// Runs are too few to hold one back.
    #[error(
        "surface `{surface}` was driven in {runs} run; record two or more, since runs that were not fitted are to judge the fit"
    )]
    TooFewRuns {
        /// The surface.
        surface: String,
        /// Runs on it.
        runs: usize,
    },
    /// A surface is named that the recording or the robot lacks.
    #[error("run `{run}`, row {row} of it: surface `{surface}` is unknown to the robot, which knows {}; `joulepath calibrate` adds it", known.join(", "))]
    UnknownSurface {
        /// The run.
        run: String,
        /// First row of the run on that surface, from 1.
        row: usize,
        /// The surface.
        surface: String,
        /// What the robot knows.
        known: Vec<String>,
    },
    /// The surface that the others lean on was not driven.
    #[error("no run drove on the reference surface `{surface}`; the recording has {}", found.join(", "))]
    NoReference {
        /// The surface asked for.
        surface: String,
        /// What was driven on.
        found: Vec<String>,
    },
    /// Motor currents need newtons per ampere to become watts.
    #[error(
        "the recording tells power as motor currents: give `force_n_per_a` in motors.left and motors.right of the robot, or run `joulepath calibrate`, which finds it"
    )]
    NoForcePerAmpere,
    /// A cell of a lifting test that is not what it should be.
    #[error(
        "line {line}, column `{column}`: `{found}` will not do; the table needs the columns side (left or right), force_n, rim_speed_mps, power_w with numbers below them"
    )]
    Lift {
        /// Line from 1.
        line: usize,
        /// The column.
        column: String,
        /// What stands there.
        found: String,
    },
    /// The method does not fit the recording.
    #[error("{method} needs {needs}")]
    Needs {
        /// What was asked for.
        method: &'static str,
        /// What the recording lacks.
        needs: &'static str,
    },
    /// Who asked for it stopped the computation.
    #[error("the computation was stopped")]
    Stopped,
    /// The recording is not what its readers make.
    #[error(transparent)]
    Recording(recording::Error),
    /// The fitted robot does not pass its own checks.
    #[error("the fitted robot cannot be: {0}")]
    Robot(#[from] model::Error),
}

impl From<recording::Error> for Error {
    fn from(error: recording::Error) -> Self {
        match error {
            recording::Error::Stopped => Error::Stopped,
            other => Error::Recording(other),
        }
    }
}
