//! The formats of recordings, by a file's first bytes or its name.

use std::{
    fs::File,
    io::Seek,
    path::{Path, PathBuf},
};

use serde::{Deserialize, Serialize};

use crate::{Error, mcap, reading::read_up_to, ulog};

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
    /// Comma-, semicolon-, tab- or space-separated text with a header line, packed with gzip or zstd or not.
    Csv,
    /// Parquet with the same columns.
    Parquet,
    /// A ROS 2 MCAP file.
    Mcap,
    /// A ROS 1 bag, version 2.0.
    Bag,
    /// The SQLite file that `ros2 bag record` writes by default up to Humble.
    Db3,
    /// A log of PX4.
    Ulog,
}

impl Format {
    /// The format that a file name's ending stands for; text may be packed, as `drive.csv.gz`.
    ///
    /// # Errors
    /// The ending, when it stands for none.
    pub fn of(path: &Path) -> Result<Format, Error> {
        let inner = unpacked_name(path);
        let (ending, is_packed) = (ending_of(&inner), inner != path);
        match ending.as_str() {
            "csv" | "tsv" | "txt" => Ok(Format::Csv),
            "parquet" if !is_packed => Ok(Format::Parquet),
            "mcap" if !is_packed => Ok(Format::Mcap),
            "bag" if !is_packed => Ok(Format::Bag),
            // What `rosbag record` writes to until it is stopped.
            "active" if !is_packed && ending_of(&path.with_extension("")) == "bag" => Ok(Format::Bag),
            "db3" if !is_packed => Ok(Format::Db3),
            "ulg" if !is_packed => Ok(Format::Ulog),
            // Of a name as `drive.gz` the content has to tell, which is that of text or refused.
            "" if ending_of(path) == "gz" => Ok(Format::Csv),
            "" if is_packed => Err(Error::UnknownFormat { ending: format!(".{}", ending_of(path)) }),
            _ if is_packed => Err(Error::UnknownFormat { ending: format!(".{ending}.{}", ending_of(path)) }),
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
            () if begins(ulog::MAGIC) => Some(Format::Ulog),
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

/// The name of a file without the ending of what it is packed with.
fn unpacked_name(path: &Path) -> PathBuf {
    let is_packed = matches!(ending_of(path).as_str(), "gz" | "zst" | "zstd");
    if is_packed { path.with_extension("") } else { path.to_owned() }
}

pub(crate) fn ending_of(path: &Path) -> String {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default().to_ascii_lowercase()
}

/// The name of a run that its file does not name: that of the file without its ending, or of the folder.
pub(crate) fn run_name(path: &Path) -> String {
    let whole = path.canonicalize().unwrap_or_else(|_| path.to_owned());
    let path = if path.file_name().is_some() { path } else { &whole };
    let unpacked = unpacked_name(path);
    let name = if path.is_dir() { path.file_name() } else { unpacked.file_stem() };
    name.and_then(|name| name.to_str()).unwrap_or("recording").to_owned()
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
