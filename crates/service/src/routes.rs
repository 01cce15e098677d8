//! One file for each path: request, handler and answer together.

pub mod compare;
pub mod health;
pub mod maps;
pub mod plan;
pub mod robots;
