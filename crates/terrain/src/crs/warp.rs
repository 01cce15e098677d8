//! From a grid of degrees to square cells of metres in the UTM zone of its middle.
//!
//! Heights are bilinear between the source's cell centres. What that changes is measured by reading back, and said.

mod fidelity;
mod footprint;
mod frame;
mod lattice;
mod refusal;
mod unwarped;

pub use self::refusal::WarpRefusal;
use self::{
    fidelity::Fidelity,
    footprint::{bounds_m, edges_m},
    lattice::Lattice,
};
pub(crate) use self::{
    frame::DegreeFrame,
    unwarped::{Regridding, Unwarped},
};
use rayon::prelude::*;

use super::{Crs, Earth, Size, UTM_SCALE_ERROR};
use crate::{
    Error, Grid, Terrain, Warning, WarningKind,
    io::degrees::utm_epsg,
    resample::{Affine, Raster},
};

/// Widest source [°]: a zone and a half. At its edges, 7.5° from a zone's meridian at most, a metre of ground is 1.008 m of UTM at most.
const WIDEST_DEG: f64 = 9.0;

/// Latitudes that UTM is for [°] (NGA.SIG.0012, section 2).
const UTM_LATITUDES_DEG: [f64; 2] = [-80.0, 84.0];

/// Easting of a zone's meridian [m].
const FALSE_EASTING_M: f64 = 500_000.0;

/// Where the cells of a grid of degrees come to lie.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Warp {
    source: DegreeFrame,
    /// Name of the source's system.
    system: String,
    /// Edges of the source's middle cell, east and north [m].
    source_cell_m: [f64; 2],
    /// The UTM zone.
    epsg: u32,
    grid: Grid,
}

impl Warp {
    /// The grid for a source in some system; `ending` is that of the file's name.
    ///
    /// # Errors
    /// A system whose degrees are not those of WGS 84, a place or size beyond what one UTM zone serves, or too many cells.
    pub(crate) fn plan(
        source: DegreeFrame,
        crs: &Crs,
        ending: &'static str,
        most_cells: u64,
    ) -> Result<Self, Error> {
        let [longitude_deg, latitude_deg] = source.middle_deg();
        let epsg = utm_epsg(longitude_deg, latitude_deg);
        let Some(system) = crs.earth_centred_degrees() else {
            let found = crs.text.clone().unwrap_or_else(|| "one of the file's own".into());
            let found = found.chars().take(60).collect();
            return Err(WarpRefusal::System { found, ending, epsg }.into());
        };
        refuse_beyond_zone(&source, ending)?;
        let earth = zone(epsg)?;
        let source_cell_m = edges_m(&source, &earth)?;
        let cell_size_m = three_digits(source_cell_m[0].min(source_cell_m[1]));
        let (min_m, max_m) = Terrain::CELL_SIZE_M;
        if !(min_m..=max_m).contains(&cell_size_m) {
            let cell_deg = source.step_deg[1];
            return Err(WarpRefusal::CellSize { cell_deg, value_m: cell_size_m, min_m, max_m }.into());
        }
        let [west_m, south_m, east_m, north_m] = bounds_m(&source, &earth, epsg)?;
        let origin = [west_m, south_m].map(|edge_m| (edge_m / cell_size_m).floor());
        let count = |far_m: f64, first: f64| ((far_m / cell_size_m).ceil() - first) as u64;
        let (columns, rows) = (count(east_m, origin[0]), count(north_m, origin[1]));
        if columns.saturating_mul(rows) > most_cells {
            return Err(Error::TooManyCells { rows, columns, limit: most_cells });
        }
        let origin_m = origin.map(|cells| cells * cell_size_m);
        let grid = Terrain::check_size(rows, columns, cell_size_m, origin_m)?;
        Ok(Warp { source, system: system.to_owned(), source_cell_m, epsg, grid })
    }

