//! `GET /healthz` and `GET /readyz`.

use axum::{Json, extract::State};
use serde::Serialize;
use utoipa::ToSchema;

use crate::{Engine, problem::Problem};

/// The service is alive, or ready.
#[derive(Debug, Serialize, ToSchema)]
pub struct Health {
    /// Always `ok`.
    pub status: &'static str,
    /// Version of the service.
    pub version: &'static str,
}

impl Health {
    fn ok() -> Json<Health> {
        Json(Health { status: "ok", version: env!("CARGO_PKG_VERSION") })
    }
}

/// Is the service alive? It is until it has ended, however much there is to do.
#[utoipa::path(get, path = "/healthz", tag = "service", responses((status = 200, description = "The process answers", body = Health)))]
pub(crate) async fn healthz() -> Json<Health> {
    Health::ok()
}

/// Should the service be asked? Not once it has been told to end, nor while its store is out of reach, nothing can be computed, or
/// a cancelled job does not end.
#[utoipa::path(
    get, path = "/readyz", tag = "service",
    responses(
        (status = 200, description = "The service can take requests", body = Health),
        (status = 503, description = "It is about to end, cannot compute, or cannot reach its store", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn readyz(State(engine): State<Engine>) -> Result<Json<Health>, Problem> {
    engine.check_ready().await?;
    Ok(Health::ok())
}
