//! `POST /v1/plan`: one path.

mod document;
mod driven_path;
mod limits;
mod planners;
mod request;
mod stance;
mod steering;
mod time;
mod unknown_ground;
pub(crate) mod warnings;
mod work;

use axum::{extract::State, http::HeaderMap};
use planner::{Patience, Planner};

use crate::{
    Engine, Tenant,
    answer::Written,
    body::JsonBody,
    problem::Problem,
    tracks::{TrackForm, Tracks},
};

pub(crate) use document::place_all;
pub use document::{PlanAnswer, PoseAnswer, RefinedAnswer, SearchAnswer, SnapAnswer, Snapped};
pub use driven_path::DrivenPath;
pub use request::{GoalPose, ObjectiveName, PlanRequest, StartPose};
pub use steering::{ForbidName, GoalHeading, PricesRequest, UnknownGroundRequest};
pub(crate) use unknown_ground::no_plan_over;
pub(crate) use warnings::map_warnings;
pub(crate) use work::with_planner;

/// Plan one path.
#[utoipa::path(
    post, path = "/v1/plan", tag = "plan",
    request_body = PlanRequest,
    responses(
        (status = 200, description = "The path, in the form that `Accept` asks for; longitude and latitude of WGS 84 in GeoJSON and GPX where the map has a `crs`, else metres in GeoJSON, and the start of a GPX track at 0° N 0° E; KML of a map with a `crs` alone", content(
            (PlanAnswer = "application/json"),
            (Object = "application/geo+json"),
            (String = "text/csv"),
            (String = "application/gpx+xml"),
            (String = "application/vnd.google-earth.kml+xml")
        )),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such map or robot", body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "Start or goal unusable, no path, or limits that no path keeps", body = Problem, content_type = "application/problem+json"),
        (status = 504, description = "Out of time", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn handler(
    State(engine): State<Engine>,
    tenant: Tenant,
    headers: HeaderMap,
    JsonBody(mut request): JsonBody<PlanRequest>,
) -> Result<Written, Problem> {
    let (media_type, form) = TrackForm::asked_for(&headers);
    let planned = with_planner(&engine, &tenant, &mut request, move |planner, request, patience| {
        form.map_or(Ok(()), |form| form.check(&planner.lattice().terrain))?;
        answer(planner, request, patience)
    });
    let found = planned.await?;
    engine.metrics().expansions.inc_by(found.search.expanded);
    Ok(Written::new(media_type, move |out| match form {
        Some(form) => Tracks::from(&found).write(form, out),
        None => Ok(serde_json::to_writer(out, &found)?),
    }))
}

/// Answers a request; its own map is not looked at.
///
/// # Errors
/// An unusable end, no path, or time that ran out before there was one.
pub fn answer(planner: &Planner, request: &PlanRequest, patience: &Patience) -> Result<PlanAnswer, Problem> {
    let request = &request.settled(&planner.lattice().terrain)?;
    let query = request.query(planner, patience);
    let objective = request.objective.into();
    let limits = request.limits()?;
    request.check_limits(planner.lattice().has_preferences())?;
    if request.hold_goal {
        planner.hold_goal(&query, objective).map_err(|e| request.no_plan(planner, &e))?;
    }
    let found = match request.partial {
        true => planner.plan_partly(&query, objective).map_err(routing::Error::Planner),
        false => routing::plan_within(planner, &query, objective, &limits),
    };
    let found = found
        .map_err(|error| request.no_routing(planner, &error))
        .map_err(|problem| request.too_steep(planner, problem, patience))?;
    Ok(PlanAnswer::of(&found, planner, request, patience))
}

impl PlanRequest {
    /// Why the planner has no path for the request.
    pub(crate) fn no_plan(&self, planner: &Planner, error: &planner::Error) -> Problem {
        let ends_m = [[self.start.x_m, self.start.y_m], [self.goal.x_m, self.goal.y_m]];
        no_plan_over(planner, ends_m, error)
    }

    /// Why a question within limits has no answer.
    pub(crate) fn no_routing(&self, planner: &Planner, error: &routing::Error) -> Problem {
        match error {
            routing::Error::Planner(error) => self.no_plan(planner, error),
            other => Problem::no_routing(other),
        }
    }
}
