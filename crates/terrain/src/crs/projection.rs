//! Projections by their PROJ definition, and how long their metres are on the ground.

use proj4rs::{Proj, transform::transform};

use super::mercator::{ECCENTRICITY_2, SEMI_MAJOR_M, is_of_earth};

/// A projection as PROJ defines it.
#[derive(Clone, Debug, PartialEq)]
pub struct Projection {
    /// The definition, as `+proj=stere +lat_0=90 +lat_ts=70 +datum=WGS84`.
    pub(super) definition: String,
    /// Metres of the map by metres of the projection, along x and y; 1 but for a map whose coordinates were multiplied.
    pub(super) multiplied_by: [f64; 2],
}

/// Lengths on the ground by lengths on the map, along the map's axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AxisScale {
    pub(crate) x: f64,
    pub(crate) y: f64,
    /// Cosine of the angle on the ground between the map's axes: 0 where they stand upright on each other.
    pub(crate) shear: f64,
}

impl AxisScale {
    /// The mean of both directions.
    pub(crate) fn mean(&self) -> f64 {
        (self.x * self.y).sqrt()
    }

    /// Difference of the directions, in length or from a right angle.
    pub(crate) fn unevenness(&self) -> f64 {
        (self.x / self.y - 1.0).abs().max(self.shear.abs())
    }

    /// Largest difference from metres of the ground.
    pub(crate) fn departure(&self) -> f64 {
        (self.x - 1.0).abs().max((self.y - 1.0).abs()).max(self.shear.abs())
    }
}

/// Keys of what a geographic system shares with a projected one: the ellipsoid.
const ELLIPSOID: [&str; 7] = ["+datum=", "+ellps=", "+a=", "+b=", "+R=", "+rf=", "+f="];

/// Keys of shifts between datums, which change no scale, and of units: coordinates are metres here.
const LEFT_OUT: [&str; 6] = ["+towgs84=", "+nadgrids=", "+units=", "+to_meter=", "+vunits=", "+vto_meter="];

impl Projection {
    /// The projection of a definition.
    pub(super) fn of(definition: impl Into<String>) -> Self {
        Projection { definition: definition.into(), multiplied_by: [1.0; 2] }
    }

    /// PROJ's name of it.
    pub(crate) fn name(&self) -> &str {
        let mut words = self.definition.split_ascii_whitespace();
        words.find_map(|word| word.strip_prefix("+proj=")).unwrap_or_default()
    }

    /// Whether a coordinate runs west or south instead of east or north.
    pub(crate) fn is_south_orientated(&self) -> bool {
        let mut words = self.definition.split_ascii_whitespace();
        let axes = words.find_map(|word| word.strip_prefix("+axis=")).unwrap_or_default();
        axes.contains(['w', 's'])
    }

    /// Whether its ellipsoid is one of the earth's. Those that have a name all are; other bodies come with lengths.
    pub(crate) fn is_of_earth(&self) -> bool {
        let mut words = self.definition.split_ascii_whitespace();
        let radius = words.find_map(|word| word.strip_prefix("+a=").or_else(|| word.strip_prefix("+R=")));
        radius.is_none_or(|radius| radius.parse().is_ok_and(is_of_earth))
    }

    /// Largest difference of a metre from one of the ground at some places of a Cassini projection, which is true to scale along x; `None` for all
    /// others.
    ///
    /// ```text
    /// dN / dy = cos(x / R)    x distance from the central meridian
    /// ```
    ///
    /// Snyder (1987), eqs 13-1 and 13-2, on the sphere; by PROJ 9.5 it is right to 1e-7 20 km off the meridian.
    pub(super) fn cassini_departure(&self, places_m: &[[f64; 2]]) -> Option<f64> {
        let mut words = self.definition.split_ascii_whitespace();
        let false_easting_m =
            words.find_map(|word| word.strip_prefix("+x_0=")?.parse::<f64>().ok()).unwrap_or(0.0);
        let off_m = places_m.iter().map(|[x_m, _]| (x_m - false_easting_m).abs()).fold(0.0, f64::max);
        (self.name() == "cass").then(|| 1.0 - (off_m / SEMI_MAJOR_M).cos())
    }

    /// The way to longitude and latitude on its own datum; `None` for a projection that is not computed here.
    pub(crate) fn conversion(&self) -> Option<Conversion> {
        if !self.is_of_earth() {
            return None;
        }
        let is_one_of = |word: &str, keys: &[&str]| keys.iter().any(|key| word.starts_with(key));
        // Datums that are found by grids of corrections are left to their ellipsoid too.
        let definition = self.definition.replace("+datum=NAD27", "+ellps=clrk66");
        let words = || definition.split_ascii_whitespace();
        let projected: Vec<&str> = words().filter(|word| !is_one_of(word, &LEFT_OUT)).collect();
        let ellipsoid: Vec<&str> = words().filter(|word| is_one_of(word, &ELLIPSOID)).collect();
        let geographic = format!("+proj=longlat {} +no_defs", ellipsoid.join(" "));
        Some(Conversion {
            projected: Proj::from_proj_string(&projected.join(" ")).ok()?,
            geographic: Proj::from_proj_string(&geographic).ok()?,
            multiplied_by: self.multiplied_by,
        })
    }
}

/// The way from a projection to longitude and latitude on its own datum.
pub(crate) struct Conversion {
    projected: Proj,
    geographic: Proj,
    multiplied_by: [f64; 2],
}

