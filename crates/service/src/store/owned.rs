//! Notes of one kind, each tenant's apart: who has a note of an id owns what it stands for.

use std::{
    collections::BTreeMap,
    sync::{Arc, Mutex, PoisonError},
    time::{Duration, Instant},
};

use quick_cache::sync::Cache;
use serde::{Serialize, de::DeserializeOwned};

use super::{Notes, Store, TENANTS};
use crate::{Tenant, problem::Problem};

/// How long a note is believed to be in the store still: after a removal at another service, it is found for so long.
const BELIEVED: Duration = Duration::from_secs(2);
/// Most notes of which it is kept when they were last seen.
const SEEN_NOTES: usize = 10_000;

/// The notes of a kind by tenant and id.
#[derive(Debug)]
pub(crate) struct Owned<T> {
    store: Store,
    kind: &'static str,
    tenants: Mutex<BTreeMap<Tenant, Arc<Notes<T>>>>,
    seen: Cache<(Tenant, String), Instant>,
}

impl<T: Serialize + DeserializeOwned + Send + Sync> Owned<T> {
    pub(crate) fn new(store: &Store, kind: &'static str) -> Self {
        Owned { store: store.clone(), kind, tenants: Mutex::default(), seen: Cache::new(SEEN_NOTES) }
    }

    /// The notes that one tenant owns.
    pub(crate) fn of(&self, tenant: &Tenant) -> Arc<Notes<T>> {
        let mut tenants = self.tenants.lock().unwrap_or_else(PoisonError::into_inner);
        let notes = tenants
            .entry(tenant.clone())
            .or_insert_with(|| Arc::new(Notes::new(&self.store, folder(tenant, self.kind))));
        Arc::clone(notes)
    }

    /// The note of an id that a tenant sees.
    pub(crate) async fn get(&self, tenant: &Tenant, id: &str) -> Result<Option<T>, Problem> {
        Ok(self.find(tenant, id).await?.map(|(_, note)| note))
    }

    /// The note of an id that a tenant sees, with its owner.
    pub(crate) async fn find(&self, tenant: &Tenant, id: &str) -> Result<Option<(Tenant, T)>, Problem> {
        for owner in self.visible(tenant).await? {
            if let Some(note) = self.of(&owner).get(id).await? {
                return Ok(Some((owner, note)));
            }
        }
        Ok(None)
    }

    /// Whether a tenant sees a note of an id.
    pub(crate) async fn has(&self, tenant: &Tenant, id: &str) -> Result<bool, Problem> {
        for owner in self.visible(tenant).await? {
            if self.of(&owner).has(id).await? {
                return Ok(true);
            }
        }
        Ok(false)
    }

    /// The same as it was a short while ago, for requests that come often. While the store is out of reach, what was seen before
    /// is believed.
    pub(crate) async fn had_lately(&self, tenant: &Tenant, id: &str) -> Result<bool, Problem> {
        let key = (tenant.clone(), id.to_owned());
        let seen = self.seen.get(&key);
        if seen.is_some_and(|seen| seen.elapsed() <= BELIEVED) {
            return Ok(true);
        }
        match self.has(tenant, id).await {
            Ok(true) => self.seen.insert(key, Instant::now()),
            Ok(false) => {
                self.seen.remove(&key);
                return Ok(false);
            }
            Err(problem) if seen.is_none() => return Err(problem),
            Err(_) => {}
        }
        Ok(true)
    }

    /// All notes that a tenant sees, in the order of their ids, one of each id.
    pub(crate) async fn list(&self, tenant: &Tenant) -> Result<Vec<(String, Arc<T>)>, Problem> {
        let mut notes = BTreeMap::new();
        for owner in self.visible(tenant).await? {
            for (id, note) in self.of(&owner).list().await? {
                notes.entry(id).or_insert(note);
            }
        }
        Ok(notes.into_iter().collect())
    }

    /// All notes, whoever owns them, one of each id.
    pub(crate) async fn list_all(&self) -> Result<Vec<(String, Arc<T>)>, Problem> {
        let mut notes = BTreeMap::new();
        for owner in self.store.tenants().await? {
            notes.extend(self.of(&owner).list().await?);
        }
        Ok(notes.into_iter().collect())
    }

