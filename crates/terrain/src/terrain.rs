//! Elevation, surfaces and obstacles of one piece of ground.

use std::sync::Arc;

use crate::{
    Cell, Error, Grid, Warning,
    areas::{Areas, UnknownGround, Zones},
    crs::{Earth, EarthError},
    fill_value,
    samples::Survey,
};

/// Ground on a grid. Unknown cells and obstacles are impassable. Clones share their cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Terrain {
    /// Where the cells lie.
    pub grid: Grid,
    /// Elevation that `relative_m` counts from [m].
    pub(crate) base_m: f64,
    /// Elevation above `base_m`, row-major, NaN where unknown [m]. Single precision over the relief only keeps
    /// it to a tenth of a millimetre up to 1.6 km of relief, whatever the height above the sea.
    pub(crate) relative_m: Arc<Vec<f32>>,
    pub(crate) surfaces: Option<Arc<Surfaces>>,
    pub(crate) obstacle: Option<Arc<Vec<bool>>>,
    /// Cells whose elevation was worked out from the ground around a hole.
    pub(crate) filled: Option<Arc<Vec<bool>>>,
    pub(crate) warnings: Arc<Vec<Warning>>,
    pub(crate) areas: Option<Arc<Areas>>,
    /// What unknown ground is taken for where the robot may drive on it.
    pub(crate) unknown_ground: Option<Arc<UnknownGround>>,
    /// What the areas come to, where they have been laid over the ground.
    pub(crate) zones: Option<Arc<Zones>>,
    /// Coordinate reference system whose easting and northing, in metres, are the map's x and y: `EPSG:` and a code, or WKT.
    pub crs: Option<String>,
}

/// What the ground is made of, cell by cell.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Surfaces {
    /// Class names; the classes index them.
    pub names: Vec<String>,
    /// Class of each cell, row-major; [`Surfaces::UNNAMED`] where the map leaves it to the robot's default.
    pub class: Vec<u8>,
}

impl Surfaces {
    /// The class of ground whose surface the map does not name.
    pub const UNNAMED: u8 = u8::MAX;

    /// Collects classes from names in row-major order.
    ///
    /// # Errors
    /// [`Error::TooManySurfaces`] beyond 255 names.
    pub fn from_names<'a>(cells: impl Iterator<Item = Option<&'a str>>) -> Result<Self, Error> {
        let mut surfaces = Surfaces { names: Vec::new(), class: Vec::new() };
        for name in cells {
            let class = surfaces.class_of(name)?;
            surfaces.class.push(class);
        }
        Ok(surfaces)
    }

    /// The class of a name, which is added if it is new.
    pub(crate) fn class_of(&mut self, name: Option<&str>) -> Result<u8, Error> {
        let Some(name) = name else { return Ok(Self::UNNAMED) };
        let known = self.names.iter().position(|n| n == name).unwrap_or_else(|| {
            self.names.push(name.to_owned());
            self.names.len() - 1
        });
        let limit = usize::from(Self::UNNAMED);
        let class = u8::try_from(known).ok().filter(|class| *class != Self::UNNAMED);
        class.ok_or_else(|| Error::TooManySurfaces { name: name.to_owned(), limit })
    }
}

impl Terrain {
    /// Most cells a map may have: 10 000 × 10 000 and some margin, 0.5 GB of elevation.
    pub const MAX_CELLS: u64 = 128_000_000;
    /// Lowest elevation accepted [m]: the deepest ground of Earth (−10 984), Moon (−9 130) and Mars (−8 200) lies above it.
    pub const LOWEST_M: f64 = -11_000.0;
    /// Highest elevation accepted [m]: the highest ground of Mars (21 230), Moon (10 790) and Earth (8 849) lies below it.
    pub const HIGHEST_M: f64 = 22_000.0;
    /// Smallest edge of a cell [m].
    pub const SMALLEST_CELL_M: f64 = 0.01;
    /// Smallest and largest edge of a cell [m].
    pub(crate) const CELL_SIZE_M: (f64, f64) = (Self::SMALLEST_CELL_M, 100.0);
    /// Projected coordinates stay below the circumference of the earth (4.0e7 m), or a million metres for each zone number before them:
    /// Gauss-Krüger zones of 3° are counted to 64 (EPSG:2581).
    const ORIGIN_LIMIT_M: f64 = 6.5e7;

