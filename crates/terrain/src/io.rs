//! Reading and writing map files.

pub mod ascii;
pub mod cells;
pub mod degrees;
mod georeference;
pub mod geotiff;
mod heights;
pub mod hgt;
pub mod json;
pub mod npy;
pub mod ros_map;

use std::{
    fs,
    io::{Cursor, Read},
    path::Path,
};

use flate2::read::MultiGzDecoder;
use tiff::{ColorType, decoder::Decoder};

pub use self::georeference::Georeference;
use crate::{Error, Terrain, crs::Unwarped};

/// How a map is to be read.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Most cells. Default: [`Terrain::MAX_CELLS`].
    pub most_cells: u64,
    /// Elevation of unknown cells, beside those that the file marks [m].
    pub nodata_m: Option<f64>,
    /// Holes of unknown ground up to this wide are filled [m]: see [`Terrain::with_filled_voids`].
    pub fill_voids_m: Option<f64>,
    /// Frame of an array, whose file holds none; any other file is refused with one.
    pub georeference: Georeference,
}

impl Default for Options {
    fn default() -> Self {
        Options {
            most_cells: Terrain::MAX_CELLS,
            nodata_m: None,
            fill_voids_m: None,
            georeference: Georeference::default(),
        }
    }
}

/// A format that one file has alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// JSON grid.
    Json,
    /// ESRI ASCII grid.
    Ascii,
    /// GeoTIFF.
    GeoTiff,
    /// Cells in bytes: see [`cells`].
    Cells,
    /// Array of numpy.
    Npy,
}

/// Most bytes that a packed text is unpacked to: 24 for each cell of the largest map, as `%.15g` and a blank take.
const MOST_UNPACKED_BYTES: u64 = 24 * Terrain::MAX_CELLS;

/// Reads a map file; its ending says which format it is in. Files beside it that belong to it are read too: `.prj` beside `.asc`, and
/// [`geotiff::Sidecars`].
///
/// `.json` grid, `.asc` and `.asc.gz` ESRI ASCII, `.tif`/`.tiff` GeoTIFF, `.hgt` and `.hgt.gz` SRTM tile, `.yaml`/`.yml` ROS `map_server`,
/// `.npy` array of numpy, which needs a cell size of the options.
///
/// # Errors
/// What is wrong with the file, with the place in it.
pub fn read_path(path: &Path) -> Result<Terrain, Error> {
    read_path_as(path, &Options::default())
}

/// Reads a map file as [`read_path`] does, with options.
///
/// # Errors
/// As [`read_path`], and options that cannot be.
pub fn read_path_as(path: &Path, options: &Options) -> Result<Terrain, Error> {
    let name = path.file_name().and_then(|name| name.to_str()).unwrap_or_default().to_ascii_lowercase();
    let bytes = || fs::read(path).map_err(|source| Error::Read { path: path.display().to_string(), source });
    let has = |endings: &[&str]| endings.iter().any(|ending| name.ends_with(ending));
    if !has(&[".npy"]) {
        options.georeference.refuse()?;
    }
    let terrain = match () {
        () if has(&[".json"]) => read_bytes(Format::Json, &bytes()?, options)?,
        () if has(&[".npy"]) => read_bytes(Format::Npy, &bytes()?, options)?,
        () if has(&[".asc"]) => read_ascii_beside(&bytes()?, path, options)?,
        () if has(&[".asc.gz"]) => {
            read_ascii_beside(&unpacked(&bytes()?, path, MOST_UNPACKED_BYTES)?, path, options)?
        }
        () if has(&[".tif", ".tiff"]) => read_geotiff(&bytes()?, &geotiff::Sidecars::beside(path)?, options)?,
        () if has(&[".hgt"]) => hgt::read(&bytes()?, &name, options)?.into_metres(options)?,
        () if has(&[".hgt.gz"]) => {
            hgt::read(&unpacked(&bytes()?, path, hgt::MOST_BYTES + 1)?, &name, options)?
                .into_metres(options)?
        }
        () if has(&[".yaml", ".yml"]) => {
            let folder = path.parent().unwrap_or(Path::new("."));
            read_ros_map(&bytes()?, options, |image| fs::read(folder.join(image)))?
        }
        () => return Err(Error::UnknownFormat { path: path.display().to_string() }),
    };
    Ok(terrain)
}

