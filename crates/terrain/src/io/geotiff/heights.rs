//! From samples to heights in metres: scale, offset and unit.

use super::metadata::BandMetadata;
use crate::{
    Error,
    crs::{Crs, LinearUnit},
};

/// What turns a sample into a height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Heights {
    scale: f64,
    offset: f64,
    unit_m: f64,
}

impl Heights {
    /// By the band's metadata and, where that has no unit, the vertical part of the system. Doubts are added to the notes.
    ///
    /// # Errors
    /// A system that counts depths.
    pub(super) fn of(band: &BandMetadata, crs: &Crs, notes: &mut Vec<String>) -> Result<Self, Error> {
        if crs.vertical.is_some_and(|vertical| vertical.is_depth) {
            return Err(Error::TiffValue {
                tag: "vertical system (VerticalGeoKey)",
                value: "one of depths".into(),
                expected: "one of heights; `gdal_calc.py -A in.tif --calc=-A --outfile=out.tif` turns depths over",
            });
        }
        let of_system = crs.vertical.map(|vertical| vertical.unit);
        match (band.unit, of_system, crs.unit) {
            (Some(band), Some(system), _) if !band.is(&system) => notes.push(format!(
                "the band's unit is {}, but that of its vertical system is {}: the band was followed",
                band.name, system.name
            )),
            (None, None, Some(unit)) if !unit.is_metre() => notes.push(format!(
                "the file does not say the unit of its heights, and its coordinates are in {}s: heights were read as metres; \
                 `gdal_edit.py -units \"{}\" FILE` says that they are not",
                unit.name, unit.name
            )),
            _ => {}
        }
        let unit = band.unit.or(of_system).unwrap_or(LinearUnit::METRE);
        Ok(Heights {
            scale: band.scale.unwrap_or(1.0),
            offset: band.offset.unwrap_or(0.0),
            unit_m: unit.metres,
        })
    }

    /// Height of a sample [m].
    pub(super) fn height_m(&self, sample: f64) -> f64 {
        (sample * self.scale + self.offset) * self.unit_m
    }
}
