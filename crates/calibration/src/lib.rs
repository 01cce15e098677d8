//! Predicted against recorded power, and robots fitted to their recordings.
//!
//! SI units; axes and signs are those of the `model` and `recording` crates. What is fitted and what is judged are averages over
//! one second ([`Drives`]); runs are kept apart, and no run is judged by a fit that saw it.

pub mod average;
pub mod calibrate;
mod contradiction;
mod copies;
pub mod correlation;
mod coverage;
pub mod current;
pub mod current_calibration;
pub mod current_fit;
pub mod current_judge;
mod current_robot;
pub mod dogru_marques;
pub mod doubt;
pub mod drives;
mod error;
mod field;
mod file_fit;
pub mod fit;
pub mod folds;
mod force;
pub mod held_out;
pub mod lag;
pub mod lift;
pub mod losses;
pub mod meter;
mod method;
mod noise;
pub mod power;
pub mod power_fit;
pub mod predict;
mod rhythm;
pub mod row;
pub mod score;
pub mod slip_law;
mod slopes;
mod standstill;
mod stuck;
mod watch;

pub use calibrate::{Calibration, FittedParameter, Options, calibrate, calibrate_watched};
pub use coverage::{Coverage, DrivesCoverage, LeftOut, RunCoverage};
pub use doubt::{Doubt, doubts};
pub use drives::Drives;
pub use error::Error;
pub use field::{MOTOR_CONSTANT_SIGMA_PER_K, RESISTANCE_SIGMA_PER_K};
pub use held_out::{Fold, HeldOut, Skill, SurfaceSkill};
pub use method::Method;
pub use predict::{
    PredictedDrives, Prediction, RunPrediction, current_readings_a, force_n_per_a, predict, predict_watched,
    signed_n_per_a, with_powers,
};
pub use slopes::slopes_note;
pub use stuck::{SlipTrack, slip_track};
