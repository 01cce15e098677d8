//! Whether a connection has an answer on its way, from the request until the last byte is sent.

use std::{
    pin::Pin,
    sync::{
        Arc,
        atomic::{AtomicU8, Ordering},
    },
    task::{Context, Poll},
};

use http_body::{Body, Frame, SizeHint};

/// No answer is on its way.
const OVER: u8 = 0;
/// A request is being answered.
const UNDER_WAY: u8 = 1;
/// The answer is complete, but not all of it has been sent.
const UNSENT: u8 = 2;

/// The present exchange of a connection, which has one at a time; cheap to clone.
#[derive(Clone, Debug, Default)]
pub(crate) struct Exchange(Arc<AtomicU8>);

/// An answer that is on its way until this is dropped.
#[derive(Debug)]
pub(crate) struct UnderWay(Exchange);

/// The body of such an answer.
#[derive(Debug)]
pub(crate) struct Watched<B> {
    body: B,
    _under_way: UnderWay,
}

impl Exchange {
    /// Begins with a request.
    pub(crate) fn begin(&self) -> UnderWay {
        self.0.store(UNDER_WAY, Ordering::Release);
        UnderWay(self.clone())
    }

    /// Says that all that was written has been sent.
    pub(crate) fn flushed(&self) {
        // While an answer is under way, more of it comes.
        let _ = self.0.compare_exchange(UNSENT, OVER, Ordering::AcqRel, Ordering::Acquire);
    }

    /// Whether no answer is on its way.
    pub(crate) fn is_over(&self) -> bool {
        self.0.load(Ordering::Acquire) == OVER
    }
}

impl UnderWay {
    /// Lasts as long as a body.
    pub(crate) fn with<B>(self, body: B) -> Watched<B> {
        Watched { body, _under_way: self }
    }
}

impl Drop for UnderWay {
    fn drop(&mut self) {
        self.0.0.store(UNSENT, Ordering::Release);
    }
}

impl<B: Body + Unpin> Body for Watched<B> {
    type Data = B::Data;
    type Error = B::Error;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<B::Data>, B::Error>>> {
        Pin::new(&mut self.body).poll_frame(context)
    }

    fn is_end_stream(&self) -> bool {
        self.body.is_end_stream()
    }

    fn size_hint(&self) -> SizeHint {
        self.body.size_hint()
    }
}
