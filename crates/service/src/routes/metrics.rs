//! `GET /metrics`: what the service counts, for Prometheus.

use axum::{
    extract::State,
    http::{HeaderName, header},
};

use crate::Engine;

const CONTENT_TYPE: &str = "application/openmetrics-text; version=1.0.0; charset=utf-8";

/// What the service counts, as Prometheus reads it.
#[utoipa::path(
    get, path = "/metrics", tag = "service",
    responses((status = 200, description = "Counts as OpenMetrics text", body = String, content_type = "application/openmetrics-text"))
)]
pub(crate) async fn handler(State(engine): State<Engine>) -> ([(HeaderName, &'static str); 1], String) {
    ([(header::CONTENT_TYPE, CONTENT_TYPE)], engine.counts())
}
