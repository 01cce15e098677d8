//! `Content-Encoding` of requests: those that can be unpacked are, the others are refused by name.

use axum::{
    extract::Request,
    http::{HeaderValue, header},
    middleware::Next,
    response::{IntoResponse, Response},
};

use crate::problem::{Problem, ProblemType};

/// What a body may be packed with.
const KNOWN: [&str; 4] = ["gzip", "br", "zstd", "identity"];

/// Refuses a packing that is not known. Limits count what comes out of the packing, so that a small body that unpacks to a
/// large one is refused as a large one is.
pub(crate) async fn refuse_unknown(request: Request, next: Next) -> Response {
    let mut packings = request.headers().get_all(header::CONTENT_ENCODING).iter();
    let found = packings.next().map(|value| value.to_str().unwrap_or("?").to_owned());
    match found {
        Some(found) if packings.next().is_some() || !KNOWN.contains(&found.as_str()) => {
            let detail =
                format!("the body is packed as `{found}`, but may be gzip, br, zstd or not packed, once");
            let mut response = Problem::new(ProblemType::UnsupportedMediaType, detail).into_response();
            response
                .headers_mut()
                .insert(header::ACCEPT_ENCODING, HeaderValue::from_static("gzip, br, zstd"));
            response
        }
        _ => next.run(request).await,
    }
}
