//! Questions and their answers, and what questions about one map and robot share.
//! Ends are snapped to the lattice or joined exactly. Where no path leads to a goal, the answer says why.

pub(crate) mod connected;
pub(crate) mod ends;
pub(crate) mod exact_ends;
pub(crate) mod explanation;
pub(crate) mod guided;
pub(crate) mod partial;
pub(crate) mod plan;
pub(crate) mod planner;
pub(crate) mod query;
pub(crate) mod relatives;
pub(crate) mod rings;
pub(crate) mod snap;
pub(crate) mod target;
