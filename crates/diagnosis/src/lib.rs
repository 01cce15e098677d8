//! Where model and recording differ, which physics was left out, how big it is, and how sure that is.
//!
//! One Gaussian model: the robot file as prior, a smooth discrepancy that all drives share, mechanisms of `model::mechanism` with
//! physical priors, and an unlisted class. What the report says is read off its posterior over sets of mechanisms. Healthy drives of
//! the same robot, if there are any, only add rows.
//!
//! Arrows point downwards only:
//!
//! ```text
//! diagnose     recordings -> rows -> posterior -> report
//! learn        healthy drives -> what the robot's file knows of itself
//! report       verdict, findings, sentence, held-out errors, detectable sizes
//! search       screening, refits, explanations
//! hypothesis   windows, effects, products by piece, unlisted class
//! fit          baseline robot, discrepancy, joint fit
//! observe      rows of all drives; what a robot would have shown
//! evidence     noise, linear model; knows no robot
//! ```

mod diagnose;
mod error;
mod learn;
mod plain;

/// Gaussian evidence: noise and linear model.
mod evidence {
    pub(crate) mod linear_model;
    pub(crate) mod noise;
    pub(crate) mod reduced;
    pub(crate) mod width;
}

/// Drives as the model sees them, second by second, and what a robot would have shown.
mod observe {
    pub(crate) mod admissible;
    pub(crate) mod average;
    pub(crate) mod climb;
    pub(crate) mod ground;
    #[cfg(test)]
    pub(crate) mod hills;
    pub(crate) mod imitate;
    pub(crate) mod kept;
    pub(crate) mod observations;
    pub(crate) mod part;
    pub(crate) mod prepared;
    pub(crate) mod reach;
    pub(crate) mod region;
    pub(crate) mod sag;
    pub(crate) mod sample;
    pub(crate) mod sanity;
    pub(crate) mod series;
    pub(crate) mod simulated;
    pub(crate) mod span;
    pub(crate) mod turning;
}

/// The robot fitted to the drives: parameters with their priors, what its model misses, and effects beside both.
mod fit {
    pub(crate) mod amplitude;
    pub(crate) mod baseline;
    pub(crate) mod discrepancy;
    pub(crate) mod features;
    pub(crate) mod held_out;
    pub(crate) mod joint;
    pub(crate) mod member;
    pub(crate) mod parameter;
    pub(crate) mod temperature;
}

/// Mechanisms with their forms, windows in which they act, and effects outside the list.
mod hypothesis {
    pub(crate) mod atoms;
    pub(crate) mod effect;
    pub(crate) mod unlisted;
    pub(crate) mod window;
}

/// The posterior over sets of mechanisms: screening on linear columns, refits in full, explanations.
mod search {
    pub(crate) mod basis;
    pub(crate) mod engine;
    pub(crate) mod explanation;
    pub(crate) mod fits;
    pub(crate) mod refine;
    pub(crate) mod screen;
}

/// What the posterior says, as a report.
pub mod report {
    pub(crate) mod about_simulation;
    pub(crate) mod assumed;
    pub(crate) mod constants;
    pub(crate) mod corrected;
    pub(crate) mod detectable;
    pub(crate) mod diagnosis;
    pub(crate) mod document;
    pub(crate) mod finding;
    pub(crate) mod next_drive;
    pub(crate) mod place;
    pub(crate) mod planned_drive;
    pub(crate) mod predictions;
    pub(crate) mod sentence;
    pub(crate) mod verdict;

    pub use diagnosis::*;
    pub use finding::UNKNOWN;
}

pub use diagnose::{Question, diagnose, diagnose_watched};
pub use error::Error;
pub use learn::{Errors, Learnt, learn, taught};
pub use observe::{
    average::{Average, Input},
    imitate::imitate,
    region::Region,
    series::Series,
    span::{Applied, Span},
};
pub use plain::Plain;
pub use report::{Diagnosis, Finding, UNKNOWN, Verdict};
