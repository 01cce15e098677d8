//! What the posterior says, as a report.

pub(crate) mod detectable;
pub(crate) mod document;
pub(crate) mod file_error;
pub(crate) mod finding;
pub(crate) mod held_out;
pub(crate) mod sentence;
pub(crate) mod verdict;
