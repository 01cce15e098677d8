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
    admission::{Admission, Turn},
    job::{Job, JobState},
    job_records::JobRecords,
    job_run::{Work, called_off},
    jobs::Jobs,
    limits::Limits,
    maps::MapStore,
    memory::Account,
    metrics::{Metrics, StateLabels},
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
    admission: Arc<Admission>,
    /// Documents are read and answers written here, so that no question waits behind long ones.
    readers: Arc<Semaphore>,
    metrics: Metrics,
    /// Whether the service has been asked to end.
    ending: AtomicBool,
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
        let metrics = Metrics::new();
        let admission = Admission::new(&limits, &metrics);
        Ok(Engine(Arc::new(Shared {
            limits,
            maps: MapStore::new(&store, limits.kept_map_bytes, admission.memory()),
            planners: Planners::default(),
            recordings: RecordingStore::new(&store),
            robots: RobotStore::new(&store),
            records: JobRecords::new(&store),
            store,
            jobs: Jobs::default(),
            admission: Arc::new(admission),
            readers: Arc::new(Semaphore::new(limits.parallel_plans.max(1))),
            metrics,
            ending: AtomicBool::new(false),
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

    pub(crate) fn admission(&self) -> &Admission {
        &self.0.admission
    }

    pub(crate) fn metrics(&self) -> &Metrics {
        &self.0.metrics
    }

    /// Lets `/readyz` say that the service is about to end.
    pub(crate) fn announce_end(&self) {
        self.0.ending.store(true, Ordering::Relaxed);
    }

    pub(crate) fn is_ending(&self) -> bool {
        self.0.ending.load(Ordering::Relaxed)
    }

    /// What is counted, as text.
    pub(crate) fn counts(&self) -> String {
        self.admission().tell();
        let metrics = self.metrics();
        metrics.kept_bytes.set(i64::try_from(self.planners().bytes()).unwrap_or(i64::MAX));
        let states = self.jobs().states();
        for (state, name) in JobState::ALL {
            let count = states.iter().filter(|other| **other == state).count();
            metrics.jobs.get_or_create(&StateLabels { state: name }).set(count as i64);
        }
        metrics.text()
    }

    /// Runs a computation on a thread of its own, in turn, or refuses it where that would take too long; its patience ends
    /// when the request does.
    pub(crate) async fn compute<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Patience) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        self.compute_within(0, work).await
    }

    /// The same within memory that the computation has to itself.
    pub(crate) async fn compute_within<T: Send + 'static>(
        &self,
        bytes: u64,
        work: impl FnOnce(&Patience) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let turn = self.0.admission.soon().await?;
        let reserved = self.admission().reserve(bytes)?;
        let deadline = Instant::now() + self.limits().plan_time;
        self.work_in(turn, move |left| {
            let _reserved = reserved;
            work(&Patience::until_or(deadline, Arc::clone(left)))
        })
        .await
    }

    /// Reads a document: at once where it is short, otherwise on a thread of its own.
    pub(crate) async fn read<T: Send + 'static>(
        &self,
        bytes: usize,
        read: impl FnOnce() -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        /// Read in less than a millisecond, which others on the same thread can wait for.
        const SHORT_BYTES: usize = 32 << 10;
        if bytes <= SHORT_BYTES {
            return read();
        }
        self.beside(read).await
    }

    /// Writes an answer on a thread of its own, beside those that read documents.
    pub(crate) async fn write<T: Send + 'static>(
        &self,
        write: impl FnOnce() -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        self.beside(write).await
    }

    /// Does what takes time only by its size, so many at a time, beside those who compute.
    async fn beside<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let turn = Arc::clone(&self.0.readers).acquire_owned().await.map_err(|_| stopping())?;
        self.on_disk(move || {
            let _turn = turn;
            work()
        })
        .await
    }

    /// Runs work on a thread of its own, in turn, for as long as it takes; it is told when the request ends.
    pub(crate) async fn work<T: Send + 'static>(
        &self,
        work: impl FnOnce(&Arc<AtomicBool>) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let turn = self.0.admission.some_time().await?;
        self.work_in(turn, work).await
    }

    async fn work_in<T: Send + 'static>(
        &self,
        turn: Turn,
        work: impl FnOnce(&Arc<AtomicBool>) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let cancelled = Arc::new(AtomicBool::new(false));
        let asked = Asked(Arc::clone(&cancelled));
        let account = Account::current();
        let running = tokio::task::spawn_blocking(move || {
            // The turn ends with the work, not with the request: who leaves early makes no room before it is there.
            let _turn = turn;
            account.during(|| work(&cancelled))
        });
        let outcome = running.await;
        drop(asked);
        outcome.unwrap_or_else(|failure| Err(self.fault(&failure)))
    }

    /// Asks the disk, which may take its time, on a thread of its own.
    pub(crate) async fn on_disk<T: Send + 'static>(
        &self,
        work: impl FnOnce() -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let account = Account::current();
        let working = tokio::task::spawn_blocking(move || account.during(work));
        working.await.unwrap_or_else(|failure| Err(self.fault(&failure)))
    }

    fn fault(&self, failure: &JoinError) -> Problem {
        self.metrics().panics.inc();
        tracing::error!(%failure, "a computation did not finish");
        Problem::new(ProblemType::Internal, "the computation failed; the fault has been logged")
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
    Problem::new(ProblemType::NotReady, "the service is stopping")
}
