//! The tables of `docs/diagnosis.md`, as the code has them.

mod page;
mod priors;
mod source;

pub(crate) use page::{filled, path};
pub(crate) use source::constants;
