//! Where on earth a map's metres are: from its coordinate reference system to longitude and latitude of WGS 84 and back.

use proj4rs::{Proj, transform::transform};

use super::{Crs, epsg, multiplied};

/// A projected system as a map's x and y are in it, in metres, and its way to WGS 84.
///
/// ```
/// use terrain::crs::Earth;
/// let earth = Earth::of("EPSG:32632").unwrap();
/// let [lon_deg, lat_deg] = earth.place_deg([512_008.5, 5_422_976.5]).unwrap();
/// assert!((lon_deg - 9.164_046_814).abs() < 1e-9 && (lat_deg - 48.959_589_321).abs() < 1e-9);
/// let [x_m, y_m] = earth.place_m([lon_deg, lat_deg]).unwrap();
/// assert!((x_m - 512_008.5).abs() < 1e-6 && (y_m - 5_422_976.5).abs() < 1e-6);
/// ```
pub struct Earth {
    projected: Proj,
    wgs84: Proj,
    /// Length of the system's own unit in the map's metres, along x and y [m].
    units_m: [f64; 2],
}

/// Why a system's way to WGS 84 is not known here.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EarthError {
    /// A map that does not say.
    #[error("the map has no crs, so that nothing says where on earth it lies")]
    NoCrs,
    /// Text that names no system of the EPSG registry, and no projection that is computed here.
    #[error(
        "the map's crs, `{found}`, names no code of the EPSG registry and no projection that is known here, so that it is not placed on earth"
    )]
    NoCode {
        /// Its beginning.
        found: String,
    },
    /// A system without a code on a datum that is not known to be WGS 84.
    #[error(
        "the map's crs, `{found}`, does not say that its datum is that of WGS 84, so that it is not placed on earth"
    )]
    OwnDatum {
        /// Its beginning.
        found: String,
    },
    /// A code whose places are not known here.
    #[error("where on WGS 84 the places of EPSG:{code} lie is not known here")]
    UnknownCode {
        /// The code.
        code: u32,
    },
    /// A datum that differs from WGS 84 by more than rounding.
    #[error("the datum of EPSG:{code} lies metres from WGS 84, and by how much exactly is not known here")]
    Datum {
        /// The code.
        code: u32,
    },
    /// A place off the map whose latitude and longitude, the other way round, lie on it.
    #[error(
        "latitude {lat_deg}°, longitude {lon_deg}° lies outside the map, and the same numbers the other way round lie on it: give latitude {lon_deg}° and longitude {lat_deg}°"
    )]
    OtherWayRound {
        /// Longitude as given [°].
        lon_deg: f64,
        /// Latitude as given [°].
        lat_deg: f64,
    },
    /// A place that the projection does not reach.
    #[error("{x}, {y} lies beyond the area that the map's crs is for")]
    Beyond {
        /// First coordinate, in metres or degrees as asked.
        x: f64,
        /// Second coordinate.
        y: f64,
    },
}

/// Ellipsoids on whose systems the registry sets the same place at the same coordinates as on WGS 84, within the metre or two by which the
/// plates have moved: datums of these without a shift are realizations of the same earth-centred system.
const EARTH_CENTRED: [&str; 2] = ["+ellps=GRS80", "+ellps=WGS84"];

/// Codes whose definitions lie kilometres from where PROJ has them: spherical formulas without the word for them, a compound system of
/// Web Mercator, and a local grid. All others of the table that are placed agree with PROJ 9.5 to a millimetre.
const MISPLACED: [u32; 6] = [3973, 3974, 3975, 6871, 6996, 6997];

/// Datums by name that are, or are set equal to, WGS 84.
const SET_EQUAL: [&str; 2] = ["+datum=WGS84", "+datum=NAD83"];

/// Longitude and latitude of WGS 84.
const WGS_84: &str = "+proj=longlat +datum=WGS84 +no_defs";

/// Largest distance between a place and where it comes back to [m]: more tells of a place beyond the projection's area.
const CLOSES_M: f64 = 1e-3;

