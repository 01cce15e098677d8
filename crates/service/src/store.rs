//! The maps at hand.

use std::{
    collections::BTreeMap,
    sync::{Arc, PoisonError, RwLock},
};

use terrain::Terrain;

use crate::{
    problem::{Problem, ProblemType},
    routes::maps::MapSummary,
};

/// Maps by content hash, in memory.
#[derive(Debug, Default)]
pub(crate) struct MapStore {
    maps: RwLock<BTreeMap<String, Stored>>,
}

/// A map with what is told of it.
#[derive(Clone, Debug)]
pub(crate) struct Stored {
    pub(crate) terrain: Arc<Terrain>,
    pub(crate) summary: MapSummary,
}

impl MapStore {
    /// Keeps a map; the same map twice is one. Returns whether it is new.
    pub(crate) fn insert(&self, map: Stored, most_cells: usize) -> Result<bool, Problem> {
        let mut maps = self.maps.write().unwrap_or_else(PoisonError::into_inner);
        if maps.contains_key(&map.summary.id) {
            return Ok(false);
        }
        let held: usize = maps.values().map(|map| map.terrain.grid.cells()).sum();
        if held + map.terrain.grid.cells() > most_cells {
            let detail = format!("{held} of {most_cells} cells are taken: delete a map first");
            return Err(Problem::new(ProblemType::StoreFull, detail));
        }
        maps.insert(map.summary.id.clone(), map);
        Ok(true)
    }

    /// The map with an id.
    pub(crate) fn get(&self, id: &str) -> Result<Arc<Terrain>, Problem> {
        let maps = self.maps.read().unwrap_or_else(PoisonError::into_inner);
        maps.get(id).map(|map| Arc::clone(&map.terrain)).ok_or_else(|| unknown(id))
    }

    /// All maps in brief, in the order of their ids.
    pub(crate) fn list(&self) -> Vec<MapSummary> {
        let maps = self.maps.read().unwrap_or_else(PoisonError::into_inner);
        maps.values().map(|map| map.summary.clone()).collect()
    }

    /// Forgets a map.
    pub(crate) fn remove(&self, id: &str) -> Result<(), Problem> {
        let mut maps = self.maps.write().unwrap_or_else(PoisonError::into_inner);
        maps.remove(id).map(drop).ok_or_else(|| unknown(id))
    }
}

fn unknown(id: &str) -> Problem {
    let shown: String = id.chars().take(64).collect();
    Problem::new(ProblemType::UnknownMap, format!("there is no map `{shown}`: POST it to /v1/maps first"))
}
