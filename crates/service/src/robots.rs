//! The robots that were stored, by content hash.

use model::Robot;
use sha2::{Digest, Sha256};

use crate::{
    problem::{Problem, ProblemType},
    store::{Notes, Store, full, id_of},
};

/// Most robots at hand; one takes about a kilobyte.
const MOST_ROBOTS: usize = 10_000;

/// Robots by content hash, every default filled in.
#[derive(Debug)]
pub(crate) struct RobotStore {
    robots: Notes<Robot>,
}

impl RobotStore {
    pub(crate) fn new(store: &Store) -> Self {
        RobotStore { robots: Notes::new(store, "robots") }
    }

    /// Keeps a robot; the same robot twice is one. Returns its id and whether it is new.
    pub(crate) async fn insert(&self, robot: &Robot) -> Result<(String, bool), Problem> {
        let id = content_id(robot)?;
        if self.robots.has(&id).await? {
            return Ok((id, false));
        }
        if self.robots.entries().await?.len() >= MOST_ROBOTS {
            let detail =
                format!("{MOST_ROBOTS} robots are stored: send the robot itself with the request instead");
            return Err(full(detail));
        }
        let new = self.robots.create(&id, robot).await?;
        Ok((id, new))
    }

    /// The robot with an id, if there is one.
    pub(crate) async fn get(&self, id: &str) -> Result<Option<Robot>, Problem> {
        self.robots.get(id).await
    }

    /// All robots, in the order of their ids.
    pub(crate) async fn list(&self) -> Result<Vec<(String, Robot)>, Problem> {
        let robots = self.robots.list().await?;
        Ok(robots.into_iter().map(|(id, robot)| (id, Robot::clone(&robot))).collect())
    }
}

/// The hash of a robot's JSON, which has every field in the same order.
pub(crate) fn content_id(robot: &Robot) -> Result<String, Problem> {
    let bytes = serde_json::to_vec(robot).map_err(|error| {
        Problem::new(ProblemType::Internal, format!("the robot cannot be written: {error}"))
    })?;
    Ok(id_of(Sha256::new_with_prefix(bytes)))
}
