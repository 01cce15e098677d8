//! `GET /v1/status`: version, limits and the maps at hand.

use axum::{Json, extract::State};
use serde::Serialize;
use utoipa::ToSchema;

use super::maps::MapSummary;
use crate::{Engine, problem::Problem};

/// The service and what it may be asked.
#[derive(Debug, Serialize, ToSchema)]
pub struct Status {
    /// Version of the service.
    pub version: &'static str,
    /// What one request may ask for.
    pub limits: LimitsAnswer,
    /// Maps at hand.
    pub maps: Vec<MapSummary>,
}

/// What one request may ask for.
#[derive(Debug, Serialize, ToSchema)]
pub struct LimitsAnswer {
    /// Largest body [bytes].
    pub body_bytes: usize,
    /// Longest time for one answer [s].
    pub plan_time_s: f64,
    /// Most cells of a map.
    pub map_cells: u64,
    /// Most entries of a matrix: sources times targets.
    pub matrix_entries: usize,
}

/// Version, limits and maps at hand.
#[utoipa::path(
    get, path = "/v1/status", tag = "service",
    responses(
        (status = 200, body = Status),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn handler(State(engine): State<Engine>) -> Result<Json<Status>, Problem> {
    let limits = engine.limits();
    Ok(Json(Status {
        version: env!("CARGO_PKG_VERSION"),
        limits: LimitsAnswer {
            body_bytes: limits.body_bytes,
            plan_time_s: limits.plan_time.as_secs_f64(),
            map_cells: limits.map_cells(),
            matrix_entries: limits.matrix_entries,
        },
        maps: engine.maps().list().await?,
    }))
}
