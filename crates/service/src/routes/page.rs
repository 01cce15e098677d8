//! `GET /`: the page, built from `ui` and carried by the program.

use axum::{
    Router,
    body::Bytes,
    extract::Path,
    http::{HeaderMap, HeaderValue, StatusCode, header},
    response::{IntoResponse, Response},
    routing::get,
};
use rust_embed::{EmbeddedFile, RustEmbed};

use crate::{
    Engine,
    problem::{Problem, ProblemType},
};

/// What `npm run build` made of `ui`.
#[derive(RustEmbed)]
#[folder = "ui/dist"]
struct Built;

/// Real ground to begin with.
const SAMPLE_MAP: &[u8] = include_bytes!("../../../../maps/minnesota.tif");

/// The page loads nothing from elsewhere, and nobody frames it.
const CONTENT_SECURITY_POLICY: &str =
    "default-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'none'";

/// The page's own paths.
pub(crate) fn routes() -> Router<Engine> {
    Router::new()
        .route("/", get(async |headers: HeaderMap| file("index.html", &headers)))
        .route(
            "/page/{name}",
            get(async |Path(name): Path<String>, headers: HeaderMap| file(&format!("page/{name}"), &headers)),
        )
        .route("/sample-map.tif", get(async || ([(header::CONTENT_TYPE, "image/tiff")], SAMPLE_MAP)))
}

/// One file, or word that the client has it already.
fn file(name: &str, headers: &HeaderMap) -> Response {
    let Some(EmbeddedFile { data, metadata }) = Built::get(name) else {
        let detail = format!("the page has no `/{name}`: reload it from /");
        return Problem::new(ProblemType::NotFound, detail).into_response();
    };
    let hash: String = metadata.sha256_hash().iter().take(8).map(|byte| format!("{byte:02x}")).collect();
    // Weak, because the bytes differ by how they are compressed.
    let tag = format!("W/\"{hash}\"");
    let known = headers.get(header::IF_NONE_MATCH).and_then(|v| v.to_str().ok());
    let is_known = known.is_some_and(|known| known.split(',').any(|known| known.trim() == tag));
    // All names but that of the first file hold a hash of what is in them.
    let keep = if name == "index.html" { "no-cache" } else { "public, max-age=31536000, immutable" };
    let about = [
        (header::ETAG, tag.as_str()),
        (header::CACHE_CONTROL, keep),
        (header::CONTENT_SECURITY_POLICY, CONTENT_SECURITY_POLICY),
        (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
        (header::REFERRER_POLICY, "no-referrer"),
    ];
    let mut response = match is_known {
        true => StatusCode::NOT_MODIFIED.into_response(),
        false => {
            ([(header::CONTENT_TYPE, content_type(name))], Bytes::from(data.into_owned())).into_response()
        }
    };
    for (field, value) in about {
        if let Ok(value) = HeaderValue::from_str(value) {
            response.headers_mut().insert(field, value);
        }
    }
    response
}

fn content_type(name: &str) -> &'static str {
    match name.rsplit('.').next() {
        Some("html") => "text/html; charset=utf-8",
        Some("js") => "text/javascript; charset=utf-8",
        Some("css") => "text/css; charset=utf-8",
        Some("svg") => "image/svg+xml",
        _ => "application/octet-stream",
    }
}
