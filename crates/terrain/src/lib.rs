//! Ground on a regular grid: elevation, slope, surface classes and obstacles, and the files they come in.
//!
//! Axes, for the whole program: x east, y north, z up; heading counter-clockwise from +x. Row 0 is the
//! southernmost, `origin_m` the south-west corner of cell (0, 0), so the centre of a cell lies half a cell further in.
//! This crate knows nothing of robots.

pub mod areas;
pub mod crs;
mod doubt;
mod error;
pub mod fill_value;
pub mod fill_voids;
pub mod gaps;
mod grid;
pub mod hidden_relief;
pub mod hillshade;
pub mod io;
mod nodata;
mod patch;
mod resample;
mod samples;
pub mod slope;
pub mod synthetic;
mod terrain;
mod warning;

pub use error::Error;
pub use grid::{Cell, Grid};
pub use io::json::MapFile;
pub use patch::{CellRange, Patch};
pub use slope::SlopeMap;
pub use terrain::{Surfaces, Terrain};
pub use warning::{Warning, WarningKind};
