//! The maps at hand.

use std::{
    collections::BTreeMap,
    sync::{Arc, PoisonError, RwLock},
};

use terrain::Terrain;

use crate::problem::{Problem, ProblemType};

/// Maps by content hash, in memory.
#[derive(Debug, Default)]
pub(crate) struct MapStore {
    maps: RwLock<BTreeMap<String, Arc<Terrain>>>,
}

impl MapStore {
    /// Keeps a map; the same map twice is one. Returns its id and whether it is new.
    pub(crate) fn insert(&self, terrain: Terrain, most_cells: usize) -> Result<(String, bool), Problem> {
        let id = terrain.content_id();
        let mut maps = self.maps.write().unwrap_or_else(PoisonError::into_inner);
        if maps.contains_key(&id) {
            return Ok((id, false));
        }
        let held: usize = maps.values().map(|map| map.grid.cells()).sum();
        if held + terrain.grid.cells() > most_cells {
            let detail = format!("{held} of {most_cells} cells are taken: delete a map first");
            return Err(Problem::new(ProblemType::StoreFull, detail));
        }
        maps.insert(id.clone(), Arc::new(terrain));
        Ok((id, true))
    }

    /// The map with an id.
    pub(crate) fn get(&self, id: &str) -> Result<Arc<Terrain>, Problem> {
        let maps = self.maps.read().unwrap_or_else(PoisonError::into_inner);
        maps.get(id).cloned().ok_or_else(|| unknown(id))
    }

    /// All maps in the order of their ids.
    pub(crate) fn list(&self) -> Vec<(String, Arc<Terrain>)> {
        let maps = self.maps.read().unwrap_or_else(PoisonError::into_inner);
        maps.iter().map(|(id, map)| (id.clone(), Arc::clone(map))).collect()
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