impl Earth {
    /// The way to WGS 84 of a map's `crs`.
    ///
    /// # Errors
    /// A system that is not in the EPSG registry, or whose projection or datum is not known here to the millimetre.
    pub fn of(crs: &str) -> Result<Self, EarthError> {
        let no_code = || EarthError::NoCode { found: crs.chars().take(60).collect() };
        let parsed = Crs::parse(crs).ok_or_else(no_code)?;
        let Some(code) = parsed.text.as_deref().and_then(code_of) else {
            return Self::described(&parsed, crs);
        };
        let unknown = || EarthError::UnknownCode { code };
        let definition = epsg::definition(code).filter(|_| !MISPLACED.contains(&code)).ok_or_else(unknown)?;
        if !is_earth_centred(&definition) {
            return Err(EarthError::Datum { code });
        }
        // The map's coordinates are metres whatever unit its own text has; the projection counts in that of its code.
        let units_m = units_of(crs, code).ok_or_else(unknown)?;
        let projected = Proj::from_proj_string(&definition).map_err(|_| unknown())?;
        let wgs84 = Proj::from_proj_string(WGS_84).map_err(|_| unknown())?;
        Ok(Earth { projected, wgs84, units_m })
    }

    /// The way of a system without a code, by its projection and datum.
    fn described(parsed: &Crs, crs: &str) -> Result<Self, EarthError> {
        let found = || crs.chars().take(60).collect::<String>();
        let no_code = || EarthError::NoCode { found: found() };
        let projection = parsed.any_projection().filter(|one| one.is_of_earth()).ok_or_else(no_code)?;
        let projected = Proj::from_proj_string(&projection.definition).map_err(|_| no_code())?;
        if !is_earth_centred(&projection.definition) {
            return Err(EarthError::OwnDatum { found: found() });
        }
        let wgs84 = Proj::from_proj_string(WGS_84).map_err(|_| no_code())?;
        Ok(Earth { projected, wgs84, units_m: projection.multiplied_by })
    }

    /// Longitude and latitude of a place of the map [°].
    ///
    /// # Errors
    /// A place beyond the projection's area.
    pub fn place_deg(&self, [x_m, y_m]: [f64; 2]) -> Result<[f64; 2], EarthError> {
        let beyond = || EarthError::Beyond { x: x_m, y: y_m };
        let mut asked_m = [x_m, y_m];
        // Some inverses end a fraction of a millimetre off; what is left is taken back once.
        for is_last in [false, true] {
            let place_deg = self.inverse(asked_m).ok_or_else(beyond)?;
            let [back_x_m, back_y_m] = self.forward(place_deg).ok_or_else(beyond)?;
            let off_m = [x_m - back_x_m, y_m - back_y_m];
            if is_last {
                return (off_m[0].hypot(off_m[1]) < CLOSES_M).then_some(place_deg).ok_or_else(beyond);
            }
            asked_m = [x_m + off_m[0], y_m + off_m[1]];
        }
        Err(beyond())
    }

    /// The place of the map at a longitude and latitude in degrees [m].
    ///
    /// # Errors
    /// A place beyond the projection's area.
    pub fn place_m(&self, [lon_deg, lat_deg]: [f64; 2]) -> Result<[f64; 2], EarthError> {
        let beyond = || EarthError::Beyond { x: lon_deg, y: lat_deg };
        if !(lon_deg.abs() <= 180.0 && lat_deg.abs() <= 90.0) {
            return Err(beyond());
        }
        let place_m = self.forward([lon_deg, lat_deg]).ok_or_else(beyond)?;
        self.place_deg(place_m).map_err(|_| beyond())?;
        Ok(place_m)
    }

    fn inverse(&self, [x_m, y_m]: [f64; 2]) -> Option<[f64; 2]> {
        let [unit_x_m, unit_y_m] = self.units_m;
        let mut point = (x_m / unit_x_m, y_m / unit_y_m, 0.0);
        transform(&self.projected, &self.wgs84, &mut point).ok()?;
        finite([point.0.to_degrees(), point.1.to_degrees()])
    }

    fn forward(&self, [lon_deg, lat_deg]: [f64; 2]) -> Option<[f64; 2]> {
        let mut point = (lon_deg.to_radians(), lat_deg.to_radians(), 0.0);
        transform(&self.wgs84, &self.projected, &mut point).ok()?;
        finite([point.0 * self.units_m[0], point.1 * self.units_m[1]])
    }
}

fn finite(pair: [f64; 2]) -> Option<[f64; 2]> {
    pair.iter().all(|value| value.is_finite()).then_some(pair)
}

