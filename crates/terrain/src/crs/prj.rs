//! The older `.prj` of ArcInfo, a word and a value a line.

use super::{Crs, by_epsg_code, by_name, geographic, mercator};

/// The `.prj` of ArcInfo: `Projection UTM`, `Zone 15`, `Datum WGS84`, `Units METERS`, a word and a value a line.
pub(super) fn parse_words(text: &str) -> Option<Crs> {
    let value = |key: &str| {
        text.lines().find_map(|line| {
            let (word, value) = line.trim().split_once(char::is_whitespace)?;
            word.eq_ignore_ascii_case(key).then(|| value.trim().to_uppercase())
        })
    };
    let projection = value("Projection")?;
    let unit = value("Units").and_then(|name| by_name(&name));
    if projection == "GEOGRAPHIC" {
        let counts_degrees = value("Units").is_some_and(|unit| matches!(unit.as_str(), "DD" | "DEGREES"));
        let code = value("Datum").filter(|_| counts_degrees).and_then(|name| geographic::code_by_name(&name));
        let text = code.map(|code| format!("EPSG:{code}"));
        return Some(Crs { text, is_geographic: true, ..Crs::default() });
    }
    let mut crs = Crs { unit, ..Crs::default() };
    if projection == "MERCATOR" {
        crs.mercator = Some(mercator::WORLD);
    }
    let zone =
        value("Zone").and_then(|zone| zone.parse::<i32>().ok()).filter(|zone| (1..=60).contains(&zone.abs()));
    let wgs84 = value("Datum").is_some_and(|datum| matches!(datum.as_str(), "WGS84" | "WGS_1984"));
    if let (true, true, Some(zone)) = (projection == "UTM", wgs84, zone) {
        let code = if zone > 0 { 32_600 } else { 32_700 } + zone.unsigned_abs();
        crs.text = Some(format!("EPSG:{code}"));
        crs.unit = crs.unit.or(by_epsg_code(9001));
    }
    Some(crs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::LinearUnit;

    #[test]
    fn the_older_form_of_arcinfo_is_read_by_line() {
        let crs = parse_words("Projection    UTM\nZone 15\nDatum WGS84\nUnits METERS\nParameters\n").unwrap();
        assert_eq!(crs.text.as_deref(), Some("EPSG:32615"));
        assert!(parse_words("Projection GEOGRAPHIC\nUnits DD\n").unwrap().is_geographic);
        assert_eq!(parse_words("Projection STATEPLANE\nUnits FEET\n").unwrap().unit, Some(LinearUnit::FOOT));
    }
}
