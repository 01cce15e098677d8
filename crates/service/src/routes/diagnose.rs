//! `POST /v1/diagnose`: find where recordings differ from a robot's model, and why, as a job.

use std::sync::Arc;

use axum::extract::State;
use diagnosis::{Diagnosis, Question, diagnose_watched};
use model::{
    Robot,
    mechanism::{self, Mechanism},
};
use recording::Map;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};
use utoipa::ToSchema;

use super::{
    calibrate::{MOST_RECORDINGS, accepted_before, inputs, notes, read, to_value},
    jobs::{Accepted, JobAnswer, accepted},
    robots::RobotChoice,
};
use crate::{
    Engine, Tenant,
    body::ShortJsonBody,
    job::Job,
    job_records::Description,
    job_run,
    problem::{Problem, ProblemType},
    recordings::{Note, map_from},
};

/// Most points of power over time in an answer: more than a screen has columns.
const MOST_POINTS: usize = 4000;

/// What to diagnose.
#[derive(Clone, Debug, Deserialize, Serialize, ToSchema)]
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
    /// Ids of stored logs of the same drives by another simulator, in place of what the robot's file predicts: what did it leave out?
    /// Not together with `reference`. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 1000)]
    pub simulated: Vec<String>,
    /// Names of mechanisms that are known not to act, such as `payload` of a robot that was weighed. Default: none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[schema(max_items = 20)]
    pub ruled_out: Vec<String>,
    /// Name of a built-in map, or a map, to read all recordings with. Default: the one that each was stored with.
    #[schema(value_type = Option<Object>)]
    pub map: Option<Value>,
}

/// Start diagnosing recordings. The job's result has `verdict` (`consistent`, `explained`, `ambiguous` or `unexplained`) with its
/// `sentence`, `where` they differ, `findings` (mechanism, parameters with intervals, evidence, what cannot be told apart, fit
/// before and after), `next_drive`, `coverage` (of each drive and of all: seconds recorded, used, taken for level, and left out with the
/// reason and the channel at fault; `reference_coverage` of healthy drives), the corrected `robot`, and the `trace` of power over time,
/// for drawing.
#[utoipa::path(
    post, path = "/v1/diagnose", tag = "jobs",
    request_body = DiagnoseRequest,
    responses(
        (status = 202, description = "In the store, and started unless the same was asked before; `Location` is the job", body = JobAnswer, headers(("location" = String))),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such robot or recording", body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 429, description = "As many jobs of the tenant wait or run as may", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "Too many jobs, or the store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn handler(
    State(engine): State<Engine>,
    tenant: Tenant,
    ShortJsonBody(request): ShortJsonBody<DiagnoseRequest>,
) -> Result<Accepted, Problem> {
    let (description, work) = prepared(&engine, &tenant, request).await?;
    Ok(accepted(engine.ask(&description, work).await?))
}

/// The work of a request that was accepted before.
pub(super) async fn work(
    engine: &Engine,
    description: &Description,
) -> Result<Box<dyn job_run::Work>, Problem> {
    let request = accepted_before(&description.request)?;
    prepared(engine, &description.owner, request).await.map(|(_, work)| work)
}

/// What a tenant's request stands for.
async fn prepared(
    engine: &Engine,
    tenant: &Tenant,
    mut request: DiagnoseRequest,
) -> Result<(Description, Box<dyn job_run::Work>), Problem> {
    request.robot.look_up(engine.robots(), tenant).await?;
    let kept = to_value(&request)?;
    let work = Work::prepare(engine, tenant, request).await?;
    let mut named = json!({ "recordings": inputs(&work.suspect), "reference": inputs(&work.healthy) });
    // Requests without a simulation stay the same job as before there were any.
    if !work.simulated.is_empty() {
        named["simulated"] = json!(inputs(&work.simulated));
    }
    Ok((Description::new(tenant, "diagnose", kept, named), Box::new(work)))
}

/// A diagnosis whose request was found right.
struct Work {
    robot: Robot,
    suspect: Vec<Note>,
    healthy: Vec<Note>,
    simulated: Vec<Note>,
    ruled_out: Vec<&'static dyn Mechanism>,
    map: Option<Map>,
}

impl Work {
    /// Refuses at once what can be known without reading a recording.
    async fn prepare(engine: &Engine, tenant: &Tenant, request: DiagnoseRequest) -> Result<Work, Problem> {
        let DiagnoseRequest { robot, recordings, reference, simulated, ruled_out, map } = request;
        for (ids, least, field) in
            [(&recordings, 1, "/recordings"), (&reference, 0, "/reference"), (&simulated, 0, "/simulated")]
        {
            let count = ids.len();
            if !(least..=MOST_RECORDINGS).contains(&count) {
                let detail =
                    format!("{count} recordings are named, but it must be {least} to {MOST_RECORDINGS}");
                return Err(Problem::new(ProblemType::InvalidRequest, detail).at(field));
            }
        }
        if !simulated.is_empty() && !reference.is_empty() {
            let detail = "healthy drives were not simulated: leave out `reference`, or `simulated`";
            return Err(Problem::new(ProblemType::InvalidRequest, detail).at("/simulated"));
        }
        Ok(Work {
            robot: robot.robot()?,
            suspect: notes(engine, tenant, &recordings, "/recordings").await?,
            healthy: notes(engine, tenant, &reference, "/reference").await?,
            simulated: notes(engine, tenant, &simulated, "/simulated").await?,
            ruled_out: mechanisms(&ruled_out)?,
            map: map.as_ref().map(map_from).transpose()?,
        })
    }
}

impl job_run::Work for Work {
    fn run(self: Box<Self>, engine: &Engine, job: &Arc<Job>) -> Result<Value, Problem> {
        let map = self.map.as_ref();
        let suspect = read(engine, job, &self.suspect, map, "/recordings")?;
        let healthy = match self.healthy[..] {
            [] => None,
            _ => Some(read(engine, job, &self.healthy, map, "/reference")?),
        };
        let simulated = match self.simulated[..] {
            [] => None,
            _ => Some(read(engine, job, &self.simulated, map, "/simulated")?),
        };
        let tell = |step: &str, share: f64| job.tell(step, Some(share));
        let question = Question {
            ruled_out: &self.ruled_out,
            simulated: simulated.as_ref(),
            ..Question::new(&self.robot, &suspect, healthy.as_ref())
        };
        let found = diagnose_watched(&question, &tell, &job.watch());
        let found = found.map_err(|error| Problem::no_diagnosis(&error))?;
        document(&found)
    }
}

/// The document of a diagnosis: the report, the corrected robot, and power over time for drawing.
///
/// # Errors
/// A report that cannot be written.
pub fn document(found: &Diagnosis) -> Result<Value, Problem> {
    let mut answer = to_value(found)?;
    answer["robot"] = to_value(&found.corrected_robot)?;
    answer["trace"] = to_value(&found.trace.thinned(MOST_POINTS))?;
    Ok(answer)
}

/// Mechanisms by their names.
///
/// # Errors
/// A name that no mechanism has.
pub fn mechanisms(names: &[String]) -> Result<Vec<&'static dyn Mechanism>, Problem> {
    let of = |(i, name): (usize, &String)| {
        mechanism::by_name(name).ok_or_else(|| {
            let known = mechanism::ALL.map(|one| one.name()).join(", ");
            let detail = format!("there is no mechanism {name:?}; there are {known}");
            Problem::new(ProblemType::InvalidRequest, detail).at(format!("/ruled_out/{i}"))
        })
    };
    names.iter().enumerate().map(of).collect()
}