    /// Builds ground from row-major elevations, southernmost row first, NaN where unknown. Conventional fill values that no
    /// ground has ([`fill_value::is_never_ground`]) are unknown too, with a warning.
    ///
    /// # Errors
    /// Any of the grid's numbers out of range, an absurd elevation, or no known cell at all.
    pub fn new(grid: Grid, elevation_m: &[f64]) -> Result<Self, Error> {
        check_grid(&grid)?;
        let survey = Survey::of(&grid, elevation_m, &|z| z)?;
        if elevation_m.len() != grid.cells() {
            return Err(Error::RowCount {
                layer: "elevation_m",
                found: elevation_m.len() / grid.columns,
                expected: grid.rows,
            });
        }
        let lowest_m = survey.lowest_m;
        let relative =
            |z: &f64| if fill_value::is_never_ground(*z) { f32::NAN } else { (z - lowest_m) as f32 };
        let terrain = Self::of_relative(grid, lowest_m, elevation_m.iter().map(relative).collect());
        Ok(match survey.warning() {
            Some(warning) => terrain.with_warning(warning),
            None => terrain,
        })
    }

    /// Ground without anything but elevations, counted from the lowest of them.
    pub(crate) fn of_relative(grid: Grid, base_m: f64, relative_m: Vec<f32>) -> Self {
        Terrain {
            grid,
            base_m,
            relative_m: Arc::new(relative_m),
            surfaces: None,
            obstacle: None,
            filled: None,
            warnings: Arc::default(),
            areas: None,
            unknown_ground: None,
            zones: None,
            crs: None,
        }
    }

    /// Checks rows, columns, cell size and origin before anything of their size is allocated.
    ///
    /// # Errors
    /// The first of them that is out of range.
    pub fn check_size(rows: u64, columns: u64, cell_size_m: f64, origin_m: [f64; 2]) -> Result<Grid, Error> {
        for (field, value) in [("rows", rows), ("columns", columns)] {
            if value == 0 {
                return Err(Error::Empty { field, value });
            }
        }
        if rows.checked_mul(columns).is_none_or(|cells| cells > Self::MAX_CELLS) {
            return Err(Error::TooManyCells { rows, columns, limit: Self::MAX_CELLS });
        }
        let grid = Grid { rows: rows as usize, columns: columns as usize, cell_size_m, origin_m };
        check_grid(&grid)?;
        Ok(grid)
    }

    /// Adds surface classes.
    ///
    /// # Panics
    /// Never: a layer of another size is refused by the readers, and ignored cells keep the default surface.
    pub fn with_surfaces(mut self, surfaces: Surfaces) -> Self {
        debug_assert_eq!(surfaces.class.len(), self.grid.cells());
        self.surfaces = Some(Arc::new(surfaces));
        self
    }

    /// Adds obstacles, row-major.
    pub fn with_obstacles(mut self, obstacle: Vec<bool>) -> Self {
        debug_assert_eq!(obstacle.len(), self.grid.cells());
        self.obstacle = Some(Arc::new(obstacle));
        self
    }

    /// Whether another has the same cells, elevations to the last bit, surfaces, obstacles and rules.
    pub fn is_same_ground(&self, other: &Self) -> bool {
        let elevations = || self.relative_m.iter().zip(other.relative_m.iter());
        self.grid == other.grid
            && self.base_m == other.base_m
            && self.surfaces == other.surfaces
            && self.obstacle == other.obstacle
            && self.unknown_ground == other.unknown_ground
            && self.zones == other.zones
            && (Arc::ptr_eq(&self.relative_m, &other.relative_m)
                || elevations().all(|(a, b)| a.to_bits() == b.to_bits()))
    }

    /// Elevation of a cell, if it is known [m].
    pub fn elevation_m(&self, cell: Cell) -> Option<f64> {
        let relative_m = self.relative_m[self.grid.index(cell)];
        (!relative_m.is_nan()).then(|| self.base_m + f64::from(relative_m))
    }

    /// Where on earth the map's metres are.
    ///
    /// # Errors
    /// A map without a system, or with one that is not known to the millimetre.
    pub fn earth(&self) -> Result<Earth, EarthError> {
        Earth::of(self.crs.as_deref().ok_or(EarthError::NoCrs)?)
    }

    /// The place of the map at a longitude and latitude in degrees [m].
    ///
    /// # Errors
    /// As [`Terrain::earth`], a place beyond the projection's area, or one off the map that lies on it with both numbers exchanged.
    pub fn place_m(&self, place_deg: [f64; 2]) -> Result<[f64; 2], EarthError> {
        let earth = self.earth()?;
        let place = earth.place_m(place_deg);
        let is_on_map = |place: &Result<[f64; 2], EarthError>| {
            place.as_ref().is_ok_and(|[x_m, y_m]| self.grid.cell_at(*x_m, *y_m).is_some())
        };
        let [lon_deg, lat_deg] = place_deg;
        if !is_on_map(&place) && is_on_map(&earth.place_m([lat_deg, lon_deg])) {
            return Err(EarthError::OtherWayRound { lon_deg, lat_deg });
        }
        place
    }

