//! What every request passes through before it reaches its route, and every answer on its way out; outermost first.

mod conditional;
mod encoder;
mod encoding;
mod host;
mod log;
mod measure;
mod negotiate;
mod pace;
mod request_id;
mod token;

use std::any::Any;

use axum::{
    Router,
    http::{HeaderName, Method, header},
    middleware::{from_fn, from_fn_with_state},
    response::{IntoResponse, Response},
};
use tower::ServiceBuilder;
use tower_http::{
    ServiceBuilderExt,
    catch_panic::CatchPanicLayer,
    compression::{
        CompressionLayer, CompressionLevel,
        predicate::{DefaultPredicate, Predicate},
    },
    cors::{AllowOrigin, CorsLayer},
    csrf::{CsrfLayer, ProtectionError},
    request_id::MakeRequestUuid,
    trace::TraceLayer,
};
use utoipa::openapi::OpenApi;

pub(crate) use conditional::{Named, is_tagged};
use negotiate::Offers;
use pace::Pace;
pub(crate) use pace::TOO_SLOW;
pub(crate) use token::needs_token;

use crate::{
    Access, Engine, answer, memory,
    problem::{Problem, ProblemType},
};

const REQUEST_ID: HeaderName = HeaderName::from_static("x-request-id");

/// Puts the layers about routes that a description tells of.
pub(crate) fn layered(
    routes: Router<Engine>,
    engine: &Engine,
    access: &Access,
    description: &OpenApi,
) -> Router<Engine> {
    let metrics = engine.metrics().clone();
    let panics = engine.metrics().clone();
    routes.layer(
        ServiceBuilder::new()
            .map_request(request_id::without_unusable)
            .set_request_id(REQUEST_ID, MakeRequestUuid)
            .layer(
                TraceLayer::new_for_http()
                    .make_span_with(log::span)
                    .on_response(log::answered)
                    .on_failure(()),
            )
            .propagate_request_id(REQUEST_ID)
            .layer(from_fn_with_state(metrics, measure::measure))
            .layer(CatchPanicLayer::custom(move |_: Box<dyn Any + Send>| {
                panics.panics.inc();
                panicked()
            }))
            .layer(from_fn_with_state(Pace::from(engine.limits()), pace::paced))
            .layer(from_fn_with_state(host::Rule::of(access), host::check))
            // What a better level saves of the wire takes longer to find than to send.
            .layer(
                CompressionLayer::new()
                    .quality(CompressionLevel::Fastest)
                    .compress_when(DefaultPredicate::new().and(encoder::has_room)),
            )
            .layer(from_fn_with_state(engine.admission().memory().clone(), encoder::reserve))
            .layer(cors(access))
            .layer(csrf(access))
            .layer(from_fn_with_state(Offers::of(description), negotiate::negotiate))
            .layer(from_fn(conditional::conditional))
            .layer(from_fn(memory::accounted))
            .layer(from_fn_with_state(engine.clone(), encoding::decode))
            .layer(from_fn_with_state(engine.clone(), answer::write)),
    )
}

/// Pages of other origins may ask only where they were allowed to.
fn cors(access: &Access) -> CorsLayer {
    if access.cors_origins.is_empty() {
        return CorsLayer::new().vary([]);
    }
    CorsLayer::new()
        .allow_origin(AllowOrigin::list(access.cors_origins.clone()))
        .allow_methods([Method::GET, Method::POST, Method::PATCH, Method::DELETE])
        .allow_headers([
            header::ACCEPT,
            header::AUTHORIZATION,
            header::CONTENT_TYPE,
            header::IF_NONE_MATCH,
            HeaderName::from_static("last-event-id"),
            REQUEST_ID,
        ])
        .expose_headers([header::ETAG, header::LOCATION, header::RETRY_AFTER, REQUEST_ID])
}

