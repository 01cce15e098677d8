//! Frontier of a search: labels of the states that it has reached, and the queue of those to take up next.
//! Dijkstra's search works with both, and exact fields begin with it.

pub(crate) mod dijkstra;
pub(crate) mod labels;
pub(crate) mod prefetch;
pub(crate) mod queue;
