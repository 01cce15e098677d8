//! Data of any size, beside a note of each tenant that owns it. A note is written last and removed first, so that what has a note
//! is whole; data goes with its last note.

use std::{fs::File, sync::Arc};

use serde::{Serialize, de::DeserializeOwned};

use super::{Owned, Quota, Spool, Store, Usage, cannot, is_id};
use crate::{
    Tenant,
    problem::{Problem, ProblemType},
};

/// Data and notes of a kind.
#[derive(Debug)]
pub(crate) struct Pairs<T> {
    store: Store,
    kind: &'static str,
    pub(crate) notes: Owned<T>,
}

/// Data with its note.
#[derive(Debug)]
pub(crate) struct Noted<'a, T> {
    pub(crate) data: Spool,
    pub(crate) note: &'a T,
}

/// What a removal left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Removed {
    /// There was nothing that the tenant sees.
    Nothing,
    /// The note is gone; another tenant still owns the data.
    Note,
    /// Note and data are gone.
    Data,
}

impl<T: Serialize + DeserializeOwned + Send + Sync> Pairs<T> {
    pub(crate) fn new(store: &Store, kind: &'static str) -> Self {
        Pairs { store: store.clone(), kind, notes: Owned::new(store, kind) }
    }

    /// A file for what is being received.
    pub(crate) fn spool(&self) -> Result<Spool, Problem> {
        self.store.spool()
    }

    /// Keeps a file with a tenant's note, in place of what was there, if that is within the tenant's quota. Returns whether it
    /// is new to the tenant.
    pub(crate) async fn keep(
        &self,
        owner: &Tenant,
        id: &str,
        noted: Noted<'_, T>,
        quota: &Quota,
    ) -> Result<bool, Problem> {
        let Noted { data, note } = noted;
        let notes = self.notes.of(owner);
        let is_new = !notes.has(id).await?;
        if is_new {
            let bytes = data.bytes().map_err(|error| cannot("read from", &error))? + notes.size(note)?;
            quota.refuse_beyond(owner, Usage::of(&self.store, owner).await?.plus(bytes))?;
        }
        self.store.keep(data, &self.name(id)).await?;
        let _changing = self.store.changing().await;
        notes.put(id, note).await?;
        if is_new {
            // Others, at this service or another, may have stored something since it was counted.
            let counted = Usage::of(&self.store, owner).await;
            if let Err(problem) = counted.and_then(|usage| quota.refuse_beyond(owner, usage)) {
                self.drop_notes(id, std::slice::from_ref(owner)).await?;
                return Err(problem);
            }
        }
        if self.store.has(&self.name(id)).await? {
            return Ok(is_new);
        }
        // It was deleted between the two.
        self.notes.remove(owner, id).await?;
        let detail = format!("`{id}` was deleted while it was stored: send it again");
        Err(Problem::new(ProblemType::StoreUnavailable, detail))
    }

    /// Puts another note of an id that a tenant has in the place of the one there is; none where that has gone meanwhile.
    pub(crate) async fn replace_note(&self, owner: &Tenant, id: &str, note: &T) -> Result<(), Problem> {
        let _changing = self.store.changing().await;
        let notes = self.notes.of(owner);
        if notes.has(id).await? { notes.put(id, note).await } else { Ok(()) }
    }

    /// The data to be read, if it is there. Whether its reader may see it is asked of `notes`.
    pub(crate) async fn open(&self, id: &str) -> Result<Option<File>, Problem> {
        if is_id(id) { self.store.open_file(&self.name(id)).await } else { Ok(None) }
    }

    /// All notes that a tenant sees, in the order of their ids.
    pub(crate) async fn list(&self, tenant: &Tenant) -> Result<Vec<Arc<T>>, Problem> {
        Ok(self.notes.list(tenant).await?.into_iter().map(|(_, note)| note).collect())
    }

