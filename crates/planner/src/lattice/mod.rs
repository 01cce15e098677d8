//! Lattice of poses: the motions of a robot from each heading, and what each takes on the ground at hand.
//! `primitive` builds the motions, `preparation` works out their steps and the cells that they sweep.
//! `edge` and `step` drive them in double precision, and `graph` holds the lattice itself.

pub(crate) mod displacement;
pub(crate) mod edge;
pub(crate) mod graph;
pub(crate) mod ground_class;
pub(crate) mod objective;
pub(crate) mod preparation;
pub(crate) mod prices;
pub(crate) mod primitive;
pub(crate) mod step;
pub(crate) mod swept;
