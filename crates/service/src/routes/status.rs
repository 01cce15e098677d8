//! `GET /v1/status`: version, limits and the maps at hand.

use axum::extract::State;
use serde::Serialize;
use utoipa::ToSchema;

use super::maps::MapSummary;
use crate::{Engine, Limits, Tenant, answer::Json, problem::Problem, store::Usage};

/// What the service is, what it allows, and what it has.
#[derive(Debug, Serialize, ToSchema)]
pub struct Status {
    /// Version of the service.
    pub version: &'static str,
    /// What one request may ask for.
    pub limits: LimitsAnswer,
    /// The tenant that asks, and what it keeps.
    pub tenant: TenantAnswer,
    /// Maps that the tenant sees, in the order of their ids.
    pub maps: Vec<MapSummary>,
}

/// A tenant and what it keeps; its limits are `tenant_bytes`, `tenant_objects` and `tenant_jobs`.
#[derive(Debug, Serialize, ToSchema)]
pub struct TenantAnswer {
    /// Name of the tenant, `default` where tokens have no names.
    #[schema(example = "default")]
    pub name: String,
    /// Bytes of its maps, robots and recordings.
    pub bytes: u64,
    /// Number of its maps, robots and recordings.
    pub objects: usize,
    /// Number of its jobs that wait or run, at all services over the store.
    pub jobs: usize,
}

impl TenantAnswer {
    async fn of(engine: &Engine, tenant: &Tenant) -> Result<TenantAnswer, Problem> {
        let Usage { bytes, objects } = engine.usage(tenant).await?;
        let jobs = engine.records().open_of(tenant).await?;
        Ok(TenantAnswer { name: tenant.name().to_owned(), bytes, objects, jobs })
    }
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
    /// Most bytes of maps, robots and recordings that a tenant may keep.
    pub tenant_bytes: u64,
    /// Most maps, robots and recordings that a tenant may keep.
    pub tenant_objects: usize,
    /// Most jobs of a tenant that may wait or run.
    pub tenant_jobs: usize,
    /// Jobs that may wait or run.
    pub open_jobs: usize,
    /// Longest time for one job [s].
    pub job_time_s: f64,
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
            tenant_bytes: limits.tenant_bytes,
            tenant_objects: limits.tenant_objects,
            tenant_jobs: limits.tenant_jobs,
            open_jobs: limits.open_jobs,
            job_time_s: limits.job_time.as_secs_f64(),
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
pub(crate) async fn handler(State(engine): State<Engine>, tenant: Tenant) -> Result<Json<Status>, Problem> {
    Ok(Json(Status {
        version: env!("CARGO_PKG_VERSION"),
        limits: engine.limits().into(),
        tenant: TenantAnswer::of(&engine, &tenant).await?,
        maps: engine.maps().list(&tenant).await?,
    }))
}
