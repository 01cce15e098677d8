//! The text of a registered system whose coordinates were multiplied to be metres of the ground.
//!
//! ```text
//! PROJCS["EPSG:3413 times 0.96",GEOGCS[..],PROJECTION["custom_proj4"],UNIT["metre",1],EXTENSION["PROJ4","+proj=stere .. +to_meter=.."]]
//! ```
//!
//! PROJ and GDAL read it by its extension, this program by its name.

use super::{LinearUnit, epsg, projection::Projection};

const BEGINNING: &str = "PROJCS[\"EPSG:";
const TIMES: &str = " times ";

/// The text of a system with its metres multiplied; `None` for one without a code of the EPSG registry.
pub(super) fn text(crs: &str, by: f64) -> Option<String> {
    let code: u32 = crs.strip_prefix("EPSG:")?.split('+').next()?.parse().ok()?;
    let definition = epsg::definition(code)?;
    let is_unit =
        |word: &str| word.starts_with("+units=") || word.starts_with("+to_meter=") || word == "+no_defs";
    let words: Vec<&str> = definition.split_ascii_whitespace().filter(|word| !is_unit(word)).collect();
    Some(format!(
        "{BEGINNING}{code}{TIMES}{by}\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",6378137,298.257223563]],\
         PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"custom_proj4\"],UNIT[\"metre\",1],\
         EXTENSION[\"PROJ4\",\"{} +to_meter={} +no_defs\"]]",
        words.join(" "),
        1.0 / by
    ))
}

/// Code and multiplier of such a text.
pub(super) fn read(text: &str) -> Option<(u32, f64)> {
    let (name, _) = text.strip_prefix(BEGINNING)?.split_once('"')?;
    let (code, by) = name.split_once(TIMES)?;
    let by: f64 = by.parse().ok().filter(|by: &f64| by.is_finite() && *by > 0.0)?;
    Some((code.parse().ok()?, by))
}

/// The projection of such a text.
pub(super) fn projection(text: &str) -> Option<Projection> {
    let (code, multiplied_by) = read(text)?;
    Some(Projection { definition: epsg::definition(code)?, multiplied_by })
}

/// Length in the map's metres of the unit of the registered system that such a text comes from.
pub(super) fn unit(code: u32, by: f64) -> Option<LinearUnit> {
    let unit = epsg::horizontal(code).unit?;
    Some(LinearUnit { metres: unit.metres * by, ..unit })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::{Crs, Earth};

    #[test]
    fn a_multiplied_system_has_the_places_of_the_registered_one() {
        let scale = 0.962_067;
        for (code, place_m) in [(3413, [1000.0, -3_323_160.27]), (2263, [300_000.0, 60_000.0])] {
            let registered = format!("EPSG:{code}");
            let text = text(&registered, scale).unwrap();
            let crs = Crs::parse(&text).unwrap();
            assert_eq!((crs.text.as_deref(), crs.unit), (Some(text.as_str()), Some(LinearUnit::METRE)));
            let wanted = Earth::of(&registered).unwrap().place_deg(place_m).unwrap();
            let found = Earth::of(&text).unwrap().place_deg(place_m.map(|at| at * scale)).unwrap();
            assert!(
                (wanted[0] - found[0]).abs() < 1e-10 && (wanted[1] - found[1]).abs() < 1e-10,
                "{found:?}"
            );
        }
        assert_eq!(text("PROJCS[\"x\"]", scale), None);
        assert_eq!(read("PROJCS[\"EPSG:3413 times -1\",GEOGCS[]]"), None);
    }
}
