//! Recordings, checked.

use std::{path::PathBuf, sync::Arc};

use numpy::PyArray1;
use pyo3::{prelude::*, types::PyTuple};
use recording::{Channel, Labels, Map, NamedColumn, ReadingReport, read_paths_watched};
use service::{Problem, ProblemType};

use crate::{
    computation::beside,
    problem::{Failure, exception, internal, invalid_recording},
    robot::Robot,
    table::{ArrowTable, HeldColumn},
};

/// Drives of a robot as channels by row.
#[pyclass(frozen, name = "Recording", module = "joulepath._native")]
pub(crate) struct Recording {
    pub(crate) recording: Arc<recording::Recording>,
    reports: Vec<ReadingReport>,
}

#[pymethods]
impl Recording {
    /// The runs of files behind one another. `columns` is a map of columns or topics as JSON, or the name of a built-in one; by
    /// default topics are those of a Husky, or of a PX4 rover in its own logs, on the wheels of the robot.
    #[staticmethod]
    fn open(
        py: Python<'_>,
        paths: Vec<PathBuf>,
        columns: Option<&str>,
        robot: &Robot,
        progress: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Self> {
        let all_px4 = paths.iter().all(|path| path.extension().is_some_and(|ending| ending == "ulg"));
        let default = if all_px4 { "\"px4\"" } else { "\"husky\"" };
        let map = map_of_columns(columns.unwrap_or(default), robot);
        let map = map.map_err(|problem| exception(py, problem))?;
        beside(py, progress, |computation| {
            computation.tell("reading", 0.0);
            read_paths_watched(&paths, Some(&map), &computation.watch())
                .map_err(|error| invalid_recording(&error))
        })
        .map(|(recording, reports)| Recording { recording: Arc::new(recording), reports })
    }

    /// A recording from the columns of a table in memory: tuples of a name, of what its values are (`numbers`, a unit of time, `texts`
    /// or `unusable`) and of the values.
    #[staticmethod]
    fn from_columns(
        py: Python<'_>,
        table: Vec<Bound<'_, PyTuple>>,
        name: &str,
        columns: Option<&str>,
        robot: &Robot,
    ) -> PyResult<Self> {
        let held = table.iter().map(HeldColumn::of).collect::<PyResult<Vec<_>>>()?;
        let named = held.iter().map(HeldColumn::named).collect::<PyResult<Vec<_>>>()?;
        Recording::of_table(py, &named, name, columns, robot)
    }

    /// A recording from a table of another library that speaks the C stream interface of Arrow.
    #[staticmethod]
    fn from_arrow(
        py: Python<'_>,
        table: &Bound<'_, PyAny>,
        name: &str,
        columns: Option<&str>,
        robot: &Robot,
    ) -> PyResult<Self> {
        let table = ArrowTable::of(table)?;
        Recording::of_table(py, &table.named(), name, columns, robot)
    }

    /// The same drives on ground that is named where the recording does not name it.
    fn on_surface(&self, name: &str) -> Self {
        let mut recording = (*self.recording).clone();
        match &mut recording.surface {
            None => recording.surface = Some(Labels::constant(name, recording.rows())),
            Some(labels) => labels.name_the_rest(name),
        }
        Recording { recording: Arc::new(recording), reports: self.reports.clone() }
    }

    /// Some of the runs.
    fn of_runs(&self, py: Python<'_>, names: Vec<String>) -> PyResult<Self> {
        let known: Vec<&str> = self.recording.runs.iter().map(|run| run.name.as_str()).collect();
        if let Some(name) = names.iter().find(|name| !known.contains(&name.as_str())) {
            let detail = format!("there is no run `{name}`; there are {}", known.join(", "));
            return Err(exception(py, Problem::new(ProblemType::InvalidRequest, detail).at("/runs")));
        }
        let recording = self.recording.of_runs(|run| names.contains(&run.name));
        Ok(Recording { recording: Arc::new(recording), reports: self.reports.clone() })
    }

    /// Number of rows.
    fn rows(&self) -> usize {
        self.recording.rows()
    }

    fn duration_s(&self) -> f64 {
        self.recording.duration_s()
    }

    /// Names of the runs, with the first row of each and the one behind its last.
    fn runs(&self) -> Vec<(String, usize, usize)> {
        self.recording.runs.iter().map(|run| (run.name.clone(), run.rows.start, run.rows.end)).collect()
    }

    /// Names of the channels, then of the columns that are no channel.
    fn names(&self) -> (Vec<&'static str>, Vec<String>) {
        let channels = self.recording.channels.keys().map(|channel| channel.name());
        (channels.collect(), self.recording.aside.keys().cloned().collect())
    }

    /// A column by row, NaN in gaps; `None` where the recording lacks it.
    fn column<'py>(&self, py: Python<'py>, name: &str) -> Option<Bound<'py, PyArray1<f64>>> {
        let recording = &self.recording;
        let values = match name {
            "t_s" => Some(&recording.t_s[..]),
            _ => Channel::from_name(name)
                .and_then(|channel| recording.channel(channel))
                .or_else(|| recording.aside.get(name).map(Vec::as_slice)),
        };
        values.map(|values| PyArray1::from_slice(py, values))
    }

    /// Names of the surfaces, and by row the index of its own; -1 where it has none.
    fn surface<'py>(&self, py: Python<'py>) -> Option<(Vec<String>, Bound<'py, PyArray1<i64>>)> {
        let labels = self.recording.surface.as_ref()?;
        let code = |index: &u32| if *index == Labels::NONE { -1 } else { i64::from(*index) };
        Some((labels.names.clone(), PyArray1::from_iter(py, labels.index.iter().map(code))))
    }

    /// What reading found, a report for each file, as JSON.
    fn reports(&self, py: Python<'_>) -> PyResult<String> {
        serde_json::to_string(&self.reports).map_err(|error| exception(py, internal(error)))
    }
}

impl Recording {
    fn of_table(
        py: Python<'_>,
        table: &[NamedColumn<'_>],
        name: &str,
        columns: Option<&str>,
        robot: &Robot,
    ) -> PyResult<Self> {
        let map = columns.map(|columns| map_of_columns(columns, robot)).transpose();
        let map = map.map_err(|problem| exception(py, problem))?;
        let reading = beside(py, None, |computation| {
            recording::Recording::from_columns(table, name, map.as_ref(), &computation.watch())
                .map_err(|error| invalid_recording(&error))
        })?;
        Ok(Recording::of(reading))
    }

    pub(crate) fn of(reading: recording::Reading) -> Self {
        Recording { recording: Arc::new(reading.recording), reports: vec![reading.report] }
    }
}

/// A built-in map by its name as JSON text, on the wheels of a robot, or a map.
pub(crate) fn map_of_columns(columns: &str, robot: &Robot) -> Result<Map, Failure> {
    let Ok(name) = serde_json::from_str::<String>(columns) else {
        return Map::from_json(columns).map_err(|error| invalid_recording(&error));
    };
    let robot = &robot.robot;
    Map::built_in_for(&name, robot.wheel_radius_m, robot.slip_track_m).ok_or_else(|| {
        let known = Map::BUILT_IN.join(", ");
        let detail = format!("there is no map `{name}`: give one of {known}, or the map itself as a dict");
        Problem::new(ProblemType::InvalidRequest, detail).at("/columns").into()
    })
}
