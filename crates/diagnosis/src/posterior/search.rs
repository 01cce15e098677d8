//! The posterior over sets of mechanisms: screening on linear columns, refits in full, explanations.

pub(crate) mod explanation;
pub(crate) mod fits;
pub(crate) mod refine;
pub(crate) mod screen;
