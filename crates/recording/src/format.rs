//! The formats of recordings, by a file's first bytes or its name.

use std::{fs::File, io::Seek, path::Path};

use serde::{Deserialize, Serialize};

use crate::{Error, mcap, reading::read_up_to};

/// The first bytes of a SQLite file, by <https://www.sqlite.org/fileformat.html>, section 1.3.
const SQLITE_MAGIC: &[u8] = b"SQLite format 3\0";

/// The first bytes of a Zstandard frame, by RFC 8878, section 3.1.1.
pub(crate) const ZSTD_MAGIC: [u8; 4] = [0x28, 0xb5, 0x2f, 0xfd];

/// Bytes that tell every format.
pub(crate) const HEAD_BYTES: u64 = SQLITE_MAGIC.len() as u64;

/// A file format of recordings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "openapi", derive(utoipa::ToSchema))]
#[serde(rename_all = "snake_case")]
pub enum Format {
    /// Comma-, semicolon- or tab-separated text with a header line.
    Csv,
    /// Parquet with the same columns.
    Parquet,
    /// A ROS 2 MCAP file.
    Mcap,
    /// A ROS 1 bag, version 2.0.
    Bag,
    /// The SQLite file that `ros2 bag record` writes by default up to Humble.
    Db3,
}

impl Format {
    /// The format that a file name's ending stands for.
    ///
    /// # Errors
    /// The ending, when it stands for none.
    pub fn of(path: &Path) -> Result<Format, Error> {
        let ending = path.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
        match ending.as_str() {
            "csv" | "tsv" | "txt" => Ok(Format::Csv),
            "parquet" => Ok(Format::Parquet),
            "mcap" => Ok(Format::Mcap),
            "bag" => Ok(Format::Bag),
            "db3" => Ok(Format::Db3),
            _ => Err(Error::UnknownFormat { ending: format!(".{ending}") }),
        }
    }

    /// The format that the first bytes of a file show; text shows none.
    pub fn of_content(head: &[u8]) -> Option<Format> {
        let begins = |magic: &[u8]| head.starts_with(magic);
        match () {
            () if begins(mcap::MAGIC) => Some(Format::Mcap),
            () if begins(SQLITE_MAGIC) => Some(Format::Db3),
            () if begins(b"#ROSBAG V") => Some(Format::Bag),
            () if begins(b"PAR1") => Some(Format::Parquet),
            () => None,
        }
    }
}

impl Format {
    /// The format that an open file's first bytes show; the file is then at its beginning again.
    ///
    /// # Errors
    /// When it cannot be read.
    pub fn of_file(file: &mut File) -> Result<Option<Format>, Error> {
        Ok(Format::of_content(&head(file)?))
    }
}

/// The first bytes of an open file, which is then at its beginning again.
pub(crate) fn head(file: &mut File) -> Result<Vec<u8>, Error> {
    let mut head = Vec::new();
    read_up_to(file, HEAD_BYTES, &mut head)?;
    file.rewind()?;
    Ok(head)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn content_tells_the_format_whatever_the_name() {
        assert_eq!(Format::of_content(b"\x89MCAP0\r\n\x01"), Some(Format::Mcap));
        assert_eq!(Format::of_content(b"SQLite format 3\0"), Some(Format::Db3));
        assert_eq!(Format::of_content(b"#ROSBAG V2.0\n"), Some(Format::Bag));
        assert_eq!(Format::of_content(b"PAR1"), Some(Format::Parquet));
        assert_eq!(Format::of_content(b"t_s,v_left_mps"), None);
        assert_eq!(Format::of_content(b""), None);
    }
}
