//! The whole table of routes.

use std::any::Any;

use axum::{
    Router,
    http::{HeaderName, Request},
    response::{IntoResponse, Response},
    routing::get,
};
use tower::ServiceBuilder;
use tower_http::{
    ServiceBuilderExt,
    catch_panic::CatchPanicLayer,
    request_id::MakeRequestUuid,
    timeout::RequestBodyTimeoutLayer,
    trace::{DefaultMakeSpan, DefaultOnResponse, TraceLayer},
};
use tracing::Level;
use utoipa::OpenApi;
use utoipa_axum::{router::OpenApiRouter, routes};

use crate::{
    Engine,
    problem::{Problem, ProblemType},
    routes::{
        alternatives, calibrate, compare, diagnose, health, jobs, maps, matrix, mission, page, plan, range,
        reachable, recordings, robots, status,
    },
};

#[derive(OpenApi)]
#[openapi(
    info(
        title = "joulepath",
        description = "Energy-minimal paths for skid-steered robots, and robots fitted to their recordings. SI units; x east, y north, z up; heading counter-clockwise from east. Failures are RFC 9457 problem documents."
    ),
    tags(
        (name = "plan", description = "Paths and their energy"),
        (name = "battery", description = "Whether a charge lasts, and for which stops"),
        (name = "maps", description = "Terrain at hand"),
        (name = "robots", description = "Robots at hand"),
        (name = "recordings", description = "Drive logs at hand"),
        (name = "jobs", description = "Long work, started, followed and cancelled"),
        (name = "service", description = "The service itself")
    )
)]
struct Description;

fn described() -> (Router<Engine>, utoipa::openapi::OpenApi) {
    OpenApiRouter::with_openapi(Description::openapi())
        .routes(routes!(plan::handler))
        .routes(routes!(compare::handler))
        .routes(routes!(alternatives::handler))
        .routes(routes!(matrix::handler))
        .routes(routes!(reachable::handler))
        .routes(routes!(range::handler))
        .routes(routes!(mission::handler))
        .routes(routes!(maps::create, maps::list))
        .routes(routes!(maps::read, maps::change, maps::remove))
        .routes(routes!(robots::create, robots::list))
        .routes(routes!(robots::read))
        .routes(routes!(recordings::create, recordings::list))
        .routes(routes!(recordings::read, recordings::remove))
        .routes(routes!(calibrate::handler))
        .routes(routes!(diagnose::handler))
        .routes(routes!(jobs::read, jobs::remove))
        .routes(routes!(jobs::events))
        .routes(routes!(health::healthz))
        .routes(routes!(status::handler))
        .split_for_parts()
}

/// The OpenAPI description of the service.
pub fn openapi() -> utoipa::openapi::OpenApi {
    described().1
}

/// The service as a router.
pub fn router(engine: Engine) -> Router {
    let (routes, description) = described();
    let document = description.to_pretty_json().unwrap_or_default();
    let body_pause = engine.limits().body_pause;
    let request_id = HeaderName::from_static("x-request-id");
    routes
        .merge(page::routes())
        .route("/openapi.json", get(|| async move { ([("content-type", "application/json")], document) }))
        .fallback(|request: Request<axum::body::Body>| async move {
            let detail = format!("{} leads nowhere; /openapi.json lists the paths", request.uri().path());
            Problem::new(ProblemType::NotFound, detail)
        })
        .method_not_allowed_fallback(|request: Request<axum::body::Body>| async move {
            let detail = format!("{} does not take {}", request.uri().path(), request.method());
            Problem::new(ProblemType::MethodNotAllowed, detail)
        })
        .layer(
            ServiceBuilder::new()
                .set_request_id(request_id.clone(), MakeRequestUuid)
                .layer(
                    TraceLayer::new_for_http()
                        .make_span_with(DefaultMakeSpan::new().level(Level::INFO))
                        .on_response(DefaultOnResponse::new().level(Level::INFO)),
                )
                .propagate_request_id(request_id)
                .layer(CatchPanicLayer::custom(panicked))
                .layer(RequestBodyTimeoutLayer::new(body_pause)),
        )
        .with_state(engine)
}

fn panicked(_: Box<dyn Any + Send>) -> Response {
    Problem::new(ProblemType::Internal, "the request hit a fault of the service, which has been logged")
        .into_response()
}
