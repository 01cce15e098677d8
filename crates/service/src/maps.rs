//! The maps at hand: in the store, and those that were asked for lately in memory.

use std::{
    io::{BufReader, BufWriter},
    sync::{
        Arc, Mutex, PoisonError, Weak,
        atomic::{AtomicU64, Ordering},
    },
};

use quick_cache::{DefaultHashBuilder, OptionsBuilder, Weighter, sync::Cache};
use terrain::{Terrain, io::cells};

use crate::{
    Tenant,
    memory::{Memory, Reserved, hold},
    problem::{Problem, ProblemType},
    routes::maps::MapSummary,
    store::{Noted, Pairs, Quota, Removed, Store, cannot, full, is_id, shown},
};

/// Maps that the cache has room for at first; it grows.
const MAPS: usize = 64;
/// Bytes of a cell in memory: its elevation, surface, obstacle and whether it was filled in.
const CELL_BYTES: u64 = 7;
/// A tenant among others may take one part of so many of the cells: no tenant alone keeps all others out.
const TENANT_SHARE: usize = 2;
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
    /// What those have reserved together who use it: it may leave the cache before they are done.
    in_use: Mutex<Weak<Reserved>>,
}

/// Most that maps may take: all of them, and those of a tenant with what else it keeps.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MapLimits {
    pub(crate) stored_cells: usize,
    pub(crate) quota: Quota,
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

    /// Keeps a map for a tenant; the same map twice is one. Returns whether it is new to the tenant.
    pub(crate) async fn insert(
        &self,
        owner: &Tenant,
        map: Stored,
        limits: &MapLimits,
    ) -> Result<bool, Problem> {
        let id = map.summary.id.clone();
        if self.maps.notes.of(owner).has(&id).await? {
            return Ok(false);
        }
        self.refuse_cells_beyond(limits.stored_cells, owner, &map.summary).await?;
        let (spool, terrain) = (self.maps.spool()?, Arc::clone(&map.terrain));
        let written = tokio::task::spawn_blocking(move || {
            cells::write(&terrain, BufWriter::with_capacity(BUFFER_BYTES, spool.writer()?))?;
            Ok(spool)
        });
        let spool = written.await.unwrap_or_else(|error| Err(std::io::Error::other(error)));
        let spool = spool.map_err(|error| cannot("write to", &error))?;
        let noted = Noted { data: spool, note: &map.summary };
        let is_new = self.maps.keep(owner, &id, noted, &limits.quota).await?;
        self.held.insert(id, Arc::new(Held::new(map.terrain)));
        Ok(is_new)
    }

    /// What a tenant calls a map, if anything.
    pub(crate) async fn name(&self, tenant: &Tenant, id: &str) -> Result<Option<String>, Problem> {
        Ok(self.maps.notes.get(tenant, id).await?.and_then(|summary| summary.name))
    }

    /// A map that is at hand under the name that it was sent with, or else the one that it has. Each tenant has names of its own.
    pub(crate) async fn renamed(&self, owner: &Tenant, summary: MapSummary) -> Result<MapSummary, Problem> {
        let Some(kept) = self.maps.notes.of(owner).get(&summary.id).await? else { return Ok(summary) };
        if summary.name.is_none() {
            return Ok(MapSummary { name: kept.name, ..summary });
        }
        if summary.name != kept.name {
            let renamed = MapSummary { name: summary.name.clone(), ..kept };
            self.maps.replace_note(owner, &summary.id, &renamed).await?;
        }
        Ok(summary)
    }

    /// Refuses one more map of a tenant beyond so many cells of all tenants, or beyond its share of them.
    async fn refuse_cells_beyond(
        &self,
        most: usize,
        owner: &Tenant,
        map: &MapSummary,
    ) -> Result<(), Problem> {
        let cells = |summary: &MapSummary| summary.rows * summary.columns;
        let sum = |maps: Vec<(String, Arc<MapSummary>)>| -> usize {
            maps.iter().filter(|(other, _)| *other != map.id).map(|(_, one)| cells(one)).sum()
        };
        let more = cells(map);
        let all = sum(self.maps.notes.list_all().await?);
        let own = sum(self.maps.notes.of(owner).list().await?);
        let share = if self.shares(owner).await? { most / TENANT_SHARE } else { most };
        let detail = if own + more > share {
            let name = owner.name();
            format!(
                "with it the tenant `{name}` would keep {} of {share} cells of maps: delete some first",
                own + more
            )
        } else if all + more <= most {
            return Ok(());
        } else if owner.is_admin() {
            format!("{all} of {most} cells are taken, and it has {more}: delete a map first")
        } else {
            // What others keep is not this tenant's to know.
            format!(
                "there is no room for its {more} cells: send a map of larger cells, or ask who runs the service for room \
                 (--stored-cells)"
            )
        };
        Err(full(detail))
    }

    /// Whether a tenant shares the store with others, so that it may not take all of it. An administrator may.
    async fn shares(&self, owner: &Tenant) -> Result<bool, Problem> {
        // Only tokens give names, and who has those may give more.
        Ok(!owner.is_admin() && (!owner.is_default() || self.maps.notes.has_several_owners().await?))
    }

    /// The map with an id, if a tenant sees it, read from the store once for all who ask at the same time.
    pub(crate) async fn get(&self, tenant: &Tenant, id: &str) -> Result<Arc<Terrain>, Problem> {
        if !is_id(id) || !self.maps.notes.had_lately(tenant, id).await? {
            return Err(unknown(id));
        }
        let held = self.held.get_or_insert_async(id, self.read(tenant, id)).await?;
        hold(held.in_use(&self.memory)?);
        Ok(Arc::clone(&held.terrain))
    }

    async fn read(&self, tenant: &Tenant, id: &str) -> Result<Arc<Held>, Problem> {
        let summary = self.maps.notes.get(tenant, id).await?.ok_or_else(|| unknown(id))?;
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
        let held = Held::new(Arc::new(terrain));
        *held.in_use.lock().unwrap_or_else(PoisonError::into_inner) = Arc::downgrade(&in_use);
        hold(in_use);
        Ok(Arc::new(held))
    }

    /// All maps that a tenant sees in brief, in the order of their ids.
    pub(crate) async fn list(&self, tenant: &Tenant) -> Result<Vec<MapSummary>, Problem> {
        let summaries = self.maps.list(tenant).await?;
        Ok(summaries.iter().map(|summary| MapSummary::clone(summary)).collect())
    }

    /// Forgets a map for a tenant, or for all if it sees all. Returns whether nobody has it any more.
    pub(crate) async fn remove(&self, tenant: &Tenant, id: &str) -> Result<bool, Problem> {
        match self.maps.remove(tenant, id).await? {
            Removed::Nothing => Err(unknown(id)),
            Removed::Note => Ok(false),
            Removed::Data => {
                self.held.remove(id);
                Ok(true)
            }
        }
    }
}

