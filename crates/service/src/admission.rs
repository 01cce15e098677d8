//! Who may compute: so many at a time, so many waiting for so long.

use std::{
    sync::{
        Arc, Mutex, PoisonError,
        atomic::{AtomicUsize, Ordering},
    },
    time::{Duration, Instant},
};

use tokio::sync::{OwnedSemaphorePermit, Semaphore};

use crate::{
    Limits,
    memory::{Memory, Reserved},
    metrics::{Metrics, ShedLabels, StateLabels},
    problem::{Problem, ProblemType},
    turns::{HeldTurn, HeldTurns},
};

/// Share of the latest computation in the mean of how long one takes.
const LATEST_SHARE: f64 = 0.1;

/// Turns and memory for computations.
pub(crate) struct Admission {
    turns: Arc<Semaphore>,
    memory: Memory,
    limits: Limits,
    waiting: AtomicUsize,
    held: HeldTurns,
    /// Mean time that a computation took of late [s].
    mean_s: Mutex<f64>,
    metrics: Metrics,
}

/// The right to compute until it is dropped.
pub(crate) struct Turn {
    admission: Arc<Admission>,
    /// When it began, if its time is to count for those who wait.
    began: Option<Instant>,
    _held: HeldTurn,
    _turn: OwnedSemaphorePermit,
}

impl Admission {
    pub(crate) fn new(limits: &Limits, metrics: &Metrics) -> Self {
        Admission {
            turns: Arc::new(Semaphore::new(limits.parallel_plans.max(1))),
            memory: Memory::new(limits.request_memory_bytes, metrics),
            limits: *limits,
            waiting: AtomicUsize::new(0),
            held: HeldTurns::default(),
            mean_s: Mutex::new(0.0),
            metrics: metrics.clone(),
        }
    }

    /// A turn for a request that is to be answered soon; refused at once where it could not be.
    pub(crate) async fn soon(self: &Arc<Self>) -> Result<Turn, Problem> {
        if let Ok(turn) = Arc::clone(&self.turns).try_acquire_owned() {
            return Ok(self.turn(turn, Some(Instant::now())));
        }
        let ahead = self.waiting.load(Ordering::Relaxed);
        let wait = self.projected_wait(ahead + 1);
        let is_crowded = ahead >= self.limits.queued_plans;
        if is_crowded || (ahead >= self.limits.patient_plans && wait > self.limits.queue_time) {
            self.metrics.shed.get_or_create(&ShedLabels { reason: "queue" }).inc();
            let detail = format!(
                "{ahead} requests wait already, for about {:.1} s: try again then",
                wait.as_secs_f64()
            );
            return Err(Problem::new(ProblemType::Overloaded, detail).retry_after(wait));
        }
        self.acquire(true).await
    }

    /// A turn as [`Admission::soon`] gives it, or a refusal at a deadline that passes while the request waits.
    pub(crate) async fn before(self: &Arc<Self>, deadline: Option<Instant>) -> Result<Turn, Problem> {
        let Some(deadline) = deadline else { return self.soon().await };
        tokio::time::timeout_at(deadline.into(), self.soon()).await.unwrap_or_else(|_| {
            let detail = "the request's time was over before its turn to compute came: give it more time, or try again when the \
                          service has less to do";
            Err(Problem::new(ProblemType::Timeout, detail))
        })
    }

    /// A turn for work that nobody waits for.
    pub(crate) async fn some_time(self: &Arc<Self>) -> Result<Turn, Problem> {
        self.acquire(false).await
    }

    async fn acquire(self: &Arc<Self>, counts: bool) -> Result<Turn, Problem> {
        let _waiting = counts.then(|| Waiting::begin(self));
        let turn = Arc::clone(&self.turns).acquire_owned().await.map_err(|_| stopping())?;
        Ok(self.turn(turn, counts.then(Instant::now)))
    }

    fn turn(self: &Arc<Self>, turn: OwnedSemaphorePermit, began: Option<Instant>) -> Turn {
        self.running().inc();
        let allowed = if began.is_some() { self.limits.plan_time } else { self.limits.job_time };
        let held = self.held.hold(Instant::now(), allowed);
        Turn { admission: Arc::clone(self), began, _held: held, _turn: turn }
    }

    /// Whether nothing can be computed: every turn is held for longer than it may be.
    pub(crate) fn is_stalled(&self, now: Instant) -> bool {
        self.held.overdue(now) >= self.limits.parallel_plans.max(1)
    }

