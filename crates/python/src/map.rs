//! Maps, checked.

use std::{path::PathBuf, sync::Arc};

use numpy::{PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use service::Problem;
use terrain::{
    MapFile, Terrain,
    io::{
        self, Georeference,
        json::{Cells, Layer, SurfaceNames},
    },
};

use crate::{
    computation::beside,
    problem::{exception, internal, invalid_request},
};

/// Ground on a grid.
#[pyclass(frozen, name = "Map", module = "joulepath._native")]
pub(crate) struct Map {
    pub(crate) terrain: Arc<Terrain>,
}

#[pymethods]
impl Map {
    /// A map from layers of cells, row by row from the south-west, and a JSON object of all that is no layer.
    #[staticmethod]
    #[pyo3(signature = (head, elevation_m, surface_names, surface, obstacle))]
    fn from_layers(
        py: Python<'_>,
        head: &str,
        elevation_m: PyReadonlyArray1<'_, f64>,
        surface_names: Vec<String>,
        surface: Option<PyReadonlyArray1<'_, i64>>,
        obstacle: Option<PyReadonlyArray1<'_, bool>>,
    ) -> PyResult<Self> {
        let mut file: MapFile =
            document::from_json(head.as_bytes()).map_err(|error| exception(py, invalid_request(&error)))?;
        let (rows, columns) = (file.rows as usize, file.columns as usize);
        file.elevation_m = Layer::new(elevation_m.as_array().to_vec(), rows, columns);
        file.surface = surface.map(|codes| {
            let mut names = SurfaceNames::default();
            let name =
                |code: &i64| usize::try_from(*code).ok().and_then(|code| surface_names.get(code)).cloned();
            codes.as_array().iter().for_each(|code| names.push(name(code)));
            Layer::new(names, rows, columns)
        });
        file.obstacle = obstacle.map(|cells| Layer::new(cells.as_array().to_vec(), rows, columns));
        let terrain =
            Terrain::try_from(file).map_err(|error| exception(py, Problem::invalid_map(&error, "")))?;
        Ok(Map { terrain: Arc::new(terrain) })
    }

    /// A map from a file, whose ending says which format it is in, and the frame of an array.
    #[staticmethod]
    fn open(
        py: Python<'_>,
        path: PathBuf,
        nodata_m: Option<f64>,
        fill_voids_m: Option<f64>,
        frame: (Option<f64>, Option<[f64; 2]>, Option<String>),
    ) -> PyResult<Self> {
        let (cell_size_m, origin_m, crs) = frame;
        let georeference = Georeference { cell_size_m, origin_m, crs };
        let options = io::Options { nodata_m, fill_voids_m, georeference, ..io::Options::default() };
        beside(py, None, |_| {
            io::read_path_as(&path, &options).map_err(|error| {
                let mut problem = Problem::invalid_map(&error, "");
                let name = path.display().to_string();
                if !problem.detail.contains(&name) {
                    problem.detail = format!("{name}: {}", problem.detail);
                }
                problem
            })
        })
        .map(|terrain| Map { terrain: Arc::new(terrain) })
    }

    /// Rows and columns.
    #[getter]
    fn shape(&self) -> (usize, usize) {
        (self.terrain.grid.rows, self.terrain.grid.columns)
    }

    #[getter]
    fn cell_size_m(&self) -> f64 {
        self.terrain.grid.cell_size_m
    }

    #[getter]
    fn origin_m(&self) -> (f64, f64) {
        self.terrain.grid.origin_m.into()
    }

    #[getter]
    fn crs(&self) -> Option<&str> {
        self.terrain.crs.as_deref()
    }

    /// Elevations row by row from the south-west, NaN where unknown [m].
    fn elevation_m<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        let base_m = self.terrain.base_m();
        PyArray1::from_iter(py, self.terrain.relative_m().iter().map(|z_m| base_m + f64::from(*z_m)))
    }

    /// Obstacles in the same order.
    fn obstacle<'py>(&self, py: Python<'py>) -> Option<Bound<'py, PyArray1<bool>>> {
        self.terrain.obstacles().map(|cells| PyArray1::from_slice(py, cells))
    }

    /// Names of the surfaces, and by cell the index of its own; 255 where the map leaves it to the robot.
    fn surface<'py>(&self, py: Python<'py>) -> Option<(Vec<String>, Bound<'py, PyArray1<u8>>)> {
        let surfaces = self.terrain.surfaces()?;
        Some((surfaces.names.clone(), PyArray1::from_slice(py, &surfaces.class)))
    }

    /// Doubts about the map as JSON.
    fn warnings(&self, py: Python<'_>) -> PyResult<String> {
        serde_json::to_string(self.terrain.warnings()).map_err(|error| exception(py, internal(error)))
    }

    /// A hash of all that the map holds: that of the service.
    fn content_id(&self) -> String {
        self.terrain.content_id()
    }
}
