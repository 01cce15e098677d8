//! Planners for requests: made anew, or out of those that are kept.

use std::sync::Arc;

use planner::{Patience, Planner};
use terrain::Terrain;

use super::PlanRequest;
use crate::{
    Engine,
    metrics::CacheLabels,
    planners::{KeyedMap, Planners},
    problem::Problem,
};

impl PlanRequest {
    /// A planner over a terrain for the request's robot.
    ///
    /// # Errors
    /// An unusable robot, one that does not suit the ground, or patience that ended.
    pub fn planner(&self, terrain: &Terrain, patience: &Patience) -> Result<Planner, Problem> {
        let robot = self.limited_robot()?;
        let own = self.ground(terrain)?;
        let planner =
            Planner::prepare(own.as_ref().unwrap_or(terrain), &robot, self.settings(&robot), patience);
        planner.map_err(|e| Problem::no_plan(&e))
    }

    /// The service's planner over a map.
    ///
    /// # Errors
    /// As [`PlanRequest::planner`].
    pub(super) fn planner_of(
        &self,
        engine: &Engine,
        map: KeyedMap<'_>,
        patience: &Patience,
    ) -> Result<Arc<Planner>, Problem> {
        let (planner, at_hand) = self.kept_planner(engine.planners(), map, patience)?;
        let outcome = if at_hand { "hit" } else { "miss" };
        engine.metrics().planners.get_or_create(&CacheLabels { outcome }).inc();
        Ok(planner)
    }

    /// The planner over a map for the request's robot out of those that are kept, made unless it is at hand, and whether it was.
    ///
    /// # Errors
    /// As [`PlanRequest::planner`].
    pub fn kept_planner(
        &self,
        planners: &Planners,
        map: KeyedMap<'_>,
        patience: &Patience,
    ) -> Result<(Arc<Planner>, bool), Problem> {
        let robot = self.limited_robot()?;
        let own = self.ground(map.terrain)?;
        let key = own.as_ref().map_or(map.id.to_owned(), |_| self.ground_key(map.id));
        let map = KeyedMap { id: &key, terrain: own.as_ref().unwrap_or(map.terrain), ..map };
        let planner = planners.get(map, &robot, self.settings(&robot), patience);
        planner.map_err(|e| Problem::no_plan(&e))
    }
}
