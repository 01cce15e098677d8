//! Why there is nothing to measure.

/// An error of the bench crate.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The planner refused the map or found no path over it.
    #[error("{side} × {side} cells: {source}")]
    Plan {
        /// Side of the map [cells].
        side: usize,
        /// What the planner said.
        source: planner::Error,
    },
    /// The map could not be made.
    #[error("{side} × {side} cells: {source}")]
    Map {
        /// Side of the map [cells].
        side: usize,
        /// What the terrain said.
        source: terrain::Error,
    },
    /// No path between the ends that are measured.
    #[error(
        "{side} × {side} cells: there is no path between the ends that are measured; take a tile that can be crossed"
    )]
    NoPath {
        /// Side of the map [cells].
        side: usize,
    },
    /// Another search found another cost.
    #[error("{name} found a path of {found} units where the planner's has {expected}: one of them is wrong")]
    Disagreement {
        /// The other search.
        name: &'static str,
        /// Its cost.
        found: u64,
        /// Ours.
        expected: u64,
    },
    /// No threads to measure on.
    #[error("cannot start a thread to measure on: {0}")]
    Threads(String),
}
