//! Who works on a job: of all services over a store, the one that made the lease with the highest number.
//!
//! A lease is an object that only one can create. Its holder writes it anew every few seconds; when it stops changing, another
//! creates the next number. So no clocks need to agree, and the store needs to know no more than "create if it is not there".
//! A holder that was only slow finds the higher number, or no lease at all, and gives up.

use std::{
    collections::BTreeSet,
    time::{Duration, Instant},
};

use serde::{Deserialize, Serialize};

use super::{KINDS, Store, cannot};
use crate::{
    job::{JobState, Progress},
    problem::Problem,
};

/// What a lease's name has between its job's id and its number.
const ENDING: &str = ".lease-";

/// What the holder last wrote.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Beat {
    /// Counts the holder's writings.
    pub(crate) count: u64,
    /// The holder has given it up.
    pub(crate) released: bool,
    /// How often a service died that worked on the job.
    #[serde(default)]
    pub(crate) deaths: u64,
    /// Where the job stands.
    pub(crate) sequence: u64,
    pub(crate) state: JobState,
    pub(crate) progress: Progress,
}

impl Beat {
    /// The first one of a job whose followers have been told so much.
    pub(crate) fn first(sequence: u64) -> Self {
        let progress = Progress { step: "waiting for its turn".into(), fraction: None };
        Beat { count: 0, released: false, deaths: 0, sequence, state: JobState::Queued, progress }
    }

    /// How often a service died that worked on the job, once this lease has ended. One that waited for its turn did no work
    /// that its service could have died of.
    pub(crate) fn deaths_at_end(&self) -> u64 {
        self.deaths + u64::from(!self.released && self.state == JobState::Running)
    }
}

/// The right to work on a job.
#[derive(Clone, Debug)]
pub(crate) struct Lease {
    job: String,
    /// How often the job has been taken up.
    pub(crate) number: u64,
}

impl Lease {
    /// The highest lease of a job, with what its holder last wrote.
    pub(crate) async fn latest(store: &Store, job: &str) -> Result<Option<(u64, Beat)>, Problem> {
        let Some(number) = numbers(store, job).await?.into_iter().max() else { return Ok(None) };
        let Some(bytes) = store.get(&name(job, number)).await? else { return Ok(None) };
        let beat = serde_json::from_slice(&bytes).map_err(|error| cannot("understand", &error))?;
        Ok(Some((number, beat)))
    }

    /// Takes a job up after a lease that ended, or none. `None`: another did.
    pub(crate) async fn take(
        store: &Store,
        job: &str,
        after: u64,
        beat: &Beat,
    ) -> Result<Option<Lease>, Problem> {
        let lease = Lease { job: job.to_owned(), number: after + 1 };
        let created = store.create(&name(job, lease.number), bytes(beat)?).await?;
        Ok(created.then_some(lease))
    }

    /// Says that the holder is still there. False: the job is no longer its.
    pub(crate) async fn beat(&self, store: &Store, beat: &Beat) -> Result<bool, Problem> {
        if numbers(store, &self.job).await?.into_iter().max() != Some(self.number) {
            return Ok(false);
        }
        store.put(&name(&self.job, self.number), bytes(beat)?).await?;
        Ok(true)
    }

    /// Removes all leases of a job.
    pub(crate) async fn clear(store: &Store, job: &str) -> Result<(), Problem> {
        for number in numbers(store, job).await? {
            store.remove(&name(job, number)).await?;
        }
        Ok(())
    }
}

/// The jobs that have leases.
pub(crate) async fn leased(store: &Store) -> Result<BTreeSet<String>, Problem> {
    let entries = store.list(KINDS[3]).await?;
    let job = |name: &str| parsed(name).map(|(job, _)| job.to_owned());
    Ok(entries.iter().filter_map(|entry| entry.location.filename().and_then(job)).collect())
}

#[cfg(test)]
impl Lease {
    /// The first lease of a job.
    pub(crate) fn first(job: &str) -> Lease {
        Lease { job: job.to_owned(), number: 1 }
    }
}

/// Ends the leases of services that are known to be no more.
pub(super) async fn release_all(store: &Store) -> object_store::Result<()> {
    for entry in store.listed(KINDS[3]).await? {
        let Some((job, number)) = entry.location.filename().and_then(parsed) else { continue };
        if release(store, &name(job, number)).await.is_err() {
            break;
        }
    }
    Ok(())
}

/// Ends one lease, counting the death of its holder.
async fn release(store: &Store, name: &str) -> Result<(), Problem> {
    let written = store.get(name).await?.unwrap_or_default();
    // What cannot be understood says nothing of its job.
    let last: Beat = serde_json::from_slice(&written).unwrap_or_else(|_| Beat::first(0));
    let released = Beat { released: true, deaths: last.deaths_at_end(), ..last };
    store.put(name, bytes(&released)?).await
}

