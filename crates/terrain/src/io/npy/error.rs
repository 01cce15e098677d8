//! What can be wrong with a numpy array.

/// An error of a numpy array; the message says how to write it anew.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NpyError {
    /// Another file, or none.
    #[error(
        "this is no numpy array: the file must begin with the bytes 93 4E 55 4D 50 59 (\\x93NUMPY), as `numpy.save(\"dem.npy\", z)` writes it{}", but(*found)
    )]
    Magic {
        /// What the first bytes say it is.
        found: Option<&'static str>,
    },
    /// A version of the format that is not read.
    #[error(
        "the array is in version {major}.{minor} of .npy, but 1.0, 2.0 and 3.0 are read: write it anew by `numpy.save(\"dem.npy\", z)`"
    )]
    Version {
        /// The byte of the major version.
        major: u8,
        /// The byte of the minor version.
        minor: u8,
    },
    /// A header that numpy does not write.
    #[error(
        "the array's header is damaged: at byte {at}, {expected} is missing; write it anew by `numpy.save(\"dem.npy\", z)`"
    )]
    Header {
        /// Offset in the file.
        at: usize,
        /// What must stand there.
        expected: &'static str,
    },
    /// Elements that are no elevations.
    #[error(
        "the array's dtype is {found}, but elevations are real numbers in metres (f2, f4, f8, i1 to i8, u1 to u8): {mend}"
    )]
    Dtype {
        /// The dtype found, in the words of its kind.
        found: String,
        /// The expression of numpy that mends it.
        mend: &'static str,
    },
    /// An array that is no table.
    #[error("the array has {axes} {}, but elevations are rows of columns: save z.squeeze() or z.reshape(rows, columns)", if *axes == 1 { "axis" } else { "axes" })]
    Axes {
        /// Axes found.
        axes: usize,
    },
    /// Fewer bytes than the header says.
    #[error(
        "the array is truncated: it takes {expected} bytes, but the file has {found}; copy or save it again"
    )]
    Truncated {
        /// Bytes of a whole file, as far as its beginning tells.
        expected: u64,
        /// Bytes there are.
        found: usize,
    },
    /// More bytes than the header says.
    #[error("{bytes} bytes follow the array: save one array a file, and no more")]
    Trailing {
        /// Bytes behind the array.
        bytes: usize,
    },
    /// No cell size was given.
    #[error(
        "a numpy array has no cell size of its own: give its cells' edge in metres as cell_size_m (`?cell_size_m=0.5` in the query, `--cell-size-m 0.5` on the command line)"
    )]
    NoCellSize,
    /// A georeference for a file that has its own.
    #[error("{field} is for numpy arrays (.npy), and this map says its own: leave {field} out")]
    NotAnArray {
        /// The field that was given.
        field: &'static str,
    },
    /// An elevation that no ground has.
    #[error(
        "z[{row}, {column}] is {value:?}, outside {min} to {max} m, between which all ground of Earth, Moon and Mars lies: give metres, and NaN (or nodata_m) for unknown ground"
    )]
    Elevation {
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
}

impl NpyError {
    /// The field at fault, where the error lies in one.
    pub(crate) fn field(&self) -> Option<String> {
        match self {
            NpyError::NoCellSize => Some("cell_size_m".into()),
            NpyError::NotAnArray { field } => Some((*field).into()),
            NpyError::Elevation { row, column, .. } => Some(format!("elevation_m[{row}][{column}]")),
            _ => None,
        }
    }
}

fn but(found: Option<&str>) -> String {
    found.map_or(String::new(), |found| format!("; it is {found}"))
}
