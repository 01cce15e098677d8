//! The maps at hand: in the store, and those that were asked for lately in memory.

use std::{
    io::{BufReader, BufWriter},
    sync::{
        Arc, Mutex, PoisonError, Weak,
        atomic::{AtomicU64, Ordering},
    },
    time::{Duration, Instant},
};

use quick_cache::{DefaultHashBuilder, OptionsBuilder, Weighter, sync::Cache};
use terrain::{Terrain, io::cells};

use crate::{
    memory::{Memory, Reserved, hold},
    problem::{Problem, ProblemType},
    routes::maps::MapSummary,
    store::{Pairs, Store, cannot, full, is_id, shown},
};

/// How long a map in memory is believed to be in the store still: who deletes it at another service waits so long.
const BELIEVED: Duration = Duration::from_secs(2);
/// Maps that the cache has room for at first; it grows.
const MAPS: usize = 64;
/// Bytes of a cell in memory: its elevation, surface and obstacle.
const CELL_BYTES: u64 = 6;
/// Bytes that are collected before they are written, or read at a time.
const BUFFER_BYTES: usize = 1 << 20;

/// Maps by content hash: cells and summaries in the store, cells in memory.
#[derive(Debug)]
pub(crate) struct MapStore {
    maps: Pairs<MapSummary>,
    held: Cache<String, Arc<Held>, Bytes>,
    reads: AtomicU64,
    memory: Memory,
}

/// A map with what is told of it.
#[derive(Clone, Debug)]
pub(crate) struct Stored {
    pub(crate) terrain: Arc<Terrain>,
    pub(crate) summary: MapSummary,
}

/// A map in memory.
#[derive(Debug)]
struct Held {
    terrain: Arc<Terrain>,
    /// When it was last known to be in the store.
    seen: Mutex<Instant>,
    /// What those have reserved together who use it: it may leave the cache before they are done.
    in_use: Mutex<Weak<Reserved>>,
}

/// Maps weigh what they take in memory.
#[derive(Clone, Debug)]
struct Bytes;

impl Weighter<String, Arc<Held>> for Bytes {
    fn weight(&self, _: &String, held: &Arc<Held>) -> u64 {
        CELL_BYTES * held.terrain.grid.cells() as u64
    }
}

impl MapStore {
    /// The maps of a store, of which so many bytes at most are kept in memory.
    pub(crate) fn new(store: &Store, most_bytes: usize, memory: &Memory) -> Self {
        let options = OptionsBuilder::new()
            .estimated_items_capacity(MAPS)
            .weight_capacity(most_bytes as u64)
            // All the room in one: a map may need most of it.
            .shards(1)
            .build();
        // Every number is given, so that the options are complete.
        let held = match options {
            Ok(options) => {
                Cache::with_options(options, Bytes, DefaultHashBuilder::default(), Default::default())
            }
            Err(_) => Cache::with_weighter(MAPS, most_bytes as u64, Bytes),
        };
        MapStore { maps: Pairs::new(store, "maps"), held, reads: AtomicU64::new(0), memory: memory.clone() }
    }

    /// Keeps a map; the same map twice is one. Returns whether it is new.
    pub(crate) async fn insert(&self, map: Stored, most_cells: usize) -> Result<bool, Problem> {
        let id = map.summary.id.clone();
        if self.maps.has(&id).await? {
            return Ok(false);
        }
        let cells = |summary: &MapSummary| summary.rows * summary.columns;
        let held: usize = self.maps.list().await?.iter().map(|summary| cells(summary)).sum();
        if held + cells(&map.summary) > most_cells {
            return Err(full(format!("{held} of {most_cells} cells are taken: delete a map first")));
        }
        let (spool, terrain) = (self.maps.spool()?, Arc::clone(&map.terrain));
        let written = tokio::task::spawn_blocking(move || {
            cells::write(&terrain, BufWriter::with_capacity(BUFFER_BYTES, spool.writer()?))?;
            Ok(spool)
        });
        let spool = written.await.unwrap_or_else(|error| Err(std::io::Error::other(error)));
        self.maps.keep(&id, spool.map_err(|error| cannot("write to", &error))?, &map.summary).await?;
        self.held.insert(id, Arc::new(Held::now(map.terrain)));
        Ok(true)
    }

    /// The map with an id, read from the store once for all who ask at the same time.
    pub(crate) async fn get(&self, id: &str) -> Result<Arc<Terrain>, Problem> {
        if !is_id(id) {
            return Err(unknown(id));
        }
        let held = self.held.get_or_insert_async(id, self.read(id)).await?;
        if held.is_to_be_checked() {
            match self.maps.has(id).await {
                Ok(true) => held.check(),
                Ok(false) => {
                    self.held.remove(id);
                    return Err(unknown(id));
                }
                // Its content is what its id says, wherever the store is.
                Err(_) => {}
            }
        }
        hold(held.in_use(&self.memory)?);
        Ok(Arc::clone(&held.terrain))
    }

