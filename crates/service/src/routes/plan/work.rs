//! From a request with a map and a robot to a planner, on a thread for computations.

use std::sync::Arc;

use planner::{Patience, Planner};
use terrain::Terrain;

use super::PlanRequest;
use crate::{
    Engine, Tenant,
    memory::estimated_bytes,
    planners::KeyedMap,
    problem::{Problem, ProblemType},
    routes::{
        maps::{refuse_too_large, terrain_from},
        robots::RobotChoice,
    },
};

/// Finds the map and the robot of a tenant's request and answers on a thread for computations.
pub(crate) async fn with_planner<T: Send + 'static>(
    engine: &Engine,
    tenant: &Tenant,
    request: &mut PlanRequest,
    answer: impl FnOnce(&Planner, &PlanRequest, &Patience) -> Result<T, Problem> + Send + 'static,
) -> Result<T, Problem> {
    // The time that a request gives itself begins when it has been read.
    let deadline = request.deadline()?;
    request.check_steering()?;
    request.robot.look_up(engine.robots(), tenant).await?;
    let stored = choose_map(engine, tenant, request).await?;
    let (inline, request) = (request.map.take(), request.clone());
    let own = engine.clone();
    let bytes = estimated_bytes(engine, request.map_id.as_deref(), stored.as_deref(), inline.as_ref());
    engine
        .compute_within(bytes, deadline, move |patience| {
            let most_cells = own.limits().map_cells();
            let large = |terrain: &Terrain| {
                refuse_too_large(terrain, most_cells).map_err(|problem| problem.at("/map"))
            };
            let found = match (stored, inline) {
                (Some(stored), _) => {
                    let map_id = request.map_id.as_deref().unwrap_or_default();
                    let map = KeyedMap { id: map_id, terrain: &stored, is_stored: true };
                    large(&stored)
                        .and_then(|()| request.planner_of(&own, map, patience))
                        .and_then(|planner| answer(&planner, &request, patience))
                }
                (None, Some(file)) => {
                    let terrain = terrain_from(file, &own.limits().map_options(), "/map")?;
                    let map = KeyedMap { id: &terrain.content_id(), terrain: &terrain, is_stored: false };
                    large(&terrain)
                        .and_then(|()| request.planner_of(&own, map, patience))
                        .and_then(|planner| answer(&planner, &request, patience))
                }
                (None, None) => return Err(no_map()),
            };
            own.planners().shrink(own.limits().kept_bytes);
            found.map_err(|problem| {
                let problem = match &request.map_id {
                    Some(_) => problem.moved("/map", "/map_id"),
                    None => problem,
                };
                // A robot given by name has no fields to point into.
                match &request.robot {
                    RobotChoice::Name(_) => problem.moved("/robot", "/robot"),
                    RobotChoice::File(_) => problem,
                }
            })
        })
        .await
}

async fn choose_map(
    engine: &Engine,
    tenant: &Tenant,
    request: &PlanRequest,
) -> Result<Option<Arc<Terrain>>, Problem> {
    match (&request.map, &request.map_id) {
        (Some(_), None) => Ok(None),
        (None, Some(id)) => {
            let found = engine.maps().get(tenant, id).await;
            found.map(Some).map_err(|problem| problem.at("/map_id"))
        }
        (Some(_), Some(_)) => {
            let detail = "the request has both map and map_id: give one of them";
            Err(Problem::new(ProblemType::InvalidRequest, detail).at("/map_id"))
        }
        (None, None) => Err(no_map()),
    }
}

fn no_map() -> Problem {
    let detail = "the request has no map: give map (inline) or map_id (from POST /v1/maps)";
    Problem::new(ProblemType::InvalidRequest, detail).at("/map")
}
