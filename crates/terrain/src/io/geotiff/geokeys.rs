//! The GeoKey directory (OGC GeoTIFF 1.1): which coordinate reference system the raster is in.

use tiff::tags::Tag;

use super::directory::Tags;
use crate::{
    Error, Warning, WarningKind,
    crs::{Crs, LinearUnit, Vertical, by_epsg_code, vertical},
};

pub(super) const MODEL_TYPE: u16 = 1024;
pub(super) const RASTER_TYPE: u16 = 1025;
pub(super) const CITATION: u16 = 1026;
pub(super) const GEODETIC_CRS: u16 = 2048;
const ANGULAR_UNITS: u16 = 2054;
pub(super) const SEMI_MAJOR_AXIS: u16 = 2057;
pub(super) const SEMI_MINOR_AXIS: u16 = 2058;
pub(super) const INVERSE_FLATTENING: u16 = 2059;
pub(super) const PROJECTED_CRS: u16 = 3072;
pub(super) const PROJECTED_CITATION: u16 = 3073;
pub(super) const LINEAR_UNITS: u16 = 3076;
const LINEAR_UNIT_SIZE: u16 = 3077;
const VERTICAL_CRS: u16 = 4096;
const VERTICAL_UNITS: u16 = 4099;

pub(super) const USER_DEFINED: u16 = 32767;
const USER_DEFINED_CODE: u32 = USER_DEFINED as u32;
/// What the citations of Esri begin with that hold a system in WKT.
pub(super) const ESRI_CITATION: &str = "ESRI PE String = ";
/// What a GeoTIFF says of its coordinate reference system.
pub(super) struct GeoKeys {
    /// Key and value of short keys; a double's or text's place otherwise.
    entries: Vec<[u16; 4]>,
    doubles: Vec<f64>,
    text: String,
}

impl GeoKeys {
    /// Reads the directory; a file without one has no keys.
    pub(super) fn read(tags: &mut Tags<'_, '_>) -> Result<Self, Error> {
        let directory = tags.unsigned_list(Tag::GeoKeyDirectoryTag)?;
        let directory: Vec<u16> = directory.iter().map(|&value| u16::try_from(value).unwrap_or(0)).collect();
        Ok(GeoKeys {
            entries: directory.get(4..).unwrap_or_default().as_chunks().0.to_vec(),
            doubles: tags.doubles(Tag::GeoDoubleParamsTag)?.unwrap_or_default(),
            text: tags.text(Tag::GeoAsciiParamsTag)?.unwrap_or_default(),
        })
    }

    /// The value of a key that is there and not zero, which stands for undefined.
    pub(super) fn code(&self, key: u16) -> Option<u32> {
        let entry = self.entries.iter().find(|entry| entry[0] == key && entry[1] == 0)?;
        Some(u32::from(entry[3])).filter(|value| *value != 0)
    }

    pub(super) fn double(&self, key: u16) -> Option<f64> {
        let entry = self.entries.iter().find(|entry| entry[0] == key && entry[1] == 34736)?;
        self.doubles.get(usize::from(entry[3])).copied().filter(|value| value.is_finite())
    }

    pub(super) fn citation(&self, key: u16) -> Option<&str> {
        let entry = self.entries.iter().find(|entry| entry[0] == key && entry[1] == 34737)?;
        let start = usize::from(entry[3]);
        let end = self.text.len().min(start + usize::from(entry[2]));
        Some(self.text.get(start..end)?.trim_end_matches(['|', '\0', ' ']))
    }

    /// Whether samples belong to points at the corners of the frame's cells, not to cells.
    pub(super) fn pixel_is_point(&self) -> bool {
        self.code(RASTER_TYPE) == Some(2)
    }

    /// Whether anything says what the coordinates are.
    pub(super) fn name_a_system(&self) -> bool {
        [MODEL_TYPE, GEODETIC_CRS, PROJECTED_CRS, LINEAR_UNITS].iter().any(|key| self.code(*key).is_some())
    }

