//! Which geographic systems have the longitudes and latitudes of WGS 84, within the metre or two by which the plates have moved.

use super::{Crs, earth};

/// Systems by the plain names of their datum or of themselves: WKT of Esri has no codes.
const NAMED: [(&[&str], u32); 5] = [
    (&["wgs1984", "wgs84", "worldgeodeticsystem1984", "worldgeodeticsystem1984ensemble"], 4326),
    (&["northamerican1983", "northamericandatum1983", "nad83", "nad1983"], 4269),
    (
        &[
            "etrs1989",
            "etrs89",
            "europeanterrestrialreferencesystem1989",
            "europeanterrestrialreferencesystem1989ensemble",
        ],
        4258,
    ),
    (&["gda1994", "gda94", "geocentricdatumofaustralia1994"], 4283),
    (&["gda2020", "geocentricdatumofaustralia2020"], 7844),
];

/// The EPSG code of the system with a name, as `GCS_WGS_1984`, or of that with a datum of a name, as `D_WGS_1984`.
pub(super) fn code_by_name(name: &str) -> Option<u32> {
    let bare = ["GCS_", "D_"].iter().find_map(|prefix| name.strip_prefix(prefix)).unwrap_or(name);
    let plain: String = bare.to_lowercase().chars().filter(char::is_ascii_alphanumeric).collect();
    NAMED.iter().find(|(names, _)| names.contains(&plain.as_str())).map(|(_, code)| *code)
}

/// The datum of a geographic system by its code, as PROJ defines it, where that is set equal to WGS 84; `None` for all others, and where the
/// file has another ellipsoid for it (semi-major axis [m] and inverse flattening).
pub(super) fn earth_centred_datum(code: u32, ellipsoid: Option<[f64; 2]>) -> Option<String> {
    /// Semi-major axis [m] and inverse flattening of GRS 80, which those of WGS 84 equal to 2e-6 (NIMA TR8350.2, table 3.1; Moritz 2000).
    const GRS_80: [f64; 2] = [6_378_137.0, 298.257_222_101];
    /// Digits with which files round a flattening.
    const WRITTEN: f64 = 1e-3;
    let is_other = |[major_m, inverse_flattening]: [f64; 2]| {
        (major_m - GRS_80[0]).abs() > WRITTEN || (inverse_flattening - GRS_80[1]).abs() > WRITTEN
    };
    if ellipsoid.is_some_and(is_other) {
        return None;
    }
    Crs::from_epsg(code).earth_centred_degrees()?;
    let definition = crs_definitions::from_code(u16::try_from(code).ok()?)?.proj4;
    let keys = ["+datum=", "+ellps=", "+towgs84="];
    let words =
        definition.split_ascii_whitespace().filter(|word| keys.iter().any(|key| word.starts_with(key)));
    Some(words.collect::<Vec<_>>().join(" "))
}

impl Crs {
    /// The name of a geographic system whose degrees are those of WGS 84; `None` for all other systems.
    ///
    /// ```
    /// use terrain::crs::Crs;
    /// assert_eq!(Crs::from_epsg(4269).earth_centred_degrees(), Some("EPSG:4269"));
    /// assert_eq!(Crs::from_epsg(4267).earth_centred_degrees(), None); // NAD27 lies some 10 to 200 m off.
    /// ```
    pub fn earth_centred_degrees(&self) -> Option<&str> {
        let text = self.text.as_deref().filter(|_| self.is_geographic)?;
        let code: u16 = text.strip_prefix("EPSG:")?.split('+').next()?.parse().ok()?;
        let definition = crs_definitions::from_code(code)?.proj4;
        let is_from_greenwich = !definition.contains("+pm=");
        let is_longlat = definition.split_ascii_whitespace().any(|word| word == "+proj=longlat");
        (is_longlat && is_from_greenwich && earth::is_earth_centred(definition)).then_some(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn datums_that_are_set_equal_to_wgs_84_are_known_by_code() {
        for code in [4326, 4979, 4269, 4258, 4283, 7844, 4617, 4674, 6318, 4612, 4490] {
            assert!(Crs::from_epsg(code).earth_centred_degrees().is_some(), "EPSG:{code}");
        }
        // NAD27, ED50, DHDN, OSGB36, Pulkovo 1942, Tokyo, NTF (Paris), and a projected system.
        for code in [4267, 4230, 4314, 4277, 4284, 4301, 4807, 32_632, 99_999] {
            assert!(Crs::from_epsg(code).earth_centred_degrees().is_none(), "EPSG:{code}");
        }
    }

    #[test]
    fn text_without_a_code_is_known_by_its_datum_if_it_counts_degrees_from_greenwich() {
        let text = |datum: &str, unit: &str, meridian: &str| {
            format!(
                "GEOGCS[\"some name\",DATUM[\"{datum}\",SPHEROID[\"s\",6378137,298.257]],PRIMEM[\"p\",{meridian}],UNIT[\"u\",{unit}]]"
            )
        };
        let name = |text: &str| Crs::parse(text).unwrap().earth_centred_degrees().map(str::to_owned);
        let degree = "0.0174532925199433";
        assert_eq!(name(&text("D_WGS_1984", degree, "0.0")).as_deref(), Some("EPSG:4326"));
        assert_eq!(name(&text("D_North_American_1983", degree, "0")).as_deref(), Some("EPSG:4269"));
        for other in [
            text("D_North_American_1927", degree, "0"),
            text("D_WGS_1984", "0.015707963267949", "0"),
            text("D_WGS_1984", degree, "2.337229"),
        ] {
            assert_eq!(name(&other), None, "{other}");
        }
        let older = |datum: &str, unit: &str| format!("Projection GEOGRAPHIC\nDatum {datum}\nUnits {unit}\n");
        assert_eq!(name(&older("WGS84", "DD")).as_deref(), Some("EPSG:4326"));
        assert_eq!(name(&older("WGS84", "DS")), None);
        assert_eq!(name(&older("NAD27", "DD")), None);
    }
}
