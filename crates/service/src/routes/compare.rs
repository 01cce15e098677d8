//! `POST /v1/compare`: the energy-minimal, shortest and fastest paths side by side.

use axum::extract::State;
use planner::{Patience, Planner};
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use super::plan::{ObjectiveName, PlanAnswer, PlanRequest, with_planner};
use crate::{
    Engine, Tenant,
    answer::Json,
    body::JsonBody,
    problem::{Problem, ProblemType},
};

/// Three paths between the same ends.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct CompareAnswer {
    /// Least energy.
    pub energy: PlanAnswer,
    /// Least length.
    pub distance: PlanAnswer,
    /// Least time.
    pub time: PlanAnswer,
    /// What the energy-minimal path saves by the `energy_j` of both, as a share of the size of the shortest path's: above 1 where
    /// the energy-minimal path returns energy and the shortest takes some, 0 between equal places.
    pub saving_fraction: f64,
    /// The same by the `refined_energy_j` of both, which the command line and the page show; absent where one of both is.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refined_saving_fraction: Option<f64>,
}

/// Compare the energy-minimal, shortest and fastest paths. The request is that of `/v1/plan`; its objective is ignored.
#[utoipa::path(
    post, path = "/v1/compare", tag = "plan",
    request_body = PlanRequest,
    responses(
        (status = 200, description = "The three paths", body = CompareAnswer),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such map or robot", body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "Start or goal unusable, or no path", body = Problem, content_type = "application/problem+json"),
        (status = 504, description = "Out of time", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn handler(
    State(engine): State<Engine>,
    tenant: Tenant,
    JsonBody(mut request): JsonBody<PlanRequest>,
) -> Result<Json<CompareAnswer>, Problem> {
    let found = with_planner(&engine, &tenant, &mut request, answer).await?;
    let expanded = [&found.energy, &found.distance, &found.time].map(|path| path.search.expanded);
    engine.metrics().expansions.inc_by(expanded.iter().sum());
    Ok(Json(found))
}

/// Answers a request; its own map is not looked at.
///
/// # Errors
/// As [`super::plan::answer`].
pub fn answer(
    planner: &Planner,
    request: &PlanRequest,
    patience: &Patience,
) -> Result<CompareAnswer, Problem> {
    let request = &request.settled(&planner.lattice().terrain)?;
    if request.partial {
        let detail = "partial is true, but paths are compared to a goal that all of them reach: ask /v1/plan";
        return Err(Problem::new(ProblemType::InvalidRequest, detail).at("/partial"));
    }
    let query = request.query(planner, patience);
    let found = planner.compare(&query).map_err(|error| request.no_plan(planner, &error))?;
    let path = |plan: &planner::Plan, objective| {
        PlanAnswer::of(plan, planner, &PlanRequest { objective, ..request.clone() }, patience)
    };
    Ok(CompareAnswer {
        saving_fraction: found.saving_fraction(),
        refined_saving_fraction: found.refined_saving_fraction(),
        energy: path(&found.energy, ObjectiveName::Energy),
        distance: path(&found.distance, ObjectiveName::Distance),
        time: path(&found.time, ObjectiveName::Time),
    })
}
