//! The ESRI ASCII grid: a header of some lines, then rows from the north.

mod beside;
mod error;
mod header;
mod notation;

pub(crate) use self::beside::ProjectionFile;
pub use self::error::AsciiError;
use std::borrow::Cow;

use self::{header::Header, notation::Notation};
use super::{
    Options,
    degrees::Coordinates,
    heights::{BandMetadata, Heights},
};
use crate::{
    Error, Grid, Terrain, Warning,
    crs::{Crs, DegreeFrame, Unwarped, Warp, square_cells},
    fill_value,
};

/// Reads an ESRI ASCII grid. Header lines come in any order, `xllcorner` and `xllcenter` both place the grid, `dx` and `dy` may
/// stand for `cellsize` where they are equal. Cells of `NODATA_value`, of the options' nodata, and `nan` or `null` are unknown.
/// Decimal commas are read where they can be nothing else.
///
/// # Errors
/// The line of a header or value that cannot be right, the count when values are missing, or coordinates in degrees.
pub fn read(text: &str, options: &Options) -> Result<Terrain, Error> {
    let text = &*with_line_feeds(text);
    let notation = Notation::of(text)?;
    let header = Header::read(text, notation)?;
    let coordinates = Coordinates {
        origin: header.origin,
        cell_size: header.cell_size,
        rows: header.rows,
        columns: header.columns,
    };
    coordinates.refuse_degrees("asc")?;
    let grid = Terrain::check_size(header.rows, header.columns, header.cell_size, header.origin)
        .map_err(in_header)?;
    let heights = Heights::METRES;
    let terrain = Values::of(&header, notation, heights, options).terrain(text, &header, grid)?;
    Ok(match coordinates.unit_warning() {
        Some(warning) => terrain.with_warning(warning),
        None => terrain,
    })
}

/// The text with lines that end in line feeds, where all end in carriage returns, as of old Macintoshes.
fn with_line_feeds(text: &str) -> Cow<'_, str> {
    if text.contains('\n') || !text.contains('\r') {
        Cow::Borrowed(text)
    } else {
        Cow::Owned(text.replace('\r', "\n"))
    }
}

/// An error of a grid in the words of a header in metres.
fn in_header(error: Error) -> Error {
    match error {
        Error::CellSize { value, min, max } => AsciiError::CellSize { value, min, max }.into(),
        Error::Origin { axis, value, limit } => AsciiError::Corner { axis, value, limit }.into(),
        other => other,
    }
}

/// Ending of the files in what is said of them.
const ENDING: &str = "asc";

/// Reads an ESRI ASCII grid whose coordinates and heights are those of a system.
///
/// # Errors
/// As [`read`], a grid of degrees that is not warped to metres, a system of depths, or one whose metres are not brought to the ground.
pub(crate) fn read_in(text: &str, options: &Options, crs: &Crs) -> Result<Unwarped, Error> {
    let text = &*with_line_feeds(text);
    let notation = Notation::of(text)?;
    let header = Header::read(text, notation)?;
    let mut warnings = Vec::new();
    let heights = Heights::of(&BandMetadata::default(), crs, ENDING, &mut warnings)?;
    let values = Values::of(&header, notation, heights, options);
    let frame = DegreeFrame::checked(header.origin, [header.cell_size; 2], [header.columns, header.rows])?;
    if crs.is_geographic {
        let warp = Warp::plan(frame, crs, ENDING, options.most_cells)?;
        let terrain = values.terrain(text, &header, warp.source_grid())?;
        return Ok(Unwarped::of(with_warnings(terrain, warnings), Some(warp)));
    }
    let is_in_metres = crs.unit.is_none_or(|unit| unit.is_metre());
    let placed = square_cells(header.affine(), frame.size, crs, ENDING, &mut warnings);
    let (grid, name) = placed.map_err(|error| if is_in_metres { in_header(error) } else { error })?;
    let terrain = Terrain { crs: name, ..values.terrain(text, &header, grid)? };
    Ok(Unwarped::of(with_warnings(terrain, warnings), None))
}

fn with_warnings(terrain: Terrain, warnings: Vec<Warning>) -> Terrain {
    warnings.into_iter().fold(terrain, Terrain::with_warning)
}

/// How the values of a grid are to be read.
struct Values {
    notation: Notation,
    heights: Heights,
    /// Values of unknown cells.
    marks: [Option<f64>; 2],
}

impl Values {
    fn of(header: &Header, notation: Notation, heights: Heights, options: &Options) -> Self {
        let given = options.nodata_m.filter(|mark| !Terrain::holds(*mark));
        Values { notation, heights, marks: [header.nodata, given] }
    }

