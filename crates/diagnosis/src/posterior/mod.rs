//! Diagnosis by one Gaussian model: the robot file as prior, a smooth discrepancy, effects with physical priors, an unlisted class.
//!
//! Arrows point downwards only:
//!
//! ```text
//! diagnose     recordings -> rows -> posterior -> report
//! engine       rows -> posterior
//! report       verdict, findings, sentence, held-out errors, detectable sizes
//! search       screening, refits, explanations
//! hypothesis   windows, effects, products by piece, unlisted class
//! fit          baseline robot, discrepancy, joint fit
//! observations rows of all drives
//! evidence     noise, linear model; knows no robot
//! ```

pub(crate) mod diagnose;
pub(crate) mod engine;
pub(crate) mod evidence;
pub(crate) mod fit;
pub(crate) mod hypothesis;
pub(crate) mod observations;
pub(crate) mod report;
pub(crate) mod search;