impl Held {
    fn new(terrain: Arc<Terrain>) -> Self {
        Held { terrain, in_use: Mutex::default() }
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

    const LIMITS: MapLimits =
        MapLimits { stored_cells: usize::MAX, quota: Quota { bytes: u64::MAX, objects: usize::MAX } };

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
        assert!(one.insert(&Tenant::default(), stored.clone(), &LIMITS).await.unwrap());
        assert!(!other.insert(&Tenant::default(), stored.clone(), &LIMITS).await.unwrap());
        let tenant = Tenant::default();
        let asked = (0..20).map(|_| other.get(&tenant, &stored.summary.id));
        for found in futures_util::future::join_all(asked).await {
            assert_eq!(*found.unwrap(), *stored.terrain);
        }
        assert_eq!((one.reads.into_inner(), other.reads.into_inner()), (0, 1));
    }

    #[tokio::test]
    async fn a_map_has_the_name_that_it_was_last_sent_with_and_each_tenant_its_own() {
        let folder = tempfile::tempdir().unwrap();
        let maps = MapStore::new(&Store::open_here(folder.path()), 1 << 20, &memory());
        let [alice, bob] = ["alice", "bob"].map(|name| Tenant::named(name).unwrap());
        let sent = async |owner: &Tenant, name: Option<&str>| {
            let mut stored = map(4);
            stored.summary.name = name.map(str::to_owned);
            let summary = stored.summary.clone();
            if maps.insert(owner, stored, &LIMITS).await.unwrap() {
                return summary.name;
            }
            maps.renamed(owner, summary).await.unwrap().name
        };
        assert_eq!(sent(&alice, Some("yard")).await.as_deref(), Some("yard"));
        assert_eq!(sent(&bob, None).await, None);
        assert_eq!(sent(&alice, None).await.as_deref(), Some("yard"), "no name takes none away");
        assert_eq!(sent(&alice, Some("field")).await.as_deref(), Some("field"));
        let id = map(4).summary.id;
        assert_eq!(maps.name(&alice, &id).await.unwrap().as_deref(), Some("field"));
        assert_eq!(maps.name(&bob, &id).await.unwrap(), None);
        assert_eq!(maps.list(&alice).await.unwrap()[0].name.as_deref(), Some("field"));
    }

