//! Files that commands write: whole or not at all.

use std::{
    fs::{self, OpenOptions},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use anyhow::Context;
use tempfile::Builder;

use crate::{failure::BadInput, interrupt};

/// Refuses a file whose folder does not exist, before long work is done for it.
///
/// # Errors
/// A folder that is missing, or a folder in the file's place.
pub(crate) fn check(path: &Path) -> Result<(), BadInput> {
    let folder = folder(path);
    if path.is_dir() {
        return Err(BadInput(format!("{}: it is a folder; name a file", path.display())));
    }
    match folder.is_dir() {
        true => Ok(()),
        false => Err(BadInput(format!(
            "{}: there is no folder {}; make it first",
            path.display(),
            folder.display()
        ))),
    }
}

/// Writes a file.
///
/// # Errors
/// As [`write_with`].
pub(crate) fn write(path: &Path, bytes: impl AsRef<[u8]>) -> anyhow::Result<()> {
    write_with(path, |out| Ok(out.write_all(bytes.as_ref())?))
}

/// Writes a file beside its place and moves it there once it is complete. What is no ordinary file, as /dev/stdout, is written to.
///
/// # Errors
/// A file that cannot be written, or what `write` fails of.
pub(crate) fn write_with(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let named = || format!("cannot write {}", path.display());
    if fs::metadata(path).is_ok_and(|known| !known.is_file()) {
        let mut out = BufWriter::new(OpenOptions::new().write(true).open(path).with_context(named)?);
        write(&mut out)?;
        return out.flush().with_context(named);
    }
    // A link stays one: its target is replaced.
    let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
    let (file, path) = new_beside(&place).with_context(named)?.into_parts();
    let kept = interrupt::forget_on_interrupt(&path);
    let mut out = BufWriter::new(file);
    write(&mut out)?;
    out.flush().with_context(named)?;
    path.persist(&place).with_context(named)?;
    drop(kept);
    Ok(())
}

fn new_beside(place: &Path) -> io::Result<tempfile::NamedTempFile> {
    let mut builder = Builder::new();
    builder.prefix(".joulepath-").suffix(".part");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // What any new file may be, less what the user's mask takes away.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    builder.tempfile_in(folder(place))
}

fn folder(path: &Path) -> PathBuf {
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_replaced_whole_or_stays_as_it_was() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        write(&path, "before").unwrap();
        let failed = write_with(&path, |out| {
            out.write_all(b"half of what")?;
            anyhow::bail!("no more")
        });
        assert!(failed.is_err());
        assert_eq!(fs::read_to_string(&path).unwrap(), "before");
        write(&path, "after").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "after");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "nothing else is left behind");
    }

    #[test]
    fn a_missing_folder_is_said_before_the_work() {
        let folder = tempfile::tempdir().unwrap();
        let said = check(&folder.path().join("none/a.svg")).unwrap_err().to_string();
        assert!(said.contains("none") && said.contains("make it first"), "{said}");
        assert!(check(folder.path()).unwrap_err().to_string().contains("name a file"));
        assert!(check(Path::new("a.svg")).is_ok());
    }
}
