//! What a tenant keeps, counted from the store itself, and the quota that it may not exceed.

use std::collections::BTreeMap;

use object_store::ObjectMeta;

use super::{Store, fault::full, is_id, owned::folder};
use crate::{Tenant, problem::Problem};

/// Kinds that count as a tenant's objects. Jobs are counted while they are open, and reports are limited by their number.
const COUNTED_KINDS: [&str; 3] = ["maps", "robots", "recordings"];

/// Maps, robots and recordings that a tenant keeps. What several tenants keep counts in full for each of them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Usage {
    /// Bytes of notes and data.
    pub(crate) bytes: u64,
    /// Number of maps, robots and recordings.
    pub(crate) objects: usize,
}

/// Most that a tenant may keep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Quota {
    /// Bytes of notes and data.
    pub(crate) bytes: u64,
    /// Number of maps, robots and recordings.
    pub(crate) objects: usize,
}

impl Usage {
    /// The present usage of a tenant.
    pub(crate) async fn of(store: &Store, tenant: &Tenant) -> Result<Usage, Problem> {
        let mut usage = Usage::default();
        for kind in COUNTED_KINDS {
            let entries = store.list(kind).await?;
            let own = match tenant.is_default() {
                true => Vec::new(),
                false => store.list(&folder(tenant, kind)).await?,
            };
            let data_bytes: BTreeMap<&str, u64> =
                entries.iter().filter_map(|entry| Some((id(entry, ".data")?, entry.size))).collect();
            let notes = if tenant.is_default() { &entries } else { &own };
            for (id, note) in notes.iter().filter_map(|note| Some((id(note, ".json")?, note))) {
                usage.objects += 1;
                usage.bytes += note.size + data_bytes.get(id).unwrap_or(&0);
            }
        }
        Ok(usage)
    }

    /// The same with one more object.
    #[must_use]
    pub(crate) fn plus(self, bytes: u64) -> Usage {
        Usage { bytes: self.bytes.saturating_add(bytes), objects: self.objects + 1 }
    }
}

impl Quota {
    /// Refuses a tenant's usage that exceeds it. An administrator has no quota.
    pub(crate) fn refuse_beyond(&self, tenant: &Tenant, usage: Usage) -> Result<(), Problem> {
        if tenant.is_admin() || (usage.bytes <= self.bytes && usage.objects <= self.objects) {
            return Ok(());
        }
        let (most_bytes, most_objects) = (self.bytes, self.objects);
        let Usage { bytes, objects } = usage;
        let detail = format!(
            "with it the tenant `{}` would keep {objects} of {most_objects} maps, robots and recordings, and {bytes} of \
             {most_bytes} bytes: delete some first",
            tenant.name()
        );
        Err(full(detail))
    }
}

fn id<'a>(entry: &'a ObjectMeta, ending: &str) -> Option<&'a str> {
    entry.location.filename()?.strip_suffix(ending).filter(|id| is_id(id))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::problem::ProblemType;

    #[tokio::test]
    async fn usage_is_what_lies_in_the_store_for_each_who_owns_it() {
        let root = tempfile::tempdir().unwrap();
        let store = Store::open_here(root.path());
        let alice = Tenant::named("alice").unwrap();
        let [shared, own] = ["0f", "1e"].map(|digits| digits.repeat(16));
        for (name, bytes) in [
            (format!("maps/{shared}.data"), 1000),
            (format!("maps/{shared}.json"), 10),
            (format!("tenants/alice/maps/{shared}.json"), 20),
            (format!("tenants/alice/robots/{own}.json"), 300),
            (format!("tenants/alice/reports/{own}.json"), 7777),
            (format!("recordings/{own}.data"), 5555),
        ] {
            store.put(&name, vec![0; bytes]).await.unwrap();
        }
        let of_alice = Usage::of(&store, &alice).await.unwrap();
        assert_eq!(of_alice, Usage { bytes: 1320, objects: 2 });
        let of_default = Usage::of(&store, &Tenant::default()).await.unwrap();
        assert_eq!(of_default, Usage { bytes: 1010, objects: 1 });
    }

    #[test]
    fn a_quota_is_kept_to_the_last_byte_and_object_by_all_but_administrators() {
        let quota = Quota { bytes: 100, objects: 2 };
        let [alice, admin] = ["alice", "admin"].map(|name| Tenant::named(name).unwrap());
        let fits = |bytes, objects| quota.refuse_beyond(&alice, Usage { bytes, objects });
        assert!(fits(100, 2).is_ok());
        assert_eq!(fits(101, 1).unwrap_err().kind, ProblemType::StoreFull);
        assert_eq!(fits(1, 3).unwrap_err().kind, ProblemType::StoreFull);
        assert!(quota.refuse_beyond(&admin, Usage { bytes: 1000, objects: 1000 }).is_ok());
        assert_eq!(Usage::default().plus(7), Usage { bytes: 7, objects: 1 });
    }
}
