//! Requests that cannot be parsed: the HTTP library refuses them by itself, without content, before any layer sees them. Its
//! bare answers become problem documents on their way out. While an answer of a layer is on its way, nothing is replaced: its content
//! may look like anything.

use std::{
    io::{self, IoSlice},
    pin::Pin,
    task::{Context, Poll, ready},
};

use tokio::io::{AsyncRead, AsyncWrite, ReadBuf};
use uuid::Uuid;

use crate::{
    exchange::Exchange,
    problem::{Problem, ProblemType},
};

/// What an answer begins with.
const VERSION: &[u8] = b"HTTP/1.1 ";

/// A stream in whose output bare refusals are replaced.
pub(crate) struct WithProblems<S> {
    stream: S,
    exchange: Exchange,
    /// What stands for a bare refusal, and how much of it has been sent.
    problem: Vec<u8>,
    sent: usize,
}

impl<S: AsyncWrite + Unpin> WithProblems<S> {
    pub(crate) fn new(stream: S, exchange: Exchange) -> Self {
        WithProblems { stream, exchange, problem: Vec::new(), sent: 0 }
    }

    fn poll_problem(&mut self, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        while self.sent < self.problem.len() {
            let rest = &self.problem[self.sent..];
            match ready!(Pin::new(&mut self.stream).poll_write(context, rest))? {
                0 => return Poll::Ready(Err(io::ErrorKind::WriteZero.into())),
                count => self.sent += count,
            }
        }
        Poll::Ready(Ok(()))
    }
}

/// The problem that a bare refusal stands for.
fn bare_refusal(output: &[u8]) -> Option<Problem> {
    if !output.starts_with(VERSION) || !output.ends_with(b"\r\n\r\n") {
        return None;
    }
    let head = std::str::from_utf8(output).ok()?;
    let status = head.split(' ').nth(1)?;
    let (kind, detail) = match status {
        "400" => (
            ProblemType::InvalidRequest,
            "the request is not HTTP/1.1: its request line or a header field is malformed",
        ),
        "414" => {
            (ProblemType::TargetTooLong, "the target of the request is longer than 65534 bytes: shorten it")
        }
        "431" => (
            ProblemType::HeaderTooLarge,
            "the head of the request exceeds 100 header fields or 128 KiB: send fewer and shorter fields",
        ),
        _ => return None,
    };
    Some(Problem::new(kind, detail))
}

fn as_answer(problem: &Problem) -> Vec<u8> {
    let body = serde_json::to_string(problem).unwrap_or_default();
    let (status, id) = (problem.kind.status(), Uuid::new_v4());
    let reason = status.canonical_reason().unwrap_or_default();
    format!(
        "HTTP/1.1 {} {reason}\r\nconnection: close\r\ncontent-type: application/problem+json\r\ncontent-length: {}\r\nx-request-id: {id}\r\n\r\n{body}",
        status.as_u16(),
        body.len()
    )
    .into_bytes()
}

impl<S: AsyncWrite + Unpin> AsyncWrite for WithProblems<S> {
    fn poll_write(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        output: &[u8],
    ) -> Poll<io::Result<usize>> {
        ready!(self.poll_problem(context))?;
        let refusal = if self.exchange.is_over() { bare_refusal(output) } else { None };
        let Some(problem) = refusal else { return Pin::new(&mut self.stream).poll_write(context, output) };
        self.problem = as_answer(&problem);
        self.sent = 0;
        // It is sent here, or by the next call; the bare one counts as sent.
        let _ = self.poll_problem(context)?;
        Poll::Ready(Ok(output.len()))
    }

