//! Why a question cannot be answered.

/// An error of the routing crate.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// What the planner says of a place or a path.
    #[error(transparent)]
    Planner(#[from] planner::Error),
}
