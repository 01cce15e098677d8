//! Memory of encoders: an answer that a client takes slowly keeps its encoder as long. Where there is no memory for one, the
//! answer is sent plain.

use axum::{
    body::HttpBody,
    extract::{Request, State},
    http::{Extensions, HeaderMap, StatusCode, Version, header},
    middleware::Next,
    response::Response,
};
use tower_http::compression::predicate::{DefaultPredicate, Predicate};

use crate::memory::{Memory, holding};

/// What the largest encoder takes at the fastest level, that of br with its window of 4 MiB [bytes].
const ENCODER_BYTES: u64 = 6 << 20;
/// An answer of so many bytes is encoded at once, and its encoder is gone before it is sent.
const SHORT_BYTES: u64 = 32 << 10;

/// Marks an answer that is to be sent plain.
#[derive(Clone, Copy)]
struct Plain;

/// Reserves memory for the encoder of a long answer.
pub(crate) async fn reserve(State(memory): State<Memory>, request: Request, next: Next) -> Response {
    let accepted = request.headers().get_all(header::ACCEPT_ENCODING).iter();
    let names_one = |text: &str| ["gzip", "br", "zstd", "*"].iter().any(|name| text.contains(name));
    let may_be_encoded = accepted.filter_map(|value| value.to_str().ok()).any(names_one);
    let mut response = next.run(request).await;
    // Events, for one, are never encoded.
    let may_be_encoded = may_be_encoded && DefaultPredicate::new().should_compress(&response);
    let is_long = response.body().size_hint().upper().is_none_or(|bytes| bytes > SHORT_BYTES);
    if !may_be_encoded || !is_long {
        return response;
    }
    match memory.spare(ENCODER_BYTES) {
        Some(reserved) => response.map(|body| holding(body, reserved)),
        None => {
            response.extensions_mut().insert(Plain);
            response
        }
    }
}

/// Whether there is memory to encode an answer.
pub(crate) fn has_room(_: StatusCode, _: Version, _: &HeaderMap, extensions: &Extensions) -> bool {
    extensions.get::<Plain>().is_none()
}
