//! What can be wrong with an ESRI ASCII grid.

/// An error of an ESRI ASCII grid; the message names the line and says how to mend it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum AsciiError {
    /// A line above the values that is no header line.
    #[error(
        "line {line}: `{found}` is no header line: the header has ncols, nrows, xllcorner or xllcenter, yllcorner or yllcenter, cellsize (or dx and dy) and NODATA_value, one a line, in any order"
    )]
    Header {
        /// Line number from 1.
        line: usize,
        /// What stands there.
        found: String,
    },
    /// The header of another format.
    #[error(
        "line {line}: this is the header of a GRASS ASCII raster, which is not read: make a GeoTIFF of it with `gdal_translate in.asc out.tif`, and name its system with `-a_srs EPSG:CODE`"
    )]
    Grass {
        /// Line number from 1.
        line: usize,
    },
    /// A header line whose value cannot be right.
    #[error("line {line}: {key} is `{found}`, but must be {expected}")]
    HeaderValue {
        /// Line number from 1.
        line: usize,
        /// Key as it stands there.
        key: &'static str,
        /// What must stand there.
        expected: &'static str,
        /// What stands there.
        found: String,
    },
    /// A header key that comes twice.
    #[error("line {line}: {key} stands in the header twice: leave one of them")]
    HeaderTwice {
        /// Line number from 1.
        line: usize,
        /// The key.
        key: &'static str,
    },
    /// A header key that does not come.
    #[error("the header ends before line {line} without `{key}`: write it above the values")]
    HeaderMissing {
        /// First line below the header, from 1.
        line: usize,
        /// The key.
        key: &'static str,
    },
    /// Cells of a size that no terrain grid has.
    #[error("cellsize is {value}, but must lie in {min} to {max}: give metres")]
    CellSize {
        /// The value found.
        value: f64,
        /// Smallest accepted [m].
        min: f64,
        /// Largest accepted [m].
        max: f64,
    },
    /// A corner that is no place in projected metres.
    #[error("{}llcorner is {value}, but must lie within ±{limit} m", if *axis == 0 { "x" } else { "y" })]
    Corner {
        /// 0 for x, 1 for y.
        axis: usize,
        /// The value found.
        value: f64,
        /// Largest magnitude accepted [m].
        limit: f64,
    },
    /// Cells that are not square.
    #[error(
        "dx is {dx} and dy is {dy}, but cells must be square: resample the grid, as by `gdalwarp -tr {least} {least} -r bilinear in.asc out.tif`",
        least = dx.min(*dy)
    )]
    Oblong {
        /// Width of a cell [m].
        dx: f64,
        /// Height of a cell [m].
        dy: f64,
    },
    /// A value that is not a number.
    #[error("line {line}, value {column}: `{found}` is not a number{}", mend(found))]
    Number {
        /// Line number from 1.
        line: usize,
        /// Position in the line from 1.
        column: usize,
        /// What stands there.
        found: String,
    },
    /// Commas that may be decimal commas or separators.
    #[error(
        "line {line}: the comma of `{found}` may be a decimal comma or separate thousands or values: export the grid with decimal points, and blanks between values"
    )]
    Comma {
        /// Line number from 1.
        line: usize,
        /// What stands there.
        found: String,
    },
    /// An elevation that no ground has.
    #[error(
        "line {line}, value {column} is {value:?}, outside {min} to {max} m, between which all ground of Earth, Moon and Mars lies: if it marks unknown ground, write the header line `NODATA_value {value:?}`; if the grid is not in metres, convert it"
    )]
    Elevation {
        /// Line number from 1.
        line: usize,
        /// Position in the line from 1.
        column: usize,
        /// The value found.
        value: f64,
        /// Lowest accepted [m].
        min: f64,
        /// Highest accepted [m].
        max: f64,
    },
    /// No known cell at all.
    #[error("the grid holds no known elevation: every value is nodata (NODATA_value, nan or null)")]
    AllUnknown,
    /// More or fewer values than the header says.
    #[error("the grid has {found} values, but nrows × ncols is {expected}: the file is truncated or ragged")]
    Count {
        /// Values found.
        found: usize,
        /// Values declared.
        expected: usize,
    },
}

/// How to mend a word that is no number.
fn mend(found: &str) -> &'static str {
    match found.trim_start_matches(['-', '+']).to_ascii_lowercase().as_str() {
        "inf" | "infinity" => ": write nan, or the header's NODATA_value, for unknown ground",
        _ => "",
    }
}
