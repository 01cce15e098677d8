//! Every failure as one shape: an RFC 9457 problem document.

use std::time::Duration;

use axum::{
    Json,
    http::{HeaderValue, StatusCode, header},
    response::{IntoResponse, Response},
};
use planner::Place;
use serde::{Deserialize, Serialize};
use utoipa::ToSchema;

use crate::numbers::with_exponents;
pub use crate::problem_type::ProblemType;

/// A problem document.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct Problem {
    /// Kind of failure.
    #[serde(rename = "type")]
    pub kind: ProblemType,
    /// The kind in words.
    pub title: String,
    /// HTTP status.
    pub status: u16,
    /// What went wrong here, where, and how to mend it.
    pub detail: String,
    /// The fields at fault.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub errors: Vec<FieldError>,
    /// When to try again, as the header `Retry-After` says it [s].
    #[serde(skip)]
    pub retry_after_s: Option<u64>,
}

/// One field at fault.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, ToSchema)]
pub struct FieldError {
    /// JSON pointer into the request (RFC 6901).
    #[schema(example = "/start/x_m")]
    pub pointer: String,
    /// What is wrong with it.
    pub detail: String,
}

/// Longest detail of a problem in bytes: 32 missing fields and their places fit in. Names in a request may be as long as the
/// request, and a problem quotes them.
const MOST_DETAIL: usize = 4096;
/// Longest JSON pointer of a problem in bytes.
const MOST_POINTER: usize = 1024;

/// The text as it is, or so much of its beginning that no more bytes are left, with an ellipsis.
fn shortened(mut text: String, most_bytes: usize) -> String {
    const ELLIPSIS: &str = "…";
    if text.len() > most_bytes {
        text.truncate(text.floor_char_boundary(most_bytes - ELLIPSIS.len()));
        text.push_str(ELLIPSIS);
        text.shrink_to_fit();
    }
    text
}

impl Problem {
    /// A problem of a kind.
    pub fn new(kind: ProblemType, detail: impl Into<String>) -> Self {
        Problem {
            kind,
            title: kind.title().to_owned(),
            status: kind.status().as_u16(),
            detail: with_exponents(shortened(detail.into(), MOST_DETAIL)),
            errors: Vec::new(),
            retry_after_s: (kind.status() == StatusCode::SERVICE_UNAVAILABLE).then_some(1),
        }
    }

    /// Says when to try again.
    #[must_use]
    pub(crate) fn retry_after(mut self, wait: Duration) -> Self {
        self.retry_after_s = Some(wait.as_secs_f64().ceil().max(1.0) as u64);
        self
    }

    /// Names the field at fault by its JSON pointer.
    #[must_use]
    pub fn at(mut self, pointer: impl Into<String>) -> Self {
        let pointer = shortened(pointer.into(), MOST_POINTER);
        self.errors.push(FieldError { pointer, detail: self.detail.clone() });
        self
    }

    /// Adds a sentence to the detail.
    #[must_use]
    pub(crate) fn and(mut self, more: &str) -> Self {
        let before = std::mem::take(&mut self.detail);
        self.detail = with_exponents(shortened(format!("{before}; {more}"), MOST_DETAIL));
        for error in self.errors.iter_mut().filter(|error| error.detail == before) {
            error.detail.clone_from(&self.detail);
        }
        self
    }

    /// Moves pointers into a field that the request did not have to the one that stood for it.
    #[must_use]
    pub(crate) fn moved(mut self, from: &str, to: &str) -> Self {
        for error in
            self.errors.iter_mut().filter(|e| e.pointer == from || e.pointer.starts_with(&format!("{from}/")))
        {
            to.clone_into(&mut error.pointer);
        }
        self
    }

