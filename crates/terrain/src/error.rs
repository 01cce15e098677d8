//! What can be wrong with a map.

/// An error of the terrain crate; the message names the place and says how to mend it.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The text is not the JSON that a map needs.
    #[error(transparent)]
    Json(#[from] document::Error),
    /// An area over the map that cannot be.
    #[error(transparent)]
    Area(#[from] crate::areas::AreaError),
    /// The time allowed was over before the areas were laid over the map.
    #[error(
        "the time allowed was over before the areas were laid over the map: allow more, or give fewer areas"
    )]
    OutOfTime,
    /// A grid with no cells.
    #[error("{field} is {value}: a map needs at least one row and one column")]
    Empty {
        /// `rows` or `columns`.
        field: &'static str,
        /// The value found.
        value: u64,
    },
    /// More cells than this program keeps in memory.
    #[error("{rows} × {columns} cells are more than the {limit} a map may have: crop it to {0} × {0} cells or use larger ones", limit.isqrt())]
    TooManyCells {
        /// Rows declared.
        rows: u64,
        /// Columns declared.
        columns: u64,
        /// Most cells accepted.
        limit: u64,
    },
    /// The layer has another number of rows than the map says.
    #[error("{layer} has {found} rows, but rows is {expected}")]
    RowCount {
        /// `elevation_m`, `surface` or `obstacle`.
        layer: &'static str,
        /// Rows found.
        found: usize,
        /// Rows declared.
        expected: usize,
    },
    /// A ragged layer.
    #[error("{layer}[{row}] has {found} values, but columns is {expected}")]
    RowLength {
        /// `elevation_m`, `surface` or `obstacle`.
        layer: &'static str,
        /// The ragged row.
        row: usize,
        /// Values found in it.
        found: usize,
        /// Columns declared.
        expected: usize,
    },
    /// An elevation that no ground has.
    #[error(
        "elevation_m[{row}][{column}] is {value}, outside {min} to {max} m, between which all ground of Earth, Moon and Mars lies: give metres, and null for unknown ground"
    )]
    Elevation {
        /// Row from the south.
        row: usize,
        /// Column from the west.
        column: usize,
        /// The value found.
        value: f64,
        /// Lowest accepted.
        min: f64,
        /// Highest accepted.
        max: f64,
    },
    /// Every cell is unknown.
    #[error("elevation_m holds no known cell: every cell is unknown ground")]
    AllUnknown,
    /// A cell size that no terrain grid has.
    #[error("cell_size_m is {value}, but must lie in {min} to {max}: give metres")]
    CellSize {
        /// The value found.
        value: f64,
        /// Smallest accepted.
        min: f64,
        /// Largest accepted.
        max: f64,
    },
    /// An origin that is not a place in projected metres.
    #[error("origin_m[{axis}] is {value}, but must be finite and within ±{limit} m")]
    Origin {
        /// 0 for x, 1 for y.
        axis: usize,
        /// The value found.
        value: f64,
        /// Largest magnitude accepted.
        limit: f64,
    },
    /// A coordinate reference system that a map's metres cannot be in.
    #[error(
        "crs is `{found}`, but must be `EPSG:` and the code of a projected system, or its WKT: leave it out if there is none"
    )]
    Crs {
        /// The text found, or its beginning.
        found: String,
    },
    /// A system of metres that are no metres of the ground.
    #[error(
        "crs is `{found}`, of which a metre is {scale:.4} m of ground here, but the cells of a grid are metres of the ground: bring the map to UTM with `gdalwarp -t_srs EPSG:{epsg} -r bilinear in.tif out.tif`, or leave crs out if its metres are those of the ground"
    )]
    StretchedCrs {
        /// The text found, or its beginning.
        found: String,
        /// Ground by map in the map's middle, the mean of both directions.
        scale: f64,
        /// EPSG code of the UTM zone of the middle.
        epsg: u32,
    },
    /// More surface classes than a byte can index.
    #[error("surface names more than {limit} classes, the last of them `{name}`")]
    TooManySurfaces {
        /// The class that was one too many.
        name: String,
        /// Most classes accepted.
        limit: usize,
    },
    /// More warnings than a map may carry.
    #[error("warnings has {found} entries, but a map carries {limit} at most")]
    TooManyWarnings {
        /// Entries found.
        found: usize,
        /// Most accepted.
        limit: usize,
    },
    /// A warning that is longer than a sentence.
    #[error("warnings[{index}].detail has {found} bytes, but {limit} are the most")]
    LongWarning {
        /// Position in the list.
        index: usize,
        /// Bytes found.
        found: usize,
        /// Most accepted.
        limit: usize,
    },
    /// A patch that changes nothing.
    #[error("the patch has no cells: give rows of elevation_m, surface or obstacle, or areas")]
    EmptyPatch,
    /// A patch that reaches beyond the map.
    #[error(
        "{field} {first} and {count} more reach beyond the map, which has {limit}: move or crop the patch"
    )]
    PatchOutside {
        /// `row` or `column`.
        field: &'static str,
        /// Where it begins.
        first: u64,
        /// How many it covers.
        count: usize,
        /// How many the map has.
        limit: usize,
    },
    /// An ESRI ASCII grid that cannot be read.
    #[error(transparent)]
    Ascii(#[from] crate::io::ascii::AsciiError),
    /// Coordinates in degrees.
    #[error(
        "cells of {cell_size} from x {west}, y {south} are degrees of longitude and latitude, but metres are needed: project the file by `gdalwarp -t_srs EPSG:{epsg} -r bilinear in.{ending} out.tif` (with `-s_srs EPSG:4326` if it names no coordinate system)"
    )]
    Degrees {
        /// Edge of a cell [deg].
        cell_size: f64,
        /// Longitude of the west edge [deg].
        west: f64,
        /// Latitude of the south edge [deg].
        south: f64,
        /// Ending of the file's name.
        ending: &'static str,
        /// EPSG code of the UTM zone of the middle.
        epsg: u32,
    },
    /// A grid of degrees that is not warped to metres.
    #[error(transparent)]
    Warp(#[from] crate::crs::WarpRefusal),
    /// A projection whose metres are not brought to the ground.
    #[error(transparent)]
    Scale(#[from] crate::crs::ScaleRefusal),
    /// An SRTM tile.
    #[error(transparent)]
    Hgt(#[from] crate::io::hgt::HgtError),
    /// An array of numpy, or what only an array takes.
    #[error(transparent)]
    Npy(#[from] crate::io::npy::NpyError),
    /// Text that is not UTF-8.
    #[error("byte {position} is not UTF-8 text{}", is_of(*found))]
    NotText {
        /// Offset of the first bad byte.
        position: usize,
        /// What the first bytes say it is.
        found: Option<&'static str>,
    },
    /// Bytes that do not begin as a TIFF does.
    #[error("not a readable GeoTIFF: by its first bytes this is {found}")]
    NotTiff {
        /// What it is.
        found: &'static str,
    },
    /// The TIFF decoder refused the file.
    #[error("not a readable GeoTIFF: {0}")]
    Tiff(#[from] tiff::TiffError),
    /// The TIFF declares more data than the file can hold.
    #[error(
        "the GeoTIFF declares {declared_bytes} bytes of elevation, but the file has {file_bytes}: it is truncated or corrupt"
    )]
    TiffTruncated {
        /// Bytes that the declared size needs.
        declared_bytes: u64,
        /// Bytes there are.
        file_bytes: u64,
    },
    /// A TIFF without the tags that place it on the ground.
    #[error("the TIFF has no {tag}: export it as a GeoTIFF in projected metres")]
    TiffTag {
        /// Name of the missing tag.
        tag: &'static str,
    },
    /// A property of a GeoTIFF that cannot be honoured.
    #[error("the GeoTIFF's {tag} is `{value}`, but must be {expected}")]
    TiffValue {
        /// The property and where it stands.
        tag: &'static str,
        /// The value found.
        value: String,
        /// What it must be, and the command that makes it so where there is one.
        expected: &'static str,
    },
    /// A compression that is not read.
    #[error(
        "the GeoTIFF is compressed with {name} (compression {code}), which is not read: recompress it with `gdal_translate -co COMPRESS=DEFLATE in.tif out.tif`"
    )]
    TiffCompression {
        /// The code that stands in the file.
        code: u64,
        /// The compression's name.
        name: &'static str,
    },
    /// A strip or tile that cannot be decoded.
    #[error("a block of the GeoTIFF is damaged: {why}; copy or export the file again")]
    TiffBlock {
        /// What the decoder says.
        why: String,
    },
    /// A Mercator projection whose scale changes over the map by more than its cells can tell.
    #[error(
        "the map is in a cylindrical projection ({crs}), of which a metre is {south:.4} m of ground in its south and {north:.4} m in its north: bring it to UTM with `gdalwarp -t_srs EPSG:{epsg} -r bilinear in.{ending} out.tif`"
    )]
    MercatorScale {
        /// The coordinate reference system.
        crs: String,
        /// Ground by map at the southern edge.
        south: f64,
        /// Ground by map at the northern edge.
        north: f64,
        /// Ending of the file's name.
        ending: &'static str,
        /// EPSG code of the UTM zone of the middle.
        epsg: u32,
    },
    /// A vertical system that counts downwards.
    #[error(
        "the file's vertical system counts depths, but heights are needed: `gdal_calc.py -A in.{ending} --calc=-A --outfile=out.tif` turns them over, and `gdal_edit.py -a_srs EPSG:CODE out.tif` names the horizontal system alone"
    )]
    Depths {
        /// Ending of the file's name.
        ending: &'static str,
    },
    /// A TIFF whose samples are not one elevation per pixel.
    #[error("the GeoTIFF holds {found}, but one band of integer or float elevation is needed")]
    TiffSamples {
        /// What it holds.
        found: String,
    },
    /// The only placement of a GeoTIFF stands in a world file that cannot be read.
    #[error(
        "the GeoTIFF does not say where it lies, and {file} beside it holds no six numbers (width, two turns, height, x and y of the first pixel's centre): write it anew, or `gdal_edit.py -a_ullr WEST NORTH EAST SOUTH FILE`"
    )]
    WorldFile {
        /// Its name.
        file: String,
    },
    /// A mask file beside a GeoTIFF that cannot be honoured.
    #[error("the mask beside the GeoTIFF (.msk) cannot be used: {why}; remove it or write it anew")]
    MaskFile {
        /// Why.
        why: String,
    },
    /// A ROS map that cannot be read.
    #[error(transparent)]
    RosMap(#[from] crate::io::ros_map::RosMapError),
    /// A GeoTIFF with an elevation that no ground has.
    #[error(
        "the GeoTIFF holds {value:?} at row {row} from the south and column {column} from the west (from 0), outside {min} to {max} m, between which all ground of Earth, Moon and Mars lies: if it marks unknown ground, say so by `gdal_translate -a_nodata {value:?} in.tif out.tif`; if it is not in metres, convert it"
    )]
    TiffElevation {
        /// Row from the south.
        row: usize,
        /// Column from the west.
        column: usize,
        /// The value found.
        value: f64,
        /// Lowest accepted [m].
        min: f64,
        /// Highest accepted [m].
        max: f64,
    },
    /// A GeoTIFF without any known cell.
    #[error("the GeoTIFF holds no known elevation: every sample is nodata or NaN")]
    TiffAllUnknown,
    /// Nodata that is no number.
    #[error("nodata is {value}, but must be a number: cells that are no number are unknown anyway")]
    Nodata {
        /// The value found.
        value: f64,
    },
    /// A width of holes to fill that cannot be.
    #[error(
        "fill_voids_m is {value}, but must be above 0 and at most {limit}: give the width of the widest hole to fill in metres"
    )]
    VoidWidth {
        /// The value found [m].
        value: f64,
        /// Largest accepted [m].
        limit: f64,
    },
    /// A file name that says nothing about its format.
    #[error(
        "`{path}` is no map file: the name must end in .json, .asc, .asc.gz, .tif, .tiff, .npy, .hgt, .hgt.gz, .yaml or .yml"
    )]
    UnknownFormat {
        /// The path.
        path: String,
    },
    /// Cells in bytes that are no map.
    #[error("these bytes are no map of cells: at byte {at}, {why}; see \"Maps in bytes\" of the guide")]
    CellBytes {
        /// Why.
        why: String,
        /// So many bytes were read.
        at: usize,
    },
    /// The file cannot be read at all.
    #[error("{path}: {source}")]
    Read {
        /// The path.
        path: String,
        /// Why.
        source: std::io::Error,
    },
}

