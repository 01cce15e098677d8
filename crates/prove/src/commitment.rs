//! Commitment to keys before they are used, in the form that `sha256sum --check` reads.

use std::{collections::BTreeMap, path::Path};

use sha2::{Digest, Sha256};

use crate::{Error, files};

/// Hashes of keys, by file name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Commitments(BTreeMap<String, String>);

/// The SHA-256 of bytes, in hexadecimal.
pub fn sha256(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

impl Commitments {
    /// Commits to a key.
    pub fn add(&mut self, file_name: &str, bytes: &[u8]) {
        self.0.insert(file_name.to_owned(), sha256(bytes));
    }

    /// One line for each key: hash, two blanks, name.
    pub fn text(&self) -> String {
        self.0.iter().map(|(name, hash)| format!("{hash}  {name}\n")).collect()
    }

    /// The contents of a key, if it is the one that was committed to.
    ///
    /// # Errors
    /// A key that has changed, or that nobody committed to.
    pub fn open(&self, path: &Path) -> Result<Vec<u8>, Error> {
        let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let Some(committed) = self.0.get(&name) else { return Err(Error::Uncommitted { path: path.into() }) };
        let bytes = files::read(path)?;
        let found = sha256(&bytes);
        if found == *committed {
            return Ok(bytes);
        }
        Err(Error::ChangedKey { path: path.into(), committed: committed.clone(), found })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_that_of_the_standard() {
        // FIPS 180-4, the published example of "abc".
        let abc = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(sha256(b"abc"), abc);
    }

    #[test]
    fn a_key_that_was_changed_by_one_bit_is_not_opened() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("case-0001.json");
        let mut commitments = Commitments::default();
        commitments.add("case-0001.json", b"payload 12");
        std::fs::write(&path, b"payload 12").unwrap();
        assert_eq!(commitments.open(&path).unwrap(), b"payload 12");
        std::fs::write(&path, b"payload 13").unwrap();
        assert!(matches!(commitments.open(&path), Err(Error::ChangedKey { .. })));
    }

    #[test]
    fn a_key_that_nobody_committed_to_is_not_opened() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("case-0002.json");
        std::fs::write(&path, b"anything").unwrap();
        assert!(matches!(Commitments::default().open(&path), Err(Error::Uncommitted { .. })));
    }
}
