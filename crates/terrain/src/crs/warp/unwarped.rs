//! Ground as a file's own cells have it, before it is brought to square cells of metres.

use super::Warp;
use crate::{Error, Terrain, io::Options, resample::Resampling};

/// Ground with the way to square cells of metres that it still needs, if it needs one. Marks of unknown ground and doubts are about the
/// file's own cells: heights between them would hide both.
pub(crate) struct Unwarped {
    pub(crate) terrain: Terrain,
    pub(crate) regridding: Option<Regridding>,
    /// Whether the file holds one number of 8 bits for each cell, as pictures do.
    pub(crate) is_of_bytes: bool,
}

/// The way from a file's own cells to square ones of metres, north up.
#[derive(Clone, Debug)]
pub(crate) enum Regridding {
    /// From degrees.
    Warp(Warp),
    /// From oblong or turned pixels.
    Resample(Resampling),
}

impl Regridding {
    /// Cells of the grid that is made.
    pub(crate) fn cells(&self) -> u64 {
        match self {
            Regridding::Warp(warp) => warp.cells(),
            Regridding::Resample(resampling) => resampling.grid.cells() as u64,
        }
    }
}

impl Unwarped {
    /// Ground of a file whose cells are those of the map, or become them by a warp.
    pub(crate) fn of(terrain: Terrain, warp: Option<Warp>) -> Self {
        Unwarped { terrain, regridding: warp.map(Regridding::Warp), is_of_bytes: false }
    }

    /// The ground in metres.
    ///
    /// # Errors
    /// As [`Warp::apply`].
    pub(crate) fn warped(self) -> Result<Terrain, Error> {
        match self.regridding {
            Some(Regridding::Warp(warp)) => warp.apply(&self.terrain),
            Some(Regridding::Resample(resampling)) => resampling.apply(&self.terrain),
            None => Ok(self.terrain),
        }
    }

    /// The ground in metres as the options want it.
    ///
    /// # Errors
    /// Options that cannot be, nodata that leaves no known cell, or as [`Warp::apply`].
    pub(crate) fn into_metres(self, options: &Options) -> Result<Terrain, Error> {
        let terrain = self.terrain.with_own_doubts(options)?;
        let terrain = if self.is_of_bytes { terrain.with_doubt_of_bytes() } else { terrain };
        Unwarped { terrain, ..self }.warped()?.with_asked_filling(options)
    }
}
