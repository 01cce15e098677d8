//! Clears away what services left that were killed between two objects of one thing.

use std::{collections::BTreeSet, time::Duration};

use object_store::ObjectMeta;

use super::{Store, lease, owned::folder};

/// Age beyond which nobody is still about to write what belongs to an object: longer than the longest upload.
const ABANDONED_AFTER: Duration = Duration::from_secs(24 * 3600);

/// Removes data without a note of any tenant: the note is written last and removed first, so that such data was never told to anyone, or is
/// told to be gone. Who is alone knows that nobody is about to write the note, and that who held a job is no more.
pub(super) async fn sweep(store: &Store, alone: bool) -> object_store::Result<()> {
    let tenants = store.named_tenants().await?;
    for kind in ["maps", "recordings"] {
        // Data first: what gets its note in the meantime is no orphan.
        let entries = store.listed(kind).await?;
        let mut noted = BTreeSet::new();
        for tenant in &tenants {
            let notes = store.listed(&folder(tenant, kind)).await?;
            noted.extend(notes.iter().filter_map(|note| stem(note, ".json").map(str::to_owned)));
        }
        let orphans = entries.iter().filter(|entry| {
            let id = stem(entry, ".data");
            id.is_some_and(|id| !noted.contains(id)) && (alone || is_abandoned(entry))
        });
        for entry in orphans {
            let name = entry.location.filename().unwrap_or_default();
            store.delete(&format!("{kind}/{name}")).await?;
        }
    }
    if alone { lease::release_all(store).await } else { Ok(()) }
}

fn stem<'a>(entry: &'a ObjectMeta, ending: &str) -> Option<&'a str> {
    entry.location.filename()?.strip_suffix(ending)
}

fn is_abandoned(entry: &ObjectMeta) -> bool {
    let age = std::time::SystemTime::from(entry.last_modified).elapsed();
    age.is_ok_and(|age| age > ABANDONED_AFTER)
}
