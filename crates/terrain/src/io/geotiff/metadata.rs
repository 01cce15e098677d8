//! What GDAL writes beside the samples: scale, offset and unit of a band (GDAL_METADATA), and the mark of unknown cells (GDAL_NODATA).

use quick_xml::{Reader, XmlVersion, events::Event};
use tiff::tags::Tag;

use super::{directory::Tags, sample::SampleType};
use crate::{Error, crs::by_name, io::heights::BandMetadata};

impl BandMetadata {
    const GDAL_METADATA: u16 = 42112;

    /// Reads what a file says of a band.
    ///
    /// # Errors
    /// A unit or number that means nothing here, by name.
    pub(super) fn read(tags: &mut Tags<'_, '_>, band: usize) -> Result<Self, Error> {
        let text = tags.text(Tag::from_u16_exhaustive(Self::GDAL_METADATA))?;
        text.map_or(Ok(BandMetadata::default()), |text| Self::parse(&text, band))
    }

    fn parse(text: &str, band: usize) -> Result<Self, Error> {
        BandMetadata::default().with(items(text, band).iter(), "GDAL_METADATA")
    }

    /// The same with items in the place of what they say anew; `source` is where they stand.
    ///
    /// # Errors
    /// A unit or number that means nothing here, by name.
    pub(super) fn with<'a>(
        self,
        items: impl Iterator<Item = &'a Item>,
        source: &'static str,
    ) -> Result<Self, Error> {
        let mut metadata = self;
        let is_beside = source != "GDAL_METADATA";
        for Item { role, text } in items {
            let number = |tag| {
                let value = text.trim().parse::<f64>().ok().filter(|value| value.is_finite());
                let refused = Error::TiffValue { tag, value: excerpt(text), expected: "a number" };
                value.map_or(Err(refused), |value| Ok(Some(value)))
            };
            match role.as_str() {
                "scale" if is_beside => metadata.scale = number("scale (.aux.xml)")?,
                "scale" => metadata.scale = number("scale (GDAL_METADATA)")?,
                "offset" if is_beside => metadata.offset = number("offset (.aux.xml)")?,
                "offset" => metadata.offset = number("offset (GDAL_METADATA)")?,
                "unittype" if !text.trim().is_empty() => {
                    let unit = by_name(text);
                    metadata.unit = Some(unit.ok_or(Error::TiffValue {
                        tag: if is_beside { "band unit (.aux.xml)" } else { "band unit (GDAL_METADATA)" },
                        value: excerpt(text),
                        expected: "a unit of length, as metre, foot or US survey foot; `gdal_edit.py -units metre FILE` sets it",
                    })?);
                }
                _ => {}
            }
        }
        if metadata.scale == Some(0.0) {
            let tag = if is_beside { "scale (.aux.xml)" } else { "scale (GDAL_METADATA)" };
            return Err(Error::TiffValue {
                tag,
                value: "0".to_owned(),
                expected: "a number other than zero",
            });
        }
        Ok(metadata)
    }
}

/// Something that metadata say of a band, by its role.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Item {
    pub(super) role: String,
    pub(super) text: String,
}

/// The items of a band. XML that is broken off is read as far as it goes, as GDAL does.
fn items(text: &str, band: usize) -> Vec<Item> {
    let mut reader = Reader::from_str(text);
    let mut items = Vec::new();
    let mut current: Option<Item> = None;
    loop {
        match reader.read_event() {
            Ok(Event::Start(element)) if element.name().as_ref() == b"Item" => {
                let attribute = |name: &str| {
                    let found = element.try_get_attribute(name).ok().flatten()?;
                    Some(found.normalized_value(XmlVersion::Implicit1_0).ok()?.trim().to_lowercase())
                };
                // An item without a band is one of the file.
                let of_band = attribute("sample").and_then(|sample| sample.parse().ok()) == Some(band);
                let role = attribute("role").filter(|_| of_band);
                current = role.map(|role| Item { role, text: String::new() });
            }
            Ok(Event::Text(piece)) => {
                if let (Some(item), Ok(piece)) = (&mut current, piece.decode()) {
                    item.text.push_str(&piece);
                }
            }
            Ok(Event::End(_)) => items.extend(current.take()),
            Ok(Event::Eof) | Err(_) => return items,
            Ok(_) => {}
        }
    }
}

fn excerpt(text: &str) -> String {
    text.trim().chars().take(40).collect()
}

/// The mark of unknown cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct NoData {
    /// The mark; NaN marks nothing beyond what is NaN.
    pub(super) mark: f64,
    /// Largest difference from the mark that is the mark still.
    tolerance: f64,
}

