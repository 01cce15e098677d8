//! `GET /`: the page, built from `ui` and carried by the program.

use std::sync::Arc;

use axum::{
    Router,
    body::Bytes,
    extract::Path,
    http::{HeaderMap, HeaderValue, StatusCode, header},
    response::{IntoResponse, Response},
    routing::get,
};
use rust_embed::{EmbeddedFile, RustEmbed};
use serde::Serialize;

use crate::{
    Access, Engine, Tiles,
    problem::{Problem, ProblemType},
};

/// What `npm run build` made of `ui`.
#[derive(RustEmbed)]
#[folder = "ui/dist"]
struct Built;

/// Real ground to begin with.
const SAMPLE_MAP: &[u8] = include_bytes!("../../../../maps/minnesota.tif");

/// The page loads nothing from elsewhere but pictures of the ground where the service was given a place for them, and nobody frames it.
fn content_security_policy(tiles: Option<&Tiles>) -> String {
    let pictures = tiles.map_or(String::new(), |tiles| format!("; img-src 'self' {}", tiles.origin()));
    format!("default-src 'self'{pictures}; frame-ancestors 'none'; base-uri 'none'; form-action 'none'")
}

/// What the service was started with that concerns the page alone.
#[derive(Serialize)]
struct Settings<'a> {
    tiles: Option<&'a Tiles>,
}

/// The page's settings, which may hold the key to somebody's tiles.
pub(crate) fn settings(access: &Access) -> Router<Engine> {
    let document = serde_json::to_vec(&Settings { tiles: access.tiles.as_ref() }).unwrap_or_default();
    let document = Bytes::from(document);
    let about = [(header::CONTENT_TYPE, "application/json"), (header::CACHE_CONTROL, "no-store")];
    Router::new().route("/page/settings.json", get(async move || (about, document)))
}

/// The page's own paths.
pub(crate) fn routes(access: &Access) -> Router<Engine> {
    let policy: Arc<str> = content_security_policy(access.tiles.as_ref()).into();
    let of_page = Arc::clone(&policy);
    Router::new()
        .route("/", get(async move |headers: HeaderMap| file("index.html", &headers, &policy)))
        .route(
            "/page/{name}",
            get(async move |Path(name): Path<String>, headers: HeaderMap| {
                file(&format!("page/{name}"), &headers, &of_page)
            }),
        )
        .route("/sample-map.tif", get(async || ([(header::CONTENT_TYPE, "image/tiff")], SAMPLE_MAP)))
}

/// One file, or word that the client has it already.
fn file(name: &str, headers: &HeaderMap, policy: &str) -> Response {
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
        (header::CONTENT_SECURITY_POLICY, policy),
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