/// What was seen of a lease, and since when it has not changed.
#[derive(Debug)]
pub(crate) struct Watched {
    number: u64,
    count: u64,
    since: Instant,
}

impl Watched {
    pub(crate) fn new(number: u64, beat: &Beat) -> Self {
        Watched { number, count: beat.count, since: Instant::now() }
    }

    /// Looks again. Whether the lease has ended: given up, or unchanged for so long.
    pub(crate) fn has_ended(&mut self, number: u64, beat: &Beat, lease_time: Duration) -> bool {
        if (self.number, self.count) != (number, beat.count) {
            *self = Watched::new(number, beat);
        }
        beat.released || self.since.elapsed() >= lease_time
    }
}

async fn numbers(store: &Store, job: &str) -> Result<Vec<u64>, Problem> {
    let entries = store.list(KINDS[3]).await?;
    let of_job = |name: &str| parsed(name).filter(|(of, _)| *of == job).map(|(_, number)| number);
    Ok(entries.iter().filter_map(|entry| entry.location.filename().and_then(of_job)).collect())
}

fn name(job: &str, number: u64) -> String {
    format!("{}/{job}{ENDING}{number}", KINDS[3])
}

fn parsed(name: &str) -> Option<(&str, u64)> {
    let (job, number) = name.split_once(ENDING)?;
    Some((job, number.parse().ok()?))
}

fn bytes(beat: &Beat) -> Result<Vec<u8>, Problem> {
    serde_json::to_vec(beat).map_err(|error| cannot("write to", &error))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[tokio::test]
    async fn of_many_who_take_a_lease_one_gets_it() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open_here(folder.path());
        for number in 0..3 {
            let beat = Beat::first(0);
            let takes = (0..10).map(|_| Lease::take(&store, "0f", number, &beat));
            let taken = futures_util::future::join_all(takes).await;
            assert_eq!(taken.into_iter().filter_map(|lease| lease.unwrap()).count(), 1);
        }
        assert_eq!(Lease::latest(&store, "0f").await.unwrap().unwrap().0, 3);
        assert_eq!(leased(&store).await.unwrap(), BTreeSet::from(["0f".to_owned()]));
    }

    #[tokio::test]
    async fn a_slow_holder_gives_up_when_another_has_taken_the_job() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open_here(folder.path());
        let slow = Lease::take(&store, "0f", 0, &Beat::first(0)).await.unwrap().unwrap();
        assert!(slow.beat(&store, &Beat { count: 1, ..Beat::first(0) }).await.unwrap());
        let other = Lease::take(&store, "0f", 1, &Beat::first(0)).await.unwrap().unwrap();
        assert!(!slow.beat(&store, &Beat::first(0)).await.unwrap());
        assert!(other.beat(&store, &Beat::first(0)).await.unwrap());
        Lease::clear(&store, "0f").await.unwrap();
        assert!(!other.beat(&store, &Beat::first(0)).await.unwrap(), "the job has ended");
        assert!(Lease::latest(&store, "0f").await.unwrap().is_none());
    }

    #[tokio::test]
    async fn a_death_is_counted_once_and_only_of_a_service_that_worked() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open_here(folder.path());
        let running = Beat { state: JobState::Running, deaths: 1, sequence: 5, ..Beat::first(0) };
        Lease::take(&store, "0f", 0, &running).await.unwrap().unwrap();
        Lease::take(&store, "1e", 0, &Beat::first(3)).await.unwrap().unwrap();
        for _ in 0..2 {
            release_all(&store).await.unwrap();
        }
        let (_, died) = Lease::latest(&store, "0f").await.unwrap().unwrap();
        assert_eq!((died.released, died.deaths_at_end(), died.sequence), (true, 2, 5));
        let (_, waited) = Lease::latest(&store, "1e").await.unwrap().unwrap();
        assert_eq!((waited.released, waited.deaths_at_end(), waited.sequence), (true, 0, 3));
    }

    #[test]
    fn a_lease_ends_when_it_is_released_or_no_longer_changes() {
        let beat = Beat::first(0);
        let (long, none) = (Duration::from_secs(3600), Duration::ZERO);
        let mut watched = Watched::new(1, &beat);
        assert!(!watched.has_ended(1, &beat, long));
        assert!(watched.has_ended(1, &beat, none));
        assert!(watched.has_ended(1, &Beat { released: true, ..beat.clone() }, long));
        let before = watched.since;
        assert!(!watched.has_ended(1, &Beat { count: 1, ..beat.clone() }, long));
        assert!(watched.since > before, "it is watched anew");
    }
}
