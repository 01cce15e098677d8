//! Coordinates that are degrees of longitude and latitude where metres are needed.

use crate::{Error, Terrain, Warning, WarningKind};

/// Where a raster lies, in a unit that its file does not name.
#[derive(Clone, Copy, Debug)]
pub struct Coordinates {
    /// South-west corner, x and y.
    pub origin: [f64; 2],
    /// Edge of a cell.
    pub cell_size: f64,
    /// Number of rows.
    pub rows: u64,
    /// Number of columns.
    pub columns: u64,
}

impl Coordinates {
    /// Refuses coordinates that can only be degrees: they lie on the globe, and either cells are finer than any ground is
    /// measured ([`Terrain::check_size`] takes 0.01 m at least) or the raster begins exactly at an edge of the globe.
    ///
    /// # Errors
    /// [`Error::Degrees`] with the command that projects the file; `ending` is that of its name.
    pub fn refuse_degrees(&self, ending: &'static str) -> Result<(), Error> {
        let [west, south] = self.origin;
        let is_at_edge = west == -180.0 || south == -90.0;
        let is_fine = self.cell_size > 0.0 && self.cell_size < Terrain::SMALLEST_CELL_M;
        if !self.lie_on_globe() || !(is_at_edge || is_fine) {
            return Ok(());
        }
        Err(self.degrees(ending))
    }

    /// The refusal of coordinates that are degrees, with the command that projects the file.
    pub(crate) fn degrees(&self, ending: &'static str) -> Error {
        let [west, south] = self.origin;
        let epsg = self.utm_epsg();
        Error::Degrees { cell_size: self.cell_size, west, south, ending, epsg }
    }

    /// A warning where coordinates could be degrees and could be metres. A local frame in metres has its origin in the map,
    /// often in a corner or the middle: only rasters that keep clear of (0, 0) are in doubt.
    pub fn unit_warning(&self) -> Option<Warning> {
        let [west, south] = self.origin;
        let [east, north] = self.far_corner();
        let holds_origin = west <= 0.0 && east >= 0.0 && south <= 0.0 && north >= 0.0;
        (self.lie_on_globe() && !holds_origin).then(|| {
            let detail = format!(
                "nothing says whether x {west} to {east} and y {south} to {north} are metres or degrees of longitude and latitude: taken as metres; if they are degrees, project the file to EPSG:{}",
                self.utm_epsg()
            );
            Warning::new(WarningKind::UnknownUnit, detail)
        })
    }

    /// EPSG code of the UTM zone of the middle.
    pub(crate) fn utm_epsg(&self) -> u32 {
        let [longitude_deg, latitude_deg] = self.middle();
        utm_epsg(longitude_deg, latitude_deg)
    }

    fn far_corner(&self) -> [f64; 2] {
        [
            self.origin[0] + self.columns as f64 * self.cell_size,
            self.origin[1] + self.rows as f64 * self.cell_size,
        ]
    }

    fn middle(&self) -> [f64; 2] {
        let far = self.far_corner();
        [(self.origin[0] + far[0]) / 2.0, (self.origin[1] + far[1]) / 2.0]
    }

    /// Whether the raster lies between the poles and within a turn; longitudes are counted from −180 or from 0.
    fn lie_on_globe(&self) -> bool {
        /// Half a cell, by which rasters of cell centres reach beyond the poles and the date line.
        const HALF_A_CELL: f64 = 0.5;
        let margin = HALF_A_CELL * self.cell_size;
        let [west, south] = self.origin;
        let [east, north] = self.far_corner();
        west >= -180.0 - margin && east <= 360.0 + margin && south >= -90.0 - margin && north <= 90.0 + margin
    }
}

/// EPSG code of the UTM zone (WGS 84) of a place; zones are 6° wide and counted from 180° W. Beyond 84° N and 80° S, where
/// there are none, that of the polar stereographic grid (UPS).
pub fn utm_epsg(longitude_deg: f64, latitude_deg: f64) -> u32 {
    if latitude_deg > 84.0 {
        return 32_661;
    }
    if latitude_deg < -80.0 {
        return 32_761;
    }
    let zone = ((longitude_deg + 180.0).rem_euclid(360.0) / 6.0).floor() as u32 + 1;
    if latitude_deg < 0.0 { 32_700 + zone } else { 32_600 + zone }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn coordinates(origin: [f64; 2], cell_size: f64) -> Coordinates {
        Coordinates { origin, cell_size, rows: 100, columns: 100 }
    }

    #[test]
    fn zones_are_those_of_the_map_of_the_world() {
        for (longitude_deg, latitude_deg, epsg) in [
            (9.0, 48.0, 32_632),
            (-93.9, 46.5, 32_615),
            (151.2, -33.9, 32_756),
            (180.0, 10.0, 32_601),
            (0.0, -89.0, 32_761),
        ] {
            assert_eq!(utm_epsg(longitude_deg, latitude_deg), epsg);
        }
    }

    #[test]
    fn only_what_cannot_be_metres_is_refused_and_what_may_not_be_is_said() {
        let refused = |origin, cell_size| coordinates(origin, cell_size).refuse_degrees("asc").is_err();
        assert!(refused([9.0, 48.0], 1.0 / 3600.0) && refused([-180.0, -90.0], 0.25));
        assert!(!refused([9.0, 48.0], 0.25) && !refused([500_000.0, 5_000_000.0], 1.0));
        let doubted = |origin, cell_size| coordinates(origin, cell_size).unit_warning().is_some();
        assert!(doubted([9.0, 48.0], 0.25));
        for (origin, cell_size) in [([0.0, 0.0], 0.05), ([-2.5, -2.5], 0.05), ([500_000.0, 5e6], 1.0)] {
            assert!(!doubted(origin, cell_size), "{origin:?}");
        }
    }
}
