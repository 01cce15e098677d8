//! `ETag` and `If-None-Match`: what a client has already is not sent again (RFC 9110, section 13.1.2).

use axum::{
    body::{Body, HttpBody, to_bytes},
    extract::{MatchedPath, Request},
    http::{HeaderMap, HeaderValue, Method, StatusCode, header},
    middleware::Next,
    response::Response,
};
use sha2::{Digest, Sha256};

/// What is kept under the hash of its content never changes, and is asked for again after a day at most: it may be deleted.
const IMMUTABLE: HeaderValue = HeaderValue::from_static("private, max-age=86400, immutable");
/// What may change is asked for each time.
const REVALIDATE: HeaderValue = HeaderValue::from_static("private, no-cache");
/// An answer to a question, a failure, or the state of the service.
const NEVER: HeaderValue = HeaderValue::from_static("no-store");

/// Paths of things that are named by the hash of their content.
const CONTENT_ADDRESSED: [&str; 2] = ["/v1/maps/{id}", "/v1/recordings/{id}"];
/// Paths that tell how the service or a job is right now.
const MOMENTARY: [&str; 5] = ["/healthz", "/readyz", "/metrics", "/v1/status", "/v1/jobs/{id}/events"];

/// Whether answers to GET of a path template carry a tag.
pub(crate) fn is_tagged(path: &str) -> bool {
    !MOMENTARY.contains(&path)
}

/// Tags answers to GET by the hash of their bytes, and answers 304 where the client has them. Answers that say themselves
/// how they are to be kept are left as they are.
pub(crate) async fn conditional(path: Option<MatchedPath>, request: Request, next: Next) -> Response {
    let path = path.as_ref().map_or("", MatchedPath::as_str).to_owned();
    let is_get = request.method() == Method::GET;
    let held = request.headers().get(header::IF_NONE_MATCH).cloned();
    let mut response = next.run(request).await;
    if response.headers().contains_key(header::CACHE_CONTROL) {
        return response;
    }
    let is_found = is_get && response.status() == StatusCode::OK;
    let keep = match path.as_str() {
        _ if !is_found => NEVER,
        path if !is_tagged(path) => NEVER,
        path if CONTENT_ADDRESSED.contains(&path) && !is_named(&response) => IMMUTABLE,
        _ => REVALIDATE,
    };
    let tagged = keep != NEVER;
    response.headers_mut().insert(header::CACHE_CONTROL, keep);
    if !tagged {
        return response;
    }
    // What one tenant sees is not there for another whose token comes from the same browser.
    response.headers_mut().append(header::VARY, HeaderValue::from_static("authorization"));
    tag(response, held.as_ref()).await
}

/// Mark of an answer that holds a name beside what its id is the hash of: the name may change.
#[derive(Clone, Copy)]
pub(crate) struct Named;

fn is_named(response: &Response) -> bool {
    response.extensions().get::<Named>().is_some()
}

/// Tags a short body that has no tag yet, and leaves out one that the client has. A body that is still being made, as events
/// are, is passed on.
async fn tag(response: Response, held: Option<&HeaderValue>) -> Response {
    let (mut parts, mut body) = response.into_parts();
    if !parts.headers.contains_key(header::ETAG) && body.size_hint().exact().is_some() {
        let Ok(bytes) = to_bytes(body, usize::MAX).await else {
            return Response::from_parts(parts, Body::empty());
        };
        let hash: String = Sha256::digest(&bytes).iter().take(16).map(|byte| format!("{byte:02x}")).collect();
        // Weak, because the same answer may be sent compressed.
        if let Ok(tag) = HeaderValue::from_str(&format!("W/\"{hash}\"")) {
            parts.headers.insert(header::ETAG, tag);
        }
        body = Body::from(bytes);
    }
    let tag = parts.headers.get(header::ETAG).and_then(|tag| tag.to_str().ok()).unwrap_or_default();
    let is_held = held.and_then(|held| held.to_str().ok()).is_some_and(|held| holds(held, tag));
    if is_held && !tag.is_empty() {
        parts.status = StatusCode::NOT_MODIFIED;
        without_content(&mut parts.headers);
        body = Body::empty();
    }
    Response::from_parts(parts, body)
}

/// Whether an `If-None-Match` names a tag, compared weakly.
fn holds(held: &str, tag: &str) -> bool {
    let opaque = |tag: &str| tag.trim().trim_start_matches("W/").to_owned();
    held.trim() == "*" || held.split(',').any(|other| opaque(other) == opaque(tag))
}

fn without_content(headers: &mut HeaderMap) {
    headers.remove(header::CONTENT_TYPE);
    headers.remove(header::CONTENT_LENGTH);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tags_are_compared_weakly_and_in_lists() {
        for held in ["\"ab\"", "W/\"ab\"", "\"x\", W/\"ab\"", "*", " * "] {
            assert!(holds(held, "W/\"ab\""), "{held}");
        }
        for held in ["", "ab", "\"abc\"", "W/\"a\""] {
            assert!(!holds(held, "W/\"ab\""), "{held}");
        }
    }
}
