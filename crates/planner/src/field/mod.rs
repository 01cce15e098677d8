//! Least costs over cells to a goal, whatever the headings: the lower bound that leads A*.
//! A field grows tile by tile from the goal towards the start, and fields asked for lately are kept.

pub(crate) mod along;
pub(crate) mod fields;
pub(crate) mod front;
pub(crate) mod goal_field;
pub(crate) mod growth;
pub(crate) mod related;
pub(crate) mod stencil;
pub(crate) mod sweep;
