//! Questions over one map, answered by the functions that answer the HTTP API.

use std::{sync::Arc, time::Instant};

use planner::Patience;
use pyo3::prelude::*;
use serde::{Serialize, de::DeserializeOwned};
use service::{
    KeyedMap, Limits, Planners, Problem, ProblemType,
    routes::{
        alternatives::{self, AlternativesRequest},
        compare,
        matrix::{self, MatrixRequest},
        mission::{self, MissionRequest},
        plan::{self, PlanRequest},
        range::{self, RangeRequest},
        reachable::{Found, ReachableRequest},
    },
};
use terrain::Terrain;

use crate::{
    computation::beside,
    map::Map,
    path::Path,
    problem::{internal, invalid_request},
};

/// A map with all that was worked out over it.
#[pyclass(frozen, name = "Planner", module = "joulepath._native")]
pub(crate) struct Planner {
    terrain: Arc<Terrain>,
    planners: Planners,
}

#[pymethods]
impl Planner {
    #[new]
    fn new(map: &Map) -> Self {
        Planner { terrain: Arc::clone(&map.terrain), planners: Planners::default() }
    }

    /// One path.
    fn plan(&self, py: Python<'_>, request: &str) -> PyResult<Path> {
        beside(py, None, |computation| {
            let request: PlanRequest = read(request)?;
            let patience = &request.patience(&computation.patience())?;
            let planner = self.planner(&request, patience)?;
            let began = Instant::now();
            Path::of(plan::answer(&planner, &request, patience)?, began)
        })
    }

    /// The energy-minimal, shortest and fastest paths, and what the first saves.
    fn compare(&self, py: Python<'_>, request: &str) -> PyResult<(Path, Path, Path, f64)> {
        beside(py, None, |computation| {
            let request: PlanRequest = read(request)?;
            let patience = &request.patience(&computation.patience())?;
            let planner = self.planner(&request, patience)?;
            let began = Instant::now();
            let found = compare::answer(&planner, &request, patience)?;
            let (energy, distance, time) = (found.energy, found.distance, found.time);
            Ok::<_, Problem>((
                Path::of(energy, began)?,
                Path::of(distance, began)?,
                Path::of(time, began)?,
                found.saving_fraction,
            ))
        })
    }

    /// Paths that trade energy for time or length, and the answer without them as JSON.
    fn alternatives(&self, py: Python<'_>, request: &str) -> PyResult<(Vec<Path>, String)> {
        beside(py, None, |computation| {
            let mut request: AlternativesRequest = read(request)?;
            let asked = request.plan()?;
            let patience = &asked.patience(&computation.patience())?;
            let planner = self.planner(&asked, patience)?;
            let began = Instant::now();
            let mut found = alternatives::answer(&planner, &request, &asked, patience)?;
            let paths = std::mem::take(&mut found.alternatives).into_iter().map(|path| Path::of(path, began));
            Ok::<_, Problem>((paths.collect::<Result<_, Problem>>()?, written(&found)?))
        })
    }

    /// Any other question by the last part of its path in the HTTP API: a document for a document.
    fn ask(&self, py: Python<'_>, kind: &str, request: &str) -> PyResult<String> {
        beside(py, None, |computation| match kind {
            "matrix" => {
                let mut request: MatrixRequest = read(request)?;
                let asked = request.plan()?;
                let patience = &asked.patience(&computation.patience())?;
                let planner = self.planner(&asked, patience)?;
                written(&matrix::answer(&planner, &request, patience)?)
            }
            "reachable" => {
                let mut request: ReachableRequest = read(request)?;
                let asked = request.plan();
                let patience = &asked.patience(&computation.patience())?;
                let planner = self.planner(&asked, patience)?;
                written(&Found::of(&planner, &request, patience)?.contours(patience)?)
            }
            "range" => {
                let mut request: RangeRequest = read(request)?;
                let asked = request.plan();
                let patience = &asked.patience(&computation.patience())?;
                let planner = self.planner(&asked, patience)?;
                written(&range::answer(&planner, &request, &asked, patience)?)
            }
            "mission" => {
                let mut request: MissionRequest = read(request)?;
                let asked = request.plan();
                let patience = &asked.patience(&computation.patience())?;
                let planner = self.planner(&asked, patience)?;
                written(&mission::answer(&planner, &request, &asked, patience)?)
            }
            other => Err(Problem::new(ProblemType::NotFound, format!("there is no question `{other}`"))),
        })
    }
}

impl Planner {
    /// The planner that suits a request, made unless it is at hand. What was not asked for lately goes where it takes the memory that
    /// a service would keep.
    fn planner(&self, request: &PlanRequest, patience: &Patience) -> Result<Arc<planner::Planner>, Problem> {
        const ONLY_MAP: &str = "";
        let map = KeyedMap { id: ONLY_MAP, terrain: &self.terrain, is_stored: true };
        let (found, _) = request.kept_planner(&self.planners, map, patience)?;
        self.planners.shrink(Limits::default().kept_bytes);
        Ok(found)
    }
}

fn read<T: DeserializeOwned>(request: &str) -> Result<T, Problem> {
    document::from_json(request.as_bytes()).map_err(|error| invalid_request(&error))
}

fn written(answer: &impl Serialize) -> Result<String, Problem> {
    serde_json::to_string(answer).map_err(internal)
}
