//! Table of the costs of all motions from every state, in 16 bits, and lower bounds of these costs.
//! Both are evaluated tile by tile in single precision, rows of cells side by side.
//! `proof` says what the table's costs prove in double precision.

pub(crate) mod cost_table;
pub(crate) mod least;
pub(crate) mod piece_bound;
pub(crate) mod proof;
pub(crate) mod relation;
pub(crate) mod roll_bound;
pub(crate) mod row_step;
pub(crate) mod step_cost;
pub(crate) mod step_costs;
pub(crate) mod strips;
pub(crate) mod tile;
pub(crate) mod tile_bound;
pub(crate) mod tile_builder;
pub(crate) mod window;