/// The code of the EPSG registry of a map's `crs`, with the length of its unit in the map's metres along x and y; `None` where it has none,
/// or where the unit is not known.
pub(crate) fn registered_code(crs: &str) -> Option<(u32, [f64; 2])> {
    let code = code_of(Crs::parse(crs)?.text.as_deref()?)?;
    epsg::definition(code)?;
    (!Crs::from_epsg(code).is_geographic)
        .then(|| units_of(crs, code))
        .flatten()
        .map(|units_m| (code, units_m))
}

/// The unit of a code in metres of the map along x and y, which may be multiples of those of the registered system.
fn units_of(crs: &str, code: u32) -> Option<[f64; 2]> {
    let by = multiplied::read(crs).map_or([1.0; 2], |multiplied| multiplied.by);
    multiplied::units_m(code, by)
}

/// The code of a text of [`Crs::text`]: `EPSG:code`, or WKT that names its code or is one of the UTM zones by the names that ESRI's files have.
fn code_of(text: &str) -> Option<u32> {
    if let Some(code) = text.strip_prefix("EPSG:") {
        return code.split('+').next()?.parse().ok().map(epsg::registered);
    }
    if let Some(multiplied) = multiplied::read(text) {
        return multiplied.code;
    }
    let name = text.split('"').nth(1)?.to_ascii_uppercase().replace([' ', '/'], "_");
    let (datum, zone) = name.split_once("_UTM_ZONE_")?;
    let (number, is_north) = match zone.strip_suffix('N') {
        Some(number) => (number, true),
        None => (zone.strip_suffix('S')?, false),
    };
    let number: u32 = number.parse().ok().filter(|number| (1..=60).contains(number))?;
    match (datum.trim_end_matches('_'), is_north) {
        ("WGS_1984" | "WGS_84", true) => Some(32_600 + number),
        ("WGS_1984" | "WGS_84", false) => Some(32_700 + number),
        ("NAD_1983" | "NAD83", true) if number <= 23 => Some(26_900 + number),
        ("ETRS_1989" | "ETRS89", true) if (28..=38).contains(&number) => Some(25_800 + number),
        _ => None,
    }
}

