//! Reading request bodies: bounded, with the place of every mistake.

use axum::{
    body::{Bytes, to_bytes},
    extract::{FromRequest, Request},
    http::header,
};
use serde::de::DeserializeOwned;

use crate::{
    Engine,
    problem::{Problem, ProblemType, pointer},
};

/// A JSON body.
pub(crate) struct JsonBody<T>(pub(crate) T);

impl<T: DeserializeOwned> FromRequest<Engine> for JsonBody<T> {
    type Rejection = Problem;

    async fn from_request(request: Request, engine: &Engine) -> Result<Self, Problem> {
        let kind = content_type(&request);
        if kind != "application/json" && !kind.ends_with("+json") {
            let found = if kind.is_empty() { "no content type".to_owned() } else { format!("`{kind}`") };
            return Err(Problem::new(
                ProblemType::UnsupportedMediaType,
                format!("this path takes application/json, but the request has {found}"),
            ));
        }
        let bytes = read(request, engine).await?;
        from_json(&bytes).map(JsonBody)
    }
}

/// The media type of a request without its parameters, in lower case; empty when it has none.
pub(crate) fn content_type(request: &Request) -> String {
    let value = request.headers().get(header::CONTENT_TYPE).and_then(|v| v.to_str().ok()).unwrap_or_default();
    value.split(';').next().unwrap_or_default().trim().to_ascii_lowercase()
}

/// The body, refused once it exceeds the limit.
pub(crate) async fn read(request: Request, engine: &Engine) -> Result<Bytes, Problem> {
    let limit = engine.limits().body_bytes;
    let too_large = || {
        Problem::new(
            ProblemType::TooLarge,
            format!("the body exceeds {limit} bytes: send a smaller map, or a GeoTIFF instead of text"),
        )
    };
    let declared = request.headers().get(header::CONTENT_LENGTH).and_then(|v| v.to_str().ok());
    if declared.and_then(|v| v.parse::<usize>().ok()).is_some_and(|length| length > limit) {
        return Err(too_large());
    }
    to_bytes(request.into_body(), limit).await.map_err(|error| {
        let mut source: Option<&dyn std::error::Error> = Some(&error);
        while let Some(cause) = source {
            if cause.to_string().contains("length limit") {
                return too_large();
            }
            source = cause.source();
        }
        Problem::new(ProblemType::InvalidRequest, format!("the body ended early: {error}"))
    })
}

/// Parses JSON and names the place of a mistake.
pub(crate) fn from_json<T: DeserializeOwned>(bytes: &[u8]) -> Result<T, Problem> {
    let mut deserializer = serde_json::Deserializer::from_slice(bytes);
    let value = serde_path_to_error::deserialize(&mut deserializer).map_err(|error| {
        let place = error.path().to_string();
        let problem = Problem::new(ProblemType::InvalidRequest, format!("{place}: {}", error.inner()));
        if error.inner().is_data() { problem.at(pointer(&place)) } else { problem }
    })?;
    deserializer
        .end()
        .map_err(|error| Problem::new(ProblemType::InvalidRequest, format!("after the document: {error}")))?;
    Ok(value)
}
