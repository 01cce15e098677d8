//! Grid of states: sixteen headings over the cells of a map.
//! A state packs into 32 bits, a cost into 16. Nothing here knows a robot.

pub(crate) mod cost;
pub(crate) mod heading;
pub(crate) mod layout;
pub(crate) mod state;
