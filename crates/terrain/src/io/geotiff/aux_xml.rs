//! GDAL's own metadata beside a raster (`.aux.xml`, its "persistent auxiliary metadata"): what it holds stands above the raster's own tags.

use quick_xml::{
    Reader, XmlVersion,
    escape::resolve_predefined_entity,
    events::{BytesStart, Event},
};

use super::metadata::Item;
use crate::{Error, crs::Crs, io::heights::BandMetadata, resample::Affine};

/// Deepest nesting that is followed; what is looked for lies three deep.
const DEEPEST: usize = 64;

/// What the metadata say of a raster and its first band.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct AuxXml {
    /// The system.
    pub(super) crs: Option<Crs>,
    /// The placement.
    pub(super) affine: Option<Affine>,
    /// The mark of unknown cells, as it is spelt.
    pub(super) nodata: Option<String>,
    /// Scale, offset and unit of the band, as they are spelt.
    items: Vec<Item>,
}

impl AuxXml {
    /// Reads what can be used, and says what of it cannot.
    pub(super) fn parse(text: &str) -> (Self, Option<String>) {
        let mut found = AuxXml::default();
        let mut unused = Vec::new();
        let is_whole = leaves(text, |path, value| match path {
            ["PAMDataset", "SRS"] => match Crs::parse(value) {
                Some(crs) => found.crs = Some(crs),
                None => unused.push("its SRS names no system that is known here"),
            },
            ["PAMDataset", "GeoTransform"] => match geo_transform(value) {
                Some(affine) => found.affine = Some(affine),
                None => unused.push("its GeoTransform is no six numbers"),
            },
            ["PAMDataset", "GCPList", ..] => {
                unused.push("ground control points are not used: `gdalwarp` lays the map out by them");
            }
            ["PAMDataset", "PAMRasterBand", "NoDataValue"] => found.nodata = Some(value.to_owned()),
            ["PAMDataset", "PAMRasterBand", role @ ("Scale" | "Offset" | "UnitType")] => {
                found.items.push(Item { role: role.to_lowercase(), text: value.to_owned() });
            }
            _ => {}
        });
        if !is_whole {
            unused.push("it is broken off");
        }
        unused.dedup();
        (found, (!unused.is_empty()).then(|| unused.join("; ")))
    }

    /// Scale, offset and unit of the band, where the file's own tags have others or none.
    ///
    /// # Errors
    /// A unit or number that means nothing here, by name.
    pub(super) fn over(&self, own: BandMetadata) -> Result<BandMetadata, Error> {
        own.with(self.items.iter(), ".aux.xml")
    }
}

/// The placement as GDAL writes it: x, width, turn, y, turn, height.
fn geo_transform(text: &str) -> Option<Affine> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|word| word.trim().parse().ok()).collect();
    let numbers = numbers.filter(|numbers| numbers.iter().all(|number| number.is_finite()))?;
    let &[x, width, turn_x, y, turn_y, height] = numbers.as_slice() else { return None };
    let affine = Affine { origin: [x, y], column: [width, turn_y], row: [turn_x, height] };
    (affine.area() != 0.0).then_some(affine)
}

/// Hands out every element without elements, by the names that lead to it and with its text. Bands but the first are left out.
/// Returns whether the document is whole.
fn leaves(text: &str, mut leaf: impl FnMut(&[&str], &str)) -> bool {
    let mut reader = Reader::from_str(text);
    let mut path: Vec<(String, bool)> = Vec::new();
    let mut value = String::new();
    loop {
        match reader.read_event() {
            Ok(Event::Start(element)) => {
                if path.len() == DEEPEST {
                    return false;
                }
                let name = String::from_utf8_lossy(element.name().as_ref()).into_owned();
                path.push((name, is_other_band(&element)));
                value.clear();
            }
            Ok(Event::Text(piece)) => value.push_str(&piece.decode().unwrap_or_default()),
            Ok(Event::GeneralRef(reference)) => match reference.resolve_char_ref() {
                Ok(Some(character)) => value.push(character),
                _ => {
                    let name = reference.decode().unwrap_or_default();
                    value.push_str(resolve_predefined_entity(&name).unwrap_or_default());
                }
            },
            Ok(Event::End(_)) => {
                let is_of_other = path.iter().any(|(_, is_other)| *is_other);
                if !is_of_other && !value.trim().is_empty() {
                    let names: Vec<&str> = path.iter().map(|(name, _)| name.as_str()).collect();
                    leaf(&names, value.trim());
                }
                path.pop();
                value.clear();
            }
            Ok(Event::Eof) => return path.is_empty(),
            Err(_) => return false,
            Ok(_) => {}
        }
    }
}

fn is_other_band(element: &BytesStart<'_>) -> bool {
    let band = element.try_get_attribute("band").ok().flatten();
    let band = band.and_then(|band| Some(band.normalized_value(XmlVersion::Implicit1_0).ok()?.into_owned()));
    element.name().as_ref() == b"PAMRasterBand" && band.is_some_and(|band| band.trim() != "1")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_gdal_writes_is_read_and_other_bands_are_not() {
        let (found, unused) = AuxXml::parse(
            "<PAMDataset><SRS dataAxisToSRSAxisMapping=\"1,2\">PROJCS[&quot;WGS 84 / UTM zone 32N&quot;,GEOGCS[&quot;WGS 84&quot;],\
             UNIT[&quot;metre&quot;,1],AUTHORITY[&quot;EPSG&quot;,&quot;32632&quot;]]</SRS>\
             <GeoTransform>  1.0e+03,  2, 0, 2000, 0, -2</GeoTransform>\
             <PAMRasterBand band=\"1\"><NoDataValue le_hex_equiv=\"0\">-9999</NoDataValue><Scale>0.1</Scale>\
             <UnitType>ft</UnitType><Metadata><MDI key=\"STATISTICS_MEAN\">7</MDI></Metadata></PAMRasterBand>\
             <PAMRasterBand band=\"2\"><NoDataValue>5</NoDataValue></PAMRasterBand></PAMDataset>",
        );
        assert_eq!(unused, None);
        assert_eq!(found.crs.unwrap().text.as_deref(), Some("EPSG:32632"));
        let affine = Affine { origin: [1000.0, 2000.0], column: [2.0, 0.0], row: [0.0, -2.0] };
        assert_eq!((found.affine, found.nodata.as_deref()), (Some(affine), Some("-9999")));
        let roles: Vec<&str> = found.items.iter().map(|item| item.role.as_str()).collect();
        assert_eq!(roles, ["scale", "unittype"]);
    }

    #[test]
    fn what_cannot_be_used_is_said() {
        let unused = |text: &str| AuxXml::parse(text).1.unwrap_or_default();
        assert!(unused("<PAMDataset><SRS>somewhere</SRS></PAMDataset>").contains("SRS"));
        assert!(unused("<PAMDataset><GeoTransform>1,2</GeoTransform></PAMDataset>").contains("GeoTransform"));
        assert!(unused("<PAMDataset><PAMRasterBand band=\"1\">").contains("broken off"));
        assert_eq!(unused("<PAMDataset></PAMDataset>"), "");
    }
}
