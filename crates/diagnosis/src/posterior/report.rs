//! What the posterior says, as a report.

pub(crate) mod detectable;
pub(crate) mod document;
pub(crate) mod file_error;
pub(crate) mod finding;
pub(crate) mod fitted;
pub(crate) mod held_out;
pub(crate) mod next_drive;
pub(crate) mod place;
pub(crate) mod planned_drive;
pub(crate) mod sentence;
pub(crate) mod verdict;
