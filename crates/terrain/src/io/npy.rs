//! The array of numpy (`.npy`): elevations alone, row 0 the southernmost as in a JSON grid, NaN where unknown.
//!
//! The header is read here: crates that read it parse any Python literal, for which they take a dozen crates more and the memory
//! that a header claims, up to 4 GB. Pickled objects are never read.

mod dtype;
mod error;
mod header;
mod literal;

use self::{
    dtype::{Dtype, Elements},
    header::Header,
};
pub use self::{error::NpyError, header::is_npy};
use super::Options;
use crate::{Error, Grid, Terrain, crs::GridSystem, fill_value};

/// The number of cells that an array's header claims, however many follow.
///
/// # Errors
/// Bytes that do not begin as a table of numbers.
pub fn claimed(bytes: &[u8]) -> Result<u64, Error> {
    Ok(Header::read(bytes)?.elements())
}

/// Reads an array of two axes, in C or Fortran order, on the cells that the options' georeference says.
///
/// # Errors
/// Another file, an array that is no table of real numbers, truncation, no cell size, or an elevation out of range by its place.
pub fn read(bytes: &[u8], options: &Options) -> Result<Terrain, Error> {
    let header = Header::read(bytes)?;
    let (rows, columns) = (header.rows, header.columns);
    if header.elements() > options.most_cells {
        return Err(Error::TooManyCells { rows, columns, limit: options.most_cells });
    }
    let place = &options.georeference;
    let cell_size_m = place.cell_size_m.ok_or(NpyError::NoCellSize)?;
    let grid = Terrain::check_size(rows, columns, cell_size_m, place.origin_m.unwrap_or_default())?;
    let system = GridSystem::of(place.crs.clone(), &grid)?;
    let fortran_rows = header.is_fortran_order.then_some(grid.rows);
    let elements = Elements { bytes: header.elements_of(bytes)?, fortran_rows };
    let terrain = terrain(grid, header.dtype, elements, options)?;
    let terrain = system.on(terrain).as_asked(options)?;
    Ok(if header.dtype.bytes() == 1 { terrain.with_doubt_of_bytes() } else { terrain })
}

/// Ground of an array's elements. Nodata that no ground has is unknown before elevations are checked.
fn terrain(grid: Grid, dtype: Dtype, elements: Elements<'_>, options: &Options) -> Result<Terrain, Error> {
    let mark = options.nodata_m.filter(|mark| !Terrain::holds(*mark));
    let elevation_m =
        |z: f64| if mark.is_some_and(|mark| fill_value::is_mark(z, mark)) { f64::NAN } else { z };
    let terrain = if dtype.is_exact_in_single() {
        Terrain::from_samples(grid, dtype.singles(elements), elevation_m)
    } else {
        Terrain::from_samples(grid, dtype.doubles(elements), elevation_m)
    };
    terrain.map_err(|error| match error {
        Error::Elevation { row, column, value, min, max } => {
            NpyError::Elevation { row, column, value, min, max }.into()
        }
        other => other,
    })
}