    /// Ground on a grid of the header's rows and columns.
    fn terrain(&self, text: &str, header: &Header, grid: Grid) -> Result<Terrain, Error> {
        let from_north = self.read(text, header.lines, grid.cells())?;
        let from_south = south_up(&grid, &from_north);
        Terrain::from_samples(grid, from_south, |z| z).map_err(|error| match error {
            Error::AllUnknown => AsciiError::AllUnknown.into(),
            other => other,
        })
    }

    /// So many heights below so many lines of header, NaN where unknown [m].
    fn read(&self, text: &str, header_lines: usize, expected: usize) -> Result<Vec<f64>, AsciiError> {
        // A value takes a digit and a blank at least.
        let mut values = Vec::with_capacity(expected.min(text.len() / 2 + 1));
        for (index, line) in text.lines().enumerate().skip(header_lines) {
            for (position, word) in line.split_ascii_whitespace().enumerate() {
                values.push(self.value(word, (index + 1, position + 1))?);
            }
        }
        match values.len() {
            found if found == expected => Ok(values),
            found => Err(AsciiError::Count { found, expected }),
        }
    }

    fn value(&self, word: &str, (line, column): (usize, usize)) -> Result<f64, AsciiError> {
        let value = self.notation.number(word);
        let value = value.ok_or_else(|| AsciiError::Number { line, column, found: excerpt(word) })?;
        if self.marks.iter().flatten().any(|mark| fill_value::is_mark(value, *mark)) {
            return Ok(f64::NAN);
        }
        let height_m = self.heights.height_m(value);
        if height_m.is_nan() || Terrain::holds(height_m) || fill_value::is_never_ground(value) {
            return Ok(height_m);
        }
        let (min, max) = (Terrain::LOWEST_M, Terrain::HIGHEST_M);
        Err(AsciiError::Elevation { line, column, value, min, max })
    }
}

/// Rows from the south out of rows from the north.
pub(crate) fn south_up(grid: &Grid, from_north: &[f64]) -> Vec<f64> {
    from_north.chunks(grid.columns).rev().flatten().copied().collect()
}

