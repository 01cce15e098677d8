//! Reading and writing map files.

pub mod ascii;
pub mod cells;
pub mod geotiff;
pub mod json;
pub mod ros_map;

use std::path::Path;

use crate::{
    Error, Terrain,
    crs::{Crs, warp_command},
};

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
        "asc" => {
            let bytes = bytes()?;
            let text = text(&bytes)?;
            placed_beside(ascii::read(text), text, path)
        }
        "tif" | "tiff" => geotiff::read(&bytes()?, Terrain::MAX_CELLS),
        "yaml" | "yml" => ros_map::read(text(&bytes()?)?, path.parent().unwrap_or(Path::new("."))),
        _ => Err(Error::UnknownFormat { path: path.display().to_string() }),
    }
}

/// A map placed in the system that a `.prj` file beside it names, if there is one that can be read.
fn placed_beside(terrain: Result<Terrain, Error>, ascii: &str, path: &Path) -> Result<Terrain, Error> {
    let beside = ["prj", "PRJ"].iter().find_map(|ending| {
        let bytes = std::fs::read(path.with_extension(ending)).ok()?;
        Crs::parse(text(&bytes).ok()?)
    });
    let header = |key: &str| {
        let mut values = ascii.lines().take(6).filter_map(|line| line.trim().split_once(char::is_whitespace));
        let value = values.find(|(word, _)| word.to_ascii_lowercase().starts_with(key))?.1;
        value.trim().parse::<f64>().ok()
    };
    match (terrain, beside) {
        (Ok(terrain), Some(crs)) => terrain.placed_in(&crs),
        // Degrees make cells that are too small for metres: what is wrong is not their size.
        (Err(Error::CellSize { .. }), Some(Crs { is_geographic: true, text, .. })) => Err(Error::Degrees {
            crs: text.unwrap_or_else(|| "longitude and latitude".into()),
            command: warp_command(header("xll").unwrap_or(0.0), header("yll").unwrap_or(0.0)),
        }),
        (terrain, _) => terrain,
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
