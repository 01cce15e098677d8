//! Hypotheses: mechanisms with their forms, windows in which they act, and effects outside the list.

pub(crate) mod atoms;
pub(crate) mod effect;
pub(crate) mod unlisted;
pub(crate) mod window;
