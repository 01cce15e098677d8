//! Connections: so many at most, none of which may stall.

use std::{io, pin::Pin, sync::Arc, time::Duration};

use axum::Router;
use hyper::server::conn::http1;
use hyper_util::{
    rt::{TokioIo, TokioTimer},
    server::graceful::GracefulShutdown,
    service::TowerToHyperService,
};
use tokio::{
    net::{TcpListener, TcpStream},
    sync::{OwnedSemaphorePermit, Semaphore},
};
use tokio_io_timeout::TimeoutStream;

use crate::{
    Engine,
    bare_refusal::WithProblems,
    metrics::{Metrics, ShedLabels},
};

/// Pause after a failed accept, as when the process has no more file handles.
const AFTER_FAILURE: Duration = Duration::from_millis(100);
/// Largest head of a request, and most of an answer that waits to be sent [bytes]. A target of 64 KiB, the longest that is
/// taken, has room in it.
const BUFFER_BYTES: usize = 128 << 10;
/// What a client is told that comes to a full house.
const FULL: &[u8] = b"HTTP/1.1 503 Service Unavailable\r\nretry-after: 1\r\nconnection: close\r\n\
content-type: application/problem+json\r\ncontent-length: 123\r\n\r\n\
{\"type\":\"overloaded\",\"title\":\"Too much to do\",\"status\":503,\"detail\":\"too many connections are open: try again in a second\"}";

/// Takes connections until it is told to stop; returns those that are still open.
pub(crate) async fn accept(
    listener: TcpListener,
    routes: Router,
    engine: &Engine,
    stop: impl Future<Output = ()>,
) -> GracefulShutdown {
    let limits = engine.limits();
    let places = Arc::new(Semaphore::new(limits.connections));
    let open = GracefulShutdown::new();
    let mut builder = http1::Builder::new();
    builder.timer(TokioTimer::new()).header_read_timeout(limits.head_time).max_buf_size(BUFFER_BYTES);
    let mut stop = std::pin::pin!(stop);
    loop {
        let accepted = tokio::select! {
            accepted = listener.accept() => accepted,
            () = &mut stop => return open,
        };
        let Ok((stream, _)) = accepted else {
            tokio::time::sleep(AFTER_FAILURE).await;
            continue;
        };
        let Ok(place) = Arc::clone(&places).try_acquire_owned() else {
            engine.metrics().shed.get_or_create(&ShedLabels { reason: "connections" }).inc();
            refuse(&stream);
            continue;
        };
        let Ok(io) = prepared(stream, limits.body_pause) else { continue };
        let service = TowerToHyperService::new(routes.clone());
        let connection = open.watch(builder.serve_connection(TokioIo::new(io), service));
        let place = Place::take(place, engine.metrics());
        tokio::spawn(async move {
            let _place = place;
            // A client that leaves or sends what is not HTTP is its own affair.
            if let Err(error) = connection.await {
                tracing::debug!(%error, "a connection broke off");
            }
        });
    }
}

/// Sends small answers at once, and gives up on a client that does not take them.
fn prepared(
    stream: TcpStream,
    pause: Duration,
) -> io::Result<WithProblems<Pin<Box<TimeoutStream<TcpStream>>>>> {
    stream.set_nodelay(true)?;
    let mut io = TimeoutStream::new(stream);
    io.set_write_timeout(Some(pause));
    Ok(WithProblems::new(Box::pin(io)))
}

/// Tells a client without waiting for it.
fn refuse(stream: &TcpStream) {
    let _ = stream.try_write(FULL);
}

/// A place among the connections, which is counted.
struct Place {
    metrics: Metrics,
    _place: OwnedSemaphorePermit,
}

impl Place {
    fn take(place: OwnedSemaphorePermit, metrics: &Metrics) -> Self {
        metrics.connections.inc();
        Place { metrics: metrics.clone(), _place: place }
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        self.metrics.connections.dec();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_refusal_is_as_long_as_it_says_and_a_problem_document() {
        let text = std::str::from_utf8(FULL).unwrap();
        let (head, body) = text.split_once("\r\n\r\n").unwrap();
        assert!(head.contains(&format!("content-length: {}", body.len())), "{}", body.len());
        let problem: serde_json::Value = serde_json::from_str(body).unwrap();
        assert_eq!((&problem["type"], &problem["status"]), (&"overloaded".into(), &503.into()));
    }
}
