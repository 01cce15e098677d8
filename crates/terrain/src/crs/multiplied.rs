//! The text of a system whose coordinates were multiplied to be metres of the ground.
//!
//! ```text
//! PROJCS["EPSG:3413 times 0.96",GEOGCS[..],PROJECTION["custom_proj4"],UNIT["metre",1],EXTENSION["PROJ4","+proj=stere .. +to_meter=.."]]
//! LOCAL_CS["EPSG:3857 times 0.6702 and 0.6688",UNIT["metre",1],EXTENSION["PROJ4","+proj=merc .."]]
//! ```
//!
//! PROJ and GDAL read the first form by its extension, this program both by name and extension. The second has a multiplier for each
//! axis, which no projected system has: for other programs it is a frame of its own in metres.

use super::{Crs, LinearUnit, epsg, projection::Projection};

const BEGINNINGS: [&str; 2] = ["PROJCS[\"", "LOCAL_CS[\""];
const TIMES: &str = " times ";
const AND: &str = " and ";
/// Stands where a registered system has its code.
const OWN: &str = "projection";
const EXTENSION: &str = ",EXTENSION[\"PROJ4\",\"";

/// Such a text as it was read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Multiplied {
    /// Code of the registered system that was multiplied, if it has one.
    pub(super) code: Option<u32>,
    /// Its definition.
    definition: String,
    /// Metres of the map by metres of the projection, along x and y.
    pub(super) by: [f64; 2],
}

/// The text of a system with its metres multiplied along x and y; `None` for one whose projection is not known.
pub(super) fn text(crs: &Crs, by: [f64; 2]) -> Option<String> {
    let code = crs.text.as_deref().and_then(code_of);
    let definition = match code {
        Some(code) => epsg::any_definition(code)?,
        None => crs.any_projection()?.definition,
    };
    let name = code.map_or_else(|| OWN.to_owned(), |code| format!("EPSG:{code}"));
    let words: Vec<&str> = definition.split_ascii_whitespace().filter(|word| !is_of_unit(word)).collect();
    let words = words.join(" ");
    let [x, y] = by;
    Some(if x == y {
        format!(
            "PROJCS[\"{name}{TIMES}{x}\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
             PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"custom_proj4\"],UNIT[\"metre\",1]\
             {EXTENSION}{words} +to_meter={} +no_defs\"]]",
            1.0 / x
        )
    } else {
        format!("LOCAL_CS[\"{name}{TIMES}{x}{AND}{y}\",UNIT[\"metre\",1]{EXTENSION}{words} +no_defs\"]]")
    })
}

/// Reads such a text.
pub(super) fn read(text: &str) -> Option<Multiplied> {
    let rest = BEGINNINGS.iter().find_map(|beginning| text.strip_prefix(beginning))?;
    let (name, rest) = rest.split_once('"')?;
    let (system, by) = name.split_once(TIMES)?;
    let (x, y) = by.split_once(AND).unwrap_or((by, by));
    let multiplier = |text: &str| text.parse().ok().filter(|by: &f64| by.is_finite() && *by > 0.0);
    let by = [multiplier(x)?, multiplier(y)?];
    if let Some(code) = system.strip_prefix("EPSG:") {
        let code = code.parse().ok()?;
        return Some(Multiplied { code: Some(code), definition: epsg::any_definition(code)?, by });
    }
    let (_, words) = rest.split_once(EXTENSION).filter(|_| system == OWN)?;
    let (words, _) = words.split_once('"')?;
    let words: Vec<&str> = words.split_ascii_whitespace().filter(|word| !is_of_unit(word)).collect();
    Some(Multiplied { code: None, definition: words.join(" "), by })
}

impl Multiplied {
    /// The projection, whose coordinates are multiplied.
    pub(super) fn projection(self) -> Projection {
        Projection { definition: self.definition, multiplied_by: self.by }
    }
}

/// Length in the map's metres of the unit of a registered system, along x and y, after its metres were multiplied.
pub(super) fn units_m(code: u32, by: [f64; 2]) -> Option<[f64; 2]> {
    let LinearUnit { metres, .. } = epsg::horizontal(code).unit?;
    Some(by.map(|by| by * metres))
}

/// The code of a text that is one of the definitions.
fn code_of(text: &str) -> Option<u32> {
    let code = text.strip_prefix("EPSG:")?.split('+').next()?.parse().ok().map(epsg::registered)?;
    epsg::any_definition(code).map(|_| code)
}

fn is_of_unit(word: &str) -> bool {
    word.starts_with("+units=") || word.starts_with("+to_meter=") || word == "+no_defs"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Earth;

    #[test]
    fn a_multiplied_system_has_the_places_of_the_registered_one() {
        for (code, place_m) in [
            (3413, [1000.0, -3_323_160.27]),
            (2263, [300_000.0, 60_000.0]),
            (3857, [1_113_194.9, 6_106_854.8]),
            (3395, [1_113_194.9, 6_075_000.0]),
            (4087, [1_113_194.9, 5_343_335.6]),
        ] {
            for by in [[0.962_067; 2], [0.67, 0.668]] {
                let registered = Crs::from_epsg(code);
                let text = text(&registered, by).unwrap();
                let crs = Crs::parse(&text).unwrap();
                assert_eq!((crs.text.as_deref(), crs.unit), (Some(text.as_str()), Some(LinearUnit::METRE)));
                let wanted = Earth::of(&format!("EPSG:{code}")).unwrap().place_deg(place_m).unwrap();
                let multiplied_m = [place_m[0] * by[0], place_m[1] * by[1]];
                let found = Earth::of(&text).unwrap().place_deg(multiplied_m).unwrap();
                assert!(
                    (wanted[0] - found[0]).abs() < 1e-10 && (wanted[1] - found[1]).abs() < 1e-10,
                    "EPSG:{code}: {found:?}"
                );
            }
        }
        assert_eq!(text(&Crs::parse("PROJCS[\"x\",GEOGCS[\"g\"]]").unwrap(), [1.0; 2]), None);
        assert_eq!(read("PROJCS[\"EPSG:3413 times -1\",GEOGCS[]]"), None);
    }

    #[test]
    fn a_system_without_a_code_keeps_its_place_by_its_definition() {
        let own = Crs::parse(
            "PROJCS[\"x\",GEOGCS[\"g\",DATUM[\"WGS_1984\",SPHEROID[\"w\",6378137,298.257223563]]],PROJECTION[\"Mercator_1SP\"],\
             PARAMETER[\"central_meridian\",9],UNIT[\"metre\",1]]",
        )
        .unwrap();
        // By pyproj: 10° east, 48° north of +proj=merc +lon_0=9.
        let place_m = [111_319.490_793, 6_075_085.090_058];
        for by in [[0.67; 2], [0.67, 0.668]] {
            let text = text(&own, by).unwrap();
            let place_deg = Earth::of(&text).unwrap().place_deg([place_m[0] * by[0], place_m[1] * by[1]]);
            let [lon_deg, lat_deg] = place_deg.unwrap();
            assert!((lon_deg - 10.0).abs() < 1e-8 && (lat_deg - 48.0).abs() < 1e-8, "{lon_deg} {lat_deg}");
        }
    }
}
