//! `POST /v1/diagnose`: find where recordings differ from a robot's model, and why, as a job.

use std::sync::Arc;

use axum::extract::State;
use diagnosis::diagnose_watched;
use model::Robot;
use recording::Map;
use serde::Deserialize;
use serde_json::Value;
use utoipa::ToSchema;

use super::{
    calibrate::{MOST_RECORDINGS, notes, read},
    jobs::{Accepted, JobAnswer, accepted},
    robots::RobotChoice,
};
use crate::{
    Engine,
    body::JsonBody,
    job::Job,
    problem::{Problem, ProblemType},
    recordings::{Note, map_from},
};

/// Most points of power over time in an answer: more than a screen has columns.
const MOST_POINTS: usize = 4000;

/// What to diagnose.
#[derive(Clone, Debug, Deserialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct DiagnoseRequest {
    /// Name of a built-in robot, id of a stored one, or a robot.
    pub robot: RobotChoice,
    /// Ids of stored recordings that the robot's model may not describe.
    #[schema(min_items = 1, max_items = 1000)]
    pub recordings: Vec<String>,
    /// Ids of stored recordings of the same robot known to be healthy. Default: none.
    #[serde(default)]
    #[schema(max_items = 1000)]
    pub reference: Vec<String>,
    /// Name of a built-in map, or a map, to read all recordings with. Default: the one that each was stored with.
    #[schema(value_type = Option<Object>)]
    pub map: Option<Value>,
}

/// Start diagnosing recordings. The job's result has `verdict` (`consistent`, `explained`, `ambiguous` or `unexplained`) with its
/// `sentence`, `where` they differ, `findings` (mechanism, parameters with intervals, evidence, what cannot be told apart, fit
/// before and after), `next_drive`, the corrected `robot`, and the `trace` of power over time, for drawing.
#[utoipa::path(
    post, path = "/v1/diagnose", tag = "jobs",
    request_body = DiagnoseRequest,
    responses(
        (status = 202, description = "Started; `Location` is the job", body = JobAnswer, headers(("location" = String))),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such robot or recording", body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "Too many jobs", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn handler(
    State(engine): State<Engine>,
    JsonBody(request): JsonBody<DiagnoseRequest>,
) -> Result<Accepted, Problem> {
    let own = engine.clone();
    let work = engine.on_disk(move || Work::prepare(&own, request)).await?;
    let own = engine.clone();
    let job = engine.start("diagnose", move |job| work.run(&own, job))?;
    Ok(accepted(&job))
}

/// A diagnosis whose request was found right.
struct Work {
    robot: Robot,
    suspect: Vec<Note>,
    healthy: Vec<Note>,
    map: Option<Map>,
}

impl Work {
    /// Refuses at once what can be known without reading a recording.
    fn prepare(engine: &Engine, request: DiagnoseRequest) -> Result<Work, Problem> {
        let DiagnoseRequest { mut robot, recordings, reference, map } = request;
        robot.look_up(engine.robots());
        for (ids, least, field) in [(&recordings, 1, "/recordings"), (&reference, 0, "/reference")] {
            let count = ids.len();
            if !(least..=MOST_RECORDINGS).contains(&count) {
                let detail =
                    format!("{count} recordings are named, but it must be {least} to {MOST_RECORDINGS}");
                return Err(Problem::new(ProblemType::InvalidRequest, detail).at(field));
            }
        }
        Ok(Work {
            robot: robot.robot()?,
            suspect: notes(engine, &recordings, "/recordings")?,
            healthy: notes(engine, &reference, "/reference")?,
            map: map.as_ref().map(map_from).transpose()?,
        })
    }

    fn run(self, engine: &Engine, job: &Arc<Job>) -> Result<Value, Problem> {
        let map = self.map.as_ref();
        let suspect = read(engine, job, &self.suspect, map, "/recordings")?;
        let healthy = match self.healthy[..] {
            [] => None,
            _ => Some(read(engine, job, &self.healthy, map, "/reference")?),
        };
        let tell = |step: &str, share: f64| job.tell(step, Some(share));
        let found = diagnose_watched(&self.robot, &suspect, healthy.as_ref(), &tell, &job.watch());
        let found = found.map_err(|error| Problem::no_diagnosis(&error))?;
        let unwritable = |error: serde_json::Error| {
            Problem::new(ProblemType::Internal, format!("the result cannot be written: {error}"))
        };
        let mut answer = serde_json::to_value(&found).map_err(unwritable)?;
        answer["robot"] = serde_json::to_value(&found.corrected_robot).map_err(unwritable)?;
        answer["trace"] = serde_json::to_value(found.trace.thinned(MOST_POINTS)).map_err(unwritable)?;
        Ok(answer)
    }
}