    async fn read(&self, id: &str) -> Result<Arc<Held>, Problem> {
        let summary = self.maps.note(id).await?.ok_or_else(|| unknown(id))?;
        let in_use = Arc::new(self.memory.reserve(
            CELL_BYTES.saturating_mul(summary.rows as u64).saturating_mul(summary.columns as u64),
        )?);
        let file = self.maps.open(id).await?.ok_or_else(|| unknown(id))?;
        let read = tokio::task::spawn_blocking(move || {
            cells::read(BufReader::with_capacity(BUFFER_BYTES, file))
                .map(|terrain| (terrain.content_id(), terrain))
        });
        let read = read.await.unwrap_or_else(|error| Err(std::io::Error::other(error)));
        let (content_id, terrain) = read.map_err(|error| cannot("understand", &error))?;
        if content_id != id {
            let detail =
                format!("the stored map `{id}` was changed where it is stored: delete it and POST it again");
            return Err(Problem::new(ProblemType::Internal, detail));
        }
        self.reads.fetch_add(1, Ordering::Relaxed);
        let held = Held::now(Arc::new(terrain));
        *held.in_use.lock().unwrap_or_else(PoisonError::into_inner) = Arc::downgrade(&in_use);
        hold(in_use);
        Ok(Arc::new(held))
    }

    /// All maps in brief, in the order of their ids.
    pub(crate) async fn list(&self) -> Result<Vec<MapSummary>, Problem> {
        Ok(self.maps.list().await?.iter().map(|summary| MapSummary::clone(summary)).collect())
    }

    /// Forgets a map.
    pub(crate) async fn remove(&self, id: &str) -> Result<(), Problem> {
        let was_there = self.maps.remove(id).await?;
        self.held.remove(id);
        if was_there { Ok(()) } else { Err(unknown(id)) }
    }
}

impl Held {
    fn now(terrain: Arc<Terrain>) -> Self {
        Held { terrain, seen: Mutex::new(Instant::now()), in_use: Mutex::default() }
    }

    /// The right to its memory for one more who uses it; it is counted once for all of them.
    fn in_use(&self, memory: &Memory) -> Result<Arc<Reserved>, Problem> {
        let mut in_use = self.in_use.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(reserved) = in_use.upgrade() {
            return Ok(reserved);
        }
        let reserved = Arc::new(memory.reserve(CELL_BYTES * self.terrain.grid.cells() as u64)?);
        *in_use = Arc::downgrade(&reserved);
        Ok(reserved)
    }

    fn is_to_be_checked(&self) -> bool {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).elapsed() > BELIEVED
    }

    fn check(&self) {
        *self.seen.lock().unwrap_or_else(PoisonError::into_inner) = Instant::now();
    }
}

fn unknown(id: &str) -> Problem {
    let detail = format!("there is no map `{}`: POST it to /v1/maps first", shown(id));
    Problem::new(ProblemType::UnknownMap, detail)
}

#[cfg(test)]
mod tests {
    use terrain::Grid;

    use super::*;
    use crate::metrics::Metrics;

    fn memory() -> Memory {
        Memory::new(1 << 30, &Metrics::new())
    }

    fn map(rows: usize) -> Stored {
        let grid = Grid { rows, columns: 3, cell_size_m: 1.0, origin_m: [0.0; 2] };
        let terrain = Terrain::new(grid, &vec![1.0; 3 * rows]).unwrap();
        Stored { summary: MapSummary::of(terrain.content_id(), &terrain), terrain: Arc::new(terrain) }
    }

    #[tokio::test]
    async fn who_ask_for_a_map_at_the_same_time_read_it_once() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open_here(folder.path());
        let (one, other) =
            (MapStore::new(&store, 1 << 20, &memory()), MapStore::new(&store, 1 << 20, &memory()));
        let stored = map(5);
        assert!(one.insert(stored.clone(), usize::MAX).await.unwrap());
        assert!(!other.insert(stored.clone(), usize::MAX).await.unwrap());
        let asked = (0..20).map(|_| other.get(&stored.summary.id));
        for found in futures_util::future::join_all(asked).await {
            assert_eq!(*found.unwrap(), *stored.terrain);
        }
        assert_eq!((one.reads.into_inner(), other.reads.into_inner()), (0, 1));
    }

    #[tokio::test]
    async fn maps_beyond_the_room_in_memory_are_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let maps = MapStore::new(&Store::open_here(folder.path()), 3 * 100 * CELL_BYTES as usize, &memory());
        let all: Vec<Stored> = (1..=100).map(map).collect();
        for stored in &all {
            maps.insert(stored.clone(), usize::MAX).await.unwrap();
        }
        for stored in &all {
            assert_eq!(*maps.get(&stored.summary.id).await.unwrap(), *stored.terrain);
        }
        assert!(maps.held.weight() <= 3 * 100 * CELL_BYTES, "{}", maps.held.weight());
        assert!(maps.reads.into_inner() > 50);
    }

    #[tokio::test]
    async fn a_map_that_was_changed_where_it_is_stored_is_told_instead_of_planned_over() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open_here(folder.path());
        let stored = map(4);
        MapStore::new(&store, 1 << 20, &memory()).insert(stored.clone(), usize::MAX).await.unwrap();
        let path = folder.path().join(format!("maps/{}.data", stored.summary.id));
        let mut bytes = std::fs::read(&path).unwrap();
        let last = bytes.len() - 1;
        bytes[last] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        let problem = MapStore::new(&store, 1 << 20, &memory()).get(&stored.summary.id).await.unwrap_err();
        assert!(problem.detail.contains("was changed where it is stored"), "{problem:?}");
    }
}
