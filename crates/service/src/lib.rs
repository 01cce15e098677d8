//! The HTTP service: terrains, robots and recordings in, paths with predicted energy and fitted robots out.
//!
//! The only crate that knows HTTP and async. Each file under `routes` holds a request, its handler and its answer; the
//! functions that turn a request into an answer are plain and are shared with the command line, so both give the same
//! document and the same errors.

mod accept;
mod access;
mod admission;
mod answer;
mod antimeridian;
mod bare_refusal;
mod body;
mod cells;
mod connections;
mod contour_file;
mod describe;
mod engine;
mod exchange;
mod form;
mod geojson;
mod guide;
mod hosts;
mod job;
mod job_records;
mod job_run;
mod job_supervision;
mod job_watch;
mod jobs;
mod layers;
mod limits;
mod map_reader;
mod maps;
mod memory;
mod metrics;
mod numbers;
mod place;
mod planners;
mod problem;
mod problem_type;
mod receive;
mod recordings;
mod robots;
mod route_file;
mod router;
pub mod routes;
mod schemas;
mod serve;
mod store;
mod tenant;
mod tiles;
mod tracks;
mod turns;

pub use access::{Access, TokenError, Tokens};
pub use engine::Engine;
pub use hosts::Hosts;
pub use limits::Limits;
pub use numbers::with_exponents;
pub use planner::Patience;
pub use planners::{KeyedMap, Planners};
pub use problem::{Problem, ProblemType};
pub use router::{openapi, router};
pub use schemas::{SCHEMAS, schema};
pub use serve::{Running, serve, start};
pub use store::StoreError;
pub use tenant::{InvalidTenant, Tenant};
pub use tiles::{Tiles, TilesError};
pub use tracks::{TrackForm, Tracks};
