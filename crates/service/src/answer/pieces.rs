//! A written answer in pieces, each given back when it has been sent.

use std::{
    collections::VecDeque,
    convert::Infallible,
    io,
    pin::Pin,
    task::{Context, Poll},
};

use axum::body::{Bytes, HttpBody};
use http_body::{Frame, SizeHint};
use sha2::{Digest, Sha256};

use crate::{
    memory::{Memory, Reserved},
    problem::Problem,
};

/// Bytes of a piece.
const PIECE_BYTES: usize = 32 << 10;

/// An answer in memory that is reserved.
pub(crate) struct Pieces {
    pieces: VecDeque<Bytes>,
    bytes: u64,
    reserved: Reserved,
}

impl Pieces {
    /// Writes an answer, whose memory is reserved as it grows; refused where there is no more.
    pub(crate) fn written<E: Into<Problem>>(
        memory: &Memory,
        write: impl FnOnce(&mut dyn io::Write) -> Result<(), E>,
    ) -> Result<Pieces, Problem> {
        let reserved = memory.reserve(0)?;
        let pieces = Pieces { pieces: VecDeque::new(), bytes: 0, reserved };
        let mut writer = Writer { pieces, piece: Vec::new(), refused: None };
        let written = write(&mut writer).map_err(Into::into);
        let outcome = written.and_then(|()| Ok(writer.end_piece()?));
        match (outcome, writer.refused) {
            (_, Some(problem)) | (Err(problem), None) => Err(problem),
            (Ok(()), None) => Ok(writer.pieces),
        }
    }

    /// A weak tag by the hash of the content: the same answer may be sent encoded.
    pub(crate) fn tag(&self) -> String {
        let mut hash = Sha256::new();
        self.pieces.iter().for_each(|piece| hash.update(piece));
        let hash: String = hash.finalize().iter().take(16).map(|byte| format!("{byte:02x}")).collect();
        format!("W/\"{hash}\"")
    }
}

impl HttpBody for Pieces {
    type Data = Bytes;
    type Error = Infallible;

    fn poll_frame(
        mut self: Pin<&mut Self>,
        _: &mut Context<'_>,
    ) -> Poll<Option<Result<Frame<Bytes>, Infallible>>> {
        let piece = self.pieces.pop_front();
        // The piece before has been sent, or is about to be.
        let left = self.bytes;
        self.reserved.shrink_to(left);
        self.bytes -= piece.as_ref().map_or(0, |piece| piece.len() as u64);
        Poll::Ready(piece.map(|piece| Ok(Frame::data(piece))))
    }

    fn is_end_stream(&self) -> bool {
        self.pieces.is_empty()
    }

    fn size_hint(&self) -> SizeHint {
        SizeHint::with_exact(self.bytes)
    }
}

struct Writer {
    pieces: Pieces,
    piece: Vec<u8>,
    refused: Option<Problem>,
}

impl Writer {
    fn end_piece(&mut self) -> io::Result<()> {
        if self.piece.is_empty() {
            return Ok(());
        }
        let length = self.pieces.bytes + self.piece.len() as u64;
        if let Err(problem) = self.pieces.reserved.grow_to(length) {
            self.refused = Some(problem);
            return Err(io::ErrorKind::OutOfMemory.into());
        }
        self.pieces.bytes = length;
        self.pieces.pieces.push_back(Bytes::from(std::mem::take(&mut self.piece)));
        Ok(())
    }
}

impl io::Write for Writer {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let room = PIECE_BYTES - self.piece.len();
        let taken = &bytes[..bytes.len().min(room)];
        self.piece.extend_from_slice(taken);
        if self.piece.len() == PIECE_BYTES {
            self.end_piece()?;
        }
        Ok(taken.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use axum::body::{Body, to_bytes};
    use futures_util::StreamExt;

    use super::*;
    use crate::{metrics::Metrics, problem::ProblemType};

    fn text(bytes: usize) -> Vec<u8> {
        (0..bytes).map(|i| i as u8).collect()
    }

    #[tokio::test]
    async fn what_is_written_is_sent_and_its_memory_given_back_as_it_goes() {
        let metrics = Metrics::new();
        let memory = Memory::new(1 << 20, &metrics);
        for bytes in [0, 1, PIECE_BYTES, PIECE_BYTES + 1, 500_000] {
            let pieces = Pieces::written(&memory, |out| out.write_all(&text(bytes))).unwrap();
            assert_eq!(pieces.size_hint().exact(), Some(bytes as u64));
            assert_eq!(metrics.reserved_bytes.get(), bytes as i64);
            assert_eq!(to_bytes(Body::new(pieces), usize::MAX).await.unwrap(), text(bytes));
            assert_eq!(metrics.reserved_bytes.get(), 0);
        }
        let pieces = Pieces::written(&memory, |out| out.write_all(&text(100_000))).unwrap();
        let mut half = Body::new(pieces).into_data_stream();
        let _ = (half.next().await, half.next().await);
        assert_eq!(
            metrics.reserved_bytes.get(),
            (100_000 - PIECE_BYTES) as i64,
            "one was sent, one is on its way"
        );
    }

    #[test]
    fn an_answer_without_room_is_refused_and_leaves_nothing_behind() {
        let metrics = Metrics::new();
        let memory = Memory::new(1 << 20, &metrics);
        let _others = memory.reserve(800_000).unwrap();
        let refused = Pieces::written(&memory, |out| out.write_all(&text(400_000))).err().unwrap();
        assert_eq!(refused.kind, ProblemType::Overloaded);
        assert_eq!(metrics.reserved_bytes.get(), 800_000);
    }

    #[test]
    fn tags_tell_contents_apart() {
        let memory = Memory::new(1 << 20, &Metrics::new());
        let tag = |bytes: usize| Pieces::written(&memory, |out| out.write_all(&text(bytes))).unwrap().tag();
        assert_eq!(tag(1000), tag(1000));
        assert_ne!(tag(1000), tag(1001));
        assert!(tag(7).starts_with("W/\"") && tag(7).len() == 36);
    }
}
