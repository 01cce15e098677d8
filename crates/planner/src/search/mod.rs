//! A* over poses, led by a field, with a proof of how good its answer is.
//! Where changes of direction have a price, a state is a pose and what the robot did last.

pub(crate) mod astar;
pub(crate) mod changes;
pub(crate) mod changing;
pub(crate) mod walk_back;
