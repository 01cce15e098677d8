//! `POST /v1/calibrate`: fit a robot to recordings, as a job.

use std::{
    ops::ControlFlow,
    sync::{
        Arc,
        atomic::{AtomicU64, Ordering},
    },
};

use axum::extract::State;
use calibration::{Method, Options, lift};
use diagnosis::taught;
use model::Robot;
use recording::{Map, Recording, Room, Watch, join_drives};
use serde::{Deserialize, Serialize, de::DeserializeOwned};
use serde_json::{Value, json};
use utoipa::ToSchema;

use super::{
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

/// Most recordings of one calibration.
pub(super) const MOST_RECORDINGS: usize = 1000;

/// What to fit to what.
#[derive(Clone, Debug, Deserialize, Serialize, ToSchema)]
#[serde(deny_unknown_fields)]
pub struct CalibrateRequest {
    /// Name of a built-in robot, id of a stored one, or a robot: what is known before.
    pub robot: RobotChoice,
    /// Ids of stored recordings.
    #[schema(min_items = 1, max_items = 1000)]
    pub recordings: Vec<String>,
    /// Which procedure: `fit` fits everything at once, `dogru-marques` is the paper's own. Default: `fit`.
    #[serde(default)]
    #[schema(value_type = String, example = "fit")]
    pub method: Method,
    /// For motor currents: the surface that what belongs to the robot is fitted on. Default: the one that tells most.
    pub reference_surface: Option<String>,
    /// Names of doubts about the recordings that are overruled, such as `power_sign`. Default: none, so that a doubtful recording is refused.
    #[serde(default)]
    #[schema(required = false)]
    pub despite: Vec<String>,
    /// Name of a built-in map, or a map, to read all recordings with. Default: the one that each was stored with.
    #[schema(value_type = Option<Object>)]
    pub map: Option<Value>,
    /// Lifting test as CSV: a table of side, force_n, rim_speed_mps, power_w, which gives k1 and k2.
    pub lift: Option<String>,
}

/// Start fitting a robot to recordings. The job's result has `parameters` (name, value, unit, interval_95, determined),
/// `held_out` (how well runs are predicted that were not fitted), `notes`, `coverage` (of each run and of all: seconds recorded,
/// used, taken for level, and left out with the reason and the channel at fault), and the fitted `robot`.
#[utoipa::path(
    post, path = "/v1/calibrate", tag = "jobs",
    request_body = CalibrateRequest,
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
    ShortJsonBody(request): ShortJsonBody<CalibrateRequest>,
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
    mut request: CalibrateRequest,
) -> Result<(Description, Box<dyn job_run::Work>), Problem> {
    request.robot.look_up(engine.robots(), tenant).await?;
    let kept = to_value(&request)?;
    let work = Work::prepare(engine, tenant, request).await?;
    let description = Description::new(tenant, "calibrate", kept, inputs(&work.notes));
    Ok((description, Box::new(work)))
}

/// A calibration whose request was found right.
struct Work {
    robot: Robot,
    notes: Vec<Note>,
    map: Option<Map>,
    method: Method,
    options: Options,
}

impl Work {
    /// Refuses at once what can be known without reading a recording.
    async fn prepare(engine: &Engine, tenant: &Tenant, request: CalibrateRequest) -> Result<Work, Problem> {
        let CalibrateRequest { robot, recordings, method, reference_surface, despite, map, lift } = request;
        let count = recordings.len();
        if !(1..=MOST_RECORDINGS).contains(&count) {
            let detail = format!("{count} recordings are named, but it must be 1 to {MOST_RECORDINGS}");
            return Err(Problem::new(ProblemType::InvalidRequest, detail).at("/recordings"));
        }
        let mut robot = robot.robot()?;
        if let Some(text) = lift {
            let lifted = lift::read(&text).and_then(|lifts| lift::apply(&robot, &lifts));
            robot = lifted.map_err(|error| {
                Problem::new(ProblemType::InvalidRequest, format!("the lifting test: {error}")).at("/lift")
            })?;
        }
        Ok(Work {
            robot,
            notes: notes(engine, tenant, &recordings, "/recordings").await?,
            map: map.as_ref().map(map_from).transpose()?,
            method,
            options: Options { reference_surface, despite },
        })
    }
}

