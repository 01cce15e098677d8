//! Robots, checked.

use std::sync::Arc;

use model::builtin;
use pyo3::prelude::*;
use service::Problem;

use crate::problem::{exception, internal};

/// A robot that cannot be wrong.
#[pyclass(frozen, name = "Robot", module = "joulepath._native")]
pub(crate) struct Robot {
    pub(crate) robot: Arc<model::Robot>,
    /// The robot's document, every default filled in.
    json: String,
}

impl Robot {
    pub(crate) fn of(robot: model::Robot) -> Result<Self, Problem> {
        let json = serde_json::to_string(&robot).map_err(internal)?;
        Ok(Robot { robot: Arc::new(robot), json })
    }
}

#[pymethods]
impl Robot {
    /// A built-in robot by its name.
    #[staticmethod]
    fn builtin(py: Python<'_>, name: &str) -> PyResult<Self> {
        let found = builtin::by_name(name).map_err(|error| Problem::invalid_robot(&error, "/robot"));
        found.and_then(Robot::of).map_err(|problem| exception(py, problem))
    }

    /// A robot from its document.
    #[staticmethod]
    fn from_json(py: Python<'_>, text: &str) -> PyResult<Self> {
        let read = model::Robot::from_json(text).map_err(|error| Problem::invalid_robot(&error, ""));
        read.and_then(Robot::of).map_err(|problem| exception(py, problem))
    }

    /// Names of the built-in robots.
    #[staticmethod]
    fn names() -> Vec<String> {
        builtin::all().into_iter().map(|robot| robot.name).collect()
    }

    fn to_json(&self) -> &str {
        &self.json
    }
}
