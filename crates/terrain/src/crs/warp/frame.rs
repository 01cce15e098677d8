//! Where the cells of a raster in degrees lie.

use crate::{Error, Terrain, crs::Size, resample::Affine};

/// A grid of cells in longitude and latitude, counted from its south-west corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct DegreeFrame {
    /// Outer corner of the first cell, longitude and latitude [°].
    pub(crate) south_west_deg: [f64; 2],
    /// Edges of a cell, both above zero [°].
    pub(crate) step_deg: [f64; 2],
    pub(crate) size: Size,
}

impl DegreeFrame {
    /// The frame of a raster whose columns run along parallels and rows along meridians; `None` for a turned one.
    pub(crate) fn of(affine: &Affine, size: Size) -> Option<Self> {
        let [west_deg, south_deg, ..] = affine.bounds(size.columns, size.rows);
        let frame = DegreeFrame { south_west_deg: [west_deg, south_deg], step_deg: affine.edges(), size };
        affine.is_upright().then_some(frame)
    }

    /// The frame of a grid whose size is not checked yet.
    ///
    /// # Errors
    /// No cells, or more than a map may have.
    pub(crate) fn checked(
        south_west_deg: [f64; 2],
        step_deg: [f64; 2],
        [columns, rows]: [u64; 2],
    ) -> Result<Self, Error> {
        /// Any size that a map may have: only the counts are asked about.
        const ANY_M: f64 = 1.0;
        let grid = Terrain::check_size(rows, columns, ANY_M, [0.0; 2])?;
        let size = Size { columns: grid.columns, rows: grid.rows };
        Ok(DegreeFrame { south_west_deg, step_deg, size })
    }

    /// West, south, east and north edge [°].
    pub(super) fn bounds_deg(&self) -> [f64; 4] {
        let [west_deg, south_deg] = self.south_west_deg;
        let [width_deg, height_deg] = self.step_deg;
        let Size { columns, rows } = self.size;
        [west_deg, south_deg, west_deg + columns as f64 * width_deg, south_deg + rows as f64 * height_deg]
    }

    /// Longitude and latitude of the middle [°].
    pub(super) fn middle_deg(&self) -> [f64; 2] {
        let [west_deg, south_deg, east_deg, north_deg] = self.bounds_deg();
        [(west_deg + east_deg) / 2.0, (south_deg + north_deg) / 2.0]
    }

    /// Whether all of it lies between the poles and within a turn of 0° or either side of 180°; half a cell beyond is left to cells that
    /// are centred there.
    pub(super) fn lies_on_globe(&self) -> bool {
        let [west_deg, south_deg, east_deg, north_deg] = self.bounds_deg();
        let [beside_deg, beyond_deg] = self.step_deg.map(|step_deg| step_deg / 2.0);
        let has_area = self.step_deg.iter().all(|step_deg| *step_deg > 0.0);
        has_area
            && west_deg >= -360.0 - beside_deg
            && east_deg <= 360.0 + beside_deg
            && south_deg >= -90.0 - beyond_deg
            && north_deg <= 90.0 + beyond_deg
    }

    /// Longitude, from −180 to 180, and latitude of a position in cells from the corner [°].
    pub(super) fn place_deg(&self, [column, row]: [f64; 2]) -> [f64; 2] {
        let longitude_deg = self.south_west_deg[0] + column * self.step_deg[0];
        let turned_deg = longitude_deg - 360.0 * (longitude_deg / 360.0).round();
        [turned_deg, self.south_west_deg[1] + row * self.step_deg[1]]
    }

    /// The position of a place in cells from the corner, whichever turn the raster counts its longitudes in.
    pub(super) fn position(&self, [longitude_deg, latitude_deg]: [f64; 2]) -> [f64; 2] {
        let turns = ((self.middle_deg()[0] - longitude_deg) / 360.0).round();
        [
            (longitude_deg + 360.0 * turns - self.south_west_deg[0]) / self.step_deg[0],
            (latitude_deg - self.south_west_deg[1]) / self.step_deg[1],
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_comes_back_to_its_position_whichever_way_longitudes_are_counted() {
        for west_deg in [9.0, -94.0, 266.0, 179.5, -180.5] {
            let size = Size { columns: 100, rows: 100 };
            let frame = DegreeFrame { south_west_deg: [west_deg, 46.0], step_deg: [0.01, 0.01], size };
            let place_deg = frame.place_deg([30.0, 70.0]);
            assert!(place_deg[0].abs() <= 180.0);
            let [column, row] = frame.position(place_deg);
            assert!((column - 30.0).abs() < 1e-9 && (row - 70.0).abs() < 1e-9, "{west_deg}: {column}, {row}");
        }
    }
}
