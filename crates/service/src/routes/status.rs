//! `GET /v1/status`: version, limits and the maps at hand.

use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

use super::maps::MapSummary;
use crate::{Engine, Limits, answer::Json, problem::Problem};

/// What the service is, what it allows, and what it has.
#[derive(Debug, Serialize, ToSchema)]
pub struct Status {
    /// Version of the service.
    pub version: &'static str,
    /// What one request may ask for.
    pub limits: LimitsAnswer,
    /// Maps at hand, in the order of their ids.
    pub maps: Vec<MapSummary>,
}

/// What one request may ask for.
#[derive(Debug, Serialize, ToSchema)]
pub struct LimitsAnswer {
    /// Largest request body, unpacked, recordings apart [bytes].
    pub body_bytes: usize,
    /// Largest recording [bytes].
    pub recording_bytes: u64,
    /// Most cells of a map that is planned over.
    pub map_cells: u64,
    /// Longest time for one answer [s].
    pub plan_time_s: f64,
    /// Most entries of a matrix: sources times targets.
    pub matrix_entries: usize,
    /// Most cells over all stored maps.
    pub stored_cells: usize,
    /// Most bytes over all stored recordings.
    pub stored_recording_bytes: u64,
    /// Most memory that requests under way may take together, as estimated [bytes].
    pub request_memory_bytes: u64,
    /// Computations that run at the same time.
    pub parallel_plans: usize,
    /// Requests that may wait to compute at most.
    pub queued_plans: usize,
    /// Jobs that may wait or run.
    pub open_jobs: usize,
    /// Longest pause while a body is sent [s].
    pub body_pause_s: f64,
}

impl From<&Limits> for LimitsAnswer {
    fn from(limits: &Limits) -> Self {
        LimitsAnswer {
            body_bytes: limits.body_bytes,
            recording_bytes: limits.recording_bytes,
            map_cells: limits.map_cells(),
            plan_time_s: limits.plan_time.as_secs_f64(),
            matrix_entries: limits.matrix_entries,
            stored_cells: limits.stored_cells,
            stored_recording_bytes: limits.stored_recording_bytes,
            request_memory_bytes: limits.request_memory_bytes,
            parallel_plans: limits.parallel_plans,
            queued_plans: limits.queued_plans,
            open_jobs: limits.open_jobs,
            body_pause_s: limits.body_pause.as_secs_f64(),
        }
    }
}

/// What the service is, what it allows, and which maps it has.
#[utoipa::path(
    get, path = "/v1/status", tag = "service",
    responses(
        (status = 200, description = "The state of the service", body = Status),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn handler(State(engine): State<Engine>) -> Result<Json<Status>, Problem> {
    Ok(Json(Status {
        version: env!("CARGO_PKG_VERSION"),
        limits: engine.limits().into(),
        maps: engine.maps().list().await?,
    }))
}
