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
mod pairs;
mod place;
mod plain_words;
mod spool;
mod sweep;

pub(crate) use fault::{cannot, full};
pub(crate) use id::{id_of, is_id, shown};
pub(crate) use lease::{Beat, Lease, Watched, leased};
pub(crate) use notes::Notes;
pub(crate) use objects::Store;
pub(crate) use pairs::Pairs;
pub use place::StoreError;
pub(crate) use spool::Spool;

/// What is kept: the first part of every object's name, and a folder where the store is one.
pub(crate) const KINDS: [&str; 5] = ["maps", "robots", "recordings", "jobs", "reports"];