    /// Whether the store has tenants beside `default`.
    pub(crate) async fn has_several_owners(&self) -> Result<bool, Problem> {
        Ok(self.store.tenants().await?.len() > 1)
    }

    /// The tenants that own an id.
    pub(crate) async fn holders(&self, id: &str) -> Result<Vec<Tenant>, Problem> {
        let mut holders = Vec::new();
        for owner in self.store.tenants().await? {
            if self.of(&owner).has(id).await? {
                holders.push(owner);
            }
        }
        Ok(holders)
    }

    /// Removes a tenant's note.
    pub(crate) async fn remove(&self, owner: &Tenant, id: &str) -> Result<(), Problem> {
        self.of(owner).remove(id).await?;
        // An administrator may have seen it as well.
        self.seen.retain(|(_, seen), _| seen != id);
        Ok(())
    }

    /// Whose notes a tenant sees, its own first.
    pub(crate) async fn visible(&self, tenant: &Tenant) -> Result<Vec<Tenant>, Problem> {
        let mut owners = vec![tenant.clone()];
        if tenant.is_admin() {
            let others = self.store.tenants().await?;
            owners.extend(others.into_iter().filter(|other| other != tenant));
        }
        Ok(owners)
    }
}

/// First part of the names of a tenant's notes.
pub(super) fn folder(tenant: &Tenant, kind: &str) -> String {
    if tenant.is_default() { kind.to_owned() } else { format!("{TENANTS}/{}/{kind}", tenant.name()) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tenant(name: &str) -> Tenant {
        Tenant::named(name).unwrap()
    }

    #[tokio::test]
    async fn a_tenant_sees_its_own_notes_and_an_administrator_those_of_all() {
        let folder = tempfile::tempdir().unwrap();
        let notes = Owned::<u32>::new(&Store::open_here(folder.path()), "robots");
        let (alice, bob, admin) = (tenant("alice"), tenant("bob"), tenant("admin"));
        let [shared, own] = ["0f", "1e"].map(|digits| digits.repeat(16));
        notes.of(&alice).put(&shared, &1).await.unwrap();
        notes.of(&Tenant::default()).put(&shared, &2).await.unwrap();
        notes.of(&bob).put(&own, &3).await.unwrap();
        assert_eq!(notes.get(&alice, &shared).await.unwrap(), Some(1));
        assert_eq!(notes.get(&alice, &own).await.unwrap(), None);
        assert_eq!(notes.get(&admin, &own).await.unwrap(), Some(3));
        let ids = async |tenant: &Tenant| -> Vec<String> {
            notes.list(tenant).await.unwrap().into_iter().map(|(id, _)| id).collect()
        };
        assert_eq!(ids(&alice).await, std::slice::from_ref(&shared));
        assert_eq!(ids(&bob).await, std::slice::from_ref(&own));
        assert_eq!(ids(&admin).await, [shared.clone(), own.clone()]);
        assert_eq!(notes.holders(&shared).await.unwrap(), [alice.clone(), Tenant::default()]);
        notes.remove(&alice, &shared).await.unwrap();
        assert!(!notes.has(&alice, &shared).await.unwrap());
        assert_eq!(notes.holders(&shared).await.unwrap(), [Tenant::default()]);
    }

    #[tokio::test]
    async fn what_is_removed_here_is_not_believed_to_be_there() {
        let folder = tempfile::tempdir().unwrap();
        let notes = Owned::<u32>::new(&Store::open_here(folder.path()), "maps");
        let (alice, admin, id) = (tenant("alice"), tenant("admin"), "0f".repeat(16));
        notes.of(&alice).put(&id, &1).await.unwrap();
        for seer in [&alice, &admin] {
            assert!(notes.had_lately(seer, &id).await.unwrap());
        }
        assert!(!notes.had_lately(&tenant("bob"), &id).await.unwrap());
        notes.remove(&alice, &id).await.unwrap();
        for seer in [&alice, &admin] {
            assert!(!notes.had_lately(seer, &id).await.unwrap());
        }
    }
}
