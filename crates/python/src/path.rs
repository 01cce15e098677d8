//! A planned path: totals as a document, poses as columns.

use std::{mem, time::Instant};

use numpy::PyArray1;
use pyo3::{prelude::*, types::PyDict};
use service::{
    Problem,
    routes::plan::{PlanAnswer, PoseAnswer},
};

use crate::problem::{exception, internal};

/// A path between poses.
#[pyclass(frozen, name = "Path", module = "joulepath._native")]
pub(crate) struct Path {
    /// The answer without poses, as JSON.
    totals: String,
    totals_answer: PlanAnswer,
    poses: Vec<PoseAnswer>,
    refined: Option<Vec<PoseAnswer>>,
    /// Time that the answer took, without the way to it and back [s].
    #[pyo3(get)]
    answered_s: f64,
}

impl Path {
    /// The path of an answer that was begun at a moment.
    pub(crate) fn of(mut answer: PlanAnswer, began: Instant) -> Result<Self, Problem> {
        let answered_s = began.elapsed().as_secs_f64();
        let poses = mem::take(&mut answer.poses);
        let refined = answer.refined.as_mut().map(|refined| mem::take(&mut refined.poses));
        let totals = serde_json::to_string(&answer).map_err(internal)?;
        Ok(Path { totals, totals_answer: answer, poses, refined, answered_s })
    }
}

#[pymethods]
impl Path {
    fn totals(&self) -> &str {
        &self.totals
    }

    /// The whole answer of the HTTP API as JSON.
    fn document(&self, py: Python<'_>) -> PyResult<String> {
        let mut answer = self.totals_answer.clone();
        answer.poses.clone_from(&self.poses);
        if let (Some(refined), Some(poses)) = (&mut answer.refined, &self.refined) {
            refined.poses.clone_from(poses);
        }
        serde_json::to_string(&answer).map_err(|error| exception(py, internal(error)))
    }

    /// Columns by name, a row for each pose; `None` where no refined path was asked for.
    fn poses<'py>(&self, py: Python<'py>, refined: bool) -> PyResult<Option<Bound<'py, PyDict>>> {
        let poses = if refined { self.refined.as_deref() } else { Some(&self.poses[..]) };
        poses.map(|poses| columns(py, poses)).transpose()
    }
}

fn columns<'py>(py: Python<'py>, poses: &[PoseAnswer]) -> PyResult<Bound<'py, PyDict>> {
    let columns = PyDict::new(py);
    let add = |name: &str, value: fn(&PoseAnswer) -> Option<f64>| {
        // Where no pose has a value, as degrees without a CRS, there is no such column.
        if name == "radius_m" || poses.iter().any(|pose| value(pose).is_some()) {
            let values = poses.iter().map(|pose| value(pose).unwrap_or(f64::NAN));
            columns.set_item(name, PyArray1::from_iter(py, values))?;
        }
        Ok::<(), PyErr>(())
    };
    add("x_m", |pose| Some(pose.x_m))?;
    add("y_m", |pose| Some(pose.y_m))?;
    add("lon_deg", |pose| pose.lon_deg)?;
    add("lat_deg", |pose| pose.lat_deg)?;
    add("z_m", |pose| Some(pose.z_m))?;
    add("heading_rad", |pose| Some(pose.heading_rad))?;
    add("t_s", |pose| Some(pose.t_s))?;
    add("distance_m", |pose| Some(pose.distance_m))?;
    add("energy_j", |pose| Some(pose.energy_j))?;
    add("power_w", |pose| Some(pose.power_w))?;
    add("pitch_rad", |pose| Some(pose.pitch_rad))?;
    add("roll_rad", |pose| Some(pose.roll_rad))?;
    add("radius_m", |pose| pose.radius_m)?;
    Ok(columns)
}