impl job_run::Work for Work {
    fn run(self: Box<Self>, engine: &Engine, job: &Arc<Job>) -> Result<Value, Problem> {
        let recording = read(engine, job, &self.notes, self.map.as_ref(), "/recordings")?;
        job.tell("fitting", None);
        let found = self
            .method
            .calibrate_watched(&self.robot, &recording, &self.options, &job.watch())
            .and_then(|found| taught(&self.robot, found, &recording, &job.watch()));
        let found = found.map_err(|error| Problem::no_calibration(&error))?;
        to_value(&found)
    }
}

/// What a tenant knows of the recordings of a request's field.
pub(super) async fn notes(
    engine: &Engine,
    tenant: &Tenant,
    ids: &[String],
    field: &str,
) -> Result<Vec<Note>, Problem> {
    let mut notes = Vec::with_capacity(ids.len());
    for (i, id) in ids.iter().enumerate() {
        let note = engine.recordings().note(tenant, id).await;
        notes.push(note.map_err(|problem| problem.at(format!("{field}/{i}")))?);
    }
    Ok(notes)
}

/// How recordings are read, which a request does not say and a result depends on.
pub(super) fn inputs(notes: &[Note]) -> Value {
    notes.iter().map(|note| json!({ "id": note.id, "name": note.name, "map": note.map })).collect()
}

/// A document as JSON.
pub(super) fn to_value(document: &impl Serialize) -> Result<Value, Problem> {
    serde_json::to_value(document).map_err(|error| {
        Problem::new(ProblemType::Internal, format!("the document cannot be written: {error}"))
    })
}

/// A request out of the store.
pub(super) fn accepted_before<T: DeserializeOwned>(request: &Value) -> Result<T, Problem> {
    T::deserialize(request).map_err(|error| {
        Problem::new(
            ProblemType::Internal,
            format!("the job was asked of another version: {error}; ask again"),
        )
    })
}

/// Reads them behind one another, telling the job.
pub(super) fn read(
    engine: &Engine,
    job: &Arc<Job>,
    notes: &[Note],
    map: Option<&Map>,
    field: &str,
) -> Result<Recording, Problem> {
    let all_bytes = notes.iter().map(|note| note.bytes).sum();
    let mut parts = Vec::with_capacity(notes.len());
    for (i, note) in notes.iter().enumerate() {
        let step = format!("reading recording {} of {}", i + 1, notes.len());
        let watch = watch(job, step, note.bytes);
        let reading =
            engine.recordings().read(note, map, &watch, Room::default().share(note.bytes, all_bytes));
        let reading = reading.map_err(|problem| problem.at(format!("{field}/{i}")))?;
        parts.push((note.name.clone(), reading.recording));
    }
    let watch = watch(job, "joining recordings".into(), all_bytes);
    join_drives(parts, &watch).map_err(|error| Problem::invalid_recording(&error).at(field.to_owned()))
}

/// Tells the job, by whole percents, how much of a recording has been read; stops reading when the job is called off.
fn watch(job: &Arc<Job>, step: String, bytes: u64) -> Watch {
    let (job, read) = (Arc::clone(job), AtomicU64::new(0));
    let percent = move |read: u64| (100.0 * read as f64 / bytes.max(1) as f64).floor().min(100.0);
    Arc::new(move |more| {
        let before = read.fetch_add(more, Ordering::Relaxed);
        let now = percent(before + more);
        if before == 0 || now > percent(before) {
            job.tell(&step, Some(now / 100.0));
        }
        if job.is_called_off() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    })
}
