//! Ground as a file's own cells have it, before it is brought to metres.

use super::Warp;
use crate::{Error, Terrain, io::Options};

/// Ground with the warp that it still needs, if it needs one. Marks of unknown ground and doubts are about the file's own cells: heights
/// between them would hide both.
pub(crate) struct Unwarped {
    pub(crate) terrain: Terrain,
    pub(crate) warp: Option<Warp>,
}

impl Unwarped {
    /// The ground in metres.
    ///
    /// # Errors
    /// As [`Warp::apply`].
    pub(crate) fn warped(self) -> Result<Terrain, Error> {
        match self.warp {
            Some(warp) => warp.apply(&self.terrain),
            None => Ok(self.terrain),
        }
    }

    /// The ground in metres as the options want it.
    ///
    /// # Errors
    /// Options that cannot be, nodata that leaves no known cell, or as [`Warp::apply`].
    pub(crate) fn into_metres(self, options: &Options) -> Result<Terrain, Error> {
        let terrain = self.terrain.with_own_doubts(options)?;
        Unwarped { terrain, warp: self.warp }.warped()?.with_asked_filling(options)
    }
}