/// Whether a PROJ definition's datum is that of WGS 84 or a realization of the same earth-centred system.
pub(super) fn is_earth_centred(definition: &str) -> bool {
    let words = || definition.split_ascii_whitespace();
    if let Some(datum) = words().find(|word| word.starts_with("+datum=")) {
        return SET_EQUAL.contains(&datum);
    }
    let shift = words().find_map(|word| word.strip_prefix("+towgs84="));
    let is_unshifted = shift.is_none_or(|shift| shift.split(',').all(|by| by.parse() == Ok(0.0)));
    let is_by_grid = words().any(|word| word.starts_with("+nadgrids=") && word != "+nadgrids=@null");
    // The sphere of Web Mercator carries longitude and latitude of WGS 84.
    let is_web_mercator = words().any(|word| word == "+nadgrids=@null");
    is_web_mercator || !is_by_grid && is_unshifted && words().any(|word| EARTH_CENTRED.contains(&word))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Longitude, latitude, easting and northing by PROJ 9.5 (pyproj), in the system's own unit.
    const BY_PROJ: [(&str, [f64; 2], [f64; 2]); 3] = [
        ("EPSG:32632", [9.164_046_814, 48.959_589_321], [512_008.5, 5_422_976.5]),
        ("EPSG:26915", [-93.0, 45.0], [500_000.0, 4_982_950.400_226_553]),
        ("EPSG:32733", [15.0, 0.0], [500_000.0, 10_000_000.0]),
    ];

    #[test]
    fn places_are_where_proj_has_them() {
        for (crs, deg, m) in BY_PROJ {
            let earth = Earth::of(crs).unwrap();
            let [lon, lat] = earth.place_deg(m).unwrap();
            assert!((lon - deg[0]).abs() < 2e-9 && (lat - deg[1]).abs() < 2e-9, "{crs}: {lon} {lat}");
            let [x, y] = earth.place_m(deg).unwrap();
            assert!((x - m[0]).abs() < 1e-3 && (y - m[1]).abs() < 1e-3, "{crs}: {x} {y}");
        }
    }

    /// Longitude, latitude, easting and northing by PROJ 9.5 (pyproj) of systems with one parallel and a scale on it [m].
    const ONE_PARALLEL: [(u32, [f64; 2], [f64; 2]); 6] = [
        (8325, [-119.8348, 44.388], [63_093.247_9, -111.001_8]),
        (8068, [-110.6152, 32.3332], [21_839.362_2, 14_284.766_5]),
        (7117, [-108.0186, 45.0384], [231_372.578_4, -32_728.499_0]),
        (6798, [-118.843, 43.3588], [193_540.164_6, 26_190.072_1]),
        (8345, [-119.3224, 41.9596], [96_190.820_2, 182.470_1]),
        (8110, [-88.9524, 45.859], [176_083.731_6, 26_151.108_3]),
    ];

    #[test]
    fn conformal_cones_with_one_parallel_have_their_scale() {
        for (code, deg, m) in ONE_PARALLEL {
            let [x_m, y_m] = Earth::of(&format!("EPSG:{code}")).unwrap().place_m(deg).unwrap();
            assert!((x_m - m[0]).hypot(y_m - m[1]) < 1e-3, "EPSG:{code}: {x_m} {y_m}");
        }
    }

    #[test]
    fn every_scale_of_the_registry_is_one_that_the_conversion_reads() {
        let codes = (1..=u32::from(u16::MAX)).filter_map(|code| Some((code, epsg::definition(code)?)));
        let mut scaled = 0;
        for (code, definition) in codes.filter(|(_, definition)| definition.contains("+k")) {
            let names = definition.split_ascii_whitespace().filter_map(|word| word.split_once('='));
            let scale = names.filter(|(name, _)| name.starts_with("+k")).collect::<Vec<_>>();
            assert!(matches!(scale[..], [("+k", _)]), "EPSG:{code}: {definition}");
            scaled += 1;
        }
        assert!(scaled > 2900, "{scaled}");
    }

    #[test]
    fn zones_are_known_by_the_names_that_esri_gives_them() {
        for (text, code) in [
            ("PROJCS[\"WGS_1984_UTM_Zone_32N\",GEOGCS[]]", Some(32_632)),
            ("PROJCS[\"WGS_1984_UTM_Zone_19S\",GEOGCS[]]", Some(32_719)),
            ("PROJCS[\"WGS 84 / UTM zone 7N\",GEOGCS[]]", Some(32_607)),
            ("PROJCS[\"NAD_1983_UTM_Zone_15N\",GEOGCS[]]", Some(26_915)),
            ("PROJCS[\"WGS_1984_UTM_Zone_61N\",GEOGCS[]]", None),
            ("PROJCS[\"NAD_1927_UTM_Zone_15N\",GEOGCS[]]", None),
        ] {
            assert_eq!(code_of(text), code, "{text}");
        }
    }

    #[test]
    fn a_zone_in_feet_lies_where_the_same_zone_in_metres_does() {
        let text = "PROJCS[\"NAD_1983_UTM_Zone_15N\",GEOGCS[\"g\"],PROJECTION[\"Transverse_Mercator\"],UNIT[\"Foot_US\",0.3048006096012192]]";
        let place_m = [512_000.0, 4_982_950.0];
        let [feet, metres] =
            [text, "EPSG:26915"].map(|crs| Earth::of(crs).unwrap().place_deg(place_m).unwrap());
        assert_eq!(feet, metres, "both count the map's metres");
    }

    #[test]
    fn what_is_not_known_to_a_millimetre_is_refused_by_name() {
        // The Ordnance Survey's and the Netherlands' datums need grids of corrections.
        for code in [27_700, 28_992, 4_267 + 22_504] {
            assert!(matches!(Earth::of(&format!("EPSG:{code}")), Err(EarthError::Datum { .. })), "{code}");
        }
        // A cap of EASE-Grid, which the table has without the word that makes a sphere of it.
        assert!(matches!(Earth::of("EPSG:3973"), Err(EarthError::UnknownCode { code: 3973 })));
        assert!(matches!(Earth::of("EPSG:9473"), Err(EarthError::UnknownCode { code: 9473 })));
        assert!(matches!(Earth::of("a field"), Err(EarthError::NoCode { .. })));
    }

    #[test]
    fn places_beyond_the_projection_are_refused() {
        let earth = Earth::of("EPSG:32632").unwrap();
        assert!(earth.place_m([190.0, 0.0]).is_err());
        assert!(earth.place_m([0.0, 91.0]).is_err());
        assert!(earth.place_m([f64::NAN, 0.0]).is_err());
        assert!(earth.place_deg([4.9e7, -4.9e7]).is_err());
    }
}
