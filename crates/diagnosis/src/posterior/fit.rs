//! The robot fitted to the drives: parameters with their priors, what its model misses, and effects beside both.

pub(crate) mod baseline;
pub(crate) mod discrepancy;
pub(crate) mod features;
pub(crate) mod joint;
pub(crate) mod parameter;
pub(crate) mod run_variation;
pub(crate) mod temperature;
