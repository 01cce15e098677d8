//! The header of an ESRI ASCII grid: keys in any order, the last of them before the first line of values.

use super::{AsciiError, excerpt, notation::Notation};
use crate::resample::Affine;

/// Keys as they are told, with their other spellings in lower case.
const KEYS: [(&str, &[&str]); 10] = [
    ("ncols", &["ncols"]),
    ("nrows", &["nrows"]),
    ("xllcorner", &["xllcorner"]),
    ("yllcorner", &["yllcorner"]),
    ("xllcenter", &["xllcenter", "xllcentre"]),
    ("yllcenter", &["yllcenter", "yllcentre"]),
    ("cellsize", &["cellsize"]),
    ("dx", &["dx"]),
    ("dy", &["dy"]),
    ("NODATA_value", &["nodata_value", "nodata"]),
];

/// Keys that a GRASS ASCII raster begins with (r.in.ascii).
const GRASS_KEYS: [&str; 6] = ["north", "south", "east", "west", "rows", "cols"];

/// What a header says.
pub(super) struct Header {
    pub(super) columns: u64,
    pub(super) rows: u64,
    /// South-west corner, x and y.
    pub(super) origin: [f64; 2],
    /// Edge of a cell.
    pub(super) cell_size: f64,
    /// Mark of unknown cells; NaN where it is a word.
    pub(super) nodata: Option<f64>,
    /// Lines that it takes.
    pub(super) lines: usize,
}

/// Header lines that were read, by key.
struct Fields<'a> {
    found: Vec<(&'static str, usize, &'a str)>,
    lines: usize,
    notation: Notation,
}

impl Header {
    pub(super) fn read(text: &str, notation: Notation) -> Result<Self, AsciiError> {
        let fields = Fields::read(text, notation)?;
        let cell_size = match (fields.find("cellsize"), fields.find("dx"), fields.find("dy")) {
            (None, Some(_), _) | (None, _, Some(_)) => {
                let (dx, dy) = (fields.number("dx")?, fields.number("dy")?);
                /// Relative difference that ten printed digits leave.
                const PRINTED: f64 = 1e-9;
                if (dx - dy).abs() > PRINTED * dx.abs() {
                    return Err(AsciiError::Oblong { dx, dy });
                }
                dx
            }
            _ => fields.number("cellsize")?,
        };
        let corner = |corner: &'static str, center: &'static str| match fields.find(center) {
            Some(_) => fields.number(center).map(|at| at - cell_size / 2.0),
            None => fields.number(corner),
        };
        Ok(Header {
            columns: fields.count("ncols")?,
            rows: fields.count("nrows")?,
            origin: [corner("xllcorner", "xllcenter")?, corner("yllcorner", "yllcenter")?],
            cell_size,
            nodata: fields.nodata()?,
            lines: fields.lines,
        })
    }
}

impl Header {
    /// Where the grid lies, from its south-west corner, in the unit of its coordinates.
    pub(super) fn affine(&self) -> Affine {
        Affine { origin: self.origin, column: [self.cell_size, 0.0], row: [0.0, self.cell_size] }
    }
}

impl<'a> Fields<'a> {
    fn read(text: &'a str, notation: Notation) -> Result<Self, AsciiError> {
        let mut fields = Fields { found: Vec::new(), lines: 0, notation };
        for (index, line) in text.lines().enumerate() {
            let mut words = line.split_ascii_whitespace();
            let Some(word) = words.next() else {
                fields.lines += 1;
                continue;
            };
            let lower = word.to_ascii_lowercase();
            let Some((key, _)) = KEYS.iter().find(|(_, spellings)| spellings.contains(&lower.as_str()))
            else {
                if notation.number(word).is_some() || !fields.lacks_any() {
                    break;
                }
                let line_number = index + 1;
                return Err(match lower.strip_suffix(':') {
                    Some(key) if GRASS_KEYS.contains(&key) => AsciiError::Grass { line: line_number },
                    _ => AsciiError::Header { line: line_number, found: excerpt(line) },
                });
            };
            if fields.find(key).is_some() {
                return Err(AsciiError::HeaderTwice { line: index + 1, key });
            }
            let value = line.trim_start().get(word.len()..).unwrap_or_default().trim();
            fields.found.push((key, index + 1, value));
            fields.lines += 1;
        }
        Ok(fields)
    }

    /// Whether a key that every grid needs has not come yet.
    fn lacks_any(&self) -> bool {
        let has = |keys: [&str; 2]| keys.iter().any(|key| self.find(key).is_some());
        !(has(["ncols", "ncols"])
            && has(["nrows", "nrows"])
            && has(["xllcorner", "xllcenter"])
            && has(["yllcorner", "yllcenter"])
            && has(["cellsize", "dy"]))
    }

    fn find(&self, key: &str) -> Option<(usize, &'a str)> {
        self.found.iter().find(|(found, ..)| *found == key).map(|(_, line, value)| (*line, *value))
    }

    fn required(&self, key: &'static str) -> Result<(usize, &'a str), AsciiError> {
        self.find(key).ok_or(AsciiError::HeaderMissing { line: self.lines + 1, key })
    }

    fn number(&self, key: &'static str) -> Result<f64, AsciiError> {
        let (line, value) = self.required(key)?;
        let number = self.notation.number(value).filter(|number| number.is_finite());
        let found = excerpt(value);
        number.ok_or(AsciiError::HeaderValue { line, key, expected: "one finite number", found })
    }

    fn count(&self, key: &'static str) -> Result<u64, AsciiError> {
        let (line, value) = self.required(key)?;
        let expected = "a whole number of at least 1";
        let number = self.notation.number(value).filter(|n| n.fract() == 0.0 && (1.0..1e12).contains(n));
        let wrong = || AsciiError::HeaderValue { line, key, expected, found: excerpt(value) };
        number.map(|number| number as u64).ok_or_else(wrong)
    }

    fn nodata(&self) -> Result<Option<f64>, AsciiError> {
        let Some((line, value)) = self.find("NODATA_value") else { return Ok(None) };
        let wrong = || AsciiError::HeaderValue {
            line,
            key: "NODATA_value",
            expected: "a number, nan or null",
            found: excerpt(value),
        };
        self.notation.number(value).map(Some).ok_or_else(wrong)
    }
}
