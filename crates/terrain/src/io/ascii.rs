//! The ESRI ASCII grid: a header of six lines, then rows from the north.

use crate::{Error, Grid, Terrain};

/// Header fields, all but the last of them required.
struct Header {
    columns: u64,
    rows: u64,
    origin_m: [f64; 2],
    cell_size_m: f64,
    nodata: Option<f64>,
}

/// Reads an ESRI ASCII grid; `xllcorner` and `xllcenter` both place it, `NODATA_value` marks unknown cells.
///
/// # Errors
/// The line of a header or value that cannot be right, or the count when values are missing.
pub fn read(text: &str) -> Result<Terrain, Error> {
    let mut lines = text.lines().enumerate().peekable();
    let header = read_header(&mut lines)?;
    let grid = Terrain::check_size(header.rows, header.columns, header.cell_size_m, header.origin_m)?;
    let mut from_north: Vec<f64> = Vec::with_capacity(grid.cells().min(text.len() / 2 + 1));
    for (index, line) in lines {
        for (position, word) in line.split_ascii_whitespace().enumerate() {
            let value: f64 = word.parse().map_err(|_| Error::AsciiNumber {
                line: index + 1,
                column: position + 1,
                found: excerpt(word),
            })?;
            let is_nodata =
                header.nodata.is_some_and(|mark| value == mark || (mark.is_nan() && value.is_nan()));
            if value.is_nan() && !is_nodata {
                return Err(Error::AsciiNumber {
                    line: index + 1,
                    column: position + 1,
                    found: excerpt(word),
                });
            }
            from_north.push(if is_nodata { f64::NAN } else { value });
        }
    }
    if from_north.len() != grid.cells() {
        return Err(Error::AsciiCount { found: from_north.len(), expected: grid.cells() });
    }
    Terrain::new(grid, &south_up(&grid, &from_north))
}

/// Rows from the south out of rows from the north.
pub(crate) fn south_up(grid: &Grid, from_north: &[f64]) -> Vec<f64> {
    from_north.chunks(grid.columns).rev().flatten().copied().collect()
}

fn read_header<'a>(
    lines: &mut std::iter::Peekable<impl Iterator<Item = (usize, &'a str)>>,
) -> Result<Header, Error> {
    let (_, columns) = field(lines, "ncols", &["ncols"])?;
    let (_, rows) = field(lines, "nrows", &["nrows"])?;
    let (x_key, x_m) = field(lines, "xllcorner", &["xllcorner", "xllcenter"])?;
    let (y_key, y_m) = field(lines, "yllcorner", &["yllcorner", "yllcenter"])?;
    let (_, cell_size_m) = field(lines, "cellsize", &["cellsize"])?;
    let nodata = match lines.peek() {
        Some((_, line)) if line.to_ascii_lowercase().trim_start().starts_with("nodata_value") => {
            Some(field(lines, "NODATA_value", &["nodata_value"])?.1)
        }
        _ => None,
    };
    let corner = |key: &str, value: f64| {
        if key.ends_with("center") { value - cell_size_m / 2.0 } else { value }
    };
    Ok(Header {
        columns: columns.max(0.0) as u64,
        rows: rows.max(0.0) as u64,
        origin_m: [corner(x_key, x_m), corner(y_key, y_m)],
        cell_size_m,
        nodata,
    })
}

fn field<'a>(
    lines: &mut impl Iterator<Item = (usize, &'a str)>,
    expected: &'static str,
    keys: &[&'static str],
) -> Result<(&'static str, f64), Error> {
    let (index, line) = lines.next().unwrap_or((0, "end of file"));
    let wrong = || Error::AsciiHeader { line: index + 1, expected, found: excerpt(line) };
    let mut words = line.split_ascii_whitespace();
    let word = words.next().ok_or_else(wrong)?.to_ascii_lowercase();
    let key = keys.iter().find(|key| **key == word).ok_or_else(wrong)?;
    let value: f64 = words.next().and_then(|v| v.parse().ok()).ok_or_else(wrong)?;
    let whole = !matches!(*key, "ncols" | "nrows") || (value.fract() == 0.0 && value < 1e12);
    if whole && words.next().is_none() { Ok((key, value)) } else { Err(wrong()) }
}

fn excerpt(text: &str) -> String {
    text.chars().take(40).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Cell;

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
    fn bad_files_are_refused_by_line() {
        let long_row = SMALL.replace("1 2 3", "1 2 3 4");
        for (text, said) in [
            (SMALL.replace("4 -9999 6", "4 x 6"), "line 8, value 2: `x`"),
            (SMALL.replace("4 -9999 6", "4 nan 6"), "line 8, value 2: `nan`"),
            (SMALL.replace("nrows 2", "rows 2"), "line 2"),
            (SMALL.replace("cellsize 0.5", "cellsize"), "line 5"),
            (SMALL.replace("4 -9999 6\n", ""), "truncated"),
            (long_row, "7 values"),
            (SMALL.replace("cellsize 0.5", "cellsize -2"), "cell_size_m"),
            (SMALL.replace("ncols 3", "ncols 2.5"), "line 1"),
            (SMALL.replace("ncols 3", "ncols -3"), "columns"),
            (SMALL.replace("4 -9999 6", "4 5 6e99"), "elevation_m"),
            (String::new(), "line 1"),
        ] {
            let message = read(&text).unwrap_err().to_string();
            assert!(message.contains(said), "{text}\n  said: {message}");
        }
    }
}
