//! Areas of a file: GeoJSON, or a raster of classes with a table of what each class changes.

use std::{fs, path::Path};

use serde_json::Value;
use terrain::{Terrain, areas::Areas};

use crate::{failure::BadInput, output};

/// Reads areas over a map. What is to be said about them goes to standard error.
///
/// # Errors
/// What is wrong with a file, with its name.
pub(crate) fn read(path: &Path, classes: Option<&Path>, terrain: &Terrain) -> anyhow::Result<Areas> {
    let named = |why: &dyn std::fmt::Display| BadInput(format!("{}: {why}", path.display()));
    let bytes = fs::read(path).map_err(|error| named(&error))?;
    let is_tiff = [&b"II"[..], b"MM"].iter().any(|magic| bytes.starts_with(magic));
    let document = match (is_tiff, classes) {
        (true, None) => {
            let why = "is a raster of classes: say by --area-classes TABLE.json what they change, as {\"80\": {\"keep_out\": true}, \"40\": {\"surface\": \"sandy_loam\"}}";
            return Err(named(&why).into());
        }
        (false, Some(_)) => {
            return Err(named(&"is no GeoTIFF, but --area-classes is for rasters of classes").into());
        }
        (true, Some(table)) => of_classes(&bytes, table, terrain).map_err(|error| named(&error))?,
        (false, None) => serde_json::from_slice(&bytes).map_err(|error| named(&error))?,
    };
    Ok(Areas::of(&document, terrain).map_err(|error| named(&error))?)
}

/// The areas of a raster of classes, as a document.
fn of_classes(tiff: &[u8], table: &Path, terrain: &Terrain) -> anyhow::Result<Value> {
    let named = |why: &dyn std::fmt::Display| BadInput(format!("{}: {why}", table.display()));
    let text = fs::read_to_string(table).map_err(|error| named(&error))?;
    let table = serde_json::from_str(&text).map_err(|error| named(&error))?;
    let areas = Areas::of_classes(tiff, &table, terrain)?;
    for note in &areas.notes {
        output::note(format_args!("warning: {note}"));
    }
    Ok(areas.document)
}
