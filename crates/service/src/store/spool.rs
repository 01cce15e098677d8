//! A file for what is being received or fetched, gone unless it is kept.

use std::{
    fs::File,
    io::{self, Seek},
};

use tempfile::TempPath;

/// A file without a place in the store yet. Where the store is a folder it lies in it, and needs only a name; else it has no
/// name anywhere, so that nothing is left of it whatever happens.
#[derive(Debug)]
pub(crate) struct Spool {
    pub(super) file: File,
    pub(super) path: Option<TempPath>,
}

impl Spool {
    /// The file to write to.
    pub(crate) fn writer(&self) -> io::Result<File> {
        self.file.try_clone()
    }

    /// Bytes that have been written.
    pub(crate) fn bytes(&self) -> io::Result<u64> {
        Ok(self.file.metadata()?.len())
    }

    /// The file from its beginning.
    pub(crate) fn reader(&self) -> io::Result<File> {
        let mut file = self.file.try_clone()?;
        file.rewind()?;
        Ok(file)
    }
}
