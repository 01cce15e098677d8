//! Planners of the robots and maps that were asked about lately, with all that they have worked out.

use std::{
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use model::{Robot, robot::RobotFile};
use planner::{Patience, Planner, Settings};
use terrain::{CellRange, Terrain};

/// A stored map, a robot and how it is driven.
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
    kept: Mutex<Vec<(Key, Arc<Planner>)>>,
}

impl Planners {
    /// The planner for a stored map, made if it is not at hand, and whether it was.
    pub(crate) fn get(
        &self,
        map_id: &str,
        terrain: &Terrain,
        robot: &Robot,
        settings: Settings,
        patience: &Patience,
    ) -> Result<(Arc<Planner>, bool), planner::Error> {
        let key = Key { map_id: map_id.to_owned(), robot: RobotFile::from(robot.clone()), settings };
        let mut kept = self.lock();
        if let Some(at) = kept.iter().position(|(other, _)| *other == key) {
            let found = kept.remove(at);
            let planner = Arc::clone(&found.1);
            kept.push(found);
            return Ok((planner, true));
        }
        drop(kept);
        let planner = Arc::new(Planner::prepare(terrain, robot, settings, patience)?);
        self.lock().push((key, Arc::clone(&planner)));
        Ok((planner, false))
    }

    /// Whether there is a planner for a stored map, whatever the robot and settings.
    pub(crate) fn knows(&self, map_id: &str) -> bool {
        self.lock().iter().any(|(key, _)| key.map_id == map_id)
    }

    /// Bytes that all planners hold.
    pub(crate) fn bytes(&self) -> usize {
        self.lock().iter().map(|(_, planner)| planner.bytes()).sum()
    }

    /// Makes planners for a map that differs from another in some cells only, out of those of the other, within
    /// [`PATCH_TIME`]; the rest are made when they are asked for.
    pub(crate) fn patch(&self, from_id: &str, to_id: &str, terrain: &Terrain, changed: &CellRange) {
        let patience = Patience::until(Instant::now() + PATCH_TIME);
        let from: Vec<_> = self.lock().iter().filter(|(key, _)| key.map_id == from_id).cloned().collect();
        for (key, planner) in from {
            let key = Key { map_id: to_id.to_owned(), ..key };
            // A surface that the robot lacks is told when it is asked for a path.
            let Ok(planner) = planner.patched(terrain, changed, &patience) else { continue };
            self.lock().push((key, Arc::new(planner)));
        }
    }

    /// Forgets the planners of a map.
    pub(crate) fn forget(&self, map_id: &str) {
        self.lock().retain(|(key, _)| key.map_id != map_id);
    }

    /// Forgets what was not asked for lately until the rest holds so many bytes at most.
    pub fn shrink(&self, most_bytes: usize) {
        let mut kept = self.lock();
        let mut held: usize = kept.iter().map(|(_, planner)| planner.bytes()).sum();
        while held > most_bytes && !kept.is_empty() {
            held -= kept.remove(0).1.bytes().min(held);
        }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<(Key, Arc<Planner>)>> {
        self.kept.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
