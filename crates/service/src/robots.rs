//! The robots that were stored, by content hash, each tenant's apart.

use model::Robot;
use sha2::{Digest, Sha256};

use crate::{
    Tenant,
    problem::{Problem, ProblemType},
    store::{Owned, Quota, Store, Usage, id_of, shown},
};

/// Largest robot that is stored [bytes of JSON]. One takes 1 to 4 kB; the rest is room for surfaces and a posterior.
const MOST_ROBOT_BYTES: u64 = 1 << 18;

/// Robots by content hash, every default filled in.
#[derive(Debug)]
pub(crate) struct RobotStore {
    store: Store,
    robots: Owned<Robot>,
}

impl RobotStore {
    pub(crate) fn new(store: &Store) -> Self {
        RobotStore { store: store.clone(), robots: Owned::new(store, "robots") }
    }

    /// Keeps a robot for a tenant, within its quota; the same robot twice is one. Returns its id and whether it is new.
    pub(crate) async fn insert(
        &self,
        owner: &Tenant,
        robot: &Robot,
        quota: &Quota,
    ) -> Result<(String, bool), Problem> {
        let id = content_id(robot)?;
        let own = self.robots.of(owner);
        let bytes = own.size(robot)?;
        refuse_too_large(bytes)?;
        let _changing = self.store.changing().await;
        if own.has(&id).await? {
            return Ok((id, false));
        }
        quota.refuse_beyond(owner, Usage::of(&self.store, owner).await?.plus(bytes))?;
        let is_new = own.create(&id, robot).await?;
        // Another service may have stored something since it was counted.
        let counted = Usage::of(&self.store, owner).await;
        if let Err(problem) = counted.and_then(|usage| quota.refuse_beyond(owner, usage)) {
            self.robots.remove(owner, &id).await?;
            return Err(problem);
        }
        Ok((id, is_new))
    }

    /// The robot with an id, if there is one that a tenant sees.
    pub(crate) async fn get(&self, tenant: &Tenant, id: &str) -> Result<Option<Robot>, Problem> {
        self.robots.get(tenant, id).await
    }

    /// All robots that a tenant sees, in the order of their ids.
    pub(crate) async fn list(&self, tenant: &Tenant) -> Result<Vec<(String, Robot)>, Problem> {
        let robots = self.robots.list(tenant).await?;
        Ok(robots.into_iter().map(|(id, robot)| (id, Robot::clone(&robot))).collect())
    }

    /// Forgets a robot for a tenant, or for all if it sees all.
    pub(crate) async fn remove(&self, tenant: &Tenant, id: &str) -> Result<(), Problem> {
        let _changing = self.store.changing().await;
        let mut owners = self.robots.holders(id).await?;
        owners.retain(|owner| tenant.sees(owner));
        if owners.is_empty() {
            let detail = format!("there is no stored robot `{}`: GET /v1/robots lists them", shown(id));
            return Err(Problem::new(ProblemType::UnknownRobot, detail));
        }
        for owner in owners {
            self.robots.remove(&owner, id).await?;
        }
        Ok(())
    }
}

fn refuse_too_large(bytes: u64) -> Result<(), Problem> {
    if bytes <= MOST_ROBOT_BYTES {
        return Ok(());
    }
    let detail = format!(
        "the robot takes {bytes} bytes as JSON, more than the {MOST_ROBOT_BYTES} of a stored one: leave out surfaces that it \
         does not drive on"
    );
    Err(Problem::new(ProblemType::TooLarge, detail))
}

/// The hash of a robot's JSON, which has every field in the same order.
pub(crate) fn content_id(robot: &Robot) -> Result<String, Problem> {
    let bytes = serde_json::to_vec(robot).map_err(|error| {
        Problem::new(ProblemType::Internal, format!("the robot cannot be written: {error}"))
    })?;
    Ok(id_of(Sha256::new_with_prefix(bytes)))
}