    fn running(&self) -> impl std::ops::Deref<Target = prometheus_client::metrics::gauge::Gauge> + '_ {
        self.metrics.computations.get_or_create(&StateLabels { state: "running" })
    }

    /// How long the last of so many would wait, if all take as long as of late.
    fn projected_wait(&self, waiting: usize) -> Duration {
        let mean_s = *self.mean_s.lock().unwrap_or_else(PoisonError::into_inner);
        Duration::from_secs_f64(mean_s * waiting as f64 / self.limits.parallel_plans.max(1) as f64)
    }

    fn took(&self, time: Duration) {
        let mut mean_s = self.mean_s.lock().unwrap_or_else(PoisonError::into_inner);
        *mean_s += LATEST_SHARE * (time.as_secs_f64() - *mean_s);
    }

    /// Memory for a request; refused at once where others have it.
    pub(crate) fn reserve(&self, bytes: u64) -> Result<Reserved, Problem> {
        self.memory.reserve(bytes)
    }

    /// The memory that requests share.
    pub(crate) fn memory(&self) -> &Memory {
        &self.memory
    }

    /// Brings what is counted elsewhere up to date.
    pub(crate) fn tell(&self) {
        let waiting = self.waiting.load(Ordering::Relaxed);
        let state = |state| self.metrics.computations.get_or_create(&StateLabels { state });
        state("waiting").set(i64::try_from(waiting).unwrap_or(i64::MAX));
        drop(self.running());
        self.metrics.projected_wait_s.set(self.projected_wait(waiting).as_secs_f64());
    }
}

/// Counts one who waits, also where it leaves before its turn.
struct Waiting<'a>(&'a AtomicUsize);

impl<'a> Waiting<'a> {
    fn begin(admission: &'a Admission) -> Self {
        admission.waiting.fetch_add(1, Ordering::Relaxed);
        Waiting(&admission.waiting)
    }
}

impl Drop for Waiting<'_> {
    fn drop(&mut self) {
        self.0.fetch_sub(1, Ordering::Relaxed);
    }
}

impl Drop for Turn {
    fn drop(&mut self) {
        self.admission.running().dec();
        if let Some(began) = self.began {
            self.admission.took(began.elapsed());
        }
    }
}

fn stopping() -> Problem {
    Problem::new(ProblemType::NotReady, "the service is stopping")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn admission(limits: Limits) -> Arc<Admission> {
        Arc::new(Admission::new(&limits, &Metrics::new()))
    }

    fn narrow() -> Limits {
        let (parallel_plans, patient_plans, queued_plans) = (1, 2, 4);
        Limits { parallel_plans, patient_plans, queued_plans, ..Limits::default() }
    }

    #[tokio::test]
    async fn who_would_wait_too_long_is_refused_at_once_and_told_when_to_come_back() {
        let admission = admission(narrow());
        *admission.mean_s.lock().unwrap() = 2.0;
        let turn = admission.soon().await.unwrap();
        let queue: Vec<_> = (0..2)
            .map(|_| {
                let admission = Arc::clone(&admission);
                tokio::spawn(async move { admission.soon().await.map(drop) })
            })
            .collect();
        while admission.waiting.load(Ordering::Relaxed) < 2 {
            tokio::task::yield_now().await;
        }
        let refused = admission.soon().await.err().unwrap();
        assert_eq!((refused.kind, refused.retry_after_s), (ProblemType::Overloaded, Some(6)));
        drop(turn);
        for waiting in queue {
            assert!(waiting.await.unwrap().is_ok());
        }
        assert!(admission.soon().await.is_ok(), "nobody waits any more");
    }

    #[tokio::test]
    async fn where_computations_are_quick_more_may_wait_up_to_a_limit() {
        let admission = admission(narrow());
        let _turn = admission.soon().await.unwrap();
        let queue: Vec<_> = (0..4)
            .map(|_| {
                let admission = Arc::clone(&admission);
                tokio::spawn(async move { admission.soon().await.map(drop) })
            })
            .collect();
        while admission.waiting.load(Ordering::Relaxed) < 4 {
            tokio::task::yield_now().await;
        }
        assert!(admission.soon().await.is_err());
        queue.iter().for_each(tokio::task::JoinHandle::abort);
        for left in queue {
            assert!(left.await.is_err());
        }
        assert_eq!(admission.waiting.load(Ordering::Relaxed), 0, "who leaves does not wait");
    }

    #[tokio::test]
    async fn nothing_can_be_computed_while_every_turn_is_held_for_too_long() {
        let admission = admission(Limits { parallel_plans: 2, ..Limits::default() });
        let late = Instant::now() + admission.limits.plan_time + Duration::from_secs(60);
        let first = admission.soon().await.unwrap();
        assert!(!admission.is_stalled(late), "one turn is free");
        let second = admission.soon().await.unwrap();
        assert!(!admission.is_stalled(Instant::now()), "both are within their time");
        assert!(admission.is_stalled(late));
        drop(first);
        assert!(!admission.is_stalled(late));
        let _job = admission.some_time().await.unwrap();
        assert!(!admission.is_stalled(late), "a job may take longer than a plan");
        drop(second);
    }

    #[tokio::test]
    async fn a_deadline_that_passes_while_a_request_waits_ends_its_wait_and_takes_no_turn() {
        let admission = admission(narrow());
        let turn = admission.soon().await.unwrap();
        let refused = admission.before(Some(Instant::now())).await.err().unwrap();
        assert_eq!(refused.kind, ProblemType::Timeout);
        assert_eq!(admission.waiting.load(Ordering::Relaxed), 0, "a refused request does not wait");
        drop(turn);
        let later = Instant::now() + Duration::from_secs(3600);
        assert!(admission.before(Some(later)).await.is_ok(), "the refused request holds no turn");
    }
}
