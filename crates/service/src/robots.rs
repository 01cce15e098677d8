//! The robots that were stored: by content hash, each a file in a folder.

use std::{
    collections::BTreeMap,
    fs, io,
    path::{Path, PathBuf},
    sync::{PoisonError, RwLock},
};

use model::Robot;
use sha2::{Digest, Sha256};

use crate::{
    problem::{Problem, ProblemType},
    recordings::cannot,
};

/// Most robots at hand; one takes about a kilobyte.
const MOST_ROBOTS: usize = 10_000;

/// Robots by content hash, in memory and, where there is a folder, on disk.
#[derive(Debug)]
pub(crate) struct RobotStore {
    robots: RwLock<BTreeMap<String, Robot>>,
    folder: Option<PathBuf>,
}

impl RobotStore {
    /// The robots of a folder, which is made; without one, none, and they last as long as the service.
    pub(crate) fn open(folder: Option<&Path>) -> io::Result<Self> {
        let folder = folder.map(|folder| folder.join("robots"));
        let mut robots = BTreeMap::new();
        if let Some(folder) = &folder {
            fs::create_dir_all(folder)?;
            for path in fs::read_dir(folder)?.flatten().map(|entry| entry.path()) {
                let is_robot = path.extension().is_some_and(|ending| ending == "json");
                let robot = is_robot.then(|| fs::read_to_string(&path).ok()).flatten();
                if let Some(robot) = robot.and_then(|text| Robot::from_json(&text).ok()) {
                    robots.insert(id_of(&robot), robot);
                }
            }
        }
        Ok(RobotStore { robots: RwLock::new(robots), folder })
    }

    /// Keeps a robot; the same robot twice is one. Returns its id and whether it is new.
    pub(crate) fn insert(&self, robot: Robot) -> Result<(String, bool), Problem> {
        let id = id_of(&robot);
        let mut robots = self.robots.write().unwrap_or_else(PoisonError::into_inner);
        if robots.contains_key(&id) {
            return Ok((id, false));
        }
        if robots.len() >= MOST_ROBOTS {
            let detail =
                format!("{MOST_ROBOTS} robots are stored: send the robot itself with the request instead");
            return Err(Problem::new(ProblemType::StoreFull, detail));
        }
        if let Some(folder) = &self.folder {
            write(folder, &id, &robot).map_err(|error| cannot("write to", &error))?;
        }
        robots.insert(id.clone(), robot);
        Ok((id, true))
    }

    /// The robot with an id, if there is one.
    pub(crate) fn get(&self, id: &str) -> Option<Robot> {
        self.robots.read().unwrap_or_else(PoisonError::into_inner).get(id).cloned()
    }

    /// All robots, in the order of their ids.
    pub(crate) fn list(&self) -> Vec<(String, Robot)> {
        let robots = self.robots.read().unwrap_or_else(PoisonError::into_inner);
        robots.iter().map(|(id, robot)| (id.clone(), robot.clone())).collect()
    }
}

/// Writes the whole file or none.
fn write(folder: &Path, id: &str, robot: &Robot) -> io::Result<()> {
    let mut file = tempfile::Builder::new().prefix(".robot-").tempfile_in(folder)?;
    serde_json::to_writer(&mut file, robot)?;
    file.as_file().sync_all()?;
    file.persist(folder.join(format!("{id}.json")))?;
    Ok(())
}

/// Content hash of a robot, as 16 hexadecimal digits.
fn id_of(robot: &Robot) -> String {
    let json = serde_json::to_vec(robot).unwrap_or_default();
    Sha256::digest(json).iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}
