//! Gaussian evidence: noise model and linear model. Knows rows and columns, and no robot.

pub(crate) mod linear_model;
pub(crate) mod noise;