    /// A JSON document that cannot be read; `under` is where it stands in the request.
    pub(crate) fn invalid_document(error: &document::Error, under: &str) -> Self {
        let mut problem = Problem::new(ProblemType::InvalidRequest, error.to_string());
        let in_fields = error.mistakes().iter().filter(|mistake| !mistake.pointer.is_empty());
        problem.errors.extend(in_fields.map(|mistake| FieldError {
            pointer: shortened(format!("{under}{}", mistake.pointer), MOST_POINTER),
            detail: shortened(mistake.message.clone(), MOST_DETAIL),
        }));
        problem
    }

    /// A map that cannot be used; `under` is where it stands in the request.
    pub fn invalid_map(error: &terrain::Error, under: &str) -> Self {
        let kind = match error {
            terrain::Error::TooManyCells { .. } => ProblemType::TooLarge,
            _ => ProblemType::InvalidMap,
        };
        let problem = Problem::new(kind, error.to_string());
        match error.field() {
            Some(field) => problem.at(format!("{under}{}", pointer(&field))),
            None => problem,
        }
    }

    /// Areas or a risk of unknown ground, of a request's own, that cannot be.
    pub fn invalid_areas(error: &terrain::areas::AreaError) -> Self {
        Problem::new(ProblemType::InvalidRequest, error.to_string()).at(pointer(&error.at))
    }

    /// A robot that cannot be used; `under` is where it stands in the request.
    pub fn invalid_robot(error: &model::Error, under: &str) -> Self {
        let kind = match error {
            model::Error::UnknownRobot { .. } => ProblemType::UnknownRobot,
            _ => ProblemType::InvalidRobot,
        };
        let place = error.field().map_or(String::new(), pointer);
        Problem::new(kind, error.to_string()).at(format!("{under}{place}"))
    }

    /// A recording or a map of one that cannot be read. A map's place is `map`, wherever it stands in the request.
    pub fn invalid_recording(error: &recording::Error) -> Self {
        use recording::Error as E;
        match error {
            E::Json(error) => Problem::invalid_document(error, "/map"),
            E::Map { path, .. } => Problem::new(ProblemType::InvalidRequest, error.to_string())
                .at(format!("/map{}", pointer(path))),
            E::Unit { index, .. } => Problem::new(ProblemType::InvalidRequest, error.to_string())
                .at(format!("/map/sources/{index}/unit")),
            E::Io(_) => Problem::new(ProblemType::Internal, format!("the stored recording: {error}")),
            E::TooLarge { .. } | E::TooLong { .. } | E::Claims { .. } => {
                Problem::new(ProblemType::TooLarge, error.to_string())
            }
            _ => Problem::new(ProblemType::InvalidRecording, error.to_string()),
        }
    }

    /// Why a robot cannot be fitted to a recording.
    pub fn no_calibration(error: &calibration::Error) -> Self {
        use calibration::Error as E;
        let (kind, at) = match error {
            E::UnknownSurface { .. } => (ProblemType::UnknownSurface, "/robot/surfaces"),
            E::NoReference { .. } => (ProblemType::UnknownSurface, "/reference_surface"),
            E::NoForcePerAmpere => (ProblemType::InvalidRobot, "/robot/motors"),
            E::Lift { .. } => (ProblemType::InvalidRequest, "/lift"),
            _ => (ProblemType::InsufficientRecording, "/recordings"),
        };
        Problem::new(kind, error.to_string()).at(at)
    }

    /// Why drives cannot be diagnosed.
    pub fn no_diagnosis(error: &diagnosis::Error) -> Self {
        use diagnosis::Error as E;
        match error {
            E::Calibration(error) => Problem::no_calibration(error),
            E::Surface { .. } => {
                Problem::new(ProblemType::UnknownSurface, error.to_string()).at("/robot/surfaces")
            }
            _ => Problem::new(ProblemType::InsufficientRecording, error.to_string()).at("/recordings"),
        }
    }