/// Reads a map from the bytes of its file.
///
/// # Errors
/// What is wrong with it, with the place in it.
pub fn read_bytes(format: Format, bytes: &[u8], options: &Options) -> Result<Terrain, Error> {
    if format != Format::Npy {
        options.georeference.refuse()?;
    }
    match format {
        Format::Json => json::read(text(bytes)?)?.as_asked(options),
        Format::Ascii => ascii::read(text(bytes)?, options)?.as_asked(options),
        Format::GeoTiff => read_geotiff(bytes, &geotiff::Sidecars::default(), options),
        Format::Cells => cells::read_sent(bytes)?.as_asked(options),
        Format::Npy => npy::read(bytes, options),
    }
}

fn read_geotiff(bytes: &[u8], beside: &geotiff::Sidecars, options: &Options) -> Result<Terrain, Error> {
    if !geotiff::is_tiff(bytes) {
        return Err(Error::NotTiff { found: what_bytes_are(bytes) });
    }
    let unwarped = geotiff::read_unwarped(bytes, options.most_cells, beside).map_err(Error::in_geotiff)?;
    Unwarped { is_of_bytes: holds_bytes(bytes), ..unwarped }.into_metres(options)
}

/// Whether a TIFF holds one number of 8 bits for each pixel.
fn holds_bytes(tiff: &[u8]) -> bool {
    let color = Decoder::new(Cursor::new(tiff)).and_then(|mut decoder| decoder.colortype());
    matches!(color, Ok(ColorType::Gray(8)))
}

/// Reads a ROS `map_server` map, whose image `image` finds by the name that the YAML has for it.
///
/// # Errors
/// What is wrong with the YAML or the image, by field.
pub fn read_ros_map(
    yaml: &[u8],
    options: &Options,
    image: impl FnOnce(&str) -> std::io::Result<Vec<u8>>,
) -> Result<Terrain, Error> {
    options.georeference.refuse()?;
    ros_map::read(text(yaml)?, options.most_cells, image)?.as_asked(options)
}

/// An ESRI ASCII grid, placed in the system that a `.prj` file beside it names.
fn read_ascii_beside(bytes: &[u8], path: &Path, options: &Options) -> Result<Terrain, Error> {
    let beside = ascii::ProjectionFile::beside(path)?;
    let text = text(bytes)?;
    let terrain = match &beside.crs {
        Some(crs) => ascii::read_in(text, options, crs)?.into_metres(options)?,
        None => ascii::read(text, options)?.as_asked(options)?,
    };
    Ok(beside.warning.into_iter().fold(terrain, Terrain::with_warning))
}

/// The bytes as text, without a byte order mark.
///
/// # Errors
/// [`Error::NotText`] with the first byte that is not UTF-8.
pub fn text(bytes: &[u8]) -> Result<&str, Error> {
    let text = std::str::from_utf8(bytes)
        .map_err(|error| Error::NotText { position: error.valid_up_to(), found: named_by_magic(bytes) })?;
    Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
}

/// What a file is by its first bytes.
fn named_by_magic(bytes: &[u8]) -> Option<&'static str> {
    const MAGIC: [(&[u8], &str); 7] = [
        (b"II*\0", "a TIFF"),
        (b"MM\0*", "a TIFF"),
        (b"II+\0", "a TIFF"),
        (b"\x1f\x8b", "a gzip file"),
        (b"\x89PNG", "a PNG image"),
        (b"PK\x03\x04", "a ZIP file"),
        (b"\x93NUMPY", "a numpy array"),
    ];
    MAGIC.iter().find(|(magic, _)| bytes.starts_with(magic)).map(|(_, name)| *name)
}

