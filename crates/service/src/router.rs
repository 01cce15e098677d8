//! The whole table of routes.

use axum::{
    Router,
    body::{Body, Bytes},
    http::{Request, header},
    middleware::from_fn_with_state,
    routing::get,
};
use utoipa::OpenApi;
use utoipa_axum::{router::OpenApiRouter, routes};
use utoipa_swagger_ui::{Config, SwaggerUi};

use crate::{
    Access, Engine,
    describe::with_layers,
    layers::{layered, needs_token},
    problem::{Problem, ProblemType},
    routes::{
        alternatives, calibrate, compare, diagnose, earth, guide, health, jobs, map_areas, maps, matrix,
        metrics, mission, page, plan, range, reachable, recordings, robot_mechanisms, robots, status,
    },
    schemas,
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

/// Paths that ask for a token where there are any.
fn guarded() -> OpenApiRouter<Engine> {
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
        .routes(routes!(map_areas::read_areas, map_areas::areas_of_classes))
        .routes(routes!(earth::read))
        .routes(routes!(robots::create, robots::list))
        .routes(routes!(robots::read, robots::remove))
        .routes(routes!(robot_mechanisms::list))
        .routes(routes!(recordings::create, recordings::list))
        .routes(routes!(recordings::columns))
        .routes(routes!(recordings::read, recordings::remove))
        .routes(routes!(calibrate::handler))
        .routes(routes!(diagnose::handler))
        .routes(routes!(jobs::list))
        .routes(routes!(jobs::read, jobs::remove))
        .routes(routes!(jobs::events))
        .routes(routes!(status::handler))
}

/// Paths that tell nothing of what the service holds.
fn open() -> OpenApiRouter<Engine> {
    OpenApiRouter::new().routes(routes!(health::healthz)).routes(routes!(health::readyz))
}

/// The routes of the description, each asking for a token where it has to.
fn described(access: &Access) -> (Router<Engine>, utoipa::openapi::OpenApi) {
    let guard = || from_fn_with_state(access.tokens.clone(), needs_token);
    let counts = OpenApiRouter::new().routes(routes!(metrics::handler));
    let (mut guarded, mut open) = (guarded(), open());
    if access.open_metrics {
        open = open.merge(counts);
    } else {
        guarded = guarded.merge(counts);
    }
    let secured: Vec<String> = match access.tokens.is_empty() {
        true => Vec::new(),
        false => guarded.get_openapi().paths.paths.keys().cloned().collect(),
    };
    let (routes, description) = guarded.route_layer(guard()).merge(open).split_for_parts();
    (routes, with_layers(description, |path| secured.iter().any(|other| other == path)))
}

/// The OpenAPI description of the service.
pub fn openapi() -> utoipa::openapi::OpenApi {
    described(&Access::default()).1
}

/// The service as a router.
pub fn router(engine: Engine, access: &Access) -> Router {
    let (routes, description) = described(access);
    let document = Bytes::from(description.to_pretty_json().unwrap_or_default());
    let reference = SwaggerUi::new("/docs").config(Config::from("/openapi.json"));
    let routes = routes
        .merge(page::routes(access))
        .merge(page::settings(access).route_layer(from_fn_with_state(access.tokens.clone(), needs_token)))
        .merge(schemas::routes())
        .merge(guide::routes())
        .merge(reference)
        .route(
            "/openapi.json",
            get(|| async move { ([(header::CONTENT_TYPE, "application/json")], document) }),
        )
        .fallback(|request: Request<Body>| async move {
            let detail = format!("{} leads nowhere; /openapi.json lists the paths", request.uri().path());
            Problem::new(ProblemType::NotFound, detail)
        })
        .method_not_allowed_fallback(|request: Request<Body>| async move {
            let detail = format!("{} does not take {}", request.uri().path(), request.method());
            Problem::new(ProblemType::MethodNotAllowed, detail)
        });
    layered(routes, &engine, access, &description).with_state(engine)
}