    #[tokio::test]
    async fn maps_beyond_the_room_in_memory_are_read_again() {
        let folder = tempfile::tempdir().unwrap();
        let maps = MapStore::new(&Store::open_here(folder.path()), 3 * 100 * CELL_BYTES as usize, &memory());
        let all: Vec<Stored> = (1..=100).map(map).collect();
        for stored in &all {
            maps.insert(&Tenant::default(), stored.clone(), &LIMITS).await.unwrap();
        }
        for stored in &all {
            assert_eq!(*maps.get(&Tenant::default(), &stored.summary.id).await.unwrap(), *stored.terrain);
        }
        assert!(maps.held.weight() <= 3 * 100 * CELL_BYTES, "{}", maps.held.weight());
        assert!(maps.reads.into_inner() > 50);
    }

    #[tokio::test]
    async fn no_tenant_takes_all_the_room_and_none_learns_what_others_keep() {
        let folder = tempfile::tempdir().unwrap();
        let maps = MapStore::new(&Store::open_here(folder.path()), 1 << 20, &memory());
        let limits = MapLimits { stored_cells: 60, ..LIMITS };
        let [alice, bob, carol, admin] =
            ["alice", "bob", "carol", "admin"].map(|name| Tenant::named(name).unwrap());
        let insert = async |owner: &Tenant, rows| maps.insert(owner, map(rows), &limits).await;
        let refused = async |owner: &Tenant, rows| {
            let problem = insert(owner, rows).await.unwrap_err();
            assert_eq!(problem.kind, ProblemType::StoreFull);
            problem.detail
        };
        let said = refused(&alice, 11).await;
        assert!(said.contains("`alice` would keep 33 of 30 cells") && said.contains("delete"), "{said}");
        assert!(insert(&alice, 10).await.unwrap(), "half is its share");
        assert!(insert(&bob, 10).await.unwrap(), "the same map of another counts once for all");
        assert!(insert(&bob, 9).await.is_err());
        assert!(insert(&carol, 9).await.unwrap());
        let said = refused(&Tenant::default(), 2).await;
        assert!(said.contains("no room for its 6 cells") && said.contains("--stored-cells"), "{said}");
        assert!(!said.contains("57") && !said.contains("60") && !said.contains("delete"), "{said}");
        let said = refused(&admin, 2).await;
        assert!(said.contains("57 of 60"), "{said}");
        assert!(insert(&admin, 1).await.unwrap());
    }

    #[tokio::test]
    async fn who_is_alone_may_take_all_the_room() {
        let folder = tempfile::tempdir().unwrap();
        let maps = MapStore::new(&Store::open_here(folder.path()), 1 << 20, &memory());
        let limits = MapLimits { stored_cells: 60, ..LIMITS };
        let alone = Tenant::default();
        assert!(maps.insert(&alone, map(20), &limits).await.unwrap());
        let said = maps.insert(&alone, map(1), &limits).await.unwrap_err().detail;
        assert!(said.contains("would keep 63 of 60 cells of maps: delete"), "{said}");
    }

    #[tokio::test]
    async fn a_map_that_was_changed_where_it_is_stored_is_told_instead_of_planned_over() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::open_here(folder.path());
        let stored = map(4);
        MapStore::new(&store, 1 << 20, &memory())
            .insert(&Tenant::default(), stored.clone(), &LIMITS)
            .await
            .unwrap();
        let path = folder.path().join(format!("maps/{}.data", stored.summary.id));
        let mut bytes = std::fs::read(&path).unwrap();
        let last = bytes.len() - 1;
        bytes[last] ^= 1;
        std::fs::write(&path, bytes).unwrap();
        let problem = MapStore::new(&store, 1 << 20, &memory())
            .get(&Tenant::default(), &stored.summary.id)
            .await
            .unwrap_err();
        assert!(problem.detail.contains("was changed where it is stored"), "{problem:?}");
    }
}
