//! What all requests share: limits, maps, and the right to compute.

use std::{
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    time::{Duration, Instant},
};

use planner::Patience;
use tokio::{
    sync::{OwnedSemaphorePermit, Semaphore},
    task::JoinError,
};

use crate::{
    Tenant,
    admission::{Admission, Turn},
    job::JobState,
    job_records::JobRecords,
    job_supervision::StuckThreads,
    jobs::Jobs,
    limits::Limits,
    maps::MapStore,
    memory::Account,
    metrics::{Metrics, StateLabels},
    planners::Planners,
    problem::{Problem, ProblemType},
    recordings::RecordingStore,
    robots::RobotStore,
    store::{Store, StoreError, Usage},
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
    /// Documents are read here, so that no question waits behind long ones.
    readers: Arc<Semaphore>,
    /// Answers are written here, so that none waits behind documents that are read.
    writers: Arc<Semaphore>,
    metrics: Metrics,
    /// Whether the service has been asked to end.
    ending: AtomicBool,
    /// Jobs take a turn here before they wait for one among all computations.
    job_turns: Arc<Semaphore>,
    stuck_threads: StuckThreads,
}

/// What a computation may take to notice that its time is over, put down its best path and let go of its tables; who asked
/// does not wait longer for it: half of the 50 ms by which no answer may be late.
const LAST_STEPS: Duration = Duration::from_millis(25);

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
            writers: Arc::new(Semaphore::new(limits.parallel_plans.max(1))),
            metrics,
            ending: AtomicBool::new(false),
            job_turns: Arc::new(Semaphore::new(limits.parallel_jobs.max(1))),
            stuck_threads: StuckThreads::default(),
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

    /// What a tenant keeps.
    pub(crate) async fn usage(&self, tenant: &Tenant) -> Result<Usage, Problem> {
        Usage::of(&self.0.store, tenant).await
    }

    /// Bytes that a tenant may still store.
    pub(crate) async fn free_bytes(&self, tenant: &Tenant) -> Result<u64, Problem> {
        if tenant.is_admin() {
            return Ok(u64::MAX);
        }
        Ok(self.limits().tenant_bytes.saturating_sub(self.usage(tenant).await?.bytes))
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
        metrics.stuck_threads.set(i64::try_from(self.stuck_threads().count()).unwrap_or(i64::MAX));
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
        let turn = self.0.admission.soon().await?;
        let deadline = Instant::now() + self.limits().plan_time;
        self.work_in(turn, move |left| work(&Patience::until_or(deadline, Arc::clone(left)))).await
    }

    /// The same within memory that the computation has to itself, and up to the request's own deadline, which counts while it
    /// waits for its turn. The answer comes by then, whatever the computation still has to put away.
    pub(crate) async fn compute_within<T: Send + 'static>(
        &self,
        bytes: u64,
        own_deadline: Option<Instant>,
        work: impl FnOnce(&Patience) -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let turn = self.0.admission.before(own_deadline).await?;
        let reserved = self.admission().reserve(bytes)?;
        let longest = Instant::now() + self.limits().plan_time;
        let deadline = own_deadline.map_or(longest, |own| own.min(longest));
        let answer = self.work_in(turn, move |left| {
            let _reserved = reserved;
            work(&Patience::until_or(deadline, Arc::clone(left)))
        });
        tokio::time::timeout_at((deadline + LAST_STEPS).into(), answer).await.unwrap_or_else(|_| {
            let detail =
                "the time was over before there was a path to show: allow more time, or a looser bound";
            Err(Problem::new(ProblemType::Timeout, detail))
        })
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
        self.beside(&self.0.readers, read).await
    }

    /// Writes an answer on a thread of its own, beside those that read documents.
    pub(crate) async fn write<T: Send + 'static>(
        &self,
        write: impl FnOnce() -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        self.beside(&self.0.writers, write).await
    }

    /// Does what takes time only by its size, so many at a time, beside those who compute.
    async fn beside<T: Send + 'static>(
        &self,
        turns: &Arc<Semaphore>,
        work: impl FnOnce() -> Result<T, Problem> + Send + 'static,
    ) -> Result<T, Problem> {
        let turn = Arc::clone(turns).acquire_owned().await.map_err(|_| stopping())?;
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
        self.outcome(outcome)
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

    /// A turn among jobs and one among all computations.
    pub(crate) async fn job_turns(&self) -> Result<(OwnedSemaphorePermit, Turn), Problem> {
        let turn = Arc::clone(&self.0.job_turns).acquire_owned().await.map_err(|_| stopping())?;
        Ok((turn, self.0.admission.some_time().await?))
    }

    /// Threads of jobs that do not end although they were told to.
    pub(crate) fn stuck_threads(&self) -> &StuckThreads {
        &self.0.stuck_threads
    }

    /// What came of work on a thread, whose panic is a fault of the service.
    pub(crate) fn outcome<T>(&self, outcome: Result<Result<T, Problem>, JoinError>) -> Result<T, Problem> {
        outcome.unwrap_or_else(|failure| Err(self.fault(&failure)))
    }

    /// Whether the service can do what it is there for: it goes on, computes, does jobs, and reaches its store.
    ///
    /// # Errors
    /// What it cannot do.
    pub async fn check_ready(&self) -> Result<(), Problem> {
        let not_ready = |detail: String| Err(Problem::new(ProblemType::NotReady, detail));
        if self.is_ending() {
            return not_ready("the service is about to end: ask another replica".into());
        }
        if self.admission().is_stalled(Instant::now()) {
            let detail = "every computation takes longer than the longest allowed time: ask another replica, and restart this one";
            return not_ready(detail.into());
        }
        let stuck = self.stuck_threads().count();
        if stuck > 0 {
            let detail = format!(
                "{stuck} cancelled jobs do not end and take processors from others: ask another replica, and restart this one"
            );
            return not_ready(detail);
        }
        self.check_store().await
    }
}

fn stopping() -> Problem {
    Problem::new(ProblemType::NotReady, "the service is stopping")
}
