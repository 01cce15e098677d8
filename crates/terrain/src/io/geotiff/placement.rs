//! The grid that a raster becomes: metres of the ground, square cells, north up; or the refusal that says how to bring it there.

use crate::{
    Error, Grid, Terrain, Warning, WarningKind,
    crs::{Crs, DegreeFrame, Regridding, Size, UNTOLD_CELLS, Warp, WarpRefusal, to_ground},
    resample::{Affine, Resampling},
};

/// Edge below which pixels of a file without a system, within the bounds of degrees, are taken for degrees.
const DEGREE_PIXEL: f64 = 0.1;

/// The grid of a map and how pixels come to its cells.
#[derive(Debug)]
pub(super) struct Placement {
    /// The grid of the file's own pixels.
    pub(super) grid: Grid,
    pub(super) arrangement: Arrangement,
    pub(super) crs: Option<String>,
    /// The way to the map's cells, where these are not the file's pixels.
    pub(super) regridding: Option<Regridding>,
}

/// From which ends rows and columns have to be taken to begin in the south-west.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Arrangement {
    pub(super) rows_from_north: bool,
    pub(super) columns_from_east: bool,
}

impl Placement {
    /// Places a raster in metres of the ground; `is_named` says whether anything names its system. What had to be assumed or changed is added to the warnings.
    ///
    /// # Errors
    /// Degrees, a scale that changes over the map, or a grid that no map may have.
    pub(super) fn of(
        affine: Affine,
        size: Size,
        (is_named, crs): (bool, &Crs),
        most_cells: u64,
        warnings: &mut Vec<Warning>,
    ) -> Result<Self, Error> {
        if crs.is_geographic {
            return Self::warped(&affine, size, crs, most_cells);
        }
        if !is_named {
            doubt_nameless(&affine, size, warnings)?;
        }
        let (affine, text) = to_ground(affine, size, crs, "tif", warnings)?;
        lay_out(affine, size, text, warnings)
    }

    /// Refuses a map of more cells than so many.
    ///
    /// # Errors
    /// [`Error::TooManyCells`].
    pub(super) fn refuse_many(&self, most_cells: u64) -> Result<(), Error> {
        let grid = match &self.regridding {
            Some(Regridding::Resample(resampling)) => resampling.grid,
            _ => self.grid,
        };
        let (rows, columns) = (grid.rows as u64, grid.columns as u64);
        let too_many = Error::TooManyCells { rows, columns, limit: most_cells };
        if rows.saturating_mul(columns) > most_cells { Err(too_many) } else { Ok(()) }
    }

    /// Numbers that are held at once to read so large a raster and bring it to its cells.
    pub(super) fn numbers(&self, size: Size) -> u64 {
        self.regridding.as_ref().map_or(size.pixels(), Regridding::cells)
    }

    /// Places pixels of degrees, whose samples are first read onto a grid of their own.
    fn warped(affine: &Affine, size: Size, crs: &Crs, most_cells: u64) -> Result<Self, Error> {
        let Some(frame) = DegreeFrame::of(affine, size) else {
            let epsg = affine.coordinates(size).utm_epsg();
            return Err(WarpRefusal::Turned { ending: "tif", epsg }.into());
        };
        let warp = Warp::plan(frame, crs, "tif", most_cells)?;
        let (grid, arrangement) = (warp.source_grid(), Arrangement::of(affine));
        Ok(Placement { grid, arrangement, crs: None, regridding: Some(Regridding::Warp(warp)) })
    }
}

impl Arrangement {
    /// That of an upright raster's pixels; those of a turned one are left as they come.
    fn of(affine: &Affine) -> Self {
        if !affine.is_upright() {
            return Arrangement::default();
        }
        Arrangement { rows_from_north: affine.row[1] < 0.0, columns_from_east: affine.column[0] < 0.0 }
    }
}

/// Refuses a file without any system whose coordinates are plainly degrees, and doubts one that may be in metres.
fn doubt_nameless(affine: &Affine, size: Size, warnings: &mut Vec<Warning>) -> Result<(), Error> {
    let coordinates = affine.coordinates(size);
    coordinates.refuse_degrees("tif")?;
    let doubt = coordinates.unit_warning();
    if doubt.is_some() && affine.edges().iter().all(|edge| *edge < DEGREE_PIXEL) {
        return Err(coordinates.degrees("tif"));
    }
    warnings.extend(doubt);
    Ok(())
}

/// The grid of a raster in metres of the ground.
fn lay_out(
    affine: Affine,
    size: Size,
    crs: Option<String>,
    warnings: &mut Vec<Warning>,
) -> Result<Placement, Error> {
    let arrangement = Arrangement::of(&affine);
    /// Relative difference of a pixel's edges that comes of the digits they are written with.
    const WRITTEN_DIGITS: f64 = 1e-6;
    let [west_m, south_m, east_m, north_m] = affine.bounds(size.columns, size.rows);
    let [width_m, height_m] = affine.edges();
    let (columns, rows) = (size.columns as u64, size.rows as u64);
    let longest = columns.max(rows) as f64;
    let same = (width_m - height_m).abs() <= WRITTEN_DIGITS * width_m;
    let cell_size_m = if same { width_m } else { (width_m * height_m).sqrt() };
    let displaced =
        ((width_m - cell_size_m).abs()).max((height_m - cell_size_m).abs()) / cell_size_m * longest;
    if affine.is_upright() && (same || displaced <= UNTOLD_CELLS) {
        if !same {
            let detail =
                format!("pixels of {width_m} × {height_m} m were taken as square ones of {cell_size_m} m");
            warnings.push(Warning::new(WarningKind::Interpolated, detail));
        }
        let origin_m = [west_m, south_m];
        let grid = Terrain::check_size(rows, columns, cell_size_m, origin_m)?;
        return Ok(Placement { grid, arrangement, crs, regridding: None });
    }
    let count = |length_m: f64| (length_m / cell_size_m + WRITTEN_DIGITS).floor().max(1.0) as u64;
    let (columns, rows) = (count(east_m - west_m), count(north_m - south_m));
    let grid = Terrain::check_size(rows, columns, cell_size_m, [west_m, south_m])?;
    let shape = if affine.is_upright() { "oblong" } else { "turned" };
    let detail = format!(
        "pixels are {shape} ({width_m:.4} × {height_m:.4} m): elevations were interpolated onto cells of {cell_size_m:.4} m, north up"
    );
    warnings.push(Warning::new(WarningKind::Interpolated, detail));
    let from_end = |is_from_end: bool, count: usize| is_from_end.then_some(count);
    let affine = affine.counted_from(
        from_end(arrangement.columns_from_east, size.columns),
        from_end(arrangement.rows_from_north, size.rows),
    );
    let resampling = Resampling { affine, grid, crs };
    let grid = resampling.source_grid(size.columns, size.rows);
    Ok(Placement { grid, arrangement, crs: None, regridding: Some(Regridding::Resample(resampling)) })
}
