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

/// Parameters of a cylindrical projection as files have them.
pub(crate) struct Parameters {
    pub(crate) spacing: Spacing,
    pub(crate) is_on_wgs84: bool,
    /// Parallel that is true to scale [°].
    pub(crate) true_scale_deg: f64,
    /// Latitude from which northings count [°].
    pub(crate) origin_latitude_deg: f64,
    /// Scale on the equator, which stands above the parallel.
    pub(crate) scale: Option<f64>,
    pub(crate) central_meridian_deg: f64,
    pub(crate) false_origin_m: [f64; 2],
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
/// Inverse flattening of WGS 84 (NIMA TR8350.2, table 3.1).
const INVERSE_FLATTENING: f64 = 298.257_223_563;

/// Whether a semi-major axis is one of the earth's: those of the EPSG registry lie within 3e-4 of that of WGS 84, spheres of the earth's mean
/// radius (6 371 km) 1.1e-3 below it. Venus, the nearest body, is 5e-2 smaller. Of other bodies nothing is known here [m].
pub(crate) fn is_of_earth(semi_major_m: f64) -> bool {
    const SPREAD: f64 = 2e-3;
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
        let radius_m = number("a").or(number("R"));
        if radius_m.is_some_and(|radius_m| !is_of_earth(radius_m)) {
            return None;
        }
        let is_spherical = value("a").is_some() && value("a") == value("b");
        Some(Self::of(&Parameters {
            spacing: match (is_even, is_spherical) {
                (true, _) => Spacing::Even,
                (false, true) => Spacing::Spherical,
                (false, false) => Spacing::Conformal,
            },
            is_on_wgs84: is_spherical || value("datum") == Some("WGS84"),
            true_scale_deg: number("lat_ts").unwrap_or(0.0),
            origin_latitude_deg: number("lat_0").unwrap_or(0.0),
            scale: number("k").or(number("k_0")),
            central_meridian_deg: number("lon_0").unwrap_or(0.0),
            false_origin_m: [number("x_0").unwrap_or(0.0), number("y_0").unwrap_or(0.0)],
        }))
    }

    /// The projection with the parameters that files have. An equidistant cylindrical one counts northings from its latitude of origin, and is
    /// true to scale on its parallel as on a sphere, as PROJ has it (`eqc`); Mercators count from the equator.
    pub(crate) fn of(parameters: &Parameters) -> Self {
        let Parameters { spacing, is_on_wgs84, central_meridian_deg, false_origin_m: [x_m, y_m], .. } =
            *parameters;
        let is_even = spacing == Spacing::Even;
        let true_scale_rad = parameters.true_scale_deg.to_radians();
        let on_parallel = if is_even { true_scale_rad.cos() } else { Self::equator_scale_of(true_scale_rad) };
        let origin_north_m =
            if is_even { SEMI_MAJOR_M * parameters.origin_latitude_deg.to_radians() } else { 0.0 };
        Mercator {
            spacing,
            is_on_wgs84,
            equator_scale: parameters.scale.filter(|scale| *scale > 0.0 && !is_even).unwrap_or(on_parallel),
            central_meridian_deg,
            false_origin_m: [x_m, y_m - origin_north_m],
        }
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

    /// The projection as PROJ defines it, in metres; without a datum where that is not WGS 84.
    pub(super) fn definition(&self) -> String {
        let Mercator { equator_scale, central_meridian_deg, .. } = self;
        let [x_m, y_m] = self.false_origin_m;
        let frame = format!("+lon_0={central_meridian_deg} +x_0={x_m} +y_0={y_m}");
        let datum = if self.is_on_wgs84 {
            "+datum=WGS84".to_owned()
        } else {
            format!("+a={SEMI_MAJOR_M} +rf={INVERSE_FLATTENING}")
        };
        match self.spacing {
            Spacing::Conformal => format!("+proj=merc +k={equator_scale} {frame} {datum}"),
            // Latitudes of the ellipsoid as if on a sphere, with the word by which PROJ takes them for those of WGS 84.
            Spacing::Spherical => format!(
                "+proj=merc +a={SEMI_MAJOR_M} +b={SEMI_MAJOR_M} +k={equator_scale} {frame}{}",
                if self.is_on_wgs84 { " +nadgrids=@null" } else { "" }
            ),
            Spacing::Even => {
                format!("+proj=eqc +lat_ts={} {frame} {datum}", equator_scale.acos().to_degrees())
            }
        }
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
    fn an_even_spacing_counts_from_its_latitude_of_origin() {
        for (definition, y_m, east) in [
            // By pyproj: 9.01° east, 49.01° north lies at (730.3, 1113.2); ν cos φ / (a cos 49°) there.
            ("+proj=eqc +lat_0=49 +lat_ts=49 +lon_0=9 +datum=WGS84", 1_113.194_907_93, 1.001_711),
            ("+proj=eqc +lat_0=49 +lat_ts=0 +lon_0=9 +datum=WGS84", 1_113.194_907_93, 0.657_181),
        ] {
            let even = crate::crs::Crs::from_proj(definition).unwrap().mercator.unwrap();
            assert_abs_diff_eq!(even.place_deg(0.0, y_m)[1], 49.01, epsilon = 1e-9);
            assert_abs_diff_eq!(even.ground_scale(y_m).east, east, epsilon = 2e-6);
        }
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
