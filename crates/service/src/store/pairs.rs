//! Data of any size, each beside a note of what it is: the note is written last and removed first, so that what has a note is
//! whole.

use std::{fs::File, sync::Arc};

use serde::{Serialize, de::DeserializeOwned};
use tokio::sync::Mutex;

use super::{Notes, Spool, Store, is_id};
use crate::problem::{Problem, ProblemType};

/// Data and notes of a kind.
#[derive(Debug)]
pub(crate) struct Pairs<T> {
    store: Store,
    kind: &'static str,
    notes: Notes<T>,
    /// Held while a note comes or goes with its data.
    changing: Mutex<()>,
}

impl<T: Serialize + DeserializeOwned + Send + Sync> Pairs<T> {
    pub(crate) fn new(store: &Store, kind: &'static str) -> Self {
        Pairs { store: store.clone(), kind, notes: Notes::new(store, kind), changing: Mutex::new(()) }
    }

    /// A file for what is being received.
    pub(crate) fn spool(&self) -> Result<Spool, Problem> {
        self.store.spool()
    }

    /// Keeps a file with its note, in place of what was there.
    pub(crate) async fn keep(&self, id: &str, data: Spool, note: &T) -> Result<(), Problem> {
        self.store.keep(data, &self.name(id)).await?;
        let _changing = self.changing.lock().await;
        self.notes.put(id, note).await?;
        if self.store.has(&self.name(id)).await? {
            return Ok(());
        }
        // It was deleted between the two.
        self.notes.remove(id).await?;
        let detail = format!("`{id}` was deleted while it was stored: send it again");
        Err(Problem::new(ProblemType::StoreUnavailable, detail))
    }

    pub(crate) async fn has(&self, id: &str) -> Result<bool, Problem> {
        self.notes.has(id).await
    }

    pub(crate) async fn note(&self, id: &str) -> Result<Option<T>, Problem> {
        self.notes.get(id).await
    }

    /// The data to be read, if it is there.
    pub(crate) async fn open(&self, id: &str) -> Result<Option<File>, Problem> {
        if is_id(id) { self.store.open_file(&self.name(id)).await } else { Ok(None) }
    }

    /// All notes, in the order of their ids.
    pub(crate) async fn list(&self) -> Result<Vec<Arc<T>>, Problem> {
        Ok(self.notes.list().await?.into_iter().map(|(_, note)| note).collect())
    }

    /// Removes data and note. False: there was none. Who reads the data already can finish.
    pub(crate) async fn remove(&self, id: &str) -> Result<bool, Problem> {
        let _changing = self.changing.lock().await;
        if !self.notes.has(id).await? {
            return Ok(false);
        }
        self.notes.remove(id).await?;
        self.store.remove(&self.name(id)).await?;
        Ok(true)
    }

    fn name(&self, id: &str) -> String {
        format!("{}/{id}.data", self.kind)
    }
}