    /// Cells that source and target have together.
    pub(crate) fn cells(&self) -> u64 {
        self.source.size.pixels() + self.grid.cells() as u64
    }

    /// A grid of the source's cells, for what is asked of them before they are warped: square, of the source's mean edge.
    pub(crate) fn source_grid(&self) -> Grid {
        let [width_m, height_m] = self.source_cell_m;
        let Size { columns, rows } = self.source.size;
        Grid { rows, columns, cell_size_m: (width_m * height_m).sqrt(), origin_m: [0.0; 2] }
    }

    /// Ground on metres out of ground on [`Warp::source_grid`], with a warning of what that changed.
    ///
    /// # Errors
    /// A place that the projection does not reach, or no known cell.
    pub(crate) fn apply(&self, source: &Terrain) -> Result<Terrain, Error> {
        let earth = zone(self.epsg)?;
        let grid = self.grid;
        let size = Size { columns: grid.columns, rows: grid.rows };
        let position = |[column, row]: [f64; 2]| {
            let [x_m, y_m] = grid.origin_m;
            let place_m = [x_m + (column + 0.5) * grid.cell_size_m, y_m + (row + 0.5) * grid.cell_size_m];
            Ok(self.source.position(earth.place_deg(place_m).map_err(WarpRefusal::Projection)?))
        };
        let positions = Lattice::of(size, &position)?;
        let raster = source_raster(source);
        let mut relative_m = vec![f32::NAN; grid.cells()];
        relative_m.par_chunks_mut(grid.columns).enumerate().for_each(|(row, cells)| {
            for (column, cell) in cells.iter_mut().enumerate() {
                *cell = raster.between(positions.at(column as f64, row as f64)) as f32;
            }
        });
        drop(positions);
        let base_m = source.base_m();
        let mut terrain = Terrain::from_samples(grid, relative_m, |relative_m| base_m + relative_m)?;
        terrain.crs = Some(format!("EPSG:{}", self.epsg));
        let fidelity = Fidelity::of(&self.source, source, &terrain, &earth)?;
        let warnings = source.warnings().iter().cloned().chain([self.warning(&fidelity)]);
        Ok(warnings.fold(terrain, Terrain::with_warning))
    }

    fn warning(&self, fidelity: &Fidelity) -> Warning {
        let [width_m, height_m] = self.source_cell_m;
        // Systems of WGS 84 itself, in two and in three dimensions; places of others differ by as much as the plates have moved.
        let is_wgs_84 = ["EPSG:4326", "EPSG:4979"].contains(&self.system.as_str());
        let datum =
            if is_wgs_84 { "" } else { ", taken as WGS 84, from which its places differ by up to 2 m" };
        let detail = format!(
            "cells of degrees ({}{datum}; {width_m:.2} × {height_m:.2} m here) were warped to cells of {} m in EPSG:{}, heights bilinear: {fidelity}{}",
            self.system,
            self.grid.cell_size_m,
            self.epsg,
            scale_doubt(&self.grid)
        );
        Warning::new(WarningKind::Warped, detail)
    }
}

/// What is said where a metre of the grid differs from one of the ground by more than it does in the zone itself.
fn scale_doubt(grid: &Grid) -> String {
    let off_m = |x_m: f64| (x_m - FALSE_EASTING_M).abs();
    let largest = utm_scale(off_m(grid.origin_m[0]).max(off_m(grid.far_corner_m()[0])));
    if (largest - 1.0).abs() <= UTM_SCALE_ERROR {
        return String::new();
    }
    format!("; beyond the zone's edges 1 m of ground is up to {largest:.4} m of the map")
}

