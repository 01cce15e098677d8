//! A system that GeoKeys describe by its projection's method and parameters, without a code (OGC GeoTIFF 1.1, annex C).

use super::geokeys::{
    CITATION, ESRI_CITATION, GEODETIC_CRS, GeoKeys, INVERSE_FLATTENING, PROJECTED_CITATION, SEMI_MAJOR_AXIS,
    SEMI_MINOR_AXIS, USER_DEFINED,
};
use crate::crs::Crs;

const PROJECTION: u16 = 3074;
const PROJECTION_METHOD: u16 = 3075;
const PRIME_MERIDIAN: u16 = 2051;
const PRIME_MERIDIAN_LONGITUDE: u16 = 2061;

const MERCATOR: u32 = 7;

/// Methods of projection (`CT_*` of GeoTIFF 1.0, which GDAL writes) as WKT 1 names them.
const METHODS: [(u32, &str); 20] = [
    (1, "Transverse_Mercator"),
    (MERCATOR, "Mercator_1SP"),
    (8, "Lambert_Conformal_Conic_2SP"),
    (9, "Lambert_Conformal_Conic_1SP"),
    (10, "Lambert_Azimuthal_Equal_Area"),
    (11, "Albers_Conic_Equal_Area"),
    (12, "Azimuthal_Equidistant"),
    (13, "Equidistant_Conic"),
    (15, "Polar_Stereographic"),
    (16, "Oblique_Stereographic"),
    (17, "Equirectangular"),
    (18, "Cassini_Soldner"),
    (19, "Gnomonic"),
    (20, "Miller_Cylindrical"),
    (22, "Polyconic"),
    (23, "Robinson"),
    (24, "Sinusoidal"),
    (25, "VanDerGrinten"),
    (26, "New_Zealand_Map_Grid"),
    (28, "Cylindrical_Equal_Area"),
];

/// Methods whose origin WKT 1 calls a centre.
const CENTRED: [u32; 4] = [10, 11, 12, 13];

/// Parameters of a projection by their name in WKT 1, with the keys that may hold them; lengths are in the file's unit.
const ANGLES_AND_SCALE: [(&str, &[u16]); 5] = [
    ("standard_parallel_1", &[3078]),
    ("standard_parallel_2", &[3079]),
    ("central_meridian", &[3080, 3084, 3088, 3095]),
    ("latitude_of_origin", &[3081, 3085, 3089]),
    ("scale_factor", &[3092, 3093]),
];
const LENGTHS: [(&str, &[u16]); 2] =
    [("false_easting", &[3082, 3086, 3090]), ("false_northing", &[3083, 3087, 3091])];

/// EPSG's code of the meridian of Greenwich.
const GREENWICH: u32 = 8901;
/// EPSG's code of WGS 84 in longitude and latitude.
const WGS_84: u32 = 4326;

impl GeoKeys {
    /// A system without a code: Esri writes its text into the citation, others its parameters into keys. Nothing is known of a file that
    /// does neither.
    pub(super) fn own_system(&self) -> Crs {
        let citations = [self.citation(PROJECTED_CITATION), self.citation(CITATION)];
        let of_esri =
            citations.iter().flatten().find_map(|text| Crs::parse(text.strip_prefix(ESRI_CITATION)?));
        if let Some(crs) = of_esri {
            return crs;
        }
        if let Some(code) = self.utm_code() {
            return Crs::from_epsg(code);
        }
        // Coordinates have the unit of the keys, whatever that of the text.
        self.own_text()
            .and_then(|text| Crs::parse(&text))
            .map_or_else(Crs::default, |crs| Crs { unit: None, ..crs })
    }

    /// The hemisphere and zone of UTM that the projection is by its code (GeoTIFF 1.0, section 6.3.3.2): whether it is southern, and its number.
    fn utm_zone(&self) -> Option<(bool, u32)> {
        match self.code(PROJECTION)? {
            code @ 16_001..=16_060 => Some((false, code - 16_000)),
            code @ 16_101..=16_160 => Some((true, code - 16_100)),
            _ => None,
        }
    }

    /// The code of a zone of UTM on WGS 84, which is given by the codes of zone and datum.
    fn utm_code(&self) -> Option<u32> {
        let (is_southern, zone) = self.utm_zone()?;
        let first = if is_southern { 32_700 } else { 32_600 };
        (self.code(GEODETIC_CRS) == Some(WGS_84)).then_some(first + zone)
    }

    /// The system in WKT 1, in metres.
    fn own_text(&self) -> Option<String> {
        let projection = self.utm_text().or_else(|| self.projection_text())?;
        let citation = self.citation(PROJECTED_CITATION).or(self.citation(CITATION)).unwrap_or("unnamed");
        let name: String =
            citation.chars().filter(|c| c.is_ascii_graphic() || *c == ' ').filter(|c| *c != '"').collect();
        Some(format!("PROJCS[\"{name}\",{},{projection},UNIT[\"metre\",1]]", self.base_text()))
    }