    /// Lowest known elevation [m].
    pub fn base_m(&self) -> f64 {
        self.base_m
    }

    /// Elevations above [`Terrain::base_m`], row-major, NaN where unknown [m].
    pub fn relative_m(&self) -> &[f32] {
        &self.relative_m
    }

    /// Whether nothing may stand on a cell: unknown ground or an obstacle.
    pub fn is_blocked(&self, cell: Cell) -> bool {
        let index = self.grid.index(cell);
        self.relative_m[index].is_nan() || self.obstacle.as_ref().is_some_and(|o| o[index])
    }

    /// Obstacles, row-major, if the map has any.
    pub fn obstacles(&self) -> Option<&[bool]> {
        self.obstacle.as_ref().map(|o| o.as_slice())
    }

    /// Cells whose elevation was worked out from the ground around a hole, row-major, if there are any.
    pub fn filled(&self) -> Option<&[bool]> {
        self.filled.as_ref().map(|filled| filled.as_slice())
    }

    /// Marks cells whose elevation was worked out from the ground around a hole, row-major.
    pub(crate) fn with_filled(mut self, filled: Vec<bool>) -> Self {
        debug_assert_eq!(filled.len(), self.grid.cells());
        self.filled = Some(Arc::new(filled));
        self
    }

    /// Doubts about the map and what was done to it.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

    /// Adds a warning, in place of one of its kind.
    pub fn with_warning(mut self, warning: Warning) -> Self {
        let warnings = Arc::make_mut(&mut self.warnings);
        warnings.retain(|other| other.kind != warning.kind);
        warnings.push(warning);
        self
    }

    /// Surface classes, if the map has any.
    pub fn surfaces(&self) -> Option<&Surfaces> {
        self.surfaces.as_deref()
    }

    /// Class of a cell's surface: an index into the names, or [`Surfaces::UNNAMED`].
    pub fn surface_class(&self, cell: Cell) -> u8 {
        self.surfaces.as_ref().map_or(Surfaces::UNNAMED, |s| s.class[self.grid.index(cell)])
    }

    /// Elevation between cell centres, bilinear [m]; `None` where one of the four is unknown or outside.
    pub fn elevation_at_m(&self, x_m: f64, y_m: f64) -> Option<f64> {
        let grid = &self.grid;
        let column = (x_m - grid.origin_m[0]) / grid.cell_size_m - 0.5;
        let row = (y_m - grid.origin_m[1]) / grid.cell_size_m - 0.5;
        let (column_0, row_0) = (column.floor(), row.floor());
        let (east, north) = (column - column_0, row - row_0);
        let mut sum_m = 0.0;
        for (dr, weight_y) in [(0.0, 1.0 - north), (1.0, north)] {
            for (dc, weight_x) in [(0.0, 1.0 - east), (1.0, east)] {
                let weight = weight_x * weight_y;
                if weight == 0.0 {
                    continue;
                }
                let (r, c) = (row_0 + dr, column_0 + dc);
                if !(r >= 0.0 && c >= 0.0 && r < grid.rows as f64 && c < grid.columns as f64) {
                    return None;
                }
                sum_m += weight * self.elevation_m(Cell { row: r as usize, column: c as usize })?;
            }
        }
        Some(sum_m)
    }

    /// Content hash of everything that a plan depends on, as 32 hexadecimal digits: 128 bits of its SHA-256.
    pub fn content_id(&self) -> String {
        use sha2::{Digest, Sha256};
        let mut hash = Sha256::new();
        let grid = &self.grid;
        hash.update((grid.rows as u64).to_le_bytes());
        hash.update((grid.columns as u64).to_le_bytes());
        for number in [grid.cell_size_m, grid.origin_m[0], grid.origin_m[1], self.base_m] {
            hash.update(number.to_le_bytes());
        }
        for z in self.relative_m.iter() {
            hash.update(z.to_bits().to_le_bytes());
        }
        if let Some(surfaces) = &self.surfaces {
            for name in &surfaces.names {
                hash.update((name.len() as u64).to_le_bytes());
                hash.update(name.as_bytes());
            }
            hash.update(&surfaces.class);
        }
        if let Some(obstacle) = &self.obstacle {
            hash.update(b"obstacle");
            for &o in obstacle.iter() {
                hash.update([u8::from(o)]);
            }
        }
        if let Some(filled) = &self.filled {
            hash.update(b"filled");
            for &f in filled.iter() {
                hash.update([u8::from(f)]);
            }
        }
        for warning in self.warnings.iter() {
            hash.update(b"warning");
            hash.update((warning.detail.len() as u64).to_le_bytes());
            hash.update(warning.detail.as_bytes());
        }
        if let Some(crs) = &self.crs {
            hash.update(b"crs");
            hash.update(crs.as_bytes());
        }
        if let Some(areas) = &self.areas {
            hash.update(b"areas");
            hash.update(areas.text().as_bytes());
        }
        hash.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect()
    }
}

