//! How long answers take, by path and status.

use std::time::Instant;

use axum::{
    extract::{MatchedPath, Request, State},
    http::Method,
    middleware::Next,
    response::Response,
};

use crate::metrics::{Metrics, RequestLabels};

/// What stands for a status where the client left before there was an answer, as nginx writes it.
const CLIENT_LEFT: u16 = 499;

/// Measures from the last byte of the head to the first of the answer's.
pub(crate) async fn measure(
    State(metrics): State<Metrics>,
    path: Option<MatchedPath>,
    request: Request,
    next: Next,
) -> Response {
    let path = path.map_or("none".to_owned(), |path| path.as_str().to_owned());
    let mut measured = Measured {
        metrics,
        began: Instant::now(),
        labels: RequestLabels { method: method(request.method()), path, status: CLIENT_LEFT },
    };
    measured.metrics.requests_in_flight.inc();
    let response = next.run(request).await;
    measured.labels.status = response.status().as_u16();
    response
}

/// Counts when it is dropped, so that requests whose client leaves are counted too.
struct Measured {
    metrics: Metrics,
    began: Instant,
    labels: RequestLabels,
}

impl Drop for Measured {
    fn drop(&mut self) {
        self.metrics.requests_in_flight.dec();
        let durations = self.metrics.request_durations.get_or_create(&self.labels);
        durations.observe(self.began.elapsed().as_secs_f64());
    }
}

/// One of few names, however many a client makes up.
fn method(method: &Method) -> &'static str {
    match *method {
        Method::GET => "GET",
        Method::HEAD => "HEAD",
        Method::POST => "POST",
        Method::PATCH => "PATCH",
        Method::DELETE => "DELETE",
        Method::PUT => "PUT",
        Method::OPTIONS => "OPTIONS",
        _ => "other",
    }
}
