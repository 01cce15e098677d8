//! One line of the log for every answer.

use std::time::Duration;

use axum::{extract::Request, response::Response};
use tower_http::request_id::RequestId;
use tracing::{Span, field::Empty};

/// What all lines of a request share. No header but the request's id is logged: others carry tokens.
pub(super) fn span<B>(request: &Request<B>) -> Span {
    let id = request.extensions().get::<RequestId>().and_then(|id| id.header_value().to_str().ok());
    tracing::info_span!(
        "request",
        method = %request.method(),
        path = request.uri().path(),
        request_id = id.unwrap_or_default(),
        tenant = Empty,
        status = Empty,
    )
}

/// Says how a request was answered.
pub(super) fn answered<B>(response: &Response<B>, took: Duration, span: &Span) {
    let status = response.status().as_u16();
    span.record("status", status);
    let took_ms = took.as_secs_f64() * 1e3;
    if response.status().is_server_error() {
        tracing::warn!(status, took_ms, "answered");
    } else {
        tracing::info!(status, took_ms, "answered");
    }
}