impl Error {
    /// The error in the words of a GeoTIFF.
    pub(crate) fn in_geotiff(self) -> Self {
        match self {
            Error::Elevation { row, column, value, min, max } => {
                Error::TiffElevation { row, column, value, min, max }
            }
            Error::AllUnknown => Error::TiffAllUnknown,
            other => other,
        }
    }

    /// The field at fault, as `elevation_m[3][2]`, where the error lies in one.
    pub fn field(&self) -> Option<String> {
        Some(match self {
            Error::Json(error) => error.field()?.to_owned(),
            Error::Empty { field, .. } => (*field).into(),
            Error::TooManyCells { .. } => "rows".into(),
            Error::RowCount { layer, .. } => (*layer).into(),
            Error::RowLength { layer, row, .. } => format!("{layer}[{row}]"),
            Error::Elevation { row, column, .. } | Error::TiffElevation { row, column, .. } => {
                format!("elevation_m[{row}][{column}]")
            }
            Error::EmptyPatch => "elevation_m".into(),
            Error::PatchOutside { field, .. } => (*field).into(),
            Error::AllUnknown => "elevation_m".into(),
            Error::CellSize { .. } => "cell_size_m".into(),
            Error::Origin { axis, .. } => format!("origin_m[{axis}]"),
            Error::Crs { .. } | Error::StretchedCrs { .. } | Error::Scale(_) => "crs".into(),
            Error::TooManySurfaces { .. } => "surface".into(),
            Error::TooManyWarnings { .. } => "warnings".into(),
            Error::Area(error) => error.at.clone(),
            Error::Npy(error) => error.field()?,
            Error::LongWarning { index, .. } => format!("warnings[{index}].detail"),
            _ => return None,
        })
    }
}

/// What bytes are that should be text.
fn is_of(found: Option<&str>) -> String {
    match found {
        Some(found) => format!(": this is {found}, not an ASCII grid or JSON; send or name it as that"),
        None => ": is this really an ASCII grid or JSON?".to_owned(),
    }
}
