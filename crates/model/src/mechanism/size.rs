//! Prior sizes of mechanisms: what a user could plausibly meet, in the robot's own units.

use crate::Robot;

/// Signs that a parameter can have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// Both.
    Either,
    /// Positive only.
    Positive,
    /// Negative only.
    Negative,
}

/// Zero-mean normal prior of a parameter, cut in half where one sign is impossible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SizePrior {
    /// One standard deviation, in the parameter's unit.
    pub sigma: f64,
    /// Possible signs.
    pub sign: Sign,
}

impl SizePrior {
    /// A normal prior.
    pub fn either(sigma: f64) -> Self {
        SizePrior { sigma, sign: Sign::Either }
    }

    /// A half-normal prior above zero.
    pub fn positive(sigma: f64) -> Self {
        SizePrior { sigma, sign: Sign::Positive }
    }

    /// A half-normal prior below zero.
    pub fn negative(sigma: f64) -> Self {
        SizePrior { sigma, sign: Sign::Negative }
    }
}

/// Figures of a robot and its drives in which prior sizes are measured.
#[derive(Clone, Copy, Debug)]
pub struct Scale<'a> {
    /// The robot as its file has it.
    pub robot: &'a Robot,
    /// What the zero of a side's meter is usually off by [W].
    pub meter_zero_w: f64,
    /// Mean magnitude of the power drawn in all [W].
    pub mean_power_w: f64,
    /// Mean copper loss of one side [W].
    pub mean_loss_w: f64,
    /// Time between the rows of the logs [s].
    pub row_s: f64,
}

/// One shape of a mechanism: parameters that are held, and those whose size is free.
#[derive(Clone, Debug, PartialEq)]
pub struct Form {
    /// Values of all parameters; those of free ones are where they begin, 0 or a value of the sign that they keep.
    pub values: Vec<f64>,
    /// Parameters whose size is free.
    pub free: Vec<usize>,
    /// Factor by which sizes are wider than the mechanism's prior has them.
    pub widening: f64,
}

impl Form {
    /// All of so many parameters free.
    pub fn all_free(count: usize) -> Self {
        Form { values: vec![0.0; count], free: (0..count).collect(), widening: 1.0 }
    }

    /// One parameter free beside values that are held.
    pub fn one_free(values: Vec<f64>, free: usize) -> Self {
        Form { values, free: vec![free], widening: 1.0 }
    }
}