    /// Removes every note of an id that a tenant sees, and the data with the last of all notes. Who reads the data already can
    /// finish.
    pub(crate) async fn remove(&self, tenant: &Tenant, id: &str) -> Result<Removed, Problem> {
        if !is_id(id) || !self.notes.has(tenant, id).await? {
            return Ok(Removed::Nothing);
        }
        let _changing = self.store.changing().await;
        let mut seen = self.notes.holders(id).await?;
        seen.retain(|owner| tenant.sees(owner));
        if seen.is_empty() { Ok(Removed::Nothing) } else { self.drop_notes(id, &seen).await }
    }

    /// Removes the notes of tenants, and the data where no other has one.
    async fn drop_notes(&self, id: &str, owners: &[Tenant]) -> Result<Removed, Problem> {
        for owner in owners {
            self.notes.remove(owner, id).await?;
        }
        if !self.notes.holders(id).await?.is_empty() {
            return Ok(Removed::Note);
        }
        self.store.remove(&self.name(id)).await?;
        Ok(Removed::Data)
    }

    fn name(&self, id: &str) -> String {
        format!("{}/{id}.data", self.kind)
    }
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use super::*;

    const AMPLE: Quota = Quota { bytes: 1 << 20, objects: 100 };

    async fn keep(pairs: &Pairs<u8>, owner: &Tenant, id: &str, quota: &Quota) -> Result<bool, Problem> {
        let spool = pairs.spool().unwrap();
        spool.writer().unwrap().write_all(&[7; 100]).unwrap();
        pairs.keep(owner, id, Noted { data: spool, note: &1 }, quota).await
    }

    fn files(folder: &std::path::Path) -> Vec<String> {
        let names = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name());
        names.map(|name| name.into_string().unwrap()).collect()
    }

    #[tokio::test]
    async fn data_of_two_tenants_is_kept_once_and_until_both_have_dropped_it() {
        let folder = tempfile::tempdir().unwrap();
        let pairs = Pairs::new(&Store::open_here(folder.path()), "maps");
        let [alice, bob] = ["alice", "bob"].map(|name| Tenant::named(name).unwrap());
        let id = "0f".repeat(16);
        for (owner, is_new) in [(&alice, true), (&bob, true), (&bob, false)] {
            assert_eq!(keep(&pairs, owner, &id, &AMPLE).await.unwrap(), is_new);
        }
        let data = vec![format!("{id}.data")];
        assert_eq!(files(&folder.path().join("maps")), data);
        assert_eq!(pairs.remove(&Tenant::default(), &id).await.unwrap(), Removed::Nothing);
        assert_eq!(pairs.remove(&alice, &id).await.unwrap(), Removed::Note);
        assert_eq!(pairs.remove(&alice, &id).await.unwrap(), Removed::Nothing);
        assert!(pairs.notes.has(&bob, &id).await.unwrap());
        assert_eq!(files(&folder.path().join("maps")), data);
        assert_eq!(pairs.remove(&bob, &id).await.unwrap(), Removed::Data);
        assert_eq!(files(&folder.path().join("maps")), Vec::<String>::new());
    }

    #[tokio::test]
    async fn many_at_two_services_never_exceed_a_quota_and_leave_nothing_of_what_was_refused() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open_here(folder.path());
        let pairs = [(); 2].map(|()| Pairs::new(&Store::open_here(folder.path()), "maps"));
        let (alice, quota) = (Tenant::named("alice").unwrap(), Quota { bytes: 404, objects: 10 });
        let ids: Vec<String> = (0..16).map(|i| format!("{i:x}").repeat(32)).collect();
        let asked = ids.iter().enumerate().map(|(i, id)| keep(&pairs[i % 2], &alice, id, &quota));
        let outcomes = futures_util::future::join_all(asked).await;
        let kept = outcomes.iter().filter(|outcome| outcome.is_ok()).count();
        assert!((1..=4).contains(&kept), "{kept}");
        let usage = Usage::of(&store, &alice).await.unwrap();
        assert_eq!(usage, Usage { bytes: 101 * kept as u64, objects: kept });
        assert_eq!(files(&folder.path().join("maps")).len(), kept);
        for outcome in outcomes.into_iter().filter_map(Result::err) {
            assert_eq!(outcome.kind, ProblemType::StoreFull);
        }
    }
}
