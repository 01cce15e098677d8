//! The older `.prj` of ArcInfo, a word and a value a line.

use super::{Crs, LinearUnit, Projection, Vertical, by_name, geographic, mercator};

/// The `.prj` of ArcInfo: `Projection UTM`, `Zone 15`, `Datum WGS84`, `Units METERS`, a word and a value a line. `None` without a
/// projection, and with shifts of the coordinates that are not those of a southern zone.
pub(super) fn parse_words(text: &str) -> Option<Crs> {
    let value = |key: &str| {
        text.lines().find_map(|line| {
            let (word, value) = line.trim().split_once(char::is_whitespace)?;
            word.eq_ignore_ascii_case(key).then(|| value.trim().to_uppercase())
        })
    };
    let projection = value("Projection")?;
    let vertical =
        value("Zunits").and_then(|name| unit(&name)).map(|unit| Vertical { unit, is_depth: false });
    if projection == "GEOGRAPHIC" {
        let counts_degrees = value("Units").is_some_and(|unit| matches!(unit.as_str(), "DD" | "DEGREES"));
        let code = value("Datum").filter(|_| counts_degrees).and_then(|name| geographic::code_by_name(&name));
        let text = code.map(|code| format!("EPSG:{code}"));
        return Some(Crs { text, is_geographic: true, vertical, ..Crs::default() });
    }
    let shift = |key| value(key).map_or(Some(0.0), |shift| shift.parse::<f64>().ok());
    let is_southern = match (shift("Xshift")?, shift("Yshift")?) {
        (0.0, 0.0) => false,
        (0.0, shift_m) if shift_m.abs() == SOUTHERN_SHIFT_M && projection == "UTM" => true,
        _ => return None,
    };
    let is_mercator = projection == "MERCATOR";
    let zone = value("Zone").and_then(|zone| zone.parse::<i32>().ok());
    let zone = zone.filter(|zone| projection == "UTM" && (1..=60).contains(&zone.abs()));
    let code = zone
        .zip(value("Datum"))
        .and_then(|(zone, datum)| zone_code(&datum, zone.unsigned_abs(), is_southern || zone < 0));
    // Of others than UTM nothing but the name is read.
    let other = || (!is_mercator).then(|| Projection::of(format!("+proj={}", projection.to_lowercase())));
    let projection = code.and_then(|code| Crs::from_epsg(code).projection).or_else(other);
    Some(Crs {
        text: code.map(|code| format!("EPSG:{code}")),
        unit: value("Units").map_or(code.map(|_| LinearUnit::METRE), |name| unit(&name)),
        mercator: is_mercator.then_some(mercator::WORLD),
        projection,
        vertical,
        ..Crs::default()
    })
}

/// By which ArcInfo shifts northings of the southern hemisphere to keep them above zero, and GDAL reads it so [m].
const SOUTHERN_SHIFT_M: f64 = 10_000_000.0;

/// The unit that a value of `Units` or `Zunits` names. Feet are those of the US survey, and a number counts units in a metre, as GDAL
/// reads them (`OGRSpatialReference::importFromESRI`). `NO` and other words name none.
fn unit(value: &str) -> Option<LinearUnit> {
    match value.parse::<f64>() {
        Ok(per_metre) if per_metre > 0.0 && per_metre.is_finite() => {
            Some(LinearUnit::of_metres(1.0 / per_metre))
        }
        Ok(_) => None,
        Err(_) if value == "FEET" => Some(LinearUnit::US_SURVEY_FOOT),
        Err(_) => by_name(value),
    }
}

/// EPSG code of a UTM zone on a datum by the name that ArcInfo gives it.
fn zone_code(datum: &str, zone: u32, is_southern: bool) -> Option<u32> {
    /// Zones of NAD83 in the registry.
    const NORTH_AMERICAN_ZONES: std::ops::RangeInclusive<u32> = 1..=23;
    match datum {
        "WGS84" | "WGS_1984" if is_southern => Some(32_700 + zone),
        "WGS84" | "WGS_1984" => Some(32_600 + zone),
        "NAD83" if !is_southern && NORTH_AMERICAN_ZONES.contains(&zone) => Some(26_900 + zone),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Crs {
        parse_words(text).unwrap()
    }

    #[test]
    fn the_older_form_of_arcinfo_is_read_by_line() {
        let crs = of("Projection    UTM\nZone 15\nDatum WGS84\nUnits METERS\nParameters\n");
        assert_eq!(crs.text.as_deref(), Some("EPSG:32615"));
        assert_eq!(of("Projection UTM\nZone 15\nDatum NAD83\n").text.as_deref(), Some("EPSG:26915"));
        assert!(of("Projection GEOGRAPHIC\nUnits DD\n").is_geographic);
    }

    #[test]
    fn feet_are_those_of_the_us_survey_and_numbers_count_units_in_a_metre() {
        let unit = |units: &str| of(&format!("Projection STATEPLANE\nUnits {units}\n")).unit;
        assert_eq!(unit("FEET"), Some(LinearUnit::US_SURVEY_FOOT));
        for (units, metres) in
            [("3.2808333333", 1200.0 / 3937.0), ("3.28084", 0.304_799_990_246), ("1000", 0.001)]
        {
            assert!((unit(units).unwrap().metres / metres - 1.0).abs() < 1e-10, "{units}");
        }
        assert_eq!((unit("FURLONGS"), unit("0"), unit("-1"), unit("nan")), (None, None, None, None));
    }

    #[test]
    fn a_shift_of_ten_thousand_kilometres_is_that_of_a_southern_zone_and_no_other_is_read() {
        let shifted = |shift: &str| parse_words(&format!("Projection UTM\nZone 33\nDatum WGS84\n{shift}\n"));
        let code = |shift: &str| shifted(shift).unwrap().text.unwrap();
        assert_eq!(code("Yshift 10000000.0"), "EPSG:32733");
        assert_eq!(code("Yshift -10000000"), "EPSG:32733");
        assert_eq!(code("Yshift 0.0\nXshift 0.0"), "EPSG:32633");
        for shift in ["Yshift -4000000.0", "Xshift 1000", "Yshift some"] {
            assert_eq!(shifted(shift), None, "{shift}");
        }
    }

    #[test]
    fn heights_have_the_unit_of_zunits() {
        let unit_of = |zunits: &str| of(&format!("Projection UTM\nZunits {zunits}\nUnits METERS\n")).vertical;
        assert_eq!(unit_of("FEET").unwrap().unit, LinearUnit::US_SURVEY_FOOT);
        assert!(unit_of("METERS").unwrap().unit.is_metre());
        assert_eq!(unit_of("100").unwrap().unit.metres, 0.01);
        assert_eq!(unit_of("NO"), None);
    }
}
