//! `/v1/robots`: robots at hand, and robots as requests name them.

use axum::{extract::State, http::StatusCode};
use model::{Robot, builtin, robot::RobotFile};
use serde::{
    Deserialize, Deserializer, Serialize,
    de::{MapAccess, Visitor, value::MapAccessDeserializer},
};
use utoipa::ToSchema;

use crate::{
    Engine, Tenant,
    answer::Json,
    body::{Id, ShortJsonBody},
    problem::{Problem, ProblemType},
    robots::RobotStore,
};

/// A robot by the name of a built-in one or the id of a stored one, or in full.
#[derive(Clone, Debug, PartialEq, Serialize, ToSchema)]
#[serde(untagged)]
pub enum RobotChoice {
    /// Name of a built-in robot, as `husky-a200`, or id of a stored one.
    Name(String),
    /// The robot itself.
    File(Box<RobotFile>),
}

impl RobotChoice {
    /// Puts a stored robot that a tenant sees in the place of its id.
    pub(crate) async fn look_up(&mut self, stored: &RobotStore, tenant: &Tenant) -> Result<(), Problem> {
        if let RobotChoice::Name(id) = self
            && let Some(robot) = stored.get(tenant, id).await?
        {
            *self = RobotChoice::File(Box::new(RobotFile::from(robot)));
        }
        Ok(())
    }

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
                f.write_str("the name or id of a robot, or a robot as an object")
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
    /// Built-in ones, in the order of their names.
    pub robots: Vec<Robot>,
    /// Stored ones, in the order of their ids.
    pub stored: Vec<StoredRobot>,
}

/// A robot with the id that requests may name it by.
#[derive(Clone, Debug, Serialize, ToSchema)]
pub struct StoredRobot {
    /// Content hash: the same robot always has the same id.
    #[schema(example = "9c1185a5c5e9fc54a0b1c2d3e4f56789")]
    pub id: String,
    /// The robot, every default filled in.
    pub robot: Robot,
}

/// Store a robot.
#[utoipa::path(
    post, path = "/v1/robots", tag = "robots",
    request_body = RobotFile,
    responses(
        (status = 201, description = "Stored", body = StoredRobot),
        (status = 200, description = "Already at hand", body = StoredRobot),
        (status = 400, body = Problem, content_type = "application/problem+json"),
        (status = 413, body = Problem, content_type = "application/problem+json"),
        (status = 415, body = Problem, content_type = "application/problem+json"),
        (status = 507, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn create(
    State(engine): State<Engine>,
    tenant: Tenant,
    ShortJsonBody(file): ShortJsonBody<RobotFile>,
) -> Result<(StatusCode, Json<StoredRobot>), Problem> {
    let robot = Robot::try_from(file).map_err(|error| Problem::invalid_robot(&error, ""))?;
    let (id, new) = engine.robots().insert(&tenant, &robot, &engine.limits().quota()).await?;
    let status = if new { StatusCode::CREATED } else { StatusCode::OK };
    Ok((status, Json(StoredRobot { id, robot })))
}

/// Robots that requests may name.
#[utoipa::path(
    get, path = "/v1/robots", tag = "robots",
    responses(
        (status = 200, description = "The robots", body = RobotList),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn list(State(engine): State<Engine>, tenant: Tenant) -> Result<Json<RobotList>, Problem> {
    let mut robots = builtin::all();
    robots.sort_by(|a, b| a.name.cmp(&b.name));
    let stored = engine
        .robots()
        .list(&tenant)
        .await?
        .into_iter()
        .map(|(id, robot)| StoredRobot { id, robot })
        .collect();
    Ok(Json(RobotList { robots, stored }))
}

/// One robot by its name or id.
#[utoipa::path(
    get, path = "/v1/robots/{id}", tag = "robots",
    params(("id" = String, Path, description = "Name of a built-in robot or id of a stored one", example = "husky-a200")),
    responses(
        (status = 200, description = "The robot", body = Robot),
        (status = 404, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn read(
    State(engine): State<Engine>,
    tenant: Tenant,
    Id(id): Id,
) -> Result<Json<Robot>, Problem> {
    known_robot(&engine, &tenant, &id).await.map(Json)
}

/// A stored or built-in robot that a path names.
///
/// # Errors
/// A name that no robot has, or a store out of reach.
pub(super) async fn known_robot(engine: &Engine, tenant: &Tenant, id: &str) -> Result<Robot, Problem> {
    if let Some(robot) = engine.robots().get(tenant, id).await? {
        return Ok(robot);
    }
    builtin::by_name(id).map_err(|error| {
        let mut problem = Problem::invalid_robot(&error, "");
        problem.errors.clear();
        problem
    })
}

/// Forget a stored robot. Jobs that were started with it finish.
#[utoipa::path(
    delete, path = "/v1/robots/{id}", tag = "robots",
    params(("id" = String, Path, description = "Id of a stored robot")),
    responses(
        (status = 204, description = "Forgotten"),
        (status = 403, description = "The robot is built in, or a page of another origin asks", body = Problem, content_type = "application/problem+json"),
        (status = 404, description = "No such robot", body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn remove(
    State(engine): State<Engine>,
    tenant: Tenant,
    Id(id): Id,
) -> Result<StatusCode, Problem> {
    if builtin::by_name(&id).is_ok() {
        let detail =
            format!("`{id}` is built in and cannot be removed; stored robots are removed by their ids");
        return Err(Problem::new(ProblemType::BuiltIn, detail));
    }
    engine.robots().remove(&tenant, &id).await?;
    Ok(StatusCode::NO_CONTENT)
}
