//! Objects by name: put, got, listed and removed.

use std::{fs::File, io, sync::Arc};

use futures_util::{StreamExt, TryStreamExt};
use object_store::{
    Error, ObjectMeta, ObjectStore, ObjectStoreExt, PutMode, PutPayload, buffered::BufWriter, path::Path,
};
use tokio::{
    io::AsyncWriteExt,
    sync::{Mutex, MutexGuard},
};

use super::{Spool, StoreError, TENANTS, cannot, folder::Folder, place::Place, sweep};
use crate::{Tenant, problem::Problem};

/// The name that is written and removed again to see whether the store can be used.
const PROBE: &str = "probe";

/// Where everything is kept; cheap to clone.
#[derive(Clone, Debug)]
pub(crate) struct Store {
    objects: Arc<dyn ObjectStore>,
    folder: Option<Arc<Folder>>,
    /// Held while notes come or go with their data.
    changing: Arc<Mutex<()>>,
}

impl Store {
    /// Opens a folder or `s3://BUCKET/PREFIX`; without either, a folder that lasts as long as the service. What killed
    /// services left is cleared away.
    ///
    /// Not to be called where tasks run.
    pub(crate) fn open(place: Option<&str>) -> Result<Store, StoreError> {
        let unusable = |source| StoreError::Unusable {
            place: place.unwrap_or("the temporary folder").to_owned(),
            source,
        };
        let Place { objects, folder, alone } = Place::open(place)?;
        // A bucket's connections belong to the runtime that opened them: this one, which ends at once, gets its own.
        let trial = match place.and_then(|place| place.strip_prefix("s3://")) {
            Some(address) => super::place::bucket(address).map_err(unusable)?,
            None => Arc::clone(&objects),
        };
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
        let runtime = runtime.map_err(|source| StoreError::System { source })?;
        let folder = folder.map(Arc::new);
        let changing = Arc::default();
        let trial = Store { objects: trial, folder: folder.clone(), changing: Arc::clone(&changing) };
        runtime
            .block_on(async {
                trial.probe().await?;
                sweep::sweep(&trial, alone).await
            })
            .map_err(unusable)?;
        Ok(Store { objects, folder, changing })
    }

    /// Whether what is kept is still there after the service has ended.
    pub(crate) fn outlasts_service(&self) -> bool {
        self.folder.as_ref().is_none_or(|folder| !folder.is_temporary())
    }

    /// Removes what does not outlast the service; nothing can be kept from now on.
    pub(crate) fn end(&self) {
        self.folder.iter().for_each(|folder| folder.end());
    }

    /// Whether an object can be written and removed.
    pub(crate) async fn check(&self) -> Result<(), Problem> {
        self.probe().await.map_err(|error| cannot("use", &error))
    }

    async fn probe(&self) -> object_store::Result<()> {
        let name = Path::from(format!("{PROBE}-{}", uuid::Uuid::new_v4().simple()));
        self.objects.put(&name, PutPayload::from_static(b"probe")).await?;
        self.objects.delete(&name).await
    }

    /// An object's bytes, if it is there.
    pub(crate) async fn get(&self, name: &str) -> Result<Option<Vec<u8>>, Problem> {
        let got = async { self.objects.get(&Path::from(name)).await?.bytes().await };
        match got.await {
            Ok(bytes) => Ok(Some(bytes.into())),
            Err(Error::NotFound { .. }) => Ok(None),
            Err(error) => Err(cannot("read from", &error)),
        }
    }

    /// Whether an object is there.
    pub(crate) async fn has(&self, name: &str) -> Result<bool, Problem> {
        match self.objects.head(&Path::from(name)).await {
            Ok(_) => Ok(true),
            Err(Error::NotFound { .. }) => Ok(false),
            Err(error) => Err(cannot("read from", &error)),
        }
    }

    /// Puts an object in place of whatever was there.
    pub(crate) async fn put(&self, name: &str, bytes: Vec<u8>) -> Result<(), Problem> {
        let put = self.objects.put(&Path::from(name), bytes.into()).await;
        put.map(drop).map_err(|error| cannot("write to", &error))
    }

    /// Puts an object where none is. False: there is one.
    pub(crate) async fn create(&self, name: &str, bytes: Vec<u8>) -> Result<bool, Problem> {
        match self.objects.put_opts(&Path::from(name), bytes.into(), PutMode::Create.into()).await {
            Ok(_) => Ok(true),
            Err(Error::AlreadyExists { .. } | Error::Precondition { .. }) => Ok(false),
            Err(error) => Err(cannot("write to", &error)),
        }
    }

    /// Removes an object, if it is there.
    pub(crate) async fn remove(&self, name: &str) -> Result<(), Problem> {
        self.delete(name).await.map_err(|error| cannot("delete from", &error))
    }

