//! `/v1/jobs`: long work, followed and called off.

use std::{convert::Infallible, sync::Arc, time::Duration};

use axum::{
    extract::State,
    http::{HeaderMap, HeaderName, StatusCode, header},
    response::{
        IntoResponse, Response,
        sse::{Event, KeepAlive, Sse},
    },
};
use futures_util::{Stream, stream};
use serde::{Deserialize, Serialize};
use serde_json::Value;
use tokio::sync::watch;
use utoipa::ToSchema;

use crate::{
    Engine, Tenant,
    answer::Json,
    body::Id,
    job::{JobState, Progress, Status},
    job_records::{Description, Report},
    job_run::Work,
    problem::{Problem, ProblemType},
};

/// What starting a job answers: where to follow it, and how it is.
pub(crate) type Accepted = (StatusCode, [(HeaderName, String); 1], Json<JobAnswer>);

/// The answer to a request that has started a job.
pub(crate) fn accepted(job: JobAnswer) -> Accepted {
    let location = format!("/v1/jobs/{}", job.id);
    (StatusCode::ACCEPTED, [(header::LOCATION, location)], Json(job))
}

/// The work that a description stands for.
pub(crate) async fn work(engine: &Engine, description: &Description) -> Result<Box<dyn Work>, Problem> {
    match description.kind.as_str() {
        "calibrate" => super::calibrate::work(engine, description).await,
        "diagnose" => super::diagnose::work(engine, description).await,
        kind => {
            let detail = format!("this service does no `{kind}`: a newer one asked for it");
            Err(Problem::new(ProblemType::Internal, detail))
        }
    }
}

/// A job.
#[derive(Clone, Debug, Serialize, Deserialize, ToSchema)]
pub struct JobAnswer {
    /// Hash of what it does and with what: the same job always has the same id.
    #[schema(example = "5b7c1f0e9a3d4c2b8e6f7a1d0c9b8a7f")]
    pub id: String,
    /// What it does.
    #[schema(example = "calibrate")]
    pub kind: String,
    /// Where it stands.
    pub state: JobState,
    /// How often it has been taken up: 1, and once more each time that the service that worked on it ended before it.
    #[schema(example = 1)]
    pub attempt: u64,
    /// What it is, or was last, busy with.
    pub progress: Progress,
    /// What it found, once it is done: of `calibrate`, what `POST /v1/calibrate` describes.
    #[serde(skip_serializing_if = "Option::is_none")]
    #[schema(value_type = Option<Object>)]
    pub result: Option<Value>,
    /// Why it failed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub problem: Option<Problem>,
}

impl JobAnswer {
    pub(crate) fn of(id: &str, kind: &str, status: Status) -> Self {
        let Status { state, attempt, progress, result, problem, .. } = status;
        let result = result.as_deref().cloned();
        JobAnswer { id: id.to_owned(), kind: kind.to_owned(), state, attempt, progress, result, problem }
    }
}

/// A job in brief.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct JobSummary {
    /// Hash of what it does and with what, to follow it by.
    #[schema(example = "5b7c1f0e9a3d4c2b8e6f7a1d0c9b8a7f")]
    pub id: String,
    /// What it does.
    #[schema(example = "calibrate")]
    pub kind: String,
    /// Where it stands.
    pub state: JobState,
    /// How often it has been taken up.
    #[schema(example = 1)]
    pub attempt: u64,
    /// What it is, or was last, busy with.
    pub progress: Progress,
}

impl From<&JobAnswer> for JobSummary {
    fn from(job: &JobAnswer) -> Self {
        let JobAnswer { id, kind, state, attempt, progress, .. } = job.clone();
        JobSummary { id, kind, state, attempt, progress }
    }
}

/// Jobs of the tenant that asks.
#[derive(Debug, Serialize, ToSchema)]
pub struct JobList {
    /// Those that wait or run, the latest first, then those that have ended, the latest first.
    pub jobs: Vec<JobSummary>,
}

