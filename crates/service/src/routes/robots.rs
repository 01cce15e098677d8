//! `GET /v1/robots`, and robots as requests name them.

use axum::Json;
use model::{Robot, builtin, robot::RobotFile};
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{MapAccess, Visitor, value::MapAccessDeserializer},
};
use utoipa::ToSchema;

use crate::{body::Id, problem::Problem};

/// A robot by the name of a built-in one, or in full.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum RobotChoice {
    /// Name of a built-in robot, as `husky-a200`.
    Name(String),
    /// The robot itself.
    File(Box<RobotFile>),
}

impl RobotChoice {
    /// The robot, checked.
    ///
    /// # Errors
    /// An unknown name, or the field that cannot be right.
    pub fn robot(&self) -> Result<Robot, Problem> {
        match self {
            RobotChoice::Name(name) => builtin::by_name(name),
            RobotChoice::File(file) => Robot::try_from((**file).clone()),
        }
        .map_err(|error| Problem::invalid_robot(&error, "/robot"))
    }
}

impl<'de> Deserialize<'de> for RobotChoice {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        // By hand, because serde's untagged enums forget where inside the robot a mistake is.
        struct Choice;
        impl<'de> Visitor<'de> for Choice {
            type Value = RobotChoice;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a robot's name or a robot")
            }

            fn visit_str<E: serde::de::Error>(self, name: &str) -> Result<RobotChoice, E> {
                Ok(RobotChoice::Name(name.to_owned()))
            }

            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<RobotChoice, A::Error> {
                let file = RobotFile::deserialize(MapAccessDeserializer::new(map))?;
                Ok(RobotChoice::File(Box::new(file)))
            }
        }
        deserializer.deserialize_any(Choice)
    }
}

/// Robots at hand.
#[derive(Debug, Serialize, ToSchema)]
pub struct RobotList {
    /// In the order of their names.
    pub robots: Vec<Robot>,
}

/// Robots that requests may name.
#[utoipa::path(get, path = "/v1/robots", tag = "robots", responses((status = 200, body = RobotList)))]
pub(crate) async fn list() -> Json<RobotList> {
    let mut robots = builtin::all();
    robots.sort_by(|a, b| a.name.cmp(&b.name));
    Json(RobotList { robots })
}

/// One robot by its name.
#[utoipa::path(
    get, path = "/v1/robots/{id}", tag = "robots",
    params(("id" = String, Path, description = "Name of the robot", example = "husky-a200")),
    responses((status = 200, body = Robot), (status = 404, body = Problem, content_type = "application/problem+json"))
)]
pub(crate) async fn read(Id(id): Id) -> Result<Json<Robot>, Problem> {
    let found = builtin::by_name(&id).map_err(|error| {
        let mut problem = Problem::invalid_robot(&error, "");
        problem.errors.clear();
        problem
    })?;
    Ok(Json(found))
}