    /// The system, with its unit as the file says or as its code implies. Doubts are added to the warnings.
    ///
    /// # Errors
    /// A unit or kind of system that cannot be read, by name.
    pub(super) fn crs(&self, warnings: &mut Vec<Warning>) -> Result<Crs, Error> {
        const PROJECTED: u32 = 1;
        const GEOGRAPHIC: u32 = 2;
        const GEOCENTRIC: u32 = 3;
        let projected = self.code(PROJECTED_CRS);
        let kind = self.code(MODEL_TYPE);
        if kind == Some(GEOCENTRIC) {
            let value = "3, geocentric".to_owned();
            return Err(Error::TiffValue {
                tag: "model type (GTModelTypeGeoKey)",
                value,
                expected: "1, projected",
            });
        }
        let geodetic = self.code(GEODETIC_CRS).filter(|code| *code != USER_DEFINED_CODE);
        if kind == Some(GEOGRAPHIC) || (kind != Some(PROJECTED) && projected.is_none() && geodetic.is_some())
        {
            self.refuse_other_angles()?;
            let text = geodetic.map(|code| format!("EPSG:{code}"));
            return Ok(Crs { text, is_geographic: true, vertical: self.vertical()?, ..Crs::default() });
        }
        let mut crs = match projected.filter(|code| *code != USER_DEFINED_CODE) {
            Some(code) => Crs::from_epsg(code),
            None => self.own_system(),
        };
        let own_unit = self.linear_unit()?;
        let name = crs.text.as_deref().unwrap_or_default();
        let doubt = match (own_unit, crs.unit) {
            (Some(own), Some(implied)) if !own.is(&implied) => Some(format!(
                "the file's unit is {}, but that of {name} is {}: the file was followed",
                own.name, implied.name
            )),
            (None, None) if projected.is_some() && crs.text.is_some() => {
                Some(format!("the unit of {name} is not known here: coordinates were read as metres"))
            }
            _ => None,
        };
        warnings.extend(doubt.map(|detail| Warning::new(WarningKind::AssumedUnit, detail)));
        crs.unit = own_unit.or(crs.unit);
        crs.vertical = self.vertical()?.or(crs.vertical);
        Ok(crs)
    }

    /// Refuses longitudes and latitudes that are counted in another unit than the degree.
    fn refuse_other_angles(&self) -> Result<(), Error> {
        /// EPSG's codes of the degree: its own and the one that leaves the notation open.
        const DEGREES: [u32; 2] = [9102, 9122];
        match self.code(ANGULAR_UNITS).filter(|code| !DEGREES.contains(code)) {
            None => Ok(()),
            Some(code) => Err(Error::TiffValue {
                tag: "angular unit (GeogAngularUnitsGeoKey)",
                value: code.to_string(),
                expected: "9102, degrees",
            }),
        }
    }

    pub(super) fn linear_unit(&self) -> Result<Option<LinearUnit>, Error> {
        const TAG: &str = "linear unit (ProjLinearUnitsGeoKey)";
        let size = self.double(LINEAR_UNIT_SIZE);
        if let Some(size) = size.filter(|size| *size <= 0.0) {
            let tag = "linear unit size (ProjLinearUnitSizeGeoKey)";
            return Err(Error::TiffValue { tag, value: size.to_string(), expected: "metres above zero" });
        }
        match self.code(LINEAR_UNITS) {
            None | Some(USER_DEFINED_CODE) => Ok(size.map(LinearUnit::of_metres)),
            Some(code) => by_epsg_code(code).map(Some).ok_or(Error::TiffValue {
                tag: TAG,
                value: code.to_string(),
                expected: "EPSG's code of a unit of length, as 9001 for metres",
            }),
        }
    }

    fn vertical(&self) -> Result<Option<Vertical>, Error> {
        let of_code = self.code(VERTICAL_CRS).filter(|code| *code != USER_DEFINED_CODE).and_then(vertical);
        let unit = match self.code(VERTICAL_UNITS) {
            None | Some(USER_DEFINED_CODE) => return Ok(of_code),
            Some(code) => by_epsg_code(code).ok_or(Error::TiffValue {
                tag: "vertical unit (VerticalUnitsGeoKey)",
                value: code.to_string(),
                expected: "EPSG's code of a unit of length, as 9001 for metres",
            })?,
        };
        Ok(Some(Vertical { unit, is_depth: of_code.is_some_and(|vertical| vertical.is_depth) }))
    }
}
