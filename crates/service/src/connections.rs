//! Connections: so many at most, none of which may stall.

use std::{convert::Infallible, io, pin::Pin, sync::Arc, time::Duration};

use axum::Router;
use hyper::{
    Request,
    body::Incoming,
    server::conn::http1,
    service::{Service, service_fn},
};
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
    exchange::Exchange,
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
        let exchange = Exchange::default();
        let Ok(io) = prepared(stream, limits.body_pause, &exchange) else { continue };
        let service = TowerToHyperService::new(routes.clone());
        let service = service_fn(move |request: Request<Incoming>| {
            let (under_way, answer) = (exchange.begin(), service.call(request));
            async move { Ok::<_, Infallible>(answer.await?.map(|body| under_way.with(body))) }
        });
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
    exchange: &Exchange,
) -> io::Result<WithProblems<Pin<Box<TimeoutStream<TcpStream>>>>> {
    stream.set_nodelay(true)?;
    let mut io = TimeoutStream::new(stream);
    io.set_write_timeout(Some(pause));
    Ok(WithProblems::new(Box::pin(io), exchange.clone()))
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
    use axum::{body::Body, routing::get};
    use tokio::io::{AsyncReadExt, AsyncWriteExt};

    use super::*;
    use crate::Limits;

    /// What a client gets that sends something and then no more.
    async fn answers(routes: Router, sent: &str) -> String {
        let engine = tokio::task::spawn_blocking(|| Engine::new(Limits::default(), None));
        let engine = engine.await.unwrap().unwrap();
        let listener = TcpListener::bind("127.0.0.1:0").await.unwrap();
        let address = listener.local_addr().unwrap();
        let serving = tokio::spawn(async move {
            accept(listener, routes, &engine, std::future::pending()).await;
        });
        let mut client = TcpStream::connect(address).await.unwrap();
        client.write_all(sent.as_bytes()).await.unwrap();
        let mut text = String::new();
        client.read_to_string(&mut text).await.unwrap();
        serving.abort();
        text
    }

    #[tokio::test]
    async fn a_body_that_looks_like_a_refusal_is_sent_as_it_is_and_what_is_no_http_is_refused_after_it() {
        const LIKE_A_REFUSAL: &str = "HTTP/1.1 400 x\r\ncontent-length: 0\r\n\r\n";
        let in_pieces = || async {
            let pieces = ["a", LIKE_A_REFUSAL, LIKE_A_REFUSAL].map(Ok::<_, Infallible>);
            Body::from_stream(futures_util::stream::iter(pieces))
        };
        let routes =
            Router::new().route("/whole", get(|| async { LIKE_A_REFUSAL })).route("/pieces", get(in_pieces));
        let ask = |path| format!("GET {path} HTTP/1.1\r\nhost: localhost\r\n\r\n");
        let sent = format!("{}{}no HTTP\r\n\r\n", ask("/whole"), ask("/pieces"));
        let text = answers(routes, &sent).await;
        assert_eq!(text.matches(LIKE_A_REFUSAL).count(), 3, "{text}");
        assert_eq!(text.matches("HTTP/1.1 200 OK").count(), 2, "{text}");
        let (_, problem) = text.rsplit_once("\r\n\r\n").unwrap();
        assert!(problem.contains("\"type\":\"invalid-request\""), "{text}");
        assert_eq!(text.matches("application/problem+json").count(), 1, "{text}");
    }

    #[test]
    fn the_refusal_is_as_long_as_it_says_and_a_problem_document() {
        let text = std::str::from_utf8(FULL).unwrap();
        let (head, body) = text.split_once("\r\n\r\n").unwrap();
        assert!(head.contains(&format!("content-length: {}", body.len())), "{}", body.len());
        let problem: serde_json::Value = serde_json::from_str(body).unwrap();
        assert_eq!((&problem["type"], &problem["status"]), (&"overloaded".into(), &503.into()));
    }
}
