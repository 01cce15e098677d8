//! Reading what a request carries: bounded, with the place of every mistake.

use std::sync::Arc;

use axum::{
    extract::{FromRequest, FromRequestParts, Path, Request},
    http::{header, request::Parts},
};
use futures_util::StreamExt;
use serde::de::DeserializeOwned;

use crate::{
    Engine,
    layers::TOO_SLOW,
    memory::{Reserved, document_bytes, hold},
    problem::{Problem, ProblemType},
};

/// A JSON body.
pub(crate) struct JsonBody<T>(pub(crate) T);

/// A JSON body that holds no map: what is done with it beside reading takes no thread of its own.
pub(crate) struct ShortJsonBody<T>(pub(crate) T);

/// Most bytes of a [`ShortJsonBody`]: a robot, a map of columns and a lifting test take some tens of kilobytes.
const SHORT_BODY_BYTES: usize = 4 << 20;

impl<T: DeserializeOwned + Send + 'static> FromRequest<Engine> for JsonBody<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, engine: &Engine) -> Result<Self, Problem> {
        parsed(request, engine, engine.limits().body_bytes).await.map(JsonBody)
    }
}

impl<T: DeserializeOwned + Send + 'static> FromRequest<Engine> for ShortJsonBody<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, engine: &Engine) -> Result<Self, Problem> {
        parsed(request, engine, SHORT_BODY_BYTES.min(engine.limits().body_bytes)).await.map(ShortJsonBody)
    }
}

/// What a JSON body of so many bytes at most says.
async fn parsed<T: DeserializeOwned + Send + 'static>(
    request: Request,
    engine: &Engine,
    most_bytes: usize,
) -> Result<T, Problem> {
    let kind = content_type(&request);
    if kind != "application/json" && !kind.ends_with("+json") {
        let found = if kind.is_empty() { "no content type".to_owned() } else { format!("`{kind}`") };
        return Err(Problem::new(
            ProblemType::UnsupportedMediaType,
            format!("this path takes application/json, but the request has {found}"),
        ));
    }
    let content = read_at_most(request, engine, most_bytes).await?;
    let length = content.bytes.len();
    engine.read(length, move || content.parsed(from_json)).await
}

/// What a body holds, and the memory that it takes.
pub(crate) struct Content {
    pub(crate) bytes: Vec<u8>,
    pub(crate) reserved: Reserved,
}

impl Content {
    /// Parses a JSON document, whose memory is reserved before and belongs to the request from then on.
    pub(crate) fn parsed<T>(mut self, parse: impl FnOnce(&[u8]) -> Result<T, Problem>) -> Result<T, Problem> {
        let document = document_bytes(&self.bytes);
        self.reserved.grow_to(self.bytes.len() as u64 + document)?;
        let value = parse(&self.bytes)?;
        drop(self.bytes);
        self.reserved.shrink_to(document);
        hold(Arc::new(self.reserved));
        Ok(value)
    }
}

/// The media type of a request without its parameters, in lower case; empty when it has none.
pub(crate) fn content_type(request: &Request) -> String {
    let value = request.headers().get(header::CONTENT_TYPE).and_then(|v| v.to_str().ok()).unwrap_or_default();
    value.split(';').next().unwrap_or_default().trim().to_ascii_lowercase()
}

/// The body, refused once it exceeds the limit, or the memory that there is. What has come is reserved as it comes.
pub(crate) async fn read(request: Request, engine: &Engine) -> Result<Content, Problem> {
    read_at_most(request, engine, engine.limits().body_bytes).await
}

/// The same with a limit of its own.
async fn read_at_most(request: Request, engine: &Engine, limit: usize) -> Result<Content, Problem> {
    let too_large = || {
        Problem::new(
            ProblemType::TooLarge,
            format!(
                "the body exceeds {limit} bytes: send a smaller document, or a map as a GeoTIFF instead of text"
            ),
        )
    };
    let declared = request.headers().get(header::CONTENT_LENGTH).and_then(|v| v.to_str().ok());
    if declared.and_then(|v| v.parse::<usize>().ok()).is_some_and(|length| length > limit) {
        return Err(too_large());
    }
    let mut content = Content { bytes: Vec::new(), reserved: engine.admission().reserve(0)? };
    let mut pieces = request.into_body().into_data_stream();
    while let Some(piece) = pieces.next().await {
        let piece = piece.map_err(|error| broken(&error))?;
        let length = content.bytes.len() + piece.len();
        if length > limit {
            return Err(too_large());
        }
        content.reserved.grow_to(length as u64)?;
        content.bytes.extend_from_slice(&piece);
    }
    Ok(content)
}

/// Why a body did not arrive.
pub(crate) fn broken(error: &axum::Error) -> Problem {
    let mut source: Option<&dyn std::error::Error> = Some(error);
    while let Some(cause) = source {
        let said = cause.to_string();
        if said.contains(TOO_SLOW) {
            return Problem::new(
                ProblemType::TooSlow,
                "the body came too slowly: send it again, over a better line",
            );
        }
        source = cause.source();
    }
    Problem::new(ProblemType::InvalidRequest, format!("the body ended early or cannot be decoded: {error}"))
}

/// Parses a JSON document and names the place of every mistake.
pub(crate) fn from_json<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, Problem> {
    document::from_json(bytes).map_err(|error| Problem::invalid_document(&error, ""))
}

/// The last part of a path, as an id.
pub(crate) struct Id(pub(crate) String);

impl FromRequestParts<Engine> for Id {
    type Rejection = Problem;

    async fn from_request_parts(parts: &mut Parts, engine: &Engine) -> Result<Self, Problem> {
        match Path::<String>::from_request_parts(parts, engine).await {
            Ok(Path(id)) => Ok(Id(id)),
            Err(error) => {
                let detail = format!("the id in the path cannot be read: {}", error.body_text());
                Err(Problem::new(ProblemType::NotFound, detail))
            }
        }
    }
}