    /// Parameters of a zone of UTM (Snyder 1987, page 57).
    fn utm_text(&self) -> Option<String> {
        let (is_southern, zone) = self.utm_zone()?;
        let (meridian_deg, north_m) = (f64::from(zone) * 6.0 - 183.0, if is_southern { 1e7 } else { 0.0 });
        Some(format!(
            "PROJECTION[\"Transverse_Mercator\"],PARAMETER[\"latitude_of_origin\",0],PARAMETER[\"central_meridian\",{meridian_deg}],\
             PARAMETER[\"scale_factor\",0.9996],PARAMETER[\"false_easting\",500000],PARAMETER[\"false_northing\",{north_m}]"
        ))
    }

    /// Method and parameters; of a method that is not known here its number alone.
    fn projection_text(&self) -> Option<String> {
        let code = self
            .code(PROJECTION_METHOD)
            .or_else(|| self.code(PROJECTION).filter(|code| *code != u32::from(USER_DEFINED)))?;
        let Some((_, method)) = METHODS.iter().find(|(known, _)| *known == code) else {
            return Some(format!("PROJECTION[\"GeoTIFF_{code}\"]"));
        };
        let method =
            if code == MERCATOR && self.is_spherical() { "Mercator_Auxiliary_Sphere" } else { method };
        let value = |keys: &[u16]| keys.iter().find_map(|key| self.double(*key));
        let named = |name: &str| {
            match name {
                "latitude_of_origin" if CENTRED.contains(&code) => "latitude_of_center",
                "central_meridian" if CENTRED.contains(&code) => "longitude_of_center",
                name => name,
            }
            .to_owned()
        };
        let unit_m = self.linear_unit().ok().flatten().map_or(1.0, |unit| unit.metres);
        let plain = ANGLES_AND_SCALE.iter().filter_map(|(name, keys)| Some((named(name), value(keys)?)));
        let lengths = LENGTHS.iter().filter_map(|(name, keys)| Some((named(name), value(keys)? * unit_m)));
        let parameters =
            plain.chain(lengths).map(|(name, number)| format!(",PARAMETER[\"{name}\",{number}]"));
        Some(format!("PROJECTION[\"{method}\"]{}", parameters.collect::<String>()))
    }

    /// Whether a Mercator treats latitudes of the ellipsoid as those of a sphere.
    fn is_spherical(&self) -> bool {
        let major_m = self.double(SEMI_MAJOR_AXIS);
        let is_sphere = major_m.is_some() && major_m == self.double(SEMI_MINOR_AXIS)
            || self.double(INVERSE_FLATTENING) == Some(0.0);
        let citations = [self.citation(PROJECTED_CITATION), self.citation(CITATION)];
        let names = citations.iter().flatten().copied().collect::<String>().to_lowercase();
        is_sphere
            || ["pseudo", "web", "google", "visualisation", "sphere"].iter().any(|word| names.contains(word))
    }

    /// The geographic system that the projection is on, named by its code where it has one and counts from Greenwich.
    fn base_text(&self) -> String {
        let is_greenwich = self.code(PRIME_MERIDIAN).is_none_or(|code| code == GREENWICH)
            && self.double(PRIME_MERIDIAN_LONGITUDE).is_none_or(|longitude_deg| longitude_deg == 0.0);
        let code = self.code(GEODETIC_CRS).filter(|code| *code != u32::from(USER_DEFINED) && is_greenwich);
        let [major_m, inverse_flattening] = self.ellipsoid();
        let (name, authority) = match code {
            Some(code) => (format!("EPSG:{code}"), format!(",AUTHORITY[\"EPSG\",\"{code}\"]")),
            None => ("unknown".to_owned(), String::new()),
        };
        format!(
            "GEOGCS[\"{name}\",DATUM[\"{name}\",SPHEROID[\"{name}\",{major_m},{inverse_flattening}]],PRIMEM[\"Greenwich\",0],\
             UNIT[\"degree\",0.0174532925199433]{authority}]"
        )
    }

    /// Semi-major axis [m] and inverse flattening, which is 0 of a sphere; those of WGS 84 where the file has none.
    fn ellipsoid(&self) -> [f64; 2] {
        /// NIMA TR8350.2, table 3.1.
        const OF_WGS_84: [f64; 2] = [6_378_137.0, 298.257_223_563];
        let Some(major_m) = self.double(SEMI_MAJOR_AXIS) else { return OF_WGS_84 };
        let flattening = self.double(INVERSE_FLATTENING).unwrap_or(0.0);
        match self.double(SEMI_MINOR_AXIS) {
            Some(minor_m) if minor_m < major_m && flattening == 0.0 => {
                [major_m, major_m / (major_m - minor_m)]
            }
            _ => [major_m, flattening],
        }
    }
}
