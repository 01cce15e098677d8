//! `POST /v1/alternatives`: the trade-off between energy and time or length.

use axum::extract::State;
use planner::{Objective, Patience, Planner, Query};
use serde::{Deserialize, Serialize};
use terrain::MapFile;
use utoipa::ToSchema;

use super::{
    plan::{GoalPose, PlanAnswer, PlanRequest, StartPose, UnknownGroundRequest, with_planner},
    robots::RobotChoice,
};
use crate::{
    Engine, Tenant,
    answer::Json,
    body::JsonBody,
    problem::{Problem, ProblemType},
};

/// What to find alternatives for.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct AlternativesRequest {
    /// The map itself; give this or `map_id`.
    pub map: Option<MapFile>,
    /// Id of a stored map; give this or `map`.
    pub map_id: Option<String>,
    /// Name of a built-in robot, id of a stored one, or a robot.
    pub robot: RobotChoice,
    /// Where the robot stands.
    pub start: StartPose,
    /// Where it is to go.
    pub goal: GoalPose,
    /// What energy is weighed against. Default: `time`.
    #[serde(default)]
    pub against: AgainstName,
    /// How many paths, 2 to 50; fewer where there are no more. Default: 7.
    #[serde(default = "seven")]
    #[schema(minimum = 2, maximum = 50)]
    pub count: usize,
    /// How exact the paths are: none that takes as little of the other amount has less than 1/(1 + epsilon) of a path's energy.
    /// 0 asks for the least itself, which can take long on large maps. 0 to 1, default: 0.01.
    #[serde(default = "percent")]
    #[schema(minimum = 0.0, maximum = 1.0)]
    pub epsilon: f64,
    /// No path may take longer. Default: no limit [s].
    #[schema(exclusive_minimum = 0.0)]
    pub max_time_s: Option<f64>,
    /// No path may draw more. Default: no limit [J].
    pub max_energy_j: Option<f64>,
    /// No path may be longer. Default: no limit [m].
    #[schema(exclusive_minimum = 0.0)]
    pub max_distance_m: Option<f64>,
    /// Steepest climb, descent or sideways tilt, up to 1.571, which is π/2. Default: the robot's limits [rad].
    #[schema(exclusive_minimum = 0.0, maximum = 1.571)]
    pub max_slope_rad: Option<f64>,
    /// Forward speed; lowered where the outer wheel would be too fast. Default: half the wheels' top speed [m/s].
    pub speed_mps: Option<f64>,
    /// Whether the robot may back up. Default: false.
    #[serde(default)]
    pub reverse: bool,
    /// How far a start or goal may be moved to ground where the robot can stand. Default: one cell [m].
    pub snap_radius_m: Option<f64>,
    /// Areas over the map, in place of those that it has, as `/v1/plan` takes them; their cost factors are left out. Default: the
    /// map's own.
    #[schema(value_type = Option<Object>)]
    pub areas: Option<serde_json::Value>,
    /// Opens unknown ground to the robot; its risk is left out. Default: it is impassable.
    pub unknown_ground: Option<UnknownGroundRequest>,
    /// Time for the answer; paths that are not proven by then are left out. Default: the service's limit [s].
    #[schema(exclusive_minimum = 0.0)]
    pub timeout_s: Option<f64>,
}

fn seven() -> usize {
    7
}

fn percent() -> f64 {
    0.01
}

/// What energy is weighed against.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum AgainstName {
    /// Time.
    #[default]
    Time,
    /// Length along the ground.
    Distance,
}

/// Paths of which none is beaten in both amounts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct AlternativesAnswer {
    /// From the least energy to the least of the other amount.
    pub alternatives: Vec<PlanAnswer>,
    /// Whether there are no others.
    pub complete: bool,
    /// How exact they are, as asked for.
    pub epsilon: f64,
    /// Whether time ran out before all were proven.
    pub timed_out: bool,
}

/// Find paths that trade energy for time or length. Each has the least energy of all that take as little of the other.
#[utoipa::path(
    post, path = "/v1/alternatives", tag = "plan",
    request_body = AlternativesRequest,
    responses(
        (status = 200, description = "The paths", body = AlternativesAnswer),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such map or robot", body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "Start or goal unusable, no path, or limits that no path keeps", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json"),
        (status = 504, description = "Out of time", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn handler(
    State(engine): State<Engine>,
    tenant: Tenant,
    JsonBody(mut request): JsonBody<AlternativesRequest>,
) -> Result<Json<AlternativesAnswer>, Problem> {
    let mut plan = request.plan()?;
    with_planner(&engine, &tenant, &mut plan, move |planner, plan, patience| {
        answer(planner, &request, plan, patience)
    })
    .await
    .map(Json)
}

impl AlternativesRequest {
    /// What of it concerns the planner; takes the map out.
    ///
    /// # Errors
    /// A count or an epsilon out of range.
    pub fn plan(&mut self) -> Result<PlanRequest, Problem> {
        let out_of_range = |field: &str, value: f64, min: f64, max: f64| {
            let detail = format!("{field} is {value}, but must lie in {min} to {max}");
            Problem::new(ProblemType::InvalidRequest, detail).at(format!("/{field}"))
        };
        if !(2..=50).contains(&self.count) {
            return Err(out_of_range("count", self.count as f64, 2.0, 50.0));
        }
        if !(0.0..=1.0).contains(&self.epsilon) {
            return Err(out_of_range("epsilon", self.epsilon, 0.0, 1.0));
        }
        Ok(PlanRequest {
            map: self.map.take(),
            map_id: self.map_id.clone(),
            bound: 1.0 + self.epsilon,
            max_time_s: self.max_time_s,
            max_energy_j: self.max_energy_j,
            max_distance_m: self.max_distance_m,
            max_slope_rad: self.max_slope_rad,
            speed_mps: self.speed_mps,
            reverse: self.reverse,
            timeout_s: self.timeout_s,
            snap_radius_m: self.snap_radius_m,
            areas: self.areas.clone(),
            unknown_ground: self.unknown_ground.clone(),
            ..PlanRequest::plain(self.robot.clone(), self.start, self.goal)
        })
    }
}

/// Answers a request; `plan` is what [`AlternativesRequest::plan`] made of it.
///
/// # Errors
/// As [`super::plan::answer`].
pub fn answer(
    planner: &Planner,
    request: &AlternativesRequest,
    plan: &PlanRequest,
    patience: &Patience,
) -> Result<AlternativesAnswer, Problem> {
    let plan = &plan.settled(&planner.lattice().terrain)?;
    let query: Query = plan.query(planner, patience);
    let against = match request.against {
        AgainstName::Time => Objective::Time,
        AgainstName::Distance => Objective::Distance,
    };
    let found = routing::alternatives(planner, &query, against, &plan.limits()?, request.count)
        .map_err(|error| plan.no_routing(planner, &error))?;
    let path = |found| PlanAnswer::of(found, planner, plan, patience);
    Ok(AlternativesAnswer {
        alternatives: found.plans.iter().map(path).collect(),
        complete: found.complete,
        epsilon: request.epsilon,
        timed_out: found.timed_out,
    })
}
