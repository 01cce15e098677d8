//! `GET /docs/guide/`: the guide, carried by the program and readable without a network.

use axum::{
    Router,
    body::Bytes,
    extract::Path,
    http::{HeaderMap, HeaderValue, StatusCode, header},
    response::{IntoResponse, Redirect, Response},
    routing::get,
};
use sha2::{Digest, Sha256};

use crate::{
    Engine,
    guide::guide_file,
    problem::{Problem, ProblemType},
};

/// The guide loads its own style sheet and pictures and nothing else, runs nothing, and nobody frames it.
const CONTENT_SECURITY_POLICY: &str = "default-src 'none'; style-src 'self'; img-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

/// Chapters and their pictures; neither asks for a token, since they tell nothing of what the service holds.
pub(crate) fn routes() -> Router<Engine> {
    Router::new()
        .route("/docs/guide", get(async || Redirect::permanent("/docs/guide/")))
        .route("/docs/guide/", get(async |headers: HeaderMap| file("", &headers)))
        .route(
            "/docs/guide/{*name}",
            get(async |Path(name): Path<String>, headers: HeaderMap| file(&name, &headers)),
        )
}

/// One file, or word that the client has it already.
fn file(name: &str, headers: &HeaderMap) -> Response {
    let Some(file) = guide_file(name) else {
        let detail = format!("the guide has no `{name}`: /docs/guide/ lists its chapters");
        return Problem::new(ProblemType::NotFound, detail).into_response();
    };
    let hash: String = Sha256::digest(&file.bytes).iter().take(8).map(|byte| format!("{byte:02x}")).collect();
    // Weak, because the bytes differ by how they are compressed.
    let tag = format!("W/\"{hash}\"");
    let known = headers.get(header::IF_NONE_MATCH).and_then(|value| value.to_str().ok());
    let is_known = known.is_some_and(|known| known.split(',').any(|known| known.trim() == tag));
    let mut response = if is_known {
        StatusCode::NOT_MODIFIED.into_response()
    } else {
        ([(header::CONTENT_TYPE, file.content_type)], Bytes::from_static(&file.bytes)).into_response()
    };
    let about = [
        (header::ETAG, tag.as_str()),
        (header::CACHE_CONTROL, "no-cache"),
        (header::CONTENT_SECURITY_POLICY, CONTENT_SECURITY_POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
    ];
    for (field, value) in about {
        if let Ok(value) = HeaderValue::from_str(value) {
            response.headers_mut().insert(field, value);
        }
    }
    response
}