/// A page of another origin may not change anything here, even by requests that browsers send without asking.
fn csrf(access: &Access) -> CsrfLayer<impl Fn(ProtectionError) -> Response + Clone + use<>> {
    let trusted = access.cors_origins.iter().filter_map(|origin| origin.to_str().ok());
    // An origin that the layer does not take is one that no browser sends.
    let layer = trusted
        .fold(CsrfLayer::new(), |layer, origin| layer.clone().add_trusted_origin(origin).unwrap_or(layer));
    layer.with_rejection_response(|_: ProtectionError| cross_origin().into_response())
}

fn cross_origin() -> Problem {
    let detail = "the request comes from a page of another origin: the service has to be started with --cors-origin for it";
    Problem::new(ProblemType::CrossOrigin, detail)
}

fn panicked() -> Response {
    Problem::new(ProblemType::Internal, "the request hit a fault of the service, which has been logged")
        .into_response()
}

#[cfg(test)]
mod tests {
    use std::time::Instant;

    use axum::{
        body::{Body, to_bytes},
        http::Request,
        http::StatusCode,
        routing::get,
    };
    use tower::ServiceExt;

    use super::*;
    use crate::{Limits, openapi};

    /// An engine opens its store on a thread of its own.
    async fn engine(limits: Limits) -> Engine {
        tokio::task::spawn_blocking(move || Engine::new(limits, None)).await.unwrap().unwrap()
    }

    async fn faulty() -> StatusCode {
        let nothing: Option<StatusCode> = std::hint::black_box(None);
        nothing.unwrap()
    }

    #[tokio::test]
    async fn a_fault_is_a_problem_document_and_counted_and_the_next_request_is_answered() {
        let engine = engine(Limits::default()).await;
        let routes = Router::new().route("/faulty", get(faulty)).route("/sound", get(|| async { "sound" }));
        let routes = layered(routes, &engine, &Access::default(), &openapi()).with_state(engine.clone());
        let ask = |path: &str| {
            let request = Request::get(path)
                .header("host", "localhost")
                .header("x-request-id", "mine")
                .body(Body::empty())
                .unwrap();
            routes.clone().oneshot(request)
        };
        let answer = ask("/faulty").await.unwrap();
        assert_eq!(answer.status(), StatusCode::INTERNAL_SERVER_ERROR);
        assert_eq!(answer.headers()["x-request-id"], "mine");
        assert_eq!(answer.headers()[header::CONTENT_TYPE], "application/problem+json");
        let body = to_bytes(answer.into_body(), 10_000).await.unwrap();
        let problem: serde_json::Value = serde_json::from_slice(&body).unwrap();
        assert_eq!(problem["type"], "internal");
        assert_eq!(engine.metrics().panics.get(), 1);
        assert_eq!(ask("/sound").await.unwrap().status(), StatusCode::OK);
    }

    #[tokio::test]
    async fn a_fault_of_a_computation_is_counted_and_its_turn_given_back() {
        let limits = Limits { parallel_plans: 1, ..Limits::default() };
        let engine = engine(limits).await;
        for _ in 0..3 {
            let nothing: Option<u8> = std::hint::black_box(None);
            let outcome = engine.compute(move |_| Ok(nothing.unwrap())).await;
            assert_eq!(outcome.unwrap_err().kind, ProblemType::Internal);
        }
        assert_eq!(engine.metrics().panics.get(), 3);
        assert!(engine.compute(|_| Ok(())).await.is_ok());
    }
    #[tokio::test]
    async fn an_answer_comes_at_its_deadline_and_the_turn_when_the_computation_has_ended() {
        let engine = engine(Limits { parallel_plans: 1, ..Limits::default() }).await;
        let (end, ended) = std::sync::mpsc::channel::<()>();
        let stays = move |_: &planner::Patience| {
            ended.recv().ok();
            Ok(())
        };
        let refused = engine.compute_within(0, Some(Instant::now()), stays).await.unwrap_err();
        assert_eq!(refused.kind, ProblemType::Timeout);
        let next = engine.compute_within(0, Some(Instant::now()), |_| Ok(())).await.unwrap_err();
        assert!(next.detail.contains("before its turn"), "{}", next.detail);
        end.send(()).unwrap();
        assert!(engine.compute(|_| Ok(())).await.is_ok());
    }
}
