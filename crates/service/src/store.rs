//! Where everything is kept that outlasts a request: objects by name, in a folder or in a bucket that speaks S3.
//!
//! An object is there as a whole or not at all, and what has been put is still there after the process was killed. Names are
//! made here, of a kind and an id that was checked: nothing that a request says becomes a path.

mod fault;
mod folder;
mod id;
mod lease;
mod notes;
mod objects;
mod owned;
mod pairs;
mod place;
mod plain_words;
mod spool;
mod sweep;
mod usage;

pub(crate) use fault::{cannot, full};
pub(crate) use id::{id_of, is_id, shown};
pub(crate) use lease::{Beat, Lease, Watched, leased};
pub(crate) use notes::Notes;
pub(crate) use objects::Store;
pub(crate) use owned::Owned;
pub(crate) use pairs::{Noted, Pairs, Removed};
pub use place::StoreError;
pub(crate) use spool::Spool;
pub(crate) use usage::{Quota, Usage};

/// What is kept: the first part of every object's name, and a folder where the store is one. Notes of the tenant `default` lie
/// under their kind, as before there were tenants; those of others lie under `tenants/NAME/`.
pub(crate) const KINDS: [&str; 6] = ["maps", "robots", "recordings", "jobs", "reports", TENANTS];
/// First part of the names of the notes of all tenants but `default`.
const TENANTS: &str = "tenants";
