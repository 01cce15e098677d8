//! `POST /v1/matrix`: energy, time and length between many poses.

use axum::extract::State;
use model::PowerModel;
use planner::{Patience, Planner};
use routing::{Question, Waypoint};
use serde::{Deserialize, Serialize};
use terrain::{MapFile, Warning};
use utoipa::ToSchema;

use super::{
    plan::{
        GoalPose, ObjectiveName, PlanRequest, StartPose, UnknownGroundRequest, map_warnings, with_planner,
    },
    robots::RobotChoice,
};
use crate::{
    Engine, Limits, Tenant,
    answer::Json,
    body::JsonBody,
    place::settle_all,
    problem::{Problem, ProblemType},
};

/// Poses to work out the paths between.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct MatrixRequest {
    /// The map itself; give this or `map_id`.
    pub map: Option<MapFile>,
    /// Id of a stored map; give this or `map`.
    pub map_id: Option<String>,
    /// Name of a built-in robot, id of a stored one, or a robot.
    pub robot: RobotChoice,
    /// Where paths start: the rows of the answer.
    #[schema(min_items = 1)]
    pub sources: Vec<StartPose>,
    /// Where paths end: the columns of the answer. Default: the sources.
    pub targets: Option<Vec<StartPose>>,
    /// What each path is to have least of. Default: `energy`.
    #[serde(default)]
    pub objective: ObjectiveName,
    /// Forward speed; lowered where the outer wheel would be too fast. Default: half the wheels' top speed [m/s].
    pub speed_mps: Option<f64>,
    /// Form of the physics. Default: `force-balance`.
    #[serde(default)]
    pub power_model: PowerModel,
    /// Whether the robot may back up. Default: false.
    #[serde(default)]
    pub reverse: bool,
    /// How far a place may be moved to ground where the robot can stand. Default: one cell [m].
    pub snap_radius_m: Option<f64>,
    /// Areas over the map, in place of those that it has, as `/v1/plan` takes them; their cost factors are left out. Default: the
    /// map's own.
    #[schema(value_type = Option<Object>)]
    pub areas: Option<serde_json::Value>,
    /// Opens unknown ground to the robot; its risk is left out. Default: it is impassable.
    pub unknown_ground: Option<UnknownGroundRequest>,
    /// Time for the whole matrix. Default: the service's limit [s].
    #[schema(exclusive_minimum = 0.0)]
    pub timeout_s: Option<f64>,
}

/// What the best paths take, a row for each source and a column for each target; null where no path leads.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct MatrixAnswer {
    /// Energy drawn from the battery [J].
    pub energy_j: Vec<Vec<Option<f64>>>,
    /// Time [s].
    pub duration_s: Vec<Vec<Option<f64>>>,
    /// Length along the ground [m].
    pub distance_m: Vec<Vec<Option<f64>>>,
    /// Why entries are null.
    pub unreachable: Vec<UnreachableAnswer>,
    /// Doubts about the map.
    #[serde(default)]
    pub warnings: Vec<Warning>,
}

/// Why an entry is null.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct UnreachableAnswer {
    /// Position of the source, from 0.
    pub source: usize,
    /// Position of the target, from 0.
    pub target: usize,
    /// Why no path leads.
    pub reason: String,
}

/// Work out the paths between many poses. Every entry is that of `/v1/plan` between the two; without a heading a pose takes
/// whichever suits the entry.
#[utoipa::path(
    post, path = "/v1/matrix", tag = "plan",
    request_body = MatrixRequest,
    responses(
        (status = 200, description = "What the paths take", body = MatrixAnswer),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such map or robot", body = Problem, content_type = "application/problem+json"),
        (status = 413, description = "Too many entries, or too large a map", body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 422, description = "A pose unusable", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json"),
        (status = 504, description = "Out of time", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn handler(
    State(engine): State<Engine>,
    tenant: Tenant,
    JsonBody(mut request): JsonBody<MatrixRequest>,
) -> Result<Json<MatrixAnswer>, Problem> {
    request.refuse_too_many(engine.limits())?;
    let mut plan = request.plan()?;
    with_planner(&engine, &tenant, &mut plan, move |planner, _, patience| answer(planner, &request, patience))
        .await
        .map(Json)
}

impl MatrixRequest {
    /// What of it concerns the planner; takes the map out.
    ///
    /// # Errors
    /// No sources, or no targets.
    pub fn plan(&mut self) -> Result<PlanRequest, Problem> {
        for (list, poses) in [("sources", Some(&self.sources)), ("targets", self.targets.as_ref())] {
            if poses.is_some_and(Vec::is_empty) {
                let detail = format!("{list} is empty: give at least one pose");
                return Err(Problem::new(ProblemType::InvalidRequest, detail).at(format!("/{list}")));
            }
        }
        let start = self.sources[0];
        Ok(PlanRequest {
            map: self.map.take(),
            map_id: self.map_id.clone(),
            objective: self.objective,
            speed_mps: self.speed_mps,
            power_model: self.power_model,
            reverse: self.reverse,
            timeout_s: self.timeout_s,
            snap_radius_m: self.snap_radius_m,
            areas: self.areas.clone(),
            unknown_ground: self.unknown_ground.clone(),
            ..PlanRequest::plain(self.robot.clone(), start, GoalPose::at(start))
        })
    }

    /// Refuses more entries than one request may ask for.
    fn refuse_too_many(&self, limits: &Limits) -> Result<(), Problem> {
        let targets = self.targets.as_ref().unwrap_or(&self.sources).len();
        let (entries, most) = (self.sources.len().saturating_mul(targets), limits.matrix_entries);
        if entries <= most {
            return Ok(());
        }
        let detail = format!(
            "{} sources and {targets} targets make {entries} entries, more than the {most} of one request: ask in parts",
            self.sources.len()
        );
        Err(Problem::new(ProblemType::TooLarge, detail).at("/sources"))
    }
}

/// Answers a request; its own map is not looked at.
///
/// # Errors
/// An unusable pose, or time that ran out.
pub fn answer(
    planner: &Planner,
    request: &MatrixRequest,
    patience: &Patience,
) -> Result<MatrixAnswer, Problem> {
    let terrain = &planner.lattice().terrain;
    let (mut sources, mut targets) = (request.sources.clone(), request.targets.clone());
    settle_all(&mut sources, terrain, "/sources")?;
    targets.as_deref_mut().map_or(Ok(()), |targets| settle_all(targets, terrain, "/targets"))?;
    let waypoints = |poses: &[StartPose]| -> Vec<Waypoint> { poses.iter().map(Waypoint::from).collect() };
    let sources = waypoints(&sources);
    let targets = targets.as_deref().map(waypoints);
    let question = Question {
        objective: request.objective.into(),
        snap_radius_m: request.snap_radius_m,
        patience: patience.clone(),
    };
    let found = routing::matrix(planner, &sources, targets.as_deref().unwrap_or(&sources), &question)
        .map_err(|error| Problem::no_routing(&error))?;
    let unreachable = found.gaps.iter().map(|gap| UnreachableAnswer {
        source: gap.source,
        target: gap.target,
        reason: gap.reason.to_string(),
    });
    Ok(MatrixAnswer {
        unreachable: unreachable.collect(),
        energy_j: found.energy_j,
        duration_s: found.duration_s,
        distance_m: found.distance_m,
        warnings: map_warnings(planner),
    })
}

impl From<&StartPose> for Waypoint {
    fn from(pose: &StartPose) -> Self {
        Waypoint { x_m: pose.x_m, y_m: pose.y_m, heading_rad: pose.heading_rad }
    }
}
