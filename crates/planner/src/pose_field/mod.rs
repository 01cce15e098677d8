//! Least costs over poses: from every state to goals, or from starts to every state.
//! An exact field grows tile by tile. `near` is the part about a goal that has a heading.

pub(crate) mod exact;
pub(crate) mod near;
pub(crate) mod pose_codes;
pub(crate) mod pose_costs;
pub(crate) mod pose_growth;
pub(crate) mod pose_stencil;
pub(crate) mod pose_sweep;