/// What bytes are that should be a TIFF, and what their file should be called.
fn what_bytes_are(bytes: &[u8]) -> &'static str {
    /// Bytes by which text is told: longer than the longest header.
    const BEGINNING: usize = 1024;
    let beginning = &bytes[..bytes.len().min(BEGINNING)];
    let is_text = !beginning.is_empty()
        && beginning.iter().all(|byte| byte.is_ascii_graphic() || byte.is_ascii_whitespace());
    match named_by_magic(bytes) {
        Some(name) => name,
        None if !is_text => "no TIFF",
        None if beginning.trim_ascii_start().starts_with(b"{") => {
            "text, as of a JSON grid, whose name ends in .json"
        }
        None => "text, as of an ESRI ASCII grid, whose name ends in .asc",
    }
}

fn unpacked(bytes: &[u8], path: &Path, most_bytes: u64) -> Result<Vec<u8>, Error> {
    let mut text = Vec::new();
    let read = MultiGzDecoder::new(bytes).take(most_bytes).read_to_end(&mut text);
    read.map(|_| text).map_err(|source| Error::Read { path: path.display().to_string(), source })
}

impl Terrain {
    /// The ground as the options want it, with doubts about what its cells hold.
    ///
    /// # Errors
    /// Options that cannot be, or nodata that leaves no known cell.
    pub fn as_asked(self, options: &Options) -> Result<Self, Error> {
        self.with_own_doubts(options)?.with_asked_filling(options)
    }

    /// The ground with the options' nodata unknown, and with doubts about what its cells hold.
    pub(crate) fn with_own_doubts(self, options: &Options) -> Result<Self, Error> {
        let terrain = match options.nodata_m {
            Some(nodata_m) => self.with_nodata(nodata_m)?,
            None => self,
        };
        Ok(terrain.with_doubts())
    }

    /// The ground with holes filled as the options want it.
    pub(crate) fn with_asked_filling(self, options: &Options) -> Result<Self, Error> {
        match options.fill_voids_m {
            Some(fill_voids_m) => self.with_filled_voids(fill_voids_m),
            None => Ok(self),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    const GRID: &str = "ncols 2\nnrows 1\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n";

    #[test]
    fn a_packed_grid_is_the_grid() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("Ground.ASC.gz");
        let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
        packed.write_all(GRID.as_bytes()).unwrap();
        fs::write(&path, packed.finish().unwrap()).unwrap();
        let plain = read_bytes(Format::Ascii, GRID.as_bytes(), &Options::default()).unwrap();
        assert_eq!(read_path(&path).unwrap(), plain);
        fs::write(&path, b"\x1f\x8b broken").unwrap();
        assert!(read_path(&path).unwrap_err().to_string().contains("Ground.ASC.gz"));
    }

    #[test]
    fn text_in_the_place_of_a_tiff_is_named() {
        let said =
            |bytes: &[u8]| read_bytes(Format::GeoTiff, bytes, &Options::default()).unwrap_err().to_string();
        assert!(said(GRID.as_bytes()).contains("ESRI ASCII grid, whose name ends in .asc"));
        assert!(said(b" {\"rows\": 1}").contains("JSON grid"));
        assert!(said(b"\x89PNG").contains("a PNG image") && said(b"").contains("no TIFF"));
    }

    #[test]
    fn bytes_in_the_place_of_text_are_named() {
        let said = read_bytes(Format::Ascii, b"II*\0\xff\xff", &Options::default()).unwrap_err().to_string();
        assert!(said.contains("byte 4") && said.contains("this is a TIFF"), "{said}");
        let said =
            read_bytes(Format::Json, b"{\"a\": \"\xff\"}", &Options::default()).unwrap_err().to_string();
        assert!(said.contains("is this really"), "{said}");
    }
}
