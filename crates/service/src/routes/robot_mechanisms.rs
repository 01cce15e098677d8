//! `GET /v1/robots/{id}/mechanisms`: what a robot's file may carry beyond its fields.

use axum::extract::State;
use model::{
    KnownMechanism, Robot,
    mechanism::{self, Mechanism},
};
use serde::Serialize;
use utoipa::ToSchema;

use super::robots::known_robot;
use crate::{Engine, Tenant, answer::Json, body::Id, problem::Problem};

/// Mechanisms that a robot's file may carry.
#[derive(Debug, Serialize, ToSchema)]
pub struct MechanismList {
    /// Those of a robot, of which some may stand at a surface as well.
    pub mechanisms: Vec<MechanismAnswer>,
}

/// A mechanism, with what its parameters may be on the robot.
#[derive(Debug, Serialize, ToSchema)]
pub struct MechanismAnswer {
    /// Its name in files and reports.
    #[schema(example = "payload")]
    pub mechanism: &'static str,
    /// What it is, in words that go into a sentence.
    pub label: &'static str,
    /// Whether a surface may have it.
    pub of_ground: bool,
    /// Its parameters.
    pub parameters: Vec<ParameterRange>,
}

/// A parameter of a mechanism.
#[derive(Debug, Serialize, ToSchema)]
pub struct ParameterRange {
    /// Its name.
    #[schema(example = "mass_kg")]
    pub name: &'static str,
    /// Its unit, `1` for none.
    #[schema(example = "kg")]
    pub unit: &'static str,
    /// Least value on this robot.
    pub least: f64,
    /// Greatest value on this robot.
    pub greatest: f64,
    /// Whether a file may leave it out.
    pub optional: bool,
}

impl MechanismAnswer {
    fn of(mechanism: &dyn Mechanism, robot: &Robot) -> Self {
        let parameters = mechanism.parameters().iter().enumerate().map(|(i, parameter)| {
            let [least, greatest] = parameter.bounds_of(robot);
            let optional = mechanism.is_optional(i);
            ParameterRange { name: parameter.name, unit: parameter.unit, least, greatest, optional }
        });
        MechanismAnswer {
            mechanism: mechanism.name(),
            label: mechanism.label(),
            of_ground: KnownMechanism::is_of_ground(mechanism),
            parameters: parameters.collect(),
        }
    }
}

/// Mechanisms that a robot's file may carry, with what their parameters may be on this robot: loads and forces grow with its mass.
#[utoipa::path(
    get, path = "/v1/robots/{id}/mechanisms", tag = "robots",
    params(("id" = String, Path, description = "Name of a built-in robot or id of a stored one", example = "husky-a200")),
    responses(
        (status = 200, description = "The mechanisms", body = MechanismList),
        (status = 404, body = Problem, content_type = "application/problem+json"),
        (status = 503, description = "The store is out of reach", body = Problem, content_type = "application/problem+json")
    )
)]
pub(crate) async fn list(
    State(engine): State<Engine>,
    tenant: Tenant,
    Id(id): Id,
) -> Result<Json<MechanismList>, Problem> {
    let robot = known_robot(&engine, &tenant, &id).await?;
    let of_file = mechanism::ALL.into_iter().filter(|mechanism| KnownMechanism::fits_file(*mechanism));
    let mechanisms = of_file.map(|mechanism| MechanismAnswer::of(mechanism, &robot)).collect();
    Ok(Json(MechanismList { mechanisms }))
}