impl NoData {
    /// Magnitude beyond which no number is an elevation, in feet and millimetres neither.
    const BEYOND_GROUND: f64 = 1e7;
    /// Digits that writers leave of a mark as −3.40282e+38, relative.
    const WRITTEN_DIGITS: f64 = 1e-5;

    /// Reads the mark of a file.
    ///
    /// # Errors
    /// Text that is no number.
    pub(super) fn read(tags: &mut Tags<'_, '_>, sample: SampleType) -> Result<Option<Self>, Error> {
        tags.text(Tag::GdalNodata)?.map_or(Ok(None), |text| Self::parse(&text, sample))
    }

    /// The mark by its spelling.
    ///
    /// # Errors
    /// Text that is no number.
    pub(super) fn parse(text: &str, sample: SampleType) -> Result<Option<Self>, Error> {
        let plain = text.trim().to_lowercase().replace(',', ".");
        let mark = match plain.as_str() {
            "" | "none" | "null" | "n/a" => return Ok(None),
            "1.#qnan" | "-1.#qnan" | "1.#ind" | "-1.#ind" | "-nan" | "1.#snan" | "-1.#snan" => f64::NAN,
            "1.#inf" => f64::INFINITY,
            "-1.#inf" => f64::NEG_INFINITY,
            other => other.parse().map_err(|_| Error::TiffValue {
                tag: "nodata value (GDAL_NODATA)",
                value: excerpt(text),
                expected: "a number; `gdal_edit.py -a_nodata -9999 FILE` sets it",
            })?,
        };
        // Samples hold the mark as their own type does.
        let mark = if sample == SampleType::F32 { f64::from(mark as f32) } else { mark };
        let digits = mark.is_finite() && mark.abs() > Self::BEYOND_GROUND && sample.is_float();
        Ok(Some(NoData { mark, tolerance: if digits { mark.abs() * Self::WRITTEN_DIGITS } else { 0.0 } }))
    }

    /// Whether a sample is the mark.
    pub(super) fn marks(&self, sample: f64) -> bool {
        sample == self.mark || (sample - self.mark).abs() <= self.tolerance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::LinearUnit;

    #[test]
    fn roles_of_the_band_are_read_and_those_of_others_are_not() {
        let text = "<GDALMetadata>\n  <Item name=\"SCALE\" sample=\"0\" role=\"scale\">0.1</Item>\n\
            <Item name=\"OFFSET\" sample='0' role=\"offset\">-100</Item><Item name=\"AREA\">x &amp; y</Item>\
            <Item name=\"UNITTYPE\" sample=\"0\" role=\"unittype\">US survey foot</Item>\
            <Item name=\"SCALE\" sample=\"1\" role=\"scale\">7</Item></GDALMetadata>";
        let first = BandMetadata::parse(text, 0).unwrap();
        assert_eq!((first.scale, first.offset), (Some(0.1), Some(-100.0)));
        assert_eq!(first.unit, Some(LinearUnit::US_SURVEY_FOOT));
        assert_eq!(BandMetadata::parse(text, 1).unwrap().scale, Some(7.0));
        assert_eq!(BandMetadata::parse("<GDALMeta", 0).unwrap(), BandMetadata::default());
    }

    #[test]
    fn what_cannot_be_honoured_is_refused_by_name() {
        let refused = |role: &str, value: &str| {
            let text =
                format!("<GDALMetadata><Item sample=\"0\" role=\"{role}\">{value}</Item></GDALMetadata>");
            BandMetadata::parse(&text, 0).unwrap_err().to_string()
        };
        assert!(refused("unittype", "furlong").contains("furlong"));
        assert!(refused("scale", "ten").contains("scale"));
        assert!(refused("scale", "0").contains("scale"));
    }

    #[test]
    fn nodata_has_many_spellings() {
        let marks = |text: &str, sample: f64| {
            NoData::parse(text, SampleType::F32).unwrap().is_some_and(|nodata| nodata.marks(sample))
        };
        for (text, sample) in [
            ("-9999", -9999.0),
            (" -9999.0\u{0}", -9999.0),
            ("-9999,0", -9999.0),
            ("-3.4028234663852886e+38", f64::from(f32::MIN)),
            ("-3.40282e+38", f64::from(f32::MIN)),
            ("-1.#INF", f64::NEG_INFINITY),
            ("0.1", f64::from(0.1f32)),
        ] {
            assert!(marks(text.trim_matches('\0'), sample), "{text}");
        }
        assert!(!marks("-9999", -9998.999), "only the mark is the mark");
        assert!(!marks("nan", 0.0) && !marks("none", 0.0));
        assert!(NoData::parse("unknown", SampleType::F32).unwrap_err().to_string().contains("unknown"));
    }
}
