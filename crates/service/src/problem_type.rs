//! The kinds of failure, each with its status and its title.

use axum::http::StatusCode;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

/// The kinds of failure; programs may rely on these names.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, ToSchema)]
#[serde(rename_all = "kebab-case")]
pub enum ProblemType {
    /// The body is not JSON, or not the JSON that is needed.
    InvalidRequest,
    /// The map cannot be used as it is.
    InvalidMap,
    /// The robot cannot be used as it is.
    InvalidRobot,
    /// The recording cannot be read.
    InvalidRecording,
    /// A content type or packing that this path does not take.
    UnsupportedMediaType,
    /// None of the media types that `Accept` asks for is one that this path answers as.
    NotAcceptable,
    /// A token is missing or wrong.
    Unauthorized,
    /// A page of another origin asks for a change.
    CrossOrigin,
    /// The request asks another host than this service.
    MisdirectedRequest,
    /// The target of the request is too long.
    TargetTooLong,
    /// The header fields of the request are too large.
    HeaderTooLarge,
    /// A robot that comes with the service cannot be removed.
    BuiltIn,
    /// The body came too slowly.
    TooSlow,
    /// No such path.
    NotFound,
    /// No map with this id.
    UnknownMap,
    /// No robot of this name.
    UnknownRobot,
    /// No recording with this id.
    UnknownRecording,
    /// No job with this id.
    UnknownJob,
    /// The path does not take this method.
    MethodNotAllowed,
    /// A surface that the robot or the recording does not know.
    UnknownSurface,
    /// The recording can be read, but does not hold what is needed.
    InsufficientRecording,
    /// The start lies off the map.
    StartOutsideMap,
    /// The goal lies off the map.
    GoalOutsideMap,
    /// The robot cannot stand at the start.
    StartBlocked,
    /// The robot cannot stand at the goal.
    GoalBlocked,
    /// No way leads from the start to the goal.
    NoPath,
    /// A pose of a list lies off the map.
    WaypointOutsideMap,
    /// The robot cannot stand at a pose of a list.
    WaypointBlocked,
    /// No path keeps all the limits asked for.
    LimitsContradict,
    /// A deadline that no plan can keep.
    DeadlineTooShort,
    /// The search stopped at its deadline.
    Timeout,
    /// The body or the map exceeds a limit.
    TooLarge,
    /// The service holds as much as it may.
    StoreFull,
    /// The store cannot be reached, or does not do what it is asked.
    StoreUnavailable,
    /// As many jobs wait or run as may.
    TooManyJobs,
    /// As many jobs of the tenant wait or run as may.
    QuotaExceeded,
    /// The services that worked on the job died, so that it was given up.
    Abandoned,
    /// As many requests wait or run as can be answered soon, or as memory allows.
    Overloaded,
    /// The service is about to end, or cannot reach its store.
    NotReady,
    /// A fault of the service.
    Internal,
}

impl ProblemType {
    pub(crate) fn status(self) -> StatusCode {
        use ProblemType as T;
        match self {
            T::InvalidRequest | T::InvalidMap | T::InvalidRobot | T::InvalidRecording => {
                StatusCode::BAD_REQUEST
            }
            T::UnsupportedMediaType => StatusCode::UNSUPPORTED_MEDIA_TYPE,
            T::NotAcceptable => StatusCode::NOT_ACCEPTABLE,
            T::Unauthorized => StatusCode::UNAUTHORIZED,
            T::CrossOrigin | T::BuiltIn => StatusCode::FORBIDDEN,
            T::MisdirectedRequest => StatusCode::MISDIRECTED_REQUEST,
            T::TargetTooLong => StatusCode::URI_TOO_LONG,
            T::HeaderTooLarge => StatusCode::REQUEST_HEADER_FIELDS_TOO_LARGE,
            T::TooSlow => StatusCode::REQUEST_TIMEOUT,
            T::NotFound | T::UnknownMap | T::UnknownRobot | T::UnknownRecording | T::UnknownJob => {
                StatusCode::NOT_FOUND
            }
            T::MethodNotAllowed => StatusCode::METHOD_NOT_ALLOWED,
            T::UnknownSurface
            | T::InsufficientRecording
            | T::StartOutsideMap
            | T::GoalOutsideMap
            | T::StartBlocked
            | T::GoalBlocked
            | T::NoPath
            | T::WaypointOutsideMap
            | T::WaypointBlocked
            | T::LimitsContradict
            | T::DeadlineTooShort => StatusCode::UNPROCESSABLE_ENTITY,
            T::Timeout => StatusCode::GATEWAY_TIMEOUT,
            T::TooLarge => StatusCode::PAYLOAD_TOO_LARGE,
            T::StoreFull => StatusCode::INSUFFICIENT_STORAGE,
            T::QuotaExceeded => StatusCode::TOO_MANY_REQUESTS,
            T::StoreUnavailable | T::TooManyJobs | T::Abandoned | T::Overloaded | T::NotReady => {
                StatusCode::SERVICE_UNAVAILABLE
            }
            T::Internal => StatusCode::INTERNAL_SERVER_ERROR,
        }
    }

    pub(crate) fn title(self) -> &'static str {
        use ProblemType as T;
        match self {
            T::InvalidRequest => "The request cannot be read",
            T::InvalidMap => "The map cannot be used",
            T::InvalidRobot => "The robot cannot be used",
            T::InvalidRecording => "The recording cannot be read",
            T::UnsupportedMediaType => "Content type not supported",
            T::NotAcceptable => "No such form of the answer",
            T::Unauthorized => "A token is needed",
            T::CrossOrigin => "Not for pages of other origins",
            T::MisdirectedRequest => "Not this host",
            T::TargetTooLong => "The target is too long",
            T::HeaderTooLarge => "The header fields are too large",
            T::BuiltIn => "The robot is built in",
            T::TooSlow => "The body came too slowly",
            T::NotFound => "No such path",
            T::UnknownMap => "No such map",
            T::UnknownRobot => "No such robot",
            T::UnknownRecording => "No such recording",
            T::UnknownJob => "No such job",
            T::MethodNotAllowed => "Method not allowed",
            T::UnknownSurface => "A surface is unknown",
            T::InsufficientRecording => "The recording does not suffice",
            T::StartOutsideMap => "The start lies outside the map",
            T::GoalOutsideMap => "The goal lies outside the map",
            T::StartBlocked => "The robot cannot stand at the start",
            T::GoalBlocked => "The robot cannot stand at the goal",
            T::NoPath => "There is no path",
            T::WaypointOutsideMap => "A pose lies outside the map",
            T::WaypointBlocked => "The robot cannot stand at a pose",
            T::LimitsContradict => "No path keeps the limits",
            T::DeadlineTooShort => "The deadline is too short",
            T::Timeout => "The search ran out of time",
            T::TooLarge => "Too large",
            T::StoreFull => "The store is full",
            T::StoreUnavailable => "The store is out of reach",
            T::TooManyJobs => "Too many jobs",
            T::QuotaExceeded => "Too many jobs of one tenant",
            T::Abandoned => "The job was given up",
            T::Overloaded => "Too much to do",
            T::NotReady => "Not ready",
            T::Internal => "Internal error",
        }
    }
}
