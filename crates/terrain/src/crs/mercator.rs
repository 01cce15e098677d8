//! Mercator and equidistant cylindrical projections, whose metres are metres of the ground on one parallel only.

/// A Mercator projection, or one that spaces parallels evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mercator {
    /// How parallels are spaced.
    pub spacing: Spacing,
    /// Whether latitudes and longitudes are those of WGS 84.
    pub is_on_wgs84: bool,
    /// Scale on the equator; less than 1 where another parallel is true to scale.
    pub equator_scale: f64,
    /// Longitude of the central meridian [deg].
    pub central_meridian_deg: f64,
    /// Easting of the central meridian and northing of the equator [m].
    pub false_origin_m: [f64; 2],
}

/// How a cylindrical projection spaces parallels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Spacing {
    /// So that angles on the ellipsoid are true (Mercator).
    Conformal,
    /// As the same would be on a sphere (Web Mercator).
    Spherical,
    /// Evenly (equirectangular, plate carrée).
    Even,
}

/// Lengths on the ground by lengths on the map.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroundScale {
    /// Eastwards.
    pub east: f64,
    /// Northwards.
    pub north: f64,
}

/// Web Mercator, EPSG:3857.
pub(super) const WEB: Mercator = Mercator {
    spacing: Spacing::Spherical,
    is_on_wgs84: true,
    equator_scale: 1.0,
    central_meridian_deg: 0.0,
    false_origin_m: [0.0; 2],
};
/// World Mercator, EPSG:3395.
pub(super) const WORLD: Mercator = Mercator { spacing: Spacing::Conformal, ..WEB };

/// Semi-major axis of WGS 84 [m] (NIMA TR8350.2, table 3.1). Other ellipsoids change a scale by less than 1e-4.
pub(super) const SEMI_MAJOR_M: f64 = 6_378_137.0;
/// First eccentricity squared of WGS 84 (NIMA TR8350.2, table 3.3).
pub(super) const ECCENTRICITY_2: f64 = 6.694_379_990_14e-3;

/// Whether a semi-major axis is one of the earth's: those of the EPSG registry lie within 3e-4 of that of WGS 84. Of other
/// bodies nothing is known here [m].
pub(crate) fn is_of_earth(semi_major_m: f64) -> bool {
    const SPREAD: f64 = 1e-3;
    (semi_major_m / SEMI_MAJOR_M - 1.0).abs() <= SPREAD
}

