//! Reading and writing map files.

pub mod ascii;
pub mod cells;
pub mod geotiff;
pub mod json;
pub mod ros_map;

use std::path::Path;

use crate::{Error, Terrain};

/// Reads a map file; its ending says which format it is in.
///
/// `.json` grid, `.asc` ESRI ASCII, `.tif`/`.tiff` GeoTIFF, `.yaml`/`.yml` ROS `map_server`.
///
/// # Errors
/// What is wrong with the file, with the place in it.
pub fn read_path(path: &Path) -> Result<Terrain, Error> {
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    let bytes =
        || std::fs::read(path).map_err(|source| Error::Read { path: path.display().to_string(), source });
    match ending.as_str() {
        "json" => json::read(text(&bytes()?)?),
        "asc" => ascii::read(text(&bytes()?)?),
        "tif" | "tiff" => geotiff::read(&bytes()?, Terrain::MAX_CELLS),
        "yaml" | "yml" => ros_map::read(text(&bytes()?)?, path.parent().unwrap_or(Path::new("."))),
        _ => Err(Error::UnknownFormat { path: path.display().to_string() }),
    }
}

/// The bytes as text, without a byte order mark.
///
/// # Errors
/// [`Error::NotText`] with the first byte that is not UTF-8.
pub fn text(bytes: &[u8]) -> Result<&str, Error> {
    let text = std::str::from_utf8(bytes).map_err(|e| Error::NotText { position: e.valid_up_to() })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}
