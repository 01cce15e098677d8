//! Drives against a robot: predicted, fitted and diagnosed.

use std::sync::Arc;

use ::calibration::{Method, Options, PredictedDrives, predict_watched};
use ::diagnosis::{Diagnosis, Question, diagnose_watched, taught};
use numpy::PyArray1;
use pyo3::{prelude::*, types::PyDict};
use service::{Problem, routes};

use crate::{
    computation::beside,
    problem::{exception, internal},
    recording::Recording,
    robot::Robot,
};

/// Predicted against recorded power.
#[pyclass(frozen, name = "Predicted", module = "joulepath._native")]
pub(crate) struct Predicted {
    robot: Arc<model::Robot>,
    found: PredictedDrives,
}

#[pymethods]
impl Predicted {
    /// The document of `joulepath predict --json`.
    fn document(&self, py: Python<'_>) -> PyResult<String> {
        serde_json::to_string(&self.found.prediction).map_err(|error| exception(py, internal(error)))
    }

    /// By row of the drives that were compared: index of the run, time, predicted and recorded power, NaN in gaps.
    fn columns<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let drives = &self.found.drives;
        let mut run = vec![-1; drives.rows.len()];
        for stretch in &drives.stretches {
            run[stretch.rows.clone()].fill(stretch.run as i64);
        }
        let columns = PyDict::new(py);
        columns.set_item("run", PyArray1::from_vec(py, run))?;
        columns.set_item("t_s", PyArray1::from_iter(py, drives.rows.iter().map(|row| row.t_s)))?;
        columns.set_item("predicted_w", PyArray1::from_slice(py, &self.found.predicted_w))?;
        columns.set_item("recorded_w", PyArray1::from_slice(py, &self.found.recorded_w))?;
        Ok(columns)
    }

    /// Names of the runs.
    fn runs(&self) -> Vec<String> {
        self.found.drives.runs.clone()
    }

    /// The report as a page.
    fn html(&self) -> String {
        report::prediction_page(&self.robot, &self.found)
    }
}

/// Predicts the power of recorded drives.
#[pyfunction]
pub(crate) fn predict(py: Python<'_>, robot: &Robot, recording: &Recording) -> PyResult<Predicted> {
    let (robot, recording) = (&robot.robot, &recording.recording);
    let found = beside(py, None, |computation| {
        predict_watched(robot, recording, &computation.watch())
            .map_err(|error| Problem::no_calibration(&error))
    })?;
    Ok(Predicted { robot: Arc::clone(robot), found })
}

/// Fits a robot to recordings: the document of a calibration's job, as JSON.
#[pyfunction]
pub(crate) fn calibrate(
    py: Python<'_>,
    robot: &Robot,
    recording: &Recording,
    options: &str,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<String> {
    let (robot, recording) = (&robot.robot, &recording.recording);
    beside(py, progress, |computation| {
        let (method, options) = options_of(options)?;
        computation.tell("fitting", 0.0);
        let watch = computation.watch();
        let found = method
            .calibrate_watched(robot, recording, &options, &watch)
            .and_then(|found| taught(robot, found, recording, &watch))
            .map_err(|error| Problem::no_calibration(&error))?;
        serde_json::to_string(&found).map_err(internal)
    })
}

/// Method and options of a calibration from `[method, reference_surface, despite]`.
fn options_of(options: &str) -> Result<(Method, Options), Problem> {
    let (method, reference_surface, despite) =
        document::from_json(options.as_bytes()).map_err(|error| crate::problem::invalid_request(&error))?;
    Ok((method, Options { reference_surface, despite }))
}

/// A diagnosis with its page.
#[pyclass(frozen, name = "Diagnosed", module = "joulepath._native")]
pub(crate) struct Diagnosed {
    robot: Arc<model::Robot>,
    found: Diagnosis,
}

#[pymethods]
impl Diagnosed {
    /// The document of a diagnosis' job.
    fn document(&self, py: Python<'_>) -> PyResult<String> {
        let document = routes::diagnose::document(&self.found);
        document
            .and_then(|document| serde_json::to_string(&document).map_err(internal))
            .map_err(|problem| exception(py, problem))
    }

    /// What was recorded and predicted, by row, as JSON.
    fn trace(&self, py: Python<'_>) -> PyResult<String> {
        serde_json::to_string(&self.found.trace).map_err(|error| exception(py, internal(error)))
    }

    /// The corrected robot.
    fn corrected_robot(&self, py: Python<'_>) -> PyResult<Robot> {
        Robot::of(self.found.corrected_robot.clone()).map_err(|problem| exception(py, problem))
    }

    /// The report as a page.
    fn html(&self) -> String {
        report::diagnosis_page(&self.found, &self.robot.name)
    }
}

/// Finds where drives differ from a robot's model, and which physics was left out.
#[pyfunction]
#[pyo3(signature = (robot, recording, healthy, simulated, ruled_out, progress))]
pub(crate) fn diagnose(
    py: Python<'_>,
    robot: &Robot,
    recording: &Recording,
    healthy: Option<&Recording>,
    simulated: Option<&Recording>,
    ruled_out: Vec<String>,
    progress: Option<&Bound<'_, PyAny>>,
) -> PyResult<Diagnosed> {
    let (robot, suspect) = (&robot.robot, &recording.recording);
    let healthy = healthy.map(|healthy| &*healthy.recording);
    let simulated = simulated.map(|simulated| &*simulated.recording);
    let found = beside(py, progress, |computation| {
        let ruled_out = routes::diagnose::mechanisms(&ruled_out)?;
        let question =
            Question { ruled_out: &ruled_out, simulated, ..Question::new(robot, suspect, healthy) };
        let tell = |step: &str, share| computation.tell(step, share);
        diagnose_watched(&question, &tell, &computation.watch())
            .map_err(|error| Problem::no_diagnosis(&error))
    })?;
    Ok(Diagnosed { robot: Arc::clone(robot), found })
}