    /// Why a question of many paths, or of limits, has no answer.
    pub fn no_routing(error: &routing::Error) -> Self {
        use routing::Error as E;
        match error {
            E::Planner(error) => Problem::no_plan(error),
            E::Contradiction(_) => Problem::new(ProblemType::LimitsContradict, error.to_string()),
            E::NotPositive { field, .. } => {
                Problem::new(ProblemType::InvalidRequest, error.to_string()).at(pointer(field))
            }
            E::Charge { .. } | E::ChargeWithinReserve { .. } => {
                Problem::new(ProblemType::InvalidRequest, error.to_string()).at("/charges")
            }
            _ => Problem::new(ProblemType::Internal, error.to_string()),
        }
    }

    /// Why a question about range cannot be answered.
    pub fn no_range(error: &mission::Error) -> Self {
        use mission::Error as E;
        let (kind, at) = match error {
            E::Plan(error) => return Problem::no_plan(error),
            E::Robot(error) => return Problem::invalid_robot(error, "/robot"),
            E::NoBattery => (ProblemType::InvalidRobot, "/robot/battery".to_owned()),
            E::OutOfRange { field, .. } => (ProblemType::InvalidRequest, pointer(field)),
            E::ReserveAboveCharge { .. } => (ProblemType::InvalidRequest, "/charge".to_owned()),
            E::NowhereToGo => (ProblemType::NoPath, "/start".to_owned()),
            E::NoWayBack { .. } => (ProblemType::NoPath, "/goal".to_owned()),
            E::ScaleTooFine { .. } => (ProblemType::InvalidRequest, "/elevation_scale_m".to_owned()),
            E::Timeout { .. } => return Problem::new(ProblemType::Timeout, error.to_string()),
            _ => return Problem::new(ProblemType::Internal, error.to_string()),
        };
        Problem::new(kind, error.to_string()).at(at)
    }

    /// Why a mission cannot be planned.
    pub fn no_mission(error: &mission::MissionError) -> Self {
        use mission::MissionError as E;
        let (kind, at) = match error {
            E::Question(error) => return Problem::no_range(error),
            E::Routing(routing::Error::Planner(error)) => return Problem::no_plan(error),
            E::Count { list, count, most, .. } => {
                let kind = if count > most { ProblemType::TooLarge } else { ProblemType::InvalidRequest };
                (kind, format!("/{list}"))
            }
            E::Unreachable { waypoint, .. } | E::NoWayHome { waypoint, .. } => {
                (ProblemType::NoPath, format!("/waypoints/{waypoint}"))
            }
            E::NoChain => (ProblemType::NoPath, "/waypoints".to_owned()),
            E::DeadlineTooShort { .. } => (ProblemType::DeadlineTooShort, "/deadline_s".to_owned()),
            _ => return Problem::new(ProblemType::Internal, error.to_string()),
        };
        Problem::new(kind, error.to_string()).at(at)
    }