    pub(super) async fn delete(&self, name: &str) -> object_store::Result<()> {
        match self.objects.delete(&Path::from(name)).await {
            Ok(()) => {}
            Err(Error::NotFound { .. }) => return Ok(()),
            Err(error) => return Err(error),
        }
        let Some(folder) = self.folder.clone() else { return Ok(()) };
        let name = name.to_owned();
        let synced = tokio::task::spawn_blocking(move || folder.sync_removal(&name)).await?;
        synced.map_err(|source| Error::Generic { store: "folder", source: source.into() })
    }

    /// The right to change which notes there are beside their data, alone at this service.
    pub(crate) async fn changing(&self) -> MutexGuard<'_, ()> {
        self.changing.lock().await
    }

    /// The tenants that may own something here, `default` among them.
    pub(crate) async fn tenants(&self) -> Result<Vec<Tenant>, Problem> {
        self.named_tenants().await.map_err(|error| cannot("list", &error))
    }

    pub(super) async fn named_tenants(&self) -> object_store::Result<Vec<Tenant>> {
        let found = match self.objects.list_with_delimiter(Some(&Path::from(TENANTS))).await {
            Ok(found) => found.common_prefixes,
            Err(Error::NotFound { .. }) => Vec::new(),
            Err(error) => return Err(error),
        };
        let named = found.iter().filter_map(|prefix| Tenant::named(prefix.filename()?).ok());
        let mut tenants: Vec<Tenant> = named.chain([Tenant::default()]).collect();
        tenants.sort();
        tenants.dedup();
        Ok(tenants)
    }

    /// All objects of a kind.
    pub(crate) async fn list(&self, kind: &str) -> Result<Vec<ObjectMeta>, Problem> {
        self.listed(kind).await.map_err(|error| cannot("list", &error))
    }

    pub(super) async fn listed(&self, kind: &str) -> object_store::Result<Vec<ObjectMeta>> {
        let entries = self.objects.list(Some(&Path::from(kind)));
        // A folder's entry that goes while it is listed is not there.
        let present = entries.filter(|entry| {
            let gone = matches!(entry, Err(Error::NotFound { .. }));
            std::future::ready(!gone)
        });
        present.try_collect().await
    }

    /// A file for what is being received.
    pub(crate) fn spool(&self) -> Result<Spool, Problem> {
        let made = match &self.folder {
            Some(folder) => folder.spool().map(|named| {
                let (file, path) = named.into_parts();
                Spool { file, path: Some(path) }
            }),
            None => tempfile::tempfile().map(|file| Spool { file, path: None }),
        };
        made.map_err(|error| cannot("write to", &error))
    }

    /// Keeps a file that was written, as an object; it is never in memory as a whole.
    pub(crate) async fn keep(&self, spool: Spool, name: &str) -> Result<(), Problem> {
        let failed = |error: io::Error| cannot("write to", &error);
        if let (Some(folder), Some(path)) = (self.folder.clone(), spool.path) {
            let name = name.to_owned();
            let kept = tokio::task::spawn_blocking(move || folder.keep(&spool.file, path, &name)).await;
            return kept.unwrap_or_else(|error| Err(io::Error::other(error))).map_err(failed);
        }
        let from = Spool { file: spool.file, path: None }.reader().map_err(failed)?;
        let mut to = BufWriter::new(Arc::clone(&self.objects), Path::from(name));
        let copied = async {
            tokio::io::copy(&mut tokio::fs::File::from_std(from), &mut to).await?;
            to.shutdown().await
        };
        let copied = copied.await;
        if copied.is_err() {
            // What is not told to be complete never becomes an object.
            let _ = to.abort().await;
        }
        copied.map_err(failed)
    }

    /// An object as a file to be read, if it is there: its own where the store is a folder, else a copy without a name.
    pub(crate) async fn open_file(&self, name: &str) -> Result<Option<File>, Problem> {
        if let Some(folder) = self.folder.clone() {
            let name = name.to_owned();
            let opened = tokio::task::spawn_blocking(move || folder.open_file(&name)).await;
            return match opened.unwrap_or_else(|error| Err(io::Error::other(error))) {
                Ok(file) => Ok(Some(file)),
                Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
                Err(error) => Err(cannot("read from", &error)),
            };
        }
        let got = match self.objects.get(&Path::from(name)).await {
            Ok(got) => got,
            Err(Error::NotFound { .. }) => return Ok(None),
            Err(error) => return Err(cannot("read from", &error)),
        };
        let spool = self.spool()?;
        let mut chunks = got.into_stream();
        let copied = async {
            let mut to = tokio::fs::File::from_std(spool.writer()?);
            while let Some(chunk) = chunks.next().await {
                to.write_all(&chunk.map_err(io::Error::other)?).await?;
            }
            to.flush().await
        };
        copied.await.and_then(|()| spool.reader()).map(Some).map_err(|error| cannot("read from", &error))
    }
}

#[cfg(test)]
impl Store {
    /// A folder as the store, for tests where tasks run.
    pub(crate) fn open_here(folder: &std::path::Path) -> Store {
        let Place { objects, folder, .. } = Place::open(folder.to_str()).unwrap();
        Store { objects, folder: folder.map(Arc::new), changing: Arc::default() }
    }
}
