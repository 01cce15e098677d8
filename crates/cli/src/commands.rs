//! One file for each command: its arguments and what it does with them.

pub(crate) mod alternatives;
pub(crate) mod bench;
pub(crate) mod calibrate;
pub(crate) mod compare;
pub(crate) mod completions;
pub(crate) mod demo;
pub(crate) mod diagnose;
pub(crate) mod fleet;
pub(crate) mod inspect;
pub(crate) mod man;
pub(crate) mod matrix;
pub(crate) mod mission;
pub(crate) mod open;
pub(crate) mod plan;
pub(crate) mod predict;
pub(crate) mod prove;
pub(crate) mod range;
pub(crate) mod reachable;
pub(crate) mod robot;
pub(crate) mod schema;
pub(crate) mod serve;
pub(crate) mod simulate;
