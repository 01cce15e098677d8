//! What counts as standing, as turning and as one manoeuvre.

pub(super) use recording::STANDS_MPS;

/// Difference of rim speeds with which a robot turns \[m/s\]: five times the speed at which a rim stands still.
pub(super) const TURNING_MPS: f64 = 5.0 * STANDS_MPS;
/// Time over which errors of power are alike \[s\]: a manoeuvre. Rows within one tell nothing of their own.
pub(super) const ALIKE_S: f64 = 4.0;
