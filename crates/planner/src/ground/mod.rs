//! Ground under the robot: height, attitude and clearance from the cells about its wheels.
//! The outline is held against blocked cells here too. Nothing here knows a motion.

pub(crate) mod blocked;
pub(crate) mod clearance;
pub(crate) mod footprint;
pub(crate) mod ground_tiles;
pub(crate) mod heights;
pub(crate) mod noise;
pub(crate) mod spans;
pub(crate) mod stance;