    fn poll_write_vectored(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        outputs: &[IoSlice<'_>],
    ) -> Poll<io::Result<usize>> {
        ready!(self.poll_problem(context))?;
        let mut filled = outputs.iter().filter(|output| !output.is_empty());
        match (filled.next(), filled.next()) {
            // A bare refusal is written in one piece.
            (Some(only), None) => self.poll_write(context, only),
            _ => Pin::new(&mut self.stream).poll_write_vectored(context, outputs),
        }
    }

    fn is_write_vectored(&self) -> bool {
        self.stream.is_write_vectored()
    }

    fn poll_flush(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        ready!(self.poll_problem(context))?;
        ready!(Pin::new(&mut self.stream).poll_flush(context))?;
        self.exchange.flushed();
        Poll::Ready(Ok(()))
    }

    fn poll_shutdown(mut self: Pin<&mut Self>, context: &mut Context<'_>) -> Poll<io::Result<()>> {
        ready!(self.poll_problem(context))?;
        Pin::new(&mut self.stream).poll_shutdown(context)
    }
}

impl<S: AsyncRead + Unpin> AsyncRead for WithProblems<S> {
    fn poll_read(
        mut self: Pin<&mut Self>,
        context: &mut Context<'_>,
        buffer: &mut ReadBuf<'_>,
    ) -> Poll<io::Result<()>> {
        Pin::new(&mut self.stream).poll_read(context, buffer)
    }
}

#[cfg(test)]
mod tests {
    use tokio::io::{AsyncReadExt, AsyncWriteExt};

    use super::*;

    const BARE: &[u8] = b"HTTP/1.1 400 Bad Request\r\nconnection: close\r\ncontent-length: 0\r\ndate: Fri, 27 Nov 2026 20:00:00 GMT\r\n\r\n";

    /// What comes out when something is written in one piece and the stream is shut down, through a pipe of so many bytes.
    async fn sent(exchange: &Exchange, output: &'static [u8], pipe: usize) -> String {
        let (near, mut far) = tokio::io::duplex(pipe);
        let mut stream = WithProblems::new(near, exchange.clone());
        let writing = tokio::spawn(async move {
            stream.write_all(output).await.unwrap();
            stream.shutdown().await.unwrap();
        });
        let mut text = String::new();
        far.read_to_string(&mut text).await.unwrap();
        writing.await.unwrap();
        text
    }

    #[tokio::test]
    async fn a_bare_refusal_becomes_a_problem_document_even_through_a_narrow_pipe() {
        for pipe in [1, 10, 10_000] {
            let text = sent(&Exchange::default(), BARE, pipe).await;
            let (head, body) = text.split_once("\r\n\r\n").unwrap();
            assert!(
                head.starts_with("HTTP/1.1 400 Bad Request\r\n") && head.contains("x-request-id: "),
                "{head}"
            );
            assert!(head.contains(&format!("content-length: {}\r\n", body.len())), "{head}");
            let problem: serde_json::Value = serde_json::from_str(body).unwrap();
            assert_eq!((&problem["type"], &problem["status"]), (&"invalid-request".into(), &400.into()));
        }
    }

    #[tokio::test]
    async fn nothing_is_replaced_from_the_request_of_an_answer_until_all_of_it_is_sent() {
        let exchange = Exchange::default();
        let under_way = exchange.begin();
        assert_eq!(sent(&exchange, BARE, 100).await.as_bytes(), BARE);
        drop(under_way);
        assert_eq!(sent(&exchange, BARE, 100).await.as_bytes(), BARE, "its last piece may wait to be sent");
        WithProblems::new(tokio::io::sink(), exchange.clone()).flush().await.unwrap();
        assert!(sent(&exchange, BARE, 100).await.contains("application/problem+json"));
    }

    #[tokio::test]
    async fn what_is_no_refusal_is_sent_as_it_is() {
        for other in
            [&b"HTTP/1.1 304 Not Modified\r\ncontent-length: 0\r\n\r\n"[..], b"HTTP/1.1 400 Bad\r\n", b""]
        {
            assert_eq!(sent(&Exchange::default(), other, 100).await.as_bytes(), other);
        }
    }
}
