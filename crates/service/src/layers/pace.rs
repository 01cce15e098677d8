//! A body has to keep coming: whoever sends it drop by drop does not hold a connection for ever.

use std::{
    pin::Pin,
    task::{Context, Poll},
    time::Duration,
};

use axum::{
    body::{Body, Bytes, HttpBody, to_bytes},
    extract::{Request, State},
    middleware::Next,
    response::{IntoResponse, Response},
};
use http_body::{Frame, SizeHint};
use tokio::time::{Instant, Sleep, sleep_until};

use crate::{Limits, body::broken};

/// How slowly a body may come.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Pace {
    /// Longest pause, and what every body gets at least [s].
    pause: Duration,
    /// Least mean speed beyond that [bytes/s].
    bytes_per_s: u64,
}

impl From<&Limits> for Pace {
    fn from(limits: &Limits) -> Self {
        Pace { pause: limits.body_pause, bytes_per_s: limits.body_bytes_per_s.max(1) }
    }
}

/// What the failure of a body says that came too slowly; unpacking leaves nothing but the words of it.
pub(crate) const TOO_SLOW: &str = "the body came too slowly";

/// The body came too slowly.
#[derive(Clone, Copy, Debug)]
struct TooSlow;

impl std::fmt::Display for TooSlow {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(TOO_SLOW)
    }
}

impl std::error::Error for TooSlow {}

/// A body of so many bytes is taken whole before anything is answered: closing a connection with some of it unread would take
/// the answer with it.
const SHORT_BYTES: u64 = 32 << 10;

/// Breaks off bodies that come too slowly.
pub(crate) async fn paced(State(pace): State<Pace>, request: Request, next: Next) -> Response {
    if request.body().is_end_stream() {
        return next.run(request).await;
    }
    let request = request.map(|body| Body::new(PacedBody::new(body, pace)));
    if request.body().size_hint().upper().is_none_or(|most| most > SHORT_BYTES) {
        return next.run(request).await;
    }
    let (parts, body) = request.into_parts();
    match to_bytes(body, usize::MAX).await {
        Ok(bytes) => next.run(Request::from_parts(parts, Body::from(bytes))).await,
        Err(error) => broken(&error).into_response(),
    }
}

/// A body with a clock beside it.
struct PacedBody {
    body: Body,
    pace: Pace,
    began: Instant,
    bytes: u64,
    clock: Pin<Box<Sleep>>,
}

impl PacedBody {
    fn new(body: Body, pace: Pace) -> Self {
        let began = Instant::now();
        PacedBody { body, pace, began, bytes: 0, clock: Box::pin(sleep_until(began + pace.pause)) }
    }

    /// When the next bytes have to be there: after a pause, and not later than the mean speed allows.
    fn due(&self) -> Instant {
        let earned = Duration::from_secs_f64(self.bytes as f64 / self.pace.bytes_per_s as f64);
        (Instant::now() + self.pace.pause).min(self.began + self.pace.pause + earned)
    }
}

impl HttpBody for PacedBody {
    type Data = Bytes;
    type Error = axum::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, axum::Error>>> {
        match Pin::new(&mut self.body).poll_frame(context) {
            Poll::Ready(Some(Ok(frame))) => {
                self.bytes += frame.data_ref().map_or(0, |data| data.len() as u64);
                let due = self.due();
                self.clock.as_mut().reset(due);
                Poll::Ready(Some(Ok(frame)))
            }
            Poll::Pending if self.clock.as_mut().poll(context).is_ready() => {
                Poll::Ready(Some(Err(axum::Error::new(TooSlow))))
            }
            other => other,
        }
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}

#[cfg(test)]
mod tests {
    use futures_util::stream;

    use super::*;

    const PACE: Pace = Pace { pause: Duration::from_secs(10), bytes_per_s: 100 };

    /// Pieces of a body, each after so many seconds.
    async fn send(pieces: Vec<(u64, usize)>) -> Result<Bytes, axum::Error> {
        let pieces = stream::unfold(pieces.into_iter(), |mut pieces| async {
            let (after_s, bytes) = pieces.next()?;
            tokio::time::sleep(Duration::from_secs(after_s)).await;
            Some((Ok::<_, std::io::Error>(Bytes::from(vec![b'x'; bytes])), pieces))
        });
        to_bytes(Body::new(PacedBody::new(Body::from_stream(pieces), PACE)), usize::MAX).await
    }

    #[tokio::test(start_paused = true)]
    async fn a_body_that_keeps_coming_arrives() {
        let sent = send((0..100).map(|_| (5, 600)).collect()).await;
        assert_eq!(sent.map(|bytes| bytes.len()).ok(), Some(60_000));
    }

    #[tokio::test(start_paused = true)]
    async fn a_pause_or_a_trickle_breaks_it_off() {
        assert!(send(vec![(1, 5000), (11, 5000)]).await.is_err(), "a pause");
        assert!(send((0..100).map(|_| (5, 1)).collect()).await.is_err(), "a trickle");
    }
}
