//! Planners of the robots and maps that were asked about lately, with all that they have worked out.

use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use model::{Robot, robot::RobotFile};
use planner::{Patience, Planner, Settings};
use terrain::{CellRange, Terrain};

/// A map by its content.
#[derive(Clone, Copy, Debug)]
pub struct KeyedMap<'a> {
    /// Hash of its content, by which a map in a request is the stored one of the same content.
    pub id: &'a str,
    /// The ground.
    pub terrain: &'a Terrain,
    /// Whether the store of maps holds it too; else the planner alone keeps it.
    pub is_stored: bool,
}

/// Bytes of a cell that a planner keeps of ground that nobody else does: its elevation and three layers of a byte, and what the robot
/// stands on, touches and keeps clear of.
const OWN_GROUND_BYTES_PER_CELL: usize = 4 + 3 + 4 + 2;

/// A planner that is kept.
#[derive(Clone)]
struct Kept {
    key: Key,
    planner: Arc<Planner>,
    /// Bytes of ground that it alone keeps.
    ground_bytes: usize,
}

impl Kept {
    fn bytes(&self) -> usize {
        self.ground_bytes + self.planner.bytes()
    }
}

/// A map, a robot and how it is driven.
#[derive(Clone, Debug, PartialEq)]
struct Key {
    map_id: String,
    robot: RobotFile,
    settings: Settings,
}

/// Longest preparation of the planners of a patched map: the time that an answer may take to notice its deadline.
const PATCH_TIME: Duration = Duration::from_millis(50);

/// Planners by what they are for, the latest at the end.
#[derive(Default)]
pub struct Planners {
    kept: Mutex<Vec<Kept>>,
}

impl Planners {
    /// The planner for a map, made if it is not at hand, and whether it was.
    pub(crate) fn get(
        &self,
        map: KeyedMap<'_>,
        robot: &Robot,
        settings: Settings,
        patience: &Patience,
    ) -> Result<(Arc<Planner>, bool), planner::Error> {
        let KeyedMap { id, terrain, is_stored } = map;
        let key = Key { map_id: id.to_owned(), robot: RobotFile::from(robot.clone()), settings };
        let mut kept = self.lock();
        if let Some(at) = kept.iter().position(|kept| kept.key == key) {
            let found = kept.remove(at);
            let planner = Arc::clone(&found.planner);
            kept.push(found);
            return Ok((planner, true));
        }
        drop(kept);
        let planner = Arc::new(Planner::prepare(terrain, robot, settings, patience)?);
        let ground_bytes = if is_stored { 0 } else { terrain.grid.cells() * OWN_GROUND_BYTES_PER_CELL };
        self.keep(Kept { key, planner: Arc::clone(&planner), ground_bytes });
        Ok((planner, false))
    }

    /// Keeps a planner, which knows of the others over its map: what one has worked out may serve the same robot that drives faster or carries
    /// more.
    fn keep(&self, new: Kept) {
        let mut kept = self.lock();
        let others = kept.iter().filter(|other| other.key.map_id == new.key.map_id);
        others.for_each(|other| new.planner.relate(&other.planner));
        kept.push(new);
    }

    /// Whether there is a planner for a map, whatever the robot and settings.
    pub(crate) fn knows(&self, map_id: &str) -> bool {
        self.lock().iter().any(|kept| kept.key.map_id == map_id)
    }

    /// Bytes that all planners hold.
    pub(crate) fn bytes(&self) -> usize {
        self.lock().iter().map(Kept::bytes).sum()
    }

    /// Makes planners for a map that differs from another in some cells only, out of those of the other, within
    /// [`PATCH_TIME`]; the rest are made when they are asked for.
    pub(crate) fn patch(&self, from_id: &str, to_id: &str, terrain: &Terrain, changed: &CellRange) {
        let patience = Patience::until(Instant::now() + PATCH_TIME);
        let from: Vec<Kept> = self.lock().iter().filter(|kept| kept.key.map_id == from_id).cloned().collect();
        for Kept { key, planner, .. } in from {
            let key = Key { map_id: to_id.to_owned(), ..key };
            // A surface that the robot lacks is told when it is asked for a path.
            let Ok(planner) = planner.patched(terrain, changed, &patience) else { continue };
            self.keep(Kept { key, planner: Arc::new(planner), ground_bytes: 0 });
        }
    }

    /// Forgets the planners of a map.
    pub(crate) fn forget(&self, map_id: &str) {
        self.lock().retain(|kept| kept.key.map_id != map_id);
    }

    /// Forgets what was not asked for lately until the rest holds so many bytes at most.
    pub fn shrink(&self, most_bytes: usize) {
        let mut kept = self.lock();
        let mut held: usize = kept.iter().map(Kept::bytes).sum();
        while held > most_bytes && !kept.is_empty() {
            held -= kept.remove(0).bytes().min(held);
        }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Kept>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
