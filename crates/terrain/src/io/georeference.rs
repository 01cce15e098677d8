//! Cell size, place and system of an array, whose file holds none of them.

use super::npy::NpyError;
use crate::Error;

/// The frame of a file that holds elevations alone. Fields have the names, units and defaults of the JSON grid.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Georeference {
    /// Edge of a cell [m].
    pub cell_size_m: Option<f64>,
    /// South-west corner of the first cell, x and y [m]. Default: (0, 0).
    pub origin_m: Option<[f64; 2]>,
    /// Coordinate reference system, in metres: `EPSG:` and a code, or WKT. Default: unknown.
    pub crs: Option<String>,
}

impl Georeference {
    /// South-west corner as text, `X,Y`, the form of a command line and of a query.
    ///
    /// ```
    /// use terrain::io::Georeference;
    /// assert_eq!(Georeference::parse_origin_m("429250,-5.5"), Ok([429250.0, -5.5]));
    /// assert!(Georeference::parse_origin_m("7").is_err());
    /// ```
    ///
    /// # Errors
    /// A sentence about a text that is no pair of numbers.
    pub fn parse_origin_m(text: &str) -> Result<[f64; 2], String> {
        let number = |text: &str| text.trim().parse::<f64>().ok();
        let pair = text.split_once(',').and_then(|(x, y)| Some([number(x)?, number(y)?]));
        pair.ok_or_else(|| {
            let shown: String = text.chars().take(40).collect();
            format!("origin_m is `{shown}`, but must be x and y of the south-west corner in metres, as 429250,5150480")
        })
    }

    /// Refuses a georeference for a file that holds its own.
    ///
    /// # Errors
    /// The first field that is given.
    pub fn refuse(&self) -> Result<(), Error> {
        let given = [
            ("cell_size_m", self.cell_size_m.is_some()),
            ("origin_m", self.origin_m.is_some()),
            ("crs", self.crs.is_some()),
        ];
        match given.iter().find(|(_, is_given)| *is_given) {
            Some((field, _)) => Err(NpyError::NotAnArray { field }.into()),
            None => Ok(()),
        }
    }
}
