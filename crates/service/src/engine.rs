//! What all requests share: limits, maps, and the right to compute.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::Instant,
};

use planner::Patience;
use serde_json::Value;
use tokio::{sync::Semaphore, task::JoinError};

use crate::{
    job::Job,
    job_records::JobRecords,
    job_run::{Work, called_off},
    jobs::Jobs,
    limits::Limits,
    maps::MapStore,
    planners::Planners,
    problem::{Problem, ProblemType},
    recordings::RecordingStore,
    robots::RobotStore,
    store::{Store, StoreError},
};

/// The state behind the router; cheap to clone.
#[derive(Clone)]
pub struct Engine(Arc<Shared>);

struct Shared {
    limits: Limits,
    maps: MapStore,
    planners: Planners,
    recordings: RecordingStore,
    robots: RobotStore,
    records: JobRecords,
    store: Store,
    jobs: Jobs,
    turns: Arc<Semaphore>,
    /// Jobs take a turn here before they wait for one among all computations.
    job_turns: Arc<Semaphore>,
}

/// Cancels a computation when its request is dropped, as it is when the client leaves.
struct Asked(Arc<AtomicBool>);

impl Drop for Asked {
    fn drop(&mut self) {
        self.0.store(true, Ordering::Relaxed);
    }
}

impl Engine {
    /// An engine over a store: a folder or `s3://BUCKET/PREFIX`, what is kept there being at hand; without one, a folder that
    /// lasts as long as the engine. Not to be called where tasks run.
    ///
    /// # Errors
    /// When nothing can be kept there.
    pub fn new(limits: Limits, store: Option<&str>) -> Result<Self, StoreError> {
        let store = Store::open(store)?;
        Ok(Engine(Arc::new(Shared {
            limits,
            maps: MapStore::new(&store, limits.kept_map_bytes),
            planners: Planners::default(),
            recordings: RecordingStore::new(&store),
            robots: RobotStore::new(&store),
            records: JobRecords::new(&store),
            store,
            jobs: Jobs::default(),
            turns: Arc::new(Semaphore::new(limits.parallel_plans.max(1))),
            job_turns: Arc::new(Semaphore::new(limits.parallel_jobs.max(1))),
        })))
    }

    /// What one request may ask for.
    pub fn limits(&self) -> &Limits {
        &self.0.limits
    }

    pub(crate) fn maps(&self) -> &MapStore {
        &self.0.maps
    }

    pub(crate) fn planners(&self) -> &Planners {
        &self.0.planners
    }

    pub(crate) fn recordings(&self) -> &RecordingStore {
        &self.0.recordings
    }

    pub(crate) fn robots(&self) -> &RobotStore {
        &self.0.robots
    }

    /// What the store knows of jobs.
    pub(crate) fn records(&self) -> &JobRecords {
        &self.0.records
    }

    /// The jobs that this service works on.
    pub(crate) fn jobs(&self) -> &Jobs {
        &self.0.jobs
    }

    /// Whether what is sent can be kept at the moment.
    ///
    /// # Errors
    /// When the store is out of reach or full.
    pub async fn check_store(&self) -> Result<(), Problem> {
        self.0.store.check().await
    }

    /// Runs a computation on a thread of its own, in turn; its patience ends when the request does.
    pub(crate) async fn compute<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Patience) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let deadline = Instant::now() + self.limits().plan_time;
        self.work(move |left| work(&Patience::until_or(deadline, Arc::clone(left)))).await
    }

    /// Runs work on a thread of its own, in turn, for as long as it takes; it is told when the request ends.
    pub(crate) async fn work<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Arc<AtomicBool>) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let turn = Arc::clone(&self.0.turns).acquire_owned().await.map_err(|_| stopping())?;
        let cancelled = Arc::new(AtomicBool::new(false));
        let asked = Asked(Arc::clone(&cancelled));
        let running = tokio::task::spawn_blocking(move || {
            // The turn ends with the work, not with the request: who leaves early makes no room before it is there.
            let _turn = turn;
            work(&cancelled)
        });
        let outcome = running.await;
        drop(asked);
        outcome.unwrap_or_else(|failure| Err(fault(&failure)))
    }

    /// Does a job's work, which takes its turn among jobs and among computations.
    pub(crate) async fn run(&self, job: &Arc<Job>, work: Box<dyn Work>) -> Result<Value, Problem> {
        let turn = Arc::clone(&self.0.job_turns).acquire_owned().await.map_err(|_| stopping())?;
        let (engine, running) = (self.clone(), Arc::clone(job));
        self.work(move |_| {
            let _turn = turn;
            if running.is_called_off() { Err(called_off()) } else { work.run(&engine, &running) }
        })
        .await
    }
}

fn stopping() -> Problem {
    Problem::new(ProblemType::Internal, "the service is stopping")
}

fn fault(failure: &JoinError) -> Problem {
    tracing::error!(%failure, "a computation did not finish");
    Problem::new(ProblemType::Internal, "the computation failed; the fault has been logged")
}
