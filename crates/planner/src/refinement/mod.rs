//! Refinement of the lattice's path: curves of any radius that replace it, driven over the same ground.
//! `shortcut` replaces stretches, then `polish` moves waypoints and radii as long as that pays.

pub(crate) mod connection;
pub(crate) mod course;
pub(crate) mod free;
pub(crate) mod polish;
pub(crate) mod rates;
pub(crate) mod refine;
pub(crate) mod shortcut;
