//! Cells in bytes that others sent: held to the same limits as a JSON grid, where those of a store are believed.

use std::sync::Arc;

use super::{LAYERS, LAYERS_AT, MAGIC, read};
use crate::{Error, Terrain, Warning, crs::GridSystem};

/// The number of cells that the first bytes of a map claim, however many follow.
///
/// # Errors
/// Bytes that do not begin as a map.
pub fn claimed(bytes: &[u8]) -> Result<u64, Error> {
    let count = |at: usize| bytes.get(at..at + 8)?.try_into().ok().map(u64::from_le_bytes);
    match (bytes.starts_with(MAGIC), count(4), count(12)) {
        (true, Some(rows), Some(columns)) => Ok(rows.saturating_mul(columns)),
        _ => Err(refused("they must begin with `JPT1`, then rows and columns as u64", 0)),
    }
}

/// Reads cells that were sent; what [`super::write`] wrote is the same map again.
///
/// # Errors
/// The place and the cause of whatever is missing, out of range or left over.
pub fn read_sent(bytes: &[u8]) -> Result<Terrain, Error> {
    claimed(bytes)?;
    let unknown = bytes.get(LAYERS_AT).is_some_and(|layers| layers & !LAYERS != 0);
    if unknown {
        return Err(refused("the byte of layers has a bit that stands for none", LAYERS_AT));
    }
    let mut rest = bytes;
    let read = read(&mut rest);
    let at = bytes.len() - rest.len();
    let sent = read.map_err(|error| refused(&error.to_string(), at))?;
    if !rest.is_empty() {
        return Err(refused("the map ends before they do", at));
    }
    checked(sent)
}

/// The map anew from what was sent, by the checks of every other format.
fn checked(sent: Terrain) -> Result<Terrain, Error> {
    let Terrain { grid, base_m, relative_m, surfaces, obstacle, filled, warnings, areas, crs, .. } = sent;
    let system = GridSystem::of(crs, &grid)?;
    if warnings.len() > Warning::MOST {
        return Err(Error::TooManyWarnings { found: warnings.len(), limit: Warning::MOST });
    }
    let limit = Warning::LONGEST_DETAIL;
    if let Some(index) = warnings.iter().position(|warning| warning.detail.len() > limit) {
        return Err(Error::LongWarning { index, found: warnings[index].detail.len(), limit });
    }
    let elevation_m: Vec<f64> = relative_m.iter().map(|z| f64::from(*z) + base_m).collect();
    let terrain = Terrain { surfaces, obstacle, filled, ..Terrain::new(grid, &elevation_m)? };
    let mut terrain = system.on(terrain);
    let told = Arc::clone(&terrain.warnings);
    terrain.warnings = warnings;
    let new = told.iter().filter(|warning| !terrain.warnings.contains(warning)).cloned();
    let terrain = new.collect::<Vec<_>>().into_iter().fold(terrain, Terrain::with_warning);
    // They were read with the map's place and system.
    Ok(Terrain { areas, ..terrain })
}

fn refused(why: &str, at: usize) -> Error {
    Error::CellBytes { why: why.to_owned(), at }
}