fn excerpt(text: &str) -> String {
    text.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Cell, WarningKind};

    fn read(text: &str) -> Result<Terrain, Error> {
        super::read(text, &Options::default())
    }

    const SMALL: &str = "ncols 3\nnrows 2\nxllcorner 10\nyllcorner 20\ncellsize 0.5\nNODATA_value -9999\n\
                         1 2 3\n4 -9999 6\n";

    #[test]
    fn rows_come_from_the_north_and_nodata_is_unknown() {
        let terrain = read(SMALL).unwrap();
        assert_eq!(terrain.grid, Grid { rows: 2, columns: 3, cell_size_m: 0.5, origin_m: [10.0, 20.0] });
        assert_eq!(terrain.elevation_m(Cell { row: 0, column: 0 }), Some(4.0));
        assert_eq!(terrain.elevation_m(Cell { row: 1, column: 2 }), Some(3.0));
        assert_eq!(terrain.elevation_m(Cell { row: 0, column: 1 }), None);
    }

    #[test]
    fn a_file_may_mark_unknown_cells_with_nan() {
        let text = SMALL.replace("-9999", "nan");
        assert_eq!(read(&text).unwrap().elevation_m(Cell { row: 0, column: 1 }), None);
    }

    #[test]
    fn a_centre_reference_lies_half_a_cell_further_out() {
        let text = SMALL.replace("xllcorner", "XLLCENTER").replace("yllcorner", "yllcenter");
        assert_eq!(read(&text).unwrap().grid.origin_m, [9.75, 19.75]);
    }

    #[test]
    fn header_lines_come_in_any_order_and_cells_may_have_two_edges() {
        let other = "nrows 2\nncols 3\nNODATA_value -9999\ndy 0.5\ndx 0.5\n\nyllcorner 20\nxllcorner 10\n1 2 3\n4 -9999 6\n";
        assert_eq!(read(other).unwrap().content_id(), read(SMALL).unwrap().content_id());
        let oblong = read(&other.replace("dy 0.5", "dy 0.25")).unwrap_err().to_string();
        assert!(oblong.contains("square") && oblong.contains("gdalwarp -tr 0.25 0.25"), "{oblong}");
    }

    #[test]
    fn unknown_cells_are_known_by_every_mark_that_programs_write() {
        for (header, cell) in [
            ("-9999", "-9999.0"),
            ("-9999", "nan"),
            ("-9999.000", "-9999"),
            ("null", "null"),
            ("nan", "-nan"),
            ("-3.4028234663852886e+38", "-3.40282e+38"),
            ("-3.4028235e+38", "-3.4028234663852886e+38"),
        ] {
            let text = SMALL.replace("-9999 6", &format!("{cell} 6"));
            let text = text.replace("NODATA_value -9999", &format!("NODATA_value {header}"));
            let terrain = read(&text).unwrap();
            assert_eq!(terrain.elevation_m(Cell { row: 0, column: 1 }), None, "{header}, {cell}");
            assert!(
                terrain.warnings().iter().all(|w| w.kind == WarningKind::UnknownUnit),
                "{header}, {cell}"
            );
        }
    }

    #[test]
    fn lines_may_end_in_carriage_returns_alone_and_the_header_of_grass_is_named() {
        assert_eq!(read(&SMALL.replace('\n', "\r")).unwrap().content_id(), read(SMALL).unwrap().content_id());
        let grass = "north: 40\nsouth: 20\neast: 50\nwest: 10\nrows: 2\ncols: 4\n1 2 3 4\n5 6 7 8\n";
        let said = read(grass).unwrap_err().to_string();
        assert!(said.contains("GRASS") && said.contains("gdal_translate"), "{said}");
    }

    #[test]
    fn a_fill_value_that_no_header_marks_is_unknown_and_said() {
        let terrain = read(&SMALL.replace("NODATA_value -9999\n", "")).unwrap();
        assert_eq!(terrain.elevation_m(Cell { row: 0, column: 1 }), None);
        let said = terrain.warnings().iter().find(|w| w.kind == WarningKind::UnmarkedNodata).unwrap();
        assert!(said.detail.contains("1 cell holds -9999"), "{}", said.detail);
    }

    #[test]
    fn decimal_commas_are_read_and_doubtful_ones_refused() {
        let commas = SMALL.replace("0.5", "0,5").replace("1 2 3", "1,25 2,0 3");
        let terrain = read(&commas).unwrap();
        assert_eq!(terrain.elevation_m(Cell { row: 1, column: 0 }), Some(1.25));
        let doubtful = read(&SMALL.replace("1 2 3", "1,250 2 3")).unwrap_err().to_string();
        assert!(doubtful.contains("line 7") && doubtful.contains("decimal points"), "{doubtful}");
    }

    #[test]
    fn degrees_are_refused_with_the_command_that_mends() {
        let globe = SMALL.replace("xllcorner 10", "xllcorner -180").replace("yllcorner 20", "yllcorner -90");
        let fine = SMALL.replace("cellsize 0.5", "cellsize 0.000277777777778");
        for (text, zone) in [(globe, "EPSG:32761"), (fine, "EPSG:32632")] {
            let said = read(&text.replace("xllcorner 10", "xllcorner 9")).unwrap_err().to_string();
            assert!(said.contains("degrees") && said.contains("gdalwarp") && said.contains(zone), "{said}");
        }
    }

    #[test]
    fn bad_files_are_refused_by_line() {
        let long_row = SMALL.replace("1 2 3", "1 2 3 4");
        for (text, said) in [
            (SMALL.replace("4 -9999 6", "4 x 6"), "line 8, value 2: `x`"),
            (SMALL.replace("4 -9999 6", "4 inf 6"), "line 8, value 2: `inf`"),
            (SMALL.replace("nrows 2", "rows 2"), "line 2"),
            (SMALL.replace("nrows 2", "ncols 2"), "line 2: ncols stands in the header twice"),
            (SMALL.replace("nrows 2\n", ""), "without `nrows`"),
            (SMALL.replace("cellsize 0.5", "cellsize"), "line 5: cellsize"),
            (SMALL.replace("cellsize 0.5", "cellsize 0.5 0.5"), "line 5: cellsize"),
            (SMALL.replace("NODATA_value -9999", "NODATA_value none at all"), "line 6: NODATA_value"),
            (SMALL.replace("4 -9999 6\n", ""), "truncated"),
            (long_row, "7 values"),
            (SMALL.replace("cellsize 0.5", "cellsize -2"), "cellsize is -2"),
            (SMALL.replace("xllcorner 10", "xllcorner 1e12"), "xllcorner is 1000000000000"),
            (SMALL.replace("ncols 3", "ncols 2.5"), "line 1"),
            (SMALL.replace("ncols 3", "ncols -3"), "ncols is `-3`"),
            (SMALL.replace("4 -9999 6", "4 5 6e7"), "line 8, value 3 is 60000000.0"),
            (SMALL.replace("1 2 3\n4 -9999 6", "nan nan nan\nnan nan nan"), "NODATA_value"),
            (String::new(), "without `cellsize`"),
        ] {
            let message = read(&text).unwrap_err().to_string();
            assert!(message.contains(said), "{text}\n  said: {message}");
        }
    }
}
