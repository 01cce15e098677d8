//! Small JSON documents of one kind by id, which say what is at hand.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
};

use futures_util::{StreamExt, TryStreamExt, stream};
use object_store::ObjectMeta;
use serde::{Serialize, de::DeserializeOwned};

use super::{Store, cannot, is_id};
use crate::problem::Problem;

/// How many are read side by side.
const PARALLEL_READS: usize = 16;

/// The notes of a kind. Those that were listed are kept in memory, each until the store has another version of it.
#[derive(Debug)]
pub(crate) struct Notes<T> {
    store: Store,
    /// First part of the names of all of them.
    under: String,
    listed: Mutex<BTreeMap<String, (String, Arc<T>)>>,
}

impl<T: Serialize + DeserializeOwned + Send + Sync> Notes<T> {
    pub(crate) fn new(store: &Store, under: impl Into<String>) -> Self {
        Notes { store: store.clone(), under: under.into(), listed: Mutex::default() }
    }

    /// The note of an id, if there is one.
    pub(crate) async fn get(&self, id: &str) -> Result<Option<T>, Problem> {
        if !is_id(id) {
            return Ok(None);
        }
        let Some(note) = self.read(id).await? else { return Ok(None) };
        note.map(Some).map_err(|error| cannot("understand", &error))
    }

    /// What stands in the note of an id, whether it can be understood or not.
    async fn read(&self, id: &str) -> Result<Option<serde_json::Result<T>>, Problem> {
        let name = self.name(id);
        let Some(bytes) = self.store.get(&name).await? else { return Ok(None) };
        let note = serde_json::from_slice(&bytes);
        if let Err(error) = &note {
            tracing::error!(object = name, %error, "cannot understand an object of the store: delete it, or put it right");
        }
        Ok(Some(note))
    }

    /// Whether an id has a note.
    pub(crate) async fn has(&self, id: &str) -> Result<bool, Problem> {
        if is_id(id) { self.store.has(&self.name(id)).await } else { Ok(false) }
    }

    /// Puts a note in place of whatever was there.
    pub(crate) async fn put(&self, id: &str, note: &T) -> Result<(), Problem> {
        self.store.put(&self.name(id), self.bytes(note)?).await
    }

    /// Puts a note where none is. False: there is one.
    pub(crate) async fn create(&self, id: &str, note: &T) -> Result<bool, Problem> {
        self.store.create(&self.name(id), self.bytes(note)?).await
    }

    /// Removes a note, if it is there.
    pub(crate) async fn remove(&self, id: &str) -> Result<(), Problem> {
        if is_id(id) { self.store.remove(&self.name(id)).await } else { Ok(()) }
    }

    /// All notes, in the order of their ids. One that cannot be understood is left out, so that the others do not go with it.
    pub(crate) async fn list(&self) -> Result<Vec<(String, Arc<T>)>, Problem> {
        let entries = self.entries().await?;
        let known = self.listed.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let known = &known;
        let reads = entries.into_iter().map(|(id, entry)| async move {
            let version = version(&entry);
            if let Some((_, note)) = known.get(&id).filter(|(read, _)| *read == version) {
                return Ok(Some((id, (version, Arc::clone(note)))));
            }
            // One that was removed since it was listed is not there.
            let note = self.read(&id).await?.and_then(Result::ok);
            Ok::<_, Problem>(note.map(|note| (id, (version, Arc::new(note)))))
        });
        let reads: Vec<_> = reads.collect();
        let read: Vec<_> = stream::iter(reads).buffer_unordered(PARALLEL_READS).try_collect().await?;
        let notes: BTreeMap<String, (String, Arc<T>)> = read.into_iter().flatten().collect();
        let list = notes.iter().map(|(id, (_, note))| (id.clone(), Arc::clone(note))).collect();
        *self.listed.lock().unwrap_or_else(PoisonError::into_inner) = notes;
        Ok(list)
    }

    /// The ids that have notes, with what the store says of these.
    pub(crate) async fn entries(&self) -> Result<Vec<(String, ObjectMeta)>, Problem> {
        let entries = self.store.list(&self.under).await?;
        let named = entries.into_iter().filter_map(|entry| {
            let id = entry.location.filename()?.strip_suffix(".json").filter(|id| is_id(id))?.to_owned();
            Some((id, entry))
        });
        Ok(named.collect())
    }

    fn name(&self, id: &str) -> String {
        format!("{}/{id}.json", self.under)
    }

    /// Bytes that a note takes.
    pub(crate) fn size(&self, note: &T) -> Result<u64, Problem> {
        Ok(self.bytes(note)?.len() as u64)
    }

    fn bytes(&self, note: &T) -> Result<Vec<u8>, Problem> {
        serde_json::to_vec(note).map_err(|error| cannot("write to", &error))
    }
}

/// What changes whenever an object does.
fn version(entry: &ObjectMeta) -> String {
    entry.e_tag.clone().unwrap_or_else(|| format!("{}-{}", entry.last_modified, entry.size))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn a_note_that_cannot_be_understood_is_left_out_of_a_list_and_told_to_who_asks_for_it() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open_here(folder.path());
        let notes = Notes::<u8>::new(&store, "jobs");
        let [sound, broken] = ["0f", "1e"].map(|digits| digits.repeat(16));
        notes.put(&sound, &7).await.unwrap();
        store.put(&notes.name(&broken), b"no number".to_vec()).await.unwrap();
        assert_eq!(notes.list().await.unwrap(), [(sound, Arc::new(7))]);
        assert!(notes.get(&broken).await.unwrap_err().detail.contains("understand"));
    }
}