    /// Why the planner has no path.
    pub fn no_plan(error: &planner::Error) -> Self {
        use planner::Error as E;
        let place = |place: &Place| match place {
            Place::Start => "/start".to_owned(),
            Place::Goal => "/goal".to_owned(),
            Place::Listed { list, index } => format!("/{list}/{index}"),
        };
        let (kind, at) = match error {
            E::OutsideMap { place: end, .. } => {
                let kind = match end {
                    Place::Start => ProblemType::StartOutsideMap,
                    Place::Goal | Place::Listed { list: "goals", .. } => ProblemType::GoalOutsideMap,
                    Place::Listed { .. } => ProblemType::WaypointOutsideMap,
                };
                (kind, Some(place(end)))
            }
            E::PlaceBlocked { place: end, .. } => {
                let kind = match end {
                    Place::Start => ProblemType::StartBlocked,
                    Place::Goal | Place::Listed { list: "goals", .. } => ProblemType::GoalBlocked,
                    Place::Listed { .. } => ProblemType::WaypointBlocked,
                };
                (kind, Some(place(end)))
            }
            E::NoPath { .. } | E::NoRoomToTurn { .. } => (ProblemType::NoPath, None),
            E::Timeout { .. } => (ProblemType::Timeout, None),
            E::Untraceable => (ProblemType::InvalidRequest, Some("/robot/surfaces".into())),
            E::UnknownSurface { .. } => (ProblemType::UnknownSurface, Some("/robot/surfaces".into())),
            E::ConflictingTolerance { .. } => (ProblemType::InvalidRequest, Some("/goal/tolerance_m".into())),
            E::OutOfRange { field, .. } => (ProblemType::InvalidRequest, Some(pointer(field))),
            E::Heading { place: end, .. } => (ProblemType::InvalidRequest, Some(place(end) + "/heading_rad")),
            E::CellsTooFine { .. } => (ProblemType::InvalidMap, Some("/map/cell_size_m".into())),
            E::TooManyStates { .. } => (ProblemType::TooLarge, Some("/map".into())),
            E::Areas(_) => (ProblemType::InvalidRequest, Some("/areas".into())),
            E::TooManyGrounds { .. } => (ProblemType::TooLarge, Some("/areas".into())),
            E::TooManySurfaces { .. } => (ProblemType::TooLarge, Some("/map/surface".into())),
            _ => (ProblemType::Internal, None),
        };
        let problem = Problem::new(kind, error.to_string());
        match at {
            Some(at) => problem.at(at),
            None => problem,
        }
    }
}

/// A path of serde or of this program, `start.x_m` or `elevation_m[3][2]`, as a JSON pointer.
pub(crate) fn pointer(path: &str) -> String {
    let mut pointer = String::new();
    for part in path.split(['.', '[']).map(|part| part.trim_end_matches(']')).filter(|p| !p.is_empty()) {
        pointer.push_str(&document::pointer(part));
    }
    pointer
}

impl IntoResponse for Problem {
    fn into_response(self) -> Response {
        let status = StatusCode::from_u16(self.status).unwrap_or(StatusCode::INTERNAL_SERVER_ERROR);
        let retry_after_s = self.retry_after_s;
        let mut response = (status, Json(self)).into_response();
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_TYPE, HeaderValue::from_static("application/problem+json"));
        if let Some(seconds) = retry_after_s {
            headers.insert(header::RETRY_AFTER, HeaderValue::from(seconds));
        }
        if status == StatusCode::UNAUTHORIZED {
            headers.insert(header::WWW_AUTHENTICATE, HeaderValue::from_static("Bearer"));
        }
        response
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::*;

    #[test]
    fn names_in_a_request_however_long_leave_a_problem_short() {
        let long = "é".repeat(1 << 20);
        let problem = Problem::new(ProblemType::InvalidRequest, format!("unknown field `{long}`"))
            .at(format!("/{long}"));
        let unreadable =
            document::from_json::<BTreeMap<String, f64>>(format!("{{\"{long}\": []}}").as_bytes());
        let unreadable = Problem::invalid_document(&unreadable.unwrap_err(), "/map");
        for problem in [problem, unreadable] {
            assert!(
                problem.detail.len() <= MOST_DETAIL && problem.detail.ends_with('…'),
                "{}",
                problem.detail.len()
            );
            let text = serde_json::to_string(&problem).unwrap();
            assert!(text.len() < 3 * MOST_DETAIL, "{}", text.len());
        }
        assert_eq!(shortened("short".into(), 5), "short");
        assert_eq!(shortened("shorter".into(), 6), "sho…");
    }

    #[test]
    fn paths_become_json_pointers() {
        assert_eq!(pointer("map.elevation_m[3][12]"), "/map/elevation_m/3/12");
        assert_eq!(pointer("robot.surfaces.wet/clay.mu_roll"), "/robot/surfaces/wet~1clay/mu_roll");
        assert_eq!(pointer("."), "");
    }
}