impl Mercator {
    /// The projection of a PROJ definition, looked up by key, if it is a Mercator.
    pub(super) fn from_proj<'a>(value: impl Fn(&str) -> Option<&'a str>) -> Option<Self> {
        let is_even = value("proj") == Some("eqc");
        if !is_even && value("proj") != Some("merc") {
            return None;
        }
        let number = |key: &str| value(key).and_then(|text| text.parse::<f64>().ok());
        let true_scale_rad = number("lat_ts").unwrap_or(0.0).to_radians();
        let is_spherical = value("a").is_some() && value("a") == value("b");
        Some(Mercator {
            spacing: match (is_even, is_spherical) {
                (true, _) => Spacing::Even,
                (false, true) => Spacing::Spherical,
                (false, false) => Spacing::Conformal,
            },
            is_on_wgs84: is_spherical || value("datum") == Some("WGS84"),
            equator_scale: number("k")
                .or(number("k_0"))
                .unwrap_or_else(|| Self::equator_scale_of(true_scale_rad)),
            central_meridian_deg: number("lon_0").unwrap_or(0.0),
            false_origin_m: [number("x_0").unwrap_or(0.0), number("y_0").unwrap_or(0.0)],
        })
    }

    /// Scale on the equator of a Mercator that is true to scale on a parallel.
    ///
    /// ```text
    /// k0 = cos φ / √(1 − e² sin² φ)
    /// ```
    ///
    /// Snyder (1987), Map Projections: A Working Manual, eq. 14-15, doi:10.3133/pp1395.
    pub(crate) fn equator_scale_of(latitude_rad: f64) -> f64 {
        latitude_rad.cos() / (1.0 - ECCENTRICITY_2 * latitude_rad.sin().powi(2)).sqrt()
    }

    /// WKT of the projection with its coordinates multiplied; `None` where its datum is not known.
    pub(crate) fn scaled_wkt(&self, by: f64) -> Option<String> {
        let (scale, meridian_deg) = (self.equator_scale * by, self.central_meridian_deg);
        let [x_m, y_m] = self.false_origin_m.map(|metres| metres * by);
        // PROJ's words say what WKT 1 has none for: latitudes of the ellipsoid as if on a sphere.
        let sphere = format!(
            ",EXTENSION[\"PROJ4\",\"+proj=merc +a={SEMI_MAJOR_M} +b={SEMI_MAJOR_M} +lat_ts=0 +lon_0={meridian_deg} +x_0={x_m} \
             +y_0={y_m} +k={scale} +units=m +nadgrids=@null +wktext +no_defs\"]"
        );
        (self.is_on_wgs84 && self.spacing != Spacing::Even).then(|| {
            format!(
                "PROJCS[\"Mercator in metres of the ground\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS 84\",\
                 6378137,298.257223563]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],\
                 PROJECTION[\"Mercator_1SP\"],PARAMETER[\"central_meridian\",{meridian_deg}],\
                 PARAMETER[\"scale_factor\",{scale}],PARAMETER[\"false_easting\",{x_m}],\
                 PARAMETER[\"false_northing\",{y_m}],UNIT[\"metre\",1]{}]",
                if self.spacing == Spacing::Spherical { sphere.as_str() } else { "" }
            )
        })
    }

    /// Longitude and latitude of a place [deg].
    ///
    /// ```text
    /// χ = π/2 − 2 atan exp(−y / (a k0)),  φ from χ by Snyder eq. 3-5
    /// ```
    ///
    /// Snyder (1987), eqs 7-4, 7-10 and 3-5. Good to 1e-9 rad.
    pub fn place_deg(&self, x_m: f64, y_m: f64) -> [f64; 2] {
        let radius_m = SEMI_MAJOR_M * self.equator_scale;
        let north_m = y_m - self.false_origin_m[1];
        let chi = std::f64::consts::FRAC_PI_2 - 2.0 * (-north_m / radius_m).exp().atan();
        let latitude_rad = match self.spacing {
            Spacing::Conformal => chi + conformal_difference_rad(chi),
            Spacing::Spherical => chi,
            Spacing::Even => north_m / SEMI_MAJOR_M,
        };
        let longitude_rad = (x_m - self.false_origin_m[0]) / radius_m;
        [self.central_meridian_deg + longitude_rad.to_degrees(), latitude_rad.to_degrees()]
    }

    /// Ground by map at a northing.
    ///
    /// ```text
    /// east:  ν cos φ / (a k0)        ν = a / √(1 − e² sin² φ)
    /// north: as east; ρ cos φ / (a k0) where projected as on a sphere; ρ / a where parallels are evenly spaced
    ///                                       ρ = ν (1 − e²) / (1 − e² sin² φ)
    /// ```
    ///
    /// Snyder (1987), eqs 4-18, 4-20, 7-8; Battersby et al. (2014), doi:10.3138/carto.49.2.2313, for the sphere.
    pub fn ground_scale(&self, y_m: f64) -> GroundScale {
        let latitude_rad = self.place_deg(self.false_origin_m[0], y_m)[1].to_radians();
        let flattening = 1.0 - ECCENTRICITY_2 * latitude_rad.sin().powi(2);
        let east = latitude_rad.cos() / flattening.sqrt() / self.equator_scale;
        let meridian = (1.0 - ECCENTRICITY_2) / flattening;
        let north = match self.spacing {
            Spacing::Conformal => east,
            Spacing::Spherical => east * meridian,
            Spacing::Even => meridian / flattening.sqrt(),
        };
        GroundScale { east, north }
    }
}

