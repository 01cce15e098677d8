//! Answers: written on threads for that, in pieces whose memory is reserved, or piece by piece as the client takes them.

mod pieces;

use std::{
    io,
    sync::{Arc, Mutex, PoisonError},
};

use axum::{
    body::{Body, Bytes},
    extract::{Request, State},
    http::{HeaderValue, Method, StatusCode, header},
    middleware::Next,
    response::{IntoResponse, Response},
};
use futures_util::stream;
use serde::Serialize;

pub(crate) use self::pieces::Pieces;
use crate::{
    Engine,
    memory::Account,
    problem::{Problem, ProblemType},
};

type Write = Box<dyn FnOnce(&mut dyn io::Write) -> io::Result<()> + Send>;

/// An answer of a media type that is yet to be written, by [`write`].
pub(crate) struct Written {
    media_type: &'static str,
    write: Write,
}

impl Written {
    pub(crate) fn new(
        media_type: &'static str,
        write: impl FnOnce(&mut dyn io::Write) -> io::Result<()> + Send + 'static,
    ) -> Self {
        Written { media_type, write: Box::new(write) }
    }
}

/// A JSON answer of another media type.
pub(crate) fn json(media_type: &'static str, value: impl Serialize + Send + 'static) -> Written {
    Written::new(media_type, move |out| Ok(serde_json::to_writer(out, &value)?))
}

/// A JSON answer, as `axum::Json`, but not written by the thread that serves others.
pub(crate) struct Json<T>(pub(crate) T);

impl<T: Serialize + Send + 'static> IntoResponse for Json<T> {
    fn into_response(self) -> Response {
        json("application/json", self.0).into_response()
    }
}

/// What is to be written, on its way through the response's extensions.
#[derive(Clone)]
struct Unwritten(Arc<Mutex<Option<Write>>>);

impl IntoResponse for Written {
    fn into_response(self) -> Response {
        let mut response = Response::new(Body::empty());
        response.headers_mut().insert(header::CONTENT_TYPE, HeaderValue::from_static(self.media_type));
        response.extensions_mut().insert(Unwritten(Arc::new(Mutex::new(Some(self.write)))));
        response
    }
}

/// Writes an answer that is yet to be written, and tags it by its hash if it is one to GET.
pub(crate) async fn write(State(engine): State<Engine>, request: Request, next: Next) -> Response {
    let is_get = request.method() == Method::GET;
    let mut response = next.run(request).await;
    let Some(Unwritten(unwritten)) = response.extensions_mut().remove() else { return response };
    let Some(write) = unwritten.lock().unwrap_or_else(PoisonError::into_inner).take() else {
        return response;
    };
    let memory = engine.admission().memory().clone();
    let is_tagged = is_get && response.status() == StatusCode::OK;
    let written = engine.write(move || {
        let pieces = Pieces::written(&memory, write)?;
        let tag = is_tagged.then(|| pieces.tag());
        Ok((pieces, tag))
    });
    match written.await {
        Ok((pieces, tag)) => {
            if let Some(tag) = tag.and_then(|tag| HeaderValue::from_str(&tag).ok()) {
                response.headers_mut().insert(header::ETAG, tag);
            }
            response.map(|_| Body::new(pieces))
        }
        Err(problem) => problem.into_response(),
    }
}

/// A body that is made piece by piece, each on a thread for that once the client has taken those before; what the request has
/// reserved stays so until then.
pub(crate) fn streamed(pieces: impl Iterator<Item = Vec<u8>> + Send + 'static) -> Body {
    let account = Account::current();
    Body::from_stream(stream::try_unfold((pieces, account), |(mut pieces, account)| async move {
        let made = tokio::task::spawn_blocking(move || (pieces.next(), pieces)).await;
        let (piece, pieces) = made.map_err(io::Error::other)?;
        Ok::<_, io::Error>(piece.map(|piece| (Bytes::from(piece), (pieces, account))))
    }))
}

/// An answer that cannot be written.
impl From<io::Error> for Problem {
    fn from(error: io::Error) -> Self {
        Problem::new(ProblemType::Internal, format!("the answer cannot be written: {error}"))
    }
}