/// Length in UTM of a metre of ground at a distance east or west of a zone's meridian.
///
/// ```text
/// k = k₀ · (1 + (x / k₀)² / 2R²)
/// ```
///
/// k₀ scale on the meridian, x distance in UTM \[m\], R radius of the earth \[m\]. Snyder (1987), chapter 8, on the sphere to second order: right
/// to 1e-4 within 8° of the meridian.
fn utm_scale(x_m: f64) -> f64 {
    const MERIDIAN_SCALE: f64 = 0.9996;
    /// Mean radius of WGS 84 (NGA.STND.0036, table 3.4).
    const MEAN_RADIUS_M: f64 = 6_371_008.8;
    MERIDIAN_SCALE * (1.0 + (x_m / MERIDIAN_SCALE / MEAN_RADIUS_M).powi(2) / 2.0)
}

fn zone(epsg: u32) -> Result<Earth, WarpRefusal> {
    Earth::of(&format!("EPSG:{epsg}")).map_err(WarpRefusal::Projection)
}

/// The source's samples, placed by their position: columns and rows from its outer corner.
fn source_raster(source: &Terrain) -> Raster<'_, f32> {
    let Grid { rows, columns, .. } = source.grid;
    let affine = Affine { origin: [0.0; 2], column: [1.0, 0.0], row: [0.0, 1.0] };
    Raster { samples: source.relative_m(), columns, rows, affine }
}

/// Refuses what is not on the globe, or what no one UTM zone serves.
fn refuse_beyond_zone(source: &DegreeFrame, ending: &'static str) -> Result<(), WarpRefusal> {
    /// Share of a cell by which written digits may push a raster beyond its limit.
    const WRITTEN_DIGITS: f64 = 1e-6;
    let [west_deg, south_deg, east_deg, north_deg] = source.bounds_deg();
    if !source.lies_on_globe() {
        return Err(WarpRefusal::OffGlobe { west_deg, south_deg, east_deg, north_deg });
    }
    let [margin_east_deg, margin_north_deg] = source.step_deg.map(|step_deg| WRITTEN_DIGITS * step_deg);
    let [lowest_deg, highest_deg] = UTM_LATITUDES_DEG;
    if south_deg < lowest_deg - margin_north_deg || north_deg > highest_deg + margin_north_deg {
        let epsg = if north_deg > highest_deg { 32_661 } else { 32_761 };
        return Err(WarpRefusal::Polar { south_deg, north_deg, ending, epsg });
    }
    let width_deg = east_deg - west_deg;
    if width_deg > WIDEST_DEG + margin_east_deg {
        return Err(WarpRefusal::Wide {
            width_deg,
            west_deg,
            north_deg,
            south_deg,
            widest_deg: WIDEST_DEG,
            ending,
        });
    }
    Ok(())
}

/// A length rounded to three digits, as cell sizes are written: it changes by half a per cent at most.
fn three_digits(length_m: f64) -> f64 {
    let unit = 10f64.powf(length_m.log10().floor() - 2.0);
    let (digits, per_metre) = ((length_m / unit).round(), (1.0 / unit).round());
    // A quotient of whole numbers is the double nearest to what is written.
    if per_metre >= 1.0 { digits / per_metre } else { digits * unit.round() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_is_that_of_utm_on_the_meridian_at_the_edge_and_beyond() {
        // 0.9996 on the meridian, 1 where x is 180 km, by PROJ's factors 1.000 981 at 3° and 1.008 284 at 7.5° of the equator.
        for (x_m, scale, tolerance) in [
            (0.0, 0.9996, 1e-12),
            (180e3, 1.0, 1e-5),
            (333_978.5, 1.000_981, 2e-5),
            (836_972.1, 1.008_284, 1e-4),
        ] {
            assert!((utm_scale(x_m) - scale).abs() < tolerance, "{x_m}: {}", utm_scale(x_m));
        }
    }

    #[test]
    fn cell_sizes_have_three_digits() {
        for (length_m, rounded_m) in
            [(20.683_2, 20.7), (0.099_96, 0.1), (92.766, 92.8), (1.0, 1.0), (9.996, 10.0), (123.4, 123.0)]
        {
            assert_eq!(three_digits(length_m), rounded_m);
        }
    }
}