/// Geodetic less conformal latitude (Snyder eq. 3-5).
fn conformal_difference_rad(chi: f64) -> f64 {
    let (e2, e4, e6) = (ECCENTRICITY_2, ECCENTRICITY_2.powi(2), ECCENTRICITY_2.powi(3));
    let e8 = ECCENTRICITY_2.powi(4);
    (e2 / 2.0 + 5.0 * e4 / 24.0 + e6 / 12.0 + 13.0 * e8 / 360.0) * (2.0 * chi).sin()
        + (7.0 * e4 / 48.0 + 29.0 * e6 / 240.0 + 811.0 * e8 / 11520.0) * (4.0 * chi).sin()
        + (7.0 * e6 / 120.0 + 81.0 * e8 / 1120.0) * (6.0 * chi).sin()
        + 4279.0 * e8 / 161_280.0 * (8.0 * chi).sin()
}

#[cfg(test)]
mod tests {
    use approx::assert_abs_diff_eq;

    use super::*;

    #[test]
    fn places_and_scales_are_those_of_other_software() {
        // GDAL: EPSG:3857 and EPSG:3395 of 10° east, 60° north. Scales by hand from the radii of curvature there.
        let [longitude_deg, latitude_deg] = WEB.place_deg(1_113_194.907_93, 8_399_737.889_82);
        assert_abs_diff_eq!(longitude_deg, 10.0, epsilon = 1e-9);
        assert_abs_diff_eq!(latitude_deg, 60.0, epsilon = 1e-9);
        let [_, latitude_deg] = WORLD.place_deg(1_113_194.907_93, 8_362_698.548_50);
        assert_abs_diff_eq!(latitude_deg, 60.0, epsilon = 1e-9);
        let scale = WEB.ground_scale(8_399_737.889_82);
        assert_abs_diff_eq!(scale.east, 0.501_260, epsilon = 2e-6);
        assert_abs_diff_eq!(scale.north, 0.500_417, epsilon = 2e-6);
    }

    #[test]
    fn a_projection_brought_to_the_ground_is_true_to_scale_and_keeps_its_places() {
        let (y_m, by) = (8_399_737.889_82, 0.500_8);
        let ground = crate::crs::Crs::parse(&WEB.scaled_wkt(by).unwrap()).unwrap().mercator.unwrap();
        assert_eq!(ground.spacing, Spacing::Spherical);
        let [longitude_deg, latitude_deg] = ground.place_deg(1_113_194.907_93 * by, y_m * by);
        assert_abs_diff_eq!(longitude_deg, 10.0, epsilon = 1e-9);
        assert_abs_diff_eq!(latitude_deg, 60.0, epsilon = 1e-9);
        assert_abs_diff_eq!(ground.ground_scale(y_m * by).east, 0.501_260 / by, epsilon = 1e-5);
    }

    #[test]
    fn evenly_spaced_parallels_keep_north_and_stretch_east() {
        let even = crate::crs::Crs::from_epsg(4087).mercator.unwrap();
        let y_m = SEMI_MAJOR_M * 60f64.to_radians();
        assert_abs_diff_eq!(even.place_deg(0.0, y_m)[1], 60.0, epsilon = 1e-9);
        let scale = even.ground_scale(y_m);
        assert_abs_diff_eq!(scale.east, 0.501_260, epsilon = 2e-6);
        // The meridian's radius of curvature at 60° by the equator's: 6 383 453.857 / 6 378 137.
        assert_abs_diff_eq!(scale.north, 1.000_834, epsilon = 2e-6);
    }

    #[test]
    fn a_parallel_of_true_scale_is_true_to_scale() {
        let caspian = crate::crs::Crs::from_epsg(3388).mercator.unwrap();
        let mut y_m = 4.0e6;
        for _ in 0..60 {
            let latitude_deg = caspian.place_deg(0.0, y_m)[1];
            y_m += (42.0 - latitude_deg) * 8.0e4;
        }
        assert_abs_diff_eq!(caspian.ground_scale(y_m).east, 1.0, epsilon = 1e-6);
    }
}