fn check_grid(grid: &Grid) -> Result<(), Error> {
    let (min, max) = Terrain::CELL_SIZE_M;
    if !(min..=max).contains(&grid.cell_size_m) {
        return Err(Error::CellSize { value: grid.cell_size_m, min, max });
    }
    for (axis, &value) in grid.origin_m.iter().enumerate() {
        if !value.is_finite() || value.abs() > Terrain::ORIGIN_LIMIT_M {
            return Err(Error::Origin { axis, value, limit: Terrain::ORIGIN_LIMIT_M });
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use approx::assert_relative_eq;

    use super::*;
    use crate::WarningKind;

    fn plane() -> Terrain {
        let grid = Grid { rows: 4, columns: 6, cell_size_m: 0.5, origin_m: [0.0, 0.0] };
        let elevation_m: Vec<f64> =
            (0..24).map(|i| grid.center_m(grid.cell(i))).map(|[x, y]| 1000.0 + 0.1 * x - 0.2 * y).collect();
        Terrain::new(grid, &elevation_m).unwrap()
    }

    #[test]
    fn bilinear_elevation_is_exact_on_a_plane_and_at_centres() {
        let terrain = plane();
        for (x, y) in [(0.25, 0.25), (1.1, 0.9), (2.75, 1.75)] {
            assert_relative_eq!(
                terrain.elevation_at_m(x, y).unwrap(),
                1000.0 + 0.1 * x - 0.2 * y,
                epsilon = 1e-6
            );
        }
        assert_eq!(terrain.elevation_at_m(0.1, 0.3), None, "beyond the outermost centres nothing is known");
    }

    #[test]
    fn absurd_heights_are_refused_with_their_cell() {
        let grid = Grid { rows: 2, columns: 2, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        for bad in [-12_345.0, 40_000.0, 1e6, f64::INFINITY] {
            let error = Terrain::new(grid, &[0.0, 1.0, 2.0, bad]).unwrap_err();
            assert_eq!(error.field().as_deref(), Some("elevation_m[1][1]"), "{error}");
        }
        assert!(matches!(Terrain::new(grid, &[f64::NAN; 4]), Err(Error::AllUnknown)));
        assert!(matches!(Terrain::new(grid, &[-9999.0; 4]), Err(Error::AllUnknown)));
    }

    #[test]
    fn unmarked_nodata_is_unknown_ground_and_said() {
        let grid = Grid { rows: 2, columns: 2, cell_size_m: 1.0, origin_m: [0.0, 0.0] };
        for mark in [-9999.0, -32768.0, f64::from(f32::MIN), -3.40282e38, 1e30] {
            let terrain = Terrain::new(grid, &[5.0, mark, 6.0, mark]).unwrap();
            assert_eq!((terrain.base_m(), terrain.elevation_m(Cell { row: 1, column: 1 })), (5.0, None));
            let [warning] = terrain.warnings() else { panic!("{:?}", terrain.warnings()) };
            assert_eq!(warning.kind, WarningKind::UnmarkedNodata);
            assert!(warning.detail.starts_with("2 cells"), "{}", warning.detail);
        }
    }

    #[test]
    fn the_content_id_changes_with_every_layer_and_only_with_content() {
        let a = plane();
        assert_eq!(a.content_id(), plane().content_id());
        let obstacles = plane().with_obstacles(vec![false; 24]);
        assert_ne!(a.content_id(), obstacles.content_id());
        let surfaces = Surfaces { names: vec!["grass".into()], class: vec![0; 24] };
        assert_ne!(a.content_id(), plane().with_surfaces(surfaces).content_id());
        let placed = Terrain { crs: Some("EPSG:32632".into()), ..plane() };
        assert_ne!(a.content_id(), placed.content_id());
    }
}
