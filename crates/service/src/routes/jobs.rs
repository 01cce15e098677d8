//! `/v1/jobs`: long work, followed and called off.

use std::{convert::Infallible, sync::Arc};

use axum::{
    Json,
    extract::State,
    http::{HeaderMap, HeaderName, StatusCode, header},
    response::{
        IntoResponse, Response,
        sse::{Event, KeepAlive, Sse},
    },
};
use futures_util::{Stream, stream};
use serde::Serialize;
use serde_json::Value;
use tokio::sync::watch;
use utoipa::ToSchema;

use crate::{
    Engine,
    body::Id,
    job::{Job, JobState, Progress, Status},
    problem::Problem,
};

/// What starting a job answers: where to follow it, and how it is.
pub(crate) type Accepted = (StatusCode, [(HeaderName, String); 1], Json<JobAnswer>);

/// The answer to a request that has started a job.
pub(crate) fn accepted(job: &Job) -> Accepted {
    let location = format!("/v1/jobs/{}", job.id);
    (StatusCode::ACCEPTED, [(header::LOCATION, location)], Json(JobAnswer::of(job, job.status())))
}

/// A job.
#[derive(Debug, Serialize, ToSchema)]
pub struct JobAnswer {
    /// Its id.
    pub id: String,
    /// What it does.
    #[schema(example = "calibrate")]
    pub kind: &'static str,
    /// Where it stands.
    pub state: JobState,
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
    pub(crate) fn of(job: &Job, status: Status) -> Self {
        let Status { state, progress, result, problem, .. } = status;
        let result = result.as_deref().cloned();
        JobAnswer { id: job.id.clone(), kind: job.kind, state, progress, result, problem }
    }
}

/// One job: its state, progress, and result or problem.
#[utoipa::path(
    get, path = "/v1/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "Id of the job")),
    responses((status = 200, body = JobAnswer), (status = 404, body = Problem, content_type = "application/problem+json"))
)]
pub(crate) async fn read(State(engine): State<Engine>, Id(id): Id) -> Result<Json<JobAnswer>, Problem> {
    let job = engine.jobs().get(&id)?;
    let status = job.status();
    Ok(Json(JobAnswer::of(&job, status)))
}

/// Cancel a job that waits or runs; forget one that has ended.
#[utoipa::path(
    delete, path = "/v1/jobs/{id}", tag = "jobs",
    params(("id" = String, Path, description = "Id of the job")),
    responses(
        (status = 200, description = "Cancelled", body = JobAnswer),
        (status = 204, description = "It had ended, and is forgotten"),
        (status = 404, body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn remove(State(engine): State<Engine>, Id(id): Id) -> Result<Response, Problem> {
    let job = engine.jobs().get(&id)?;
    if job.call_off() {
        let status = job.status();
        return Ok(Json(JobAnswer::of(&job, status)).into_response());
    }
    engine.jobs().forget(&id);
    Ok(StatusCode::NO_CONTENT.into_response())
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
        (status = 200, description = "Events until the job ends", body = JobAnswer, content_type = "text/event-stream"),
        (status = 204, description = "The last event was seen already: there will be no more"),
        (status = 404, body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn events(
    State(engine): State<Engine>,
    Id(id): Id,
    headers: HeaderMap,
) -> Result<Response, Problem> {
    let job = engine.jobs().get(&id)?;
    let seen = headers.get("last-event-id").and_then(|id| id.to_str().ok()).and_then(|id| id.parse().ok());
    let status = job.status();
    if status.state.is_final() && seen == Some(status.sequence) {
        // A browser's event source comes back after every end; this status tells it to stay away.
        return Ok(StatusCode::NO_CONTENT.into_response());
    }
    let follower = Follower { changes: job.follow(), job, seen };
    Ok(Sse::new(follower.events()).keep_alive(KeepAlive::default()).into_response())
}

/// A client that follows a job.
struct Follower {
    job: Arc<Job>,
    changes: watch::Receiver<Status>,
    /// The number of the last change that it was told.
    seen: Option<u64>,
}

impl Follower {
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
            let event = event.json_data(JobAnswer::of(&follower.job, status)).ok()?;
            Some((Ok(event), follower))
        })
    }

    /// The next status that the client has not seen; `None` after the final one.
    async fn next(&mut self) -> Option<Status> {
        loop {
            let status = self.changes.borrow_and_update().clone();
            if self.seen != Some(status.sequence) {
                self.seen = Some(status.sequence);
                return Some(status);
            }
            if status.state.is_final() {
                return None;
            }
            self.changes.changed().await.ok()?;
        }
    }
}
