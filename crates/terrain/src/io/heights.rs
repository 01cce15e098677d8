//! From samples to heights in metres: scale, offset and unit, the same for every format that says them.

use crate::{
    Error, Warning, WarningKind,
    crs::{Crs, LinearUnit},
    fill_value::is_never_ground,
};

/// Scale, offset and unit of a band.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct BandMetadata {
    pub(super) scale: Option<f64>,
    pub(super) offset: Option<f64>,
    /// Unit of what scale and offset give.
    pub(super) unit: Option<LinearUnit>,
}

/// What turns a sample into a height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Heights {
    scale: f64,
    offset: f64,
    unit_m: f64,
    /// Whether samples are heights in metres as they stand.
    is_height: bool,
}

impl Heights {
    /// Samples that are heights in metres as they stand.
    pub(super) const METRES: Heights = Heights { scale: 1.0, offset: 0.0, unit_m: 1.0, is_height: true };

    /// By the band's metadata and, where that has no unit, the vertical part of the system. Doubts are added to the warnings;
    /// `ending` is that of the file's name.
    ///
    /// # Errors
    /// A system that counts depths.
    pub(super) fn of(
        band: &BandMetadata,
        crs: &Crs,
        ending: &'static str,
        warnings: &mut Vec<Warning>,
    ) -> Result<Self, Error> {
        if crs.vertical.is_some_and(|vertical| vertical.is_depth) {
            return Err(Error::Depths { ending });
        }
        let of_system = crs.vertical.map(|vertical| vertical.unit);
        let doubt = match (band.unit, of_system, crs.unit) {
            (Some(band), Some(system), _) if !band.is(&system) => Some(format!(
                "the band's unit is {}, but that of its vertical system is {}: the band was followed",
                band.name, system.name
            )),
            (None, None, Some(unit)) if !unit.is_metre() => Some(format!(
                "the file does not say the unit of its heights, and its coordinates are in {0}: heights were read as metres; \
                 {1}`gdal_edit.py -units \"{0}\" {2}` says that they are not",
                unit.name,
                if ending == "tif" { "" } else { "after `gdal_translate` to a GeoTIFF, " },
                if ending == "tif" { "FILE" } else { "out.tif" },
            )),
            _ => None,
        };
        warnings.extend(doubt.map(|detail| Warning::new(WarningKind::AssumedHeightUnit, detail)));
        let unit = band.unit.or(of_system).unwrap_or(LinearUnit::METRE);
        let (scale, offset) = (band.scale.unwrap_or(1.0), band.offset.unwrap_or(0.0));
        let is_height = scale == 1.0 && offset == 0.0 && unit.metres == 1.0;
        Ok(Heights { scale, offset, unit_m: unit.metres, is_height })
    }

    /// Whether samples are heights in metres as they stand.
    pub(super) fn is_height(&self) -> bool {
        self.is_height
    }

    /// Height of a sample [m]. Fill values that nothing marks stay as they are, unless a scale makes heights of all numbers.
    pub(super) fn height_m(&self, sample: f64) -> f64 {
        if self.is_height {
            return sample;
        }
        let is_scaled = self.scale != 1.0 || self.offset != 0.0;
        if !is_scaled && is_never_ground(sample) {
            return sample;
        }
        (sample * self.scale + self.offset) * self.unit_m
    }
}
