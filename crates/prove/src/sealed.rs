//! Keys that are kept apart: sealed with the hashes of their case's files, committed to before a diagnosis, opened after.

use std::{collections::BTreeMap, path::Path};

use serde::{Serialize, de::DeserializeOwned};

use crate::{Commitments, Error, commitment::sha256, files};

/// What holds the truth of a case.
pub(crate) trait Sealed: Serialize + DeserializeOwned {
    /// SHA-256 of the files that the diagnosis gets, by file name.
    fn files(&self) -> &BTreeMap<String, String>;
}

/// Hashes of the files of a case.
pub(crate) fn hashes(folder: &Path) -> Result<BTreeMap<String, String>, Error> {
    let hash = |name: &&str| Ok(((*name).to_owned(), sha256(&files::read(&folder.join(name))?)));
    files::ALL.iter().map(hash).collect()
}

/// The file that a key is kept in.
pub(crate) fn bytes(key: &impl Serialize, path: &Path) -> Result<Vec<u8>, Error> {
    let text =
        serde_json::to_string_pretty(key).map_err(|source| Error::Content { path: path.into(), source })?;
    Ok((text + "\n").into_bytes())
}

/// Opens a key, if it is the one that was committed to and its case's files are those that it speaks of.
pub(crate) fn open<K: Sealed>(path: &Path, commitments: &Commitments, folder: &Path) -> Result<K, Error> {
    let bytes = commitments.open(path)?;
    let key: K =
        serde_json::from_slice(&bytes).map_err(|source| Error::Content { path: path.into(), source })?;
    for (name, hash) in key.files() {
        let path = folder.join(name);
        if sha256(&files::read(&path)?) != *hash {
            return Err(Error::ChangedCase { path });
        }
    }
    Ok(key)
}

/// Writes the keys of cases into a folder, by name, with the list of their hashes; the commitments, and the hash of that list.
pub(crate) fn commit<'k>(
    folder: &Path,
    keys: impl IntoIterator<Item = (&'k str, &'k [u8])>,
) -> Result<(Commitments, String), Error> {
    let mut commitments = Commitments::default();
    for (case, bytes) in keys {
        let name = file_name(case);
        let path = folder.join(&name);
        std::fs::write(&path, bytes).map_err(Error::file(&path))?;
        commitments.add(&name, bytes);
    }
    let text = commitments.text();
    files::write(&folder.join("SHA256SUMS"), &text)?;
    Ok((commitments, sha256(text.as_bytes())))
}

/// Name of the file that the key of a case is kept in.
pub(crate) fn file_name(case: &str) -> String {
    format!("{case}.json")
}
