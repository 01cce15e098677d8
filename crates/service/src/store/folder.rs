//! A folder as the store: what S3 does by itself, done on a disk.

use std::{
    fs::{self, File, TryLockError},
    io,
    path::{Path, PathBuf},
};

use tempfile::{NamedTempFile, TempDir, TempPath};

use super::KINDS;

/// Held by every service that uses the folder, so that the first of them knows that it is alone.
const LOCK: &str = ".lock";
/// Where what is being received lies until it is whole.
const INCOMING: &str = "incoming";

/// A folder that this service uses, perhaps among others.
#[derive(Debug)]
pub(crate) struct Folder {
    root: PathBuf,
    /// Shared with other services until this one ends, however it ends.
    _lock: File,
    /// Keeps a folder of the service's own until the service ends.
    own: Option<TempDir>,
}

impl Folder {
    /// Opens a folder, which is made; without one, one that lasts as long as the service. Also says whether no other
    /// service uses it; what killed services left half-written is then gone.
    pub(crate) fn open(root: Option<&Path>) -> io::Result<(Folder, bool)> {
        let own =
            root.is_none().then(|| tempfile::Builder::new().prefix("joulepath-").tempdir()).transpose()?;
        let root = match (root, &own) {
            (Some(root), _) => root.to_owned(),
            (None, own) => own.as_ref().map_or_else(PathBuf::new, |own| own.path().to_owned()),
        };
        for kind in KINDS.into_iter().chain([INCOMING]) {
            fs::create_dir_all(root.join(kind))?;
        }
        sync_folder(&root)?;
        let root = root.canonicalize()?;
        let lock = File::options().create(true).truncate(false).write(true).open(root.join(LOCK))?;
        let alone = match lock.try_lock() {
            Ok(()) => {
                sweep_half_written(&root)?;
                lock.unlock()?;
                true
            }
            Err(TryLockError::WouldBlock) => false,
            Err(TryLockError::Error(error)) => return Err(error),
        };
        lock.lock_shared()?;
        Ok((Folder { root, _lock: lock, own }, alone))
    }

    pub(crate) fn root(&self) -> &Path {
        &self.root
    }

    /// Whether it goes with the service.
    pub(crate) fn is_temporary(&self) -> bool {
        self.own.is_some()
    }

    /// Removes a folder of the service's own, before what still runs has let go of it.
    pub(crate) fn end(&self) {
        if let Some(own) = &self.own
            && let Err(error) = fs::remove_dir_all(own.path())
            && error.kind() != io::ErrorKind::NotFound
        {
            tracing::warn!("{} was left behind: {error}", own.path().display());
        }
    }

    /// A file for what is being received; gone again unless it is kept.
    pub(crate) fn spool(&self) -> io::Result<NamedTempFile> {
        tempfile::Builder::new().prefix(".received-").tempfile_in(self.root.join(INCOMING))
    }

    /// Gives a file its name once all of it is on disk, so that it is whole whenever it is seen.
    pub(crate) fn keep(&self, file: &File, path: TempPath, name: &str) -> io::Result<()> {
        file.sync_all()?;
        let kept = self.root.join(name);
        path.persist(&kept).map_err(|error| error.error)?;
        sync_parent(&kept)
    }

    pub(crate) fn open_file(&self, name: &str) -> io::Result<File> {
        File::open(self.root.join(name))
    }

    /// Makes a removal outlast a power cut.
    pub(crate) fn sync_removal(&self, name: &str) -> io::Result<()> {
        sync_parent(&self.root.join(name))
    }
}

/// Removes what services wrote when they were killed: files that were being received, and those that `object_store` writes
/// beside an object before it takes their place, called as the object with `#` and a number.
fn sweep_half_written(root: &Path) -> io::Result<()> {
    let mut folders: Vec<PathBuf> = KINDS.into_iter().chain([INCOMING]).map(|name| root.join(name)).collect();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder)? {
            let entry = entry?;
            if entry.file_type()?.is_dir() {
                folders.push(entry.path());
            } else if folder.ends_with(INCOMING) || entry.file_name().to_string_lossy().contains('#') {
                fs::remove_file(entry.path())?;
            }
        }
    }
    Ok(())
}

fn sync_parent(path: &Path) -> io::Result<()> {
    path.parent().map_or(Ok(()), sync_folder)
}

/// Makes what was named in a folder, or is no longer, outlast a power cut.
fn sync_folder(folder: &Path) -> io::Result<()> {
    #[cfg(unix)]
    File::open(folder)?.sync_all()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_who_is_alone_sweeps() {
        let root = tempfile::tempdir().unwrap();
        let left = root.path().join("maps").join("0f.json#1");
        let received = root.path().join(INCOMING).join(".received-x");
        let of_tenant = root.path().join("tenants/alice/maps");
        fs::create_dir_all(&of_tenant).unwrap();
        let (whole, half) = (of_tenant.join("0f.json"), of_tenant.join("0f.json#1"));
        let (first, alone) = Folder::open(Some(root.path())).unwrap();
        assert!(alone);
        fs::write(&left, "half").unwrap();
        fs::write(&received, "half").unwrap();
        fs::write(&half, "half").unwrap();
        fs::write(&whole, "whole").unwrap();
        let (second, alone) = Folder::open(Some(root.path())).unwrap();
        assert!(!alone && left.exists() && received.exists(), "they may belong to the first");
        drop((first, second));
        assert!(Folder::open(Some(root.path())).unwrap().1);
        assert!(!left.exists() && !received.exists() && !half.exists() && whole.exists());
    }
}