/// One's own jobs in brief, without their results.
#[utoipa::path(
    get, path = "/v1/jobs", tag = "jobs",
    responses(
        (status = 200, description = "Jobs that wait, run or have ended and are not forgotten", body = JobList),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn list(State(engine): State<Engine>, tenant: Tenant) -> Result<Json<JobList>, Problem> {
    let mut jobs = engine.records().list(&tenant).await?;
    for listed in &mut jobs {
        // The service that works on a job knows more than it has written down.
        if let Some(job) = engine.jobs().get(&listed.id) {
            *listed = JobSummary::from(&JobAnswer::of(&job.id, &job.kind, job.status()));
        }
    }
    Ok(Json(JobList { jobs }))
}

/// One job: its state, progress, and result or problem.
#[utoipa::path(
    get, path = "/v1/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "Id of the job")),
    responses(
        (status = 200, description = "The job", body = JobAnswer),
        (status = 404, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn read(
    State(engine): State<Engine>,
    tenant: Tenant,
    Id(id): Id,
) -> Result<Json<JobAnswer>, Problem> {
    if let Some(job) = engine.jobs().get(&id).filter(|job| tenant.sees(&job.owner)) {
        return Ok(Json(JobAnswer::of(&job.id, &job.kind, job.status())));
    }
    Ok(Json(engine.records().look_up(&tenant, &id).await?.1.job))
}

/// Cancel a job that waits or runs; forget one that has ended.
#[utoipa::path(
    delete, path = "/v1/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "Id of the job")),
    responses(
        (status = 200, description = "Cancelled", body = JobAnswer),
        (status = 204, description = "It had ended, and is forgotten"),
        (status = 404, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn remove(
    State(engine): State<Engine>,
    tenant: Tenant,
    Id(id): Id,
) -> Result<Response, Problem> {
    Ok(match engine.call_off(&tenant, &id).await? {
        Some(job) => Json(job).into_response(),
        None => StatusCode::NO_CONTENT.into_response(),
    })
}

/// Follow a job by server-sent events: `progress`, then one of `done`, `failed` and `cancelled`, each with the job as
/// its data. The first event tells the present state; who comes back with `Last-Event-ID` is told what is new since.
#[utoipa::path(
    get, path = "/v1/jobs/{id}/events", tag = "jobs",
    params(
        ("id" = String, Path, description = "Id of the job"),
        ("last-event-id" = Option<String>, Header, description = "The id of the last event seen")
    ),
    responses(
        (status = 200, description = "Events until the job ends, each with a `JobAnswer` as its data", body = String, content_type = "text/event-stream"),
        (status = 204, description = "The last event was seen already: there will be no more"),
        (status = 404, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn events(
    State(engine): State<Engine>,
    tenant: Tenant,
    Id(id): Id,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let seen = headers.get("last-event-id").and_then(|id| id.to_str().ok()).and_then(|id| id.parse().ok());
    let follower = Follower::of(&engine, &tenant, &id, seen).await?;
    let status = follower.changes.borrow().clone();
    if status.state.is_final() && seen == Some(status.sequence) {
        // A browser's event source comes back after every end; this status tells it to stay away.
        return Ok(StatusCode::NO_CONTENT.into_response());
    }
    Ok(Sse::new(follower.events()).keep_alive(KeepAlive::default()).into_response())
}

/// How often a job is looked up that another service works on.
const LOOK: Duration = Duration::from_secs(1);

/// A client that follows a job.
struct Follower {
    id: String,
    kind: String,
    changes: watch::Receiver<Status>,
    /// The number of the last change that it was told.
    seen: Option<u64>,
}

impl Follower {
    /// Follows a job that a tenant sees, wherever it is worked on.
    async fn of(engine: &Engine, tenant: &Tenant, id: &str, seen: Option<u64>) -> Result<Follower, Problem> {
        if let Some(job) = engine.jobs().get(id).filter(|job| tenant.sees(&job.owner)) {
            let changes = job.follow();
            return Ok(Follower { id: job.id.clone(), kind: job.kind.clone(), changes, seen });
        }
        let (owner, known) = engine.records().look_up(tenant, id).await?;
        let (id, kind) = (known.job.id.clone(), known.job.kind.clone());
        let (changed, changes) = watch::channel(status(known));
        tokio::spawn(look_out(engine.clone(), owner, id.clone(), changed));
        Ok(Follower { id, kind, changes, seen })
    }

    /// Every change that is still the latest when the client is ready for it, up to the last.
    fn events(self) -> impl Stream<Item = Result<Event, Infallible>> {
        stream::unfold(self, |mut follower| async {
            let status = follower.next().await?;
            let event = match status.state {
                JobState::Queued | JobState::Running => "progress",
                JobState::Done => "done",
                JobState::Failed => "failed",
                JobState::Cancelled => "cancelled",
            };
            let event = Event::default().event(event).id(status.sequence.to_string());
            let event = event.json_data(JobAnswer::of(&follower.id, &follower.kind, status)).ok()?;
            Some((Ok(event), follower))
        })
    }

    /// The next status that the client has not seen; `None` after the last one.
    async fn next(&mut self) -> Option<Status> {
        loop {
            let status = self.changes.borrow_and_update().clone();
            if self.seen != Some(status.sequence) {
                self.seen = Some(status.sequence);
                return Some(status);
            }
            if status.is_last() {
                return None;
            }
            self.changes.changed().await.ok()?;
        }
    }
}

/// Looks a job up again and again, until it has ended, is forgotten, or nobody follows it any more.
async fn look_out(engine: Engine, owner: Tenant, id: String, changed: watch::Sender<Status>) {
    while !changed.borrow().is_last() {
        tokio::select! {
            () = changed.closed() => return,
            () = tokio::time::sleep(LOOK) => {}
        }
        match engine.records().look_up(&owner, &id).await {
            Ok((_, known)) => drop(changed.send_replace(status(known))),
            Err(problem) if problem.kind == ProblemType::StoreUnavailable => {}
            Err(_) => return,
        }
    }
}

fn status(known: Report) -> Status {
    let JobAnswer { state, attempt, progress, result, problem, .. } = known.job;
    let result = result.map(Arc::new);
    Status { sequence: known.sequence, attempt, state, progress, result, problem, handed_back: false }
}