impl Conversion {
    /// Longitude and latitude of a place of the map [°]; `None` beyond the projection's area.
    pub(crate) fn place_deg(&self, [x_m, y_m]: [f64; 2]) -> Option<[f64; 2]> {
        let [by_x, by_y] = self.multiplied_by;
        let mut point = (x_m / by_x, y_m / by_y, 0.0);
        transform(&self.projected, &self.geographic, &mut point).ok()?;
        let place_deg = [point.0.to_degrees(), point.1.to_degrees()];
        (place_deg[0].is_finite() && place_deg[1].abs() <= 90.0).then_some(place_deg)
    }

    /// Ground by map at a place, along the map's axes, by central differences of the conversion; `None` beyond the projection's area.
    ///
    /// ```text
    /// dE = ν cos φ dλ    ν = a / √(1 − e² sin² φ)
    /// dN = ρ dφ          ρ = ν (1 − e²) / (1 − e² sin² φ)
    /// ```
    ///
    /// Snyder (1987), Map Projections: A Working Manual, eqs 4-18 and 4-20, doi:10.3133/pp1395, on WGS 84. Other ellipsoids change a
    /// scale by less than 1e-4, spheres by up to e².
    pub(crate) fn axis_scale(&self, [x_m, y_m]: [f64; 2]) -> Option<AxisScale> {
        /// Half of the difference [m]: a conversion good to 1e-11 rad leaves 1e-6 of it.
        const HALF_STEP_M: f64 = 50.0;
        let [_, latitude_deg] = self.place_deg([x_m, y_m])?;
        let latitude_rad = latitude_deg.to_radians();
        let flattening = 1.0 - ECCENTRICITY_2 * latitude_rad.sin().powi(2);
        let nu_m = SEMI_MAJOR_M / flattening.sqrt();
        let rho_m = nu_m * (1.0 - ECCENTRICITY_2) / flattening;
        let ground = |from: [f64; 2], to: [f64; 2]| {
            let ([from_deg, to_deg], length_m) =
                ([self.place_deg(from)?, self.place_deg(to)?], 2.0 * HALF_STEP_M);
            let turned_deg = to_deg[0] - from_deg[0];
            let turned_rad = (turned_deg - 360.0 * (turned_deg / 360.0).round()).to_radians();
            let north_rad = (to_deg[1] - from_deg[1]).to_radians();
            Some([nu_m * latitude_rad.cos() * turned_rad / length_m, rho_m * north_rad / length_m])
        };
        let along_x = ground([x_m - HALF_STEP_M, y_m], [x_m + HALF_STEP_M, y_m])?;
        let along_y = ground([x_m, y_m - HALF_STEP_M], [x_m, y_m + HALF_STEP_M])?;
        let (x, y) = (along_x[0].hypot(along_x[1]), along_y[0].hypot(along_y[1]));
        let shear = (along_x[0] * along_y[0] + along_x[1] * along_y[1]) / (x * y);
        let scale = AxisScale { x, y, shear };
        [x, y, shear].iter().all(|number| number.is_finite()).then_some(scale)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::crs::Crs;

    fn scale(code: u32, place_m: [f64; 2]) -> AxisScale {
        let projection = Crs::from_epsg(code).projection.unwrap();
        projection.conversion().unwrap().axis_scale(place_m).unwrap()
    }

    #[test]
    fn conformal_projections_have_the_scale_that_proj_has_in_both_directions() {
        // Meridional scale by PROJ 9.5 (Proj.get_factors): map by ground.
        for (code, place_m, by_proj) in [
            (5041, [2_591_424.98, -1_354_137.74], 1.065_302),
            (3413, [0.0, -3_323_160.27], 1.039_428),
            (3031, [-2_457_024.46, 1_595_610.34], 1.026_667),
            (3067, [175_799.85, 6_777_654.09], 1.000_888),
            (2154, [1_197_656.7, 6_118_854.94], 1.002_075),
            (3978, [1_578_125.61, -198_241.99], 1.017_437),
        ] {
            let AxisScale { x, y, shear } = scale(code, place_m);
            assert!((x * by_proj - 1.0).abs() < 3e-6, "EPSG:{code}: {x}");
            assert!((y / x - 1.0).abs() < 1e-6 && shear.abs() < 1e-6, "EPSG:{code}: {x} {y} {shear}");
        }
    }

    #[test]
    fn equal_area_projections_stretch_one_direction_by_as_much_as_they_shrink_the_other() {
        // Along the axes where these are parallel and meridian: 1 / k and 1 / h of PROJ's factors.
        for (code, place_m, [x, y]) in [
            (6933, [964_862.8, 6_351_420.0], [1.0 / 1.729_145, 1.0 / 0.578_321]),
            (3035, [4_321_000.0, 2_765_157.5], [1.0 / 1.000_534, 1.0 / 0.999_467]),
        ] {
            let found = scale(code, place_m);
            assert!(
                (found.x / x - 1.0).abs() < 3e-6 && (found.y / y - 1.0).abs() < 3e-6,
                "{code}: {found:?}"
            );
        }
        // Tissot's axes by PROJ, 1.0369 and 0.9644, lie across those of the map.
        let oblique = scale(3035, [1_759_253.33, 989_737.76]);
        assert!(oblique.unevenness() > 0.03 && (oblique.x * oblique.y - 1.0).abs() < 0.01, "{oblique:?}");
    }

    #[test]
    fn what_is_not_computed_or_beyond_its_area_has_no_scale() {
        assert!(Crs::from_epsg(8857).projection.unwrap().conversion().is_none(), "Equal Earth");
        let conversion = Crs::from_epsg(32_632).projection.unwrap().conversion().unwrap();
        assert_eq!(conversion.axis_scale([1e9, 1e9]), None);
    }
}
