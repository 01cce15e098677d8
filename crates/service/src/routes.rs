//! One file for each path: request, handler and answer together.

pub mod alternatives;
pub mod calibrate;
pub mod compare;
pub mod diagnose;
pub mod earth;
pub(crate) mod guide;
pub mod health;
pub mod jobs;
pub mod map_areas;
pub mod maps;
pub mod matrix;
pub(crate) mod metrics;
pub mod mission;
pub(crate) mod page;
pub mod plan;
pub mod range;
pub mod reachable;
pub mod recordings;
pub mod robot_mechanisms;
pub mod robots;
pub mod status;
