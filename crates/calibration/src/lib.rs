//! Predicted against recorded power, and robots fitted to their recordings.
//!
//! SI units; axes and signs are those of the `model` and `recording` crates. What is fitted and what is judged are averages over
//! one second ([`Drives`]); runs are kept apart, and no run is judged by a fit that saw it.

pub mod current;
pub mod current_fit;
pub mod drives;
mod error;
pub mod fit;
pub mod folds;
pub mod lag;
pub mod score;
pub mod slip_law;
mod stuck;

pub use drives::Drives;
pub use error::Error;
pub use stuck::slip_track_m;
